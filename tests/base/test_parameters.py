"""Parameters declared once: a class checks itself by what a scenario's table refuses too."""

import dataclasses
import math
import re
from collections.abc import Iterator
from typing import get_args

import numpy as np
import pytest

from antenna_pin.base import changes, settings
from antenna_pin.base.changes import JointChange, LinkChange
from antenna_pin.base.directions import A_DIRECTION
from antenna_pin.base.lazy import Classes
from antenna_pin.base.parameters import Parameter, parameters_of
from antenna_pin.base.units import shown
from antenna_pin.elements import SineDrive
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.integrate.methods import METHODS
from antenna_pin.scenario import (
    FAMILY_SPECS,
    REFERENCE_SPECS,
    SPRING_SPECS,
    InitialBaseSpec,
    InitialJointSpec,
    IntegratorSpec,
    JointSpec,
    LinkSpec,
    MadeSpec,
    OutputSpec,
    PlaceSpec,
    ScalesSpec,
    ShapeSpec,
    _class_tables,
)
from antenna_pin.scenario._class_tables import Tables
from antenna_pin.scenario.spec import Spec

PAIRS = [
    (settings.ErrorScales, ScalesSpec),
    (settings.RunSettings, IntegratorSpec),
    (settings.RunSettings, OutputSpec),
    (changes.ShapeChange, ShapeSpec),
    (changes.LinkChange, LinkSpec),
    (changes.JointChange, JointSpec),
]


def breaches(parameter: Parameter) -> Iterator[object]:
    """Yield values against a declaration: no number, a foreign unit, against the rule, another size."""
    numbers = [math.nan, "1 K"]
    if parameter.rule:
        numbers.append(0.0 if parameter.rule == A_DIRECTION else -1.0)
    if not parameter.sizes:
        yield from numbers
        return
    size = max(*parameter.sizes, 1)
    yield from ([number] * size for number in numbers)
    if parameter.sizes != (0,):
        yield [0.5] * (size + 1)
        yield 0.5


@pytest.mark.parametrize(("cls", "table"), PAIRS, ids=lambda one: one.__name__)
def test_a_table_refuses_what_its_class_refuses(cls: type, table: type[MadeSpec]) -> None:
    """Whichever number it is; and an empty table builds what the class is by default."""
    assert table().build() == cls()
    keys = {field: key for key, field in table.fields_of_keys.items()}
    for name, parameter in parameters_of(cls).items():
        key = keys.get(name, name)
        if key not in table.model_fields:
            continue
        for value in breaches(parameter):
            with pytest.raises(InvalidParameterError, match=rf"{cls.__name__}: {name}(\[0\])? must be"):
                cls(**{name: value})
            with pytest.raises(ScenarioError, match=rf"{table.__name__}: {key}(\[0\])? must be"):
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


def _classes(base: type) -> set[type]:
    return {base} | {one for below in base.__subclasses__() for one in _classes(below)}


def _flags() -> Iterator[tuple[type, str]]:
    for cls in sorted(_classes(Spec), key=lambda one: one.__name__):
        for name, field in cls.model_fields.items():
            if bool in (field.annotation, *get_args(field.annotation)) and str not in get_args(
                field.annotation
            ):
                yield cls, name


def test_true_and_false_are_themselves() -> None:
    """Of every key of every table, whatever else it lacks: nothing but true and false, NumPy's too."""
    for tables in (*FAMILY_SPECS.values(), REFERENCE_SPECS, *vars(_class_tables).values()):
        if isinstance(tables, Tables | Classes):
            dict(tables)  # each is made when it is first asked for
    assert len(set(_flags())) >= 10
    for cls, name in _flags():
        given = {key: None for key, field in cls.model_fields.items() if field.is_required()}
        for value in ("no", "off", "true", 1, 0, 1.0, []):
            with pytest.raises(
                ScenarioError, match=f"{name} must be true or false, got {re.escape(shown(value))}"
            ):
                cls(**{**given, name: value})
    for value in (True, np.True_):
        assert SPRING_SPECS["spring"](joint="a", stiffness=1.0, shorter_way=value).build().shorter_way is True


@pytest.mark.parametrize("value", [True, np.True_, np.array(True), np.array([1.0]), "1_0"])
def test_true_is_no_number(value: object) -> None:
    with pytest.raises(InvalidParameterError, match="step must be"):
        settings.RunSettings(method="rk4", step=value)
    with pytest.raises(ScenarioError, match=r"step must be|step\[0\] must be"):
        IntegratorSpec(method="rk4", step=value)


FAR, LARGE = (8e9, 1e10, r"at most 8.6e\+09 {} in size, up to"), (1e99, 1e101, r"at most 1e\+100 in size")


@pytest.mark.parametrize(
    ("make", "name", "bounds", "unit"),
    [
        (lambda x: JointChange(origin_xyz=(0.0, x, 0.0)), "origin_xyz must be 3 numbers", FAR, "m"),
        (lambda x: JointChange(origin_rpy=(0.0, x, 0.0)), "origin_rpy must be 3 numbers", FAR, "rad"),
        (lambda x: JointChange(lower=-x), "lower must be", FAR, "rad"),
        (lambda x: InitialBaseSpec(position=(0.0, x, 0.0)), r"position\[1\] must be", FAR, "m"),
        (lambda x: InitialJointSpec(angle=x), "angle must be", FAR, "rad"),
        (lambda x: InitialJointSpec(position=-x), "position must be", FAR, "rad"),
        (lambda x: PlaceSpec(link="a", point=(0, 0, x)), r"point\[2\] must be", FAR, "m"),
        (lambda x: InitialJointSpec(rate=x), "rate must be", LARGE, ""),
        (lambda x: LinkChange(mass=x), "mass must be", LARGE, ""),
        (lambda x: SineDrive(joint="a", amplitude=x, frequency=1.0), "amplitude must be", LARGE, ""),
        (lambda x: SineDrive(joint="a", amplitude=1.0, frequency=x), "frequency must be", LARGE, ""),
        (
            lambda x: SineDrive(joint="a", amplitude=1.0, frequency=1.0 / x),
            "frequency must be",
            (*LARGE[:2], "1e-100 or more, got"),
            "",
        ),
    ],
)
def test_what_a_double_does_not_hold_is_refused(make, name, bounds, unit):
    """A place or an angle of which a millionth is lost; a number of which products overflow, or vanish."""
    good, bad, says = bounds
    make(good)
    with pytest.raises(ValueError, match=f"{name} {says.format(unit)}"):
        make(bad)
