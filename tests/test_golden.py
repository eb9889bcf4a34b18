"""Does a fingerprint of behaviour notice what changes in it?"""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "scripts" / "check"))
golden = importlib.import_module("golden")
sys.path.pop(0)
_array, _clean, compared = golden._array, golden._clean, golden.compared

OLD = {
    "run/q": _array(np.array([1.0, 2.0])),
    "info": "exit code 0\nforce 3 N",
    "modes": {"value": [1.0], "doubt": [0.1]},
}


@pytest.mark.parametrize(
    ("name", "new", "said"),
    [
        ("run/q", _array(np.array([1.0, np.nextafter(2.0, 3.0)])), "shape [2], sum 3 before"),
        ("run/q", _array(np.array([2.0, 1.0])), "sum 3 after"),
        ("run/q", "MechanismError: no", "MechanismError"),
        ("info", "exit code 0\nforce 4 N", "'force 3 N' before, 'force 4 N' after"),
        ("info", "exit code 0", "2 lines before, 1 after"),
        ("modes", {"value": [1.3], "doubt": [0.1]}, "[1.0] before, [1.3] after"),
        ("modes", {"value": [float("nan")], "doubt": [0.1]}, "[nan] after"),
        ("modes", {"value": [1.0, 2.0], "doubt": [0.1, 0.1]}, "2 numbers after"),
    ],
)
def test_each_kind_of_change_is_a_line(name, new, said):
    (line,) = compared(OLD, OLD | {name: new})
    assert line.startswith(f"{name}: ") and said in line


def test_what_is_the_same_or_within_its_doubt_is_none():
    within = {"modes": {"value": [1.15], "doubt": [0.1]}, "run/q": _array(np.array([1.0, 2.0]))}
    assert not list(compared(OLD, OLD | within))
    assert list(compared(OLD, {})) == [f"{name}: only before" for name in sorted(OLD)]


def test_what_the_machine_says_of_itself_is_left_out():
    assert (
        _clean("in 3.25 s of wall time, antenna-pin: note: fit is at work, for 3 s\n")
        == "in ~ s of wall time, "
    )
