"""The random scenarios: a handful within their limits, and a script that overlooks nothing."""

import importlib
import json
import warnings
from pathlib import Path

import numpy as np
import pytest

from antenna_pin import Scenario
from antenna_pin.errors import InvalidParameterError

SCRIPTS = Path(__file__).parents[1] / "scripts" / "check"
SEED = 2024
FEW = range(5, 13)  # among them free and fixed bases, all kinds of joint, both loads and backends


@pytest.fixture
def script(monkeypatch):
    monkeypatch.syspath_prepend(str(SCRIPTS))
    return importlib.import_module("random_scenarios")


@pytest.fixture
def draw(script):
    return importlib.import_module("scenario_generator").draw_scenario


@pytest.mark.parametrize("number", FEW)
def test_a_random_scenario_keeps_its_ledgers(script, number):
    row = script.run_number(SEED, number)
    assert row.failures == []
    assert row.outcome == "COMPLETED", row.message
    assert row.energy <= script.ENERGY
    assert row.episodes > 0
    # Conserved without gravity on a free base, and only there.
    conserved = row.classes["base"] == ("free",) and row.classes["gravity"] == ("no",)
    assert (row.momentum <= script.MOMENTUM) if conserved else np.isnan(row.momentum)


@pytest.mark.parametrize("number", [12])
def test_one_with_elements_keeps_its_ledgers(script, number):
    """In samples at the peaks of contacts too, which are recorded when joints may stick that slipped then."""
    row = script.run_number(SEED, number, elements=True)
    assert row.failures == []
    assert row.outcome == "COMPLETED", row.message
    assert row.classes["element"]


def test_both_engines_come_to_the_same(script):
    row = script.run_number(SEED, FEW[1], engines=True)
    assert row.failures == []
    assert row.engines <= script.AGREE


def test_engines_that_part_are_listed(script, monkeypatch):
    simulate = script.simulate

    def astray(scenario, **named):
        run = simulate(scenario, **named)
        run.data["q"].values[:] += 1e-3 * (scenario.integrator.engine == "compiled")
        return run

    monkeypatch.setattr(script, "simulate", astray)
    failures = script.run_number(SEED, FEW[1], engines=True).failures
    assert any("engines are" in text for text in failures), failures


def test_the_handful_is_a_mixture(script, draw):
    seen = [script.classes_of(draw(SEED, number)) for number in FEW]
    for kind, least in (("base", 2), ("joint", 3), ("load", 2), ("backend", 2), ("law", 6), ("friction", 4)):
        assert len({name for classes in seen for name in classes[kind]}) >= least, kind


def test_a_scenario_follows_from_seed_and_number(draw):
    assert draw(SEED, 6) == draw(SEED, 6)
    assert draw(SEED, 6) != draw(SEED, 7)
    assert draw(SEED, 6) != draw(SEED + 1, 6)
    again = Scenario.model_validate_json(draw(SEED, 6).model_dump_json())
    assert again == draw(SEED, 6)


def test_every_law_is_dealt_once_a_round(script, draw):
    dealt = importlib.import_module("scenario_generator").dealt
    options = tuple("abcdefg")
    for first in (0, 7, 70):
        assert sorted(dealt(options, SEED, "laws", first + k) for k in range(7)) == sorted(options)


def spoiled(script, monkeypatch, change):
    """Run a scenario whose result is changed before it is judged; return what is found wrong."""
    simulate = script.simulate

    def changed(*arguments, **named):
        run = simulate(*arguments, **named)
        change(run)
        return run

    monkeypatch.setattr(script, "simulate", changed)
    return script.run_number(SEED, FEW[0]).failures


def drift(run):
    kept = json.loads(run.data.attrs["conservation"])
    run.data.attrs["conservation"] = json.dumps(kept | {"linear_momentum_drift_relative": 2e-9})


def loss(run):
    kept = json.loads(run.data.attrs["conservation"])
    run.data.attrs["conservation"] = json.dumps(kept | {"energy_error": 1.0})


def hole(run):
    run.data["v"].values[-1, 0] = np.nan


def noise(run):
    warnings.warn("overflow", RuntimeWarning, stacklevel=2)


def fault(run):
    raise ZeroDivisionError("by zero")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (drift, "linear momentum drifts by 2e-09"),
        (loss, "energy error 1 J"),
        (hole, "not finite: v"),
        (noise, "warning RuntimeWarning: overflow"),
        (fault, "ZeroDivisionError: by zero"),
    ],
)
def test_what_is_wrong_is_listed(script, monkeypatch, change, said):
    failures = spoiled(script, monkeypatch, change)
    assert any(said in text for text in failures), failures


def test_a_refusal_is_no_failure_but_an_outcome_with_a_message(script, monkeypatch):
    def refuse(*arguments, **named):
        raise InvalidParameterError("place", "parameter", "another")

    monkeypatch.setattr(script, "simulate", refuse)
    row = script.run_number(SEED, FEW[0])
    assert (row.outcome, row.failures) == ("REFUSED", [])
    assert "must be another" in row.message
    assert not script.completed_with_contacts(row)


def test_a_run_that_takes_too_long_is_listed(script, monkeypatch):
    """``robust.trials`` ends it; it is counted among its like all the same."""

    def stalled(act, items, limit, jobs):
        yield from ((number, None, f"computes for more than {limit:g} s", limit) for number in items)

    monkeypatch.setattr(script, "tried", stalled)
    rows = list(script.run_numbers(SEED, [5, 6], jobs=1, seconds=3.0))
    assert [row.number for row in rows] == [5, 6] and all(row.classes for row in rows)
    assert f"--seed {SEED} --only 5: computes for more than 3 s" in script.failure_lines(rows, SEED)[0]
