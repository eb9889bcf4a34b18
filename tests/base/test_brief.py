"""How results, models and scenarios show themselves in a shell."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin import RunSettings, build_system, load_scenario, load_study, simulate
from antenna_pin.base.readable import of_size
from antenna_pin.studies.linear import frequency_response, modes


@pytest.fixture(scope="module")
def shown():
    scenario = load_scenario("chen2021")
    system = build_system(scenario)
    run = simulate(scenario, duration="0.2 ms")
    found = modes(load_scenario("bai2020", case="flexible"))
    return {
        "scenario": scenario,
        "system": system,
        "mechanism": system.mechanism,
        "urdf": system.mechanism.urdf,
        "run": run,
        "state": run.end,
        "counts": run.counts,
        "settings": RunSettings(),
        "joint": system.clearances[0],
        "closure": next(iter(system.closures.values())),
        "drive": next(iter(system.drives.values())),
        "modes": found,
        "linearisation": found.linearisation,
        "study": load_study("bai2020/tolerances"),
        "response": frequency_response(found, "base.fx", "base.x", [1.0, 2.0]),
    }


def test_nothing_fills_the_screen(shown):
    """Modes were 42,000 letters, a run 7,000 and a mechanism 10,000."""
    for name, one in shown.items():
        for text in (repr(one), str(one)):
            assert text.count("\n") < 24, name
            if name in ("run", "modes"):
                assert max(map(len, text.splitlines())) <= 80, name
            assert len(text) < 2500, name


def test_what_a_run_modes_and_a_system_say(shown):
    run, found = repr(shown["run"]).splitlines(), repr(shown["modes"]).splitlines()
    assert run[0].startswith("Trajectory of ")
    assert any(line.split() == ["completed", *shown["run"].message.split()] for line in run)
    assert any(" variables of " in line for line in run)
    assert " ".join(found[0].split() + found[1].split()).endswith(", case flexible, 10 in all")
    first = found[3].split()
    assert first[0] == "1"
    assert len([line for line in found if line.strip()[:1].isdigit()]) == 10
    assert repr(shown["system"]).startswith(f"System({shown['mechanism'].name!r}, nq=")
    assert f"nv={shown['system'].model.nv}" in repr(shown["system"])


def test_more_modes_than_a_screen_are_counted():
    """The first twelve, then how many more and how to see them."""
    found = modes(load_scenario("bai2020", case="petals"))
    count = len(found.frequency)
    assert count > 12
    assert f"and {count - 12} more: data[['frequency', 'damping_ratio', 'kind']]" in repr(found)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.5, "1.5"),
        ("a" * 80, repr("a" * 57 + "...")),
        (np.zeros((2, 3)), "<ndarray 2 x 3>"),
        (np.float64(2.0), repr(np.float64(2.0))),
        ({}, "{}"),
        ({"a": 1, "b": 2}, "<2: a, b>"),
        (dict.fromkeys("abcdef"), "<6: a, b, c, d, ...>"),
        ((object(), object()), "<2 of object>"),
        (tuple(range(100)), "<100 of int>"),
        (xr.Dataset(coords={"time": [1, 2]}), "<Dataset: 2 time>"),
    ],
)
def test_values_by_their_size(value, text):
    assert of_size(value) == text
