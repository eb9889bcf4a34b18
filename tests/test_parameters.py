"""Parameters declared once: a class checks itself by what a scenario's table refuses too."""

import dataclasses
from typing import get_args

import pytest

from antenna_pin import changes, settings
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.integrate.methods import METHODS
from antenna_pin.parameters import parameters_of
from antenna_pin.scenario import (
    IntegratorSpec,
    JointSpec,
    LinkSpec,
    MadeSpec,
    OutputSpec,
    ScalesSpec,
    ShapeSpec,
)

PAIRS = [
    (settings.ErrorScales, ScalesSpec),
    (settings.RunSettings, IntegratorSpec),
    (settings.RunSettings, OutputSpec),
    (changes.ShapeChange, ShapeSpec),
    (changes.LinkChange, LinkSpec),
    (changes.JointChange, JointSpec),
]


@pytest.mark.parametrize(("cls", "table"), PAIRS, ids=lambda one: one.__name__)
def test_a_table_refuses_what_its_class_refuses(cls: type, table: type[MadeSpec]) -> None:
    """For the same reason, whichever number it is; and an empty table builds what the class is by default."""
    assert table().build() == cls()
    for name, parameter in parameters_of(cls).items():
        key = {**{field: key for key, field in table.fields_of_keys.items()}}.get(name, name)
        if key not in table.model_fields:
            continue
        bad = [[-1.0] * max(*parameter.sizes, 1)] if parameter.sizes else [-1.0]
        for value in bad if parameter.rule else []:
            with pytest.raises(InvalidParameterError, match=f"{cls.__name__}: {name} must be"):
                cls(**{name: value})
            with pytest.raises(ScenarioError, match=f"{table.__name__}: {key} must be {parameter.rule}, got"):
                table(**{key: value})


def test_rules_that_tie_numbers_together_hold_in_both() -> None:
    bad = {"min_step": 1.0}
    for make in (settings.RunSettings, IntegratorSpec):
        with pytest.raises(ValueError, match=r"min_step must be below max_step = 0.01 s, got 1 s"):
            make(**bad)


def test_every_number_that_is_set_has_a_unit_and_a_meaning() -> None:
    for cls in {cls for cls, _ in PAIRS}:
        for item in dataclasses.fields(cls):
            assert "unit" in item.metadata or "float" not in str(item.type), item.name


def test_methods_that_can_be_asked_for_are_those_there_are() -> None:
    assert set(get_args(settings.Method)) == set(METHODS)
