"""Settled motions that figures need: which of those at hand are used, and which are made anew."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from antenna_pin.apps.cli._run_store import AttractorStore

PLAN = """
scenario = "pendulum"
case = "ideal"
parameter = "drives.motor.amplitude"
values = "1 N*m:2 N*m:3"
quantities = ["motion_angle[hinge]", "v[hinge]"]
transient = 20
count = 32
[set]
"integrator.engine" = "compiled"
"drives.motor" = {joint = "hinge", kind = "sine", amplitude = "1 N*m", frequency = "6.25 Hz"}
"""
OVER = SimpleNamespace(name="amplitude.diagram.toml", label="Pendulum")
FIGURE = SimpleNamespace(over=OVER, x="motion_angle[hinge]", y="v[hinge]", values={"1 N*m": "weak"})
AGAIN, USED = "weak: running {} periods or more", "weak: using amplitude.diagram.toml-1N*m-section.nc"


@pytest.fixture
def attractor(tmp_path, monkeypatch, capsys):
    """Return a function: a settled motion from the folder, and the lines told of it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("antenna_pin.apps.cli._run_store._SAMPLES", 100)  # the fewer, the quicker
    (tmp_path / OVER.name).write_text(PLAN)

    def made(points=32, settings=()):
        capsys.readouterr()
        store = AttractorStore(Path(), settings, points, 3, False)
        return store.attractors(FIGURE, [FIGURE])["1 N*m"], capsys.readouterr().err

    return made


def test_a_motion_at_hand_is_used_if_it_is_of_the_scenario_and_has_enough_points(attractor):
    first, told = attractor()
    assert AGAIN.format(32) in told and USED not in told
    assert first.settled and first.section.sizes["point"] >= 32
    # Ten periods of 0.16 s behind the points.
    times = first.run.data["time"].values
    assert times[-1] - times[0] == pytest.approx(1.6, rel=1e-12)
    again, told = attractor()
    assert USED in told and "running" not in told
    xr.testing.assert_identical(again.section, first.section)
    assert np.array_equal(again.run.data["q"].values, first.run.data["q"].values)
    more, told = attractor(points=40)
    assert AGAIN.format(40) in told and more.section.sizes["point"] >= 40
    # Many enough, and of another scenario.
    other, told = attractor(settings=["drives.motor.phase=0.5"])
    assert AGAIN.format(32) in told
    assert not np.array_equal(other.section["v[hinge]"].values[:32], first.section["v[hinge]"].values[:32])


def test_a_diagram_at_hand_is_used_if_it_is_of_the_scenario_and_the_values(attractor, capsys):
    attractor()

    def diagram(values, *settings):
        capsys.readouterr()
        found = AttractorStore(Path(), settings, 32, values, False).diagram(OVER)
        return found, capsys.readouterr().err

    first, told = diagram(2)
    assert "running 2 values" in told and first["value"].values.tolist() == [1.0, 2.0]
    again, told = diagram(2)
    assert "using" in told
    xr.testing.assert_identical(again, first)
    for given in ((3,), (2, "drives.motor.phase=0.5")):
        assert f"running {given[0]} values" in diagram(*given)[1]
