"""Inputs with something changed, some of every format: ``robustness.py fuzz`` has them by the thousand."""

import importlib
import sys
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Annotated

import pytest

from antenna_pin.scenario.spec import Count, QuantityRule, Spec

SCRIPTS = str(Path(__file__).parents[1] / "scripts" / "check")
SEED, FEW = 1, 4

sys.path.insert(0, SCRIPTS)
fuzz, inputs, declared = map(importlib.import_module, ("robust.fuzz", "robust.inputs", "fuzzing.declared"))
sys.path.remove(SCRIPTS)


@pytest.mark.parametrize("kind", fuzz.FORMATS)
def test_no_input_ends_in_anything_but_a_result_or_a_line(kind):
    names = fuzz.inputs_of([kind], FEW)
    found = {name: problem for name in names if (problem := fuzz.least_problem(fuzz.drawn(SEED, name)))}
    assert found == {}


def test_an_input_follows_from_seed_and_name():
    one, other = (fuzz.drawn(SEED, f"scenario:{number}") for number in (3, 4))
    assert fuzz.drawn(SEED, "scenario:3").name == one.name != other.name
    assert fuzz.drawn(SEED + 1, "scenario:3").name != one.name


def draft(act, *, wrong=False, says=()):
    change = inputs.Change("change", lambda work: None, wrong, says)
    return inputs.Draft((change, replace(change, name="another")), lambda kept: inputs.Input({}, act))


@pytest.mark.parametrize(
    ("act", "said"),
    [
        (lambda: 1 / 0, "ZeroDivisionError"),
        (lambda: sys.exit(3), "SystemExit"),
        (("list", "--csv", "a.csv"), None),
        (("run", "no.toml"), None),
    ],
)
def test_what_must_not_come_is_noticed_and_told_by_one_change(act, said):
    found = fuzz.least_problem(draft(act))
    assert found is None if said is None else (found[0].name, said in found[1]) == ("change", True)


def test_what_is_wrong_must_be_refused_and_its_place_be_named(tmp_path):
    one = draft(("run", "no.toml"), wrong=True, says=("rtol",))
    one = replace(one, changes=one.changes[:1])
    assert "names none of rtol" in inputs.problem_of(one, tmp_path)
    assert inputs.problem_of(replace(one, made=draft(("list",)).made), tmp_path) == "not refused"


class Inner(Spec):
    """A table."""

    speed: Annotated[float, QuantityRule("m/s", "positive")]


class Outer(Spec):
    """A table of tables."""

    laps: Annotated[int, Count(2, 8, even=True)] = 2
    inner: dict[str, Inner]


def test_what_is_declared_is_tried_without_a_word_more():
    places = {place.path: place for place in declared.places_of(Outer, {"inner": {"a": {"speed": 1.0}}})}
    assert {("laps",), ("inner", "a", "speed"), ("inner", "*")} <= places.keys()
    chance, names = Random(1), {"": ["a"]}
    for what, wrong in (
        (places["laps",].what, (3, 2.5, 10, True, "2 s", float("nan"))),
        (places["inner", "a", "speed"].what, (0.0, -1.0, "1 m", "x", [1.0], float("inf"))),
    ):
        assert not any(what.admits(value) for value in wrong)
        assert all(what.admits(what.sound(chance, names)) for _ in range(50))
