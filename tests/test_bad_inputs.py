"""Bad inputs are refused in one line: a part of ``check/bad_inputs.py`` by default, all of it if asked."""

import importlib
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[1] / "scripts" / "check"
FEW = 8  # of so many one is tried by default


def _all_cases():
    sys.path.insert(0, str(SCRIPTS))
    try:
        return importlib.import_module("bad_inputs").all_cases()
    finally:
        sys.path.remove(str(SCRIPTS))


CASES = _all_cases()


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=f"{case.room}-{number}", marks=() if number % FEW == 0 else pytest.mark.slow)
        for number, case in enumerate(CASES)
    ],
)
def test_a_bad_input_is_refused_in_one_line(case, tmp_path):
    problem_of = sys.modules["bad_input_case"].problem_of
    assert problem_of(case, tmp_path) is None, case.name


def test_there_are_hundreds_of_all_kinds():
    rooms = [case.room for case in CASES]
    assert {room: rooms.count(room) >= 40 for room in set(rooms)} == dict.fromkeys(
        ("urdf", "toml", "units", "options", "results", "python"), True
    )
    names = [(case.room, case.name) for case in CASES]
    assert len(set(names)) == len(names) > 600


def test_what_is_not_refused_is_noticed(tmp_path):
    """A sound scenario, a refusal of other words, an exception that is none of ours."""
    kind = sys.modules["bad_input_case"]
    files = {"scenario.toml": kind.SCENARIO, "pair.urdf": kind.MECHANISM}
    (tmp_path / "a").mkdir()
    sound = kind.Case("toml", "sound", "", ("urdf", "scenario.toml"), files)
    assert "exit code 0" in kind.problem_of(sound, tmp_path / "a")
    assert "does not say 'zebra'" in kind.problem_of(
        kind.Case("toml", "", "zebra", ("run", "no.toml")), tmp_path
    )
    assert "ZeroDivisionError" in kind.problem_of(kind.Case("python", "", "", lambda: 1 / 0), tmp_path)
