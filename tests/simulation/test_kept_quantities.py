"""Runs that keep some quantities only: what they have is that of a full record, bit for bit."""

import importlib
import json
from pathlib import Path

import numpy as np
import pytest

from antenna_pin import Outcome, RunSettings, Trajectory, load_scenario, simulate
from antenna_pin.errors import InvalidParameterError, LedgerOpenWarning, UnknownNameError
from antenna_pin.run.simulation.samples import FEW
from antenna_pin.trajectory.quantities import KEEPABLE, OF_SAMPLES


@pytest.fixture
def draw_scenario(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "scripts" / "check"))
    return importlib.import_module("scenario_generator").draw_scenario


def check_kept(scenario, span):
    """Compare a lean run that keeps contacts and sums with one that keeps all; return both."""
    lean = {"output.form": "lean", "output.rate": 400.0 / span}
    whole = simulate(scenario.with_overrides(lean), duration=span)
    few = simulate(scenario.with_overrides({**lean, "output.keep": ["peak_force", "blows"]}), duration=span)
    assert few.outcome is whole.outcome
    assert few.counts.evaluations == whole.counts.evaluations
    assert few.end.y.tobytes() == whole.end.y.tobytes()
    missing = set(whole.data.variables) - set(few.data.variables)
    assert missing == OF_SAMPLES & set(whole.data.variables)
    for name in few.data.variables:
        kind = few.data[name].dtype.kind
        same = np.array_equal(few.data[name].values, whole.data[name].values, equal_nan=kind == "f")
        assert same, name
    assert few.data.attrs["samples"] <= FEW + 2 < whole.data.attrs["samples"]
    return whole, few


@pytest.mark.parametrize("number", range(6))
def test_kept_quantities_are_those_of_a_full_record(draw_scenario, number):
    """Over mechanisms, laws, backends and drives at random; what needs all samples is left out."""
    scenario = draw_scenario(41, number)
    check_kept(scenario, 0.2 * scenario.duration)


def test_a_result_with_kept_quantities_is_stored_and_read(tmp_path):
    whole, few = check_kept(load_scenario("bai2020", case="case3"), 0.05)
    again = Trajectory.load(few.save(tmp_path / "few.nc"))
    assert again.data.equals(few.data)
    assert json.loads(again.data.attrs["kept"]) == ["peak_force", "blows"]
    both = whole.summary(), again.summary()
    assert both[0]["contacts"] == both[1]["contacts"]
    # The balance is that of fewer samples.
    error, found = (one["conservation"]["energy_error"] for one in both)
    assert 0.0 < found <= error
    written = simulate(
        load_scenario("bai2020", case="case3"),
        duration=0.05,
        settings=RunSettings(output_form="lean", output_keep=("impacts",)),
        out=tmp_path / "written.nc",
    )
    assert written.data["peak_force"].equals(few.data["peak_force"])


def test_a_quantity_of_samples_needs_them_all():
    scenario = load_scenario("bai2020", case="case3", overrides=["output.form=lean"])
    whole = simulate(scenario, duration=0.02)
    kept = simulate(scenario.with_overrides({"output.keep": ["peak_acceleration"]}), duration=0.02)
    assert kept.data.equals(whole.data)


def test_a_ledger_that_does_not_close_is_found_by_few_samples():
    changes = ["output.form=lean", "output.keep=[]", "integrator.ledger_tolerance=1e-15"]
    with pytest.warns(LedgerOpenWarning, match="is off by"):
        run = simulate(load_scenario("bai2020", case="case3", overrides=changes), duration=0.1)
    assert run.outcome is Outcome.LEDGER_OPEN


def test_what_cannot_be_kept_is_refused():
    scenario = load_scenario("bai2020", case="case3")
    with pytest.raises(UnknownNameError, match="'peak_forc' is unknown; did you mean peak_force"):
        simulate(scenario, settings=RunSettings(output_form="lean", output_keep=("peak_forc",)))
    with pytest.raises(InvalidParameterError, match='left out with form = "full"'):
        RunSettings(output_keep=("peak_force",))
    assert OF_SAMPLES < KEEPABLE
