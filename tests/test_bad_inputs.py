"""Bad inputs are refused in one line: a part of those of ``robustness.py`` by default, all if asked."""

import importlib
import os
import sys
import warnings
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[1] / "scripts" / "check"
FEW = 8  # of so many one is tried by default


sys.path.insert(0, str(SCRIPTS))
case, inputs = map(importlib.import_module, ("bad_inputs.case", "robust.inputs"))
CASES = importlib.import_module("robust.bad_inputs").all_cases()
sys.path.remove(str(SCRIPTS))


@pytest.mark.parametrize(
    "bad",
    [
        pytest.param(bad, id=f"{bad.room}-{number}", marks=() if number % FEW == 0 else pytest.mark.slow)
        for number, bad in enumerate(CASES)
    ],
)
def test_a_bad_input_is_refused_in_one_line(bad, tmp_path):
    problem = inputs.problem_of(bad.draft, tmp_path)
    if "need a browser" in (problem or "") and os.environ.get("ANTENNA_PIN_TEST_BROWSER") != "required":
        pytest.skip("no browser")
    assert problem is None, bad.name


def test_there_are_hundreds_of_all_kinds():
    rooms = [bad.room for bad in CASES]
    assert {room: rooms.count(room) >= 40 for room in set(rooms)} == dict.fromkeys(
        ("urdf", "toml", "units", "options", "results", "python"), True
    )
    names = [(bad.room, bad.name) for bad in CASES]
    assert len(set(names)) == len(names) > 600


def noisy():
    warnings.warn("a warning", UserWarning, stacklevel=1)


@pytest.mark.parametrize(
    ("says", "act", "problem"),
    [
        ("", ("urdf", "scenario.toml"), "not refused"),
        ("zebra", ("run", "no.toml"), "the refusal names none of zebra"),
        ("", lambda: 1 / 0, "ZeroDivisionError"),
        ("", noisy, "UserWarning"),
    ],
)
def test_what_is_not_refused_is_noticed(says, act, problem, tmp_path):
    """A sound scenario, a refusal of other words, an exception that is none of ours, a warning."""
    bad = case.Case("toml", "some", says, act, case.FILES)
    assert problem in inputs.problem_of(bad.draft, tmp_path)
