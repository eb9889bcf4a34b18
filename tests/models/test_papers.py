"""What docs/papers.md gives as the reason why a paper is met or not."""

import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate

SCRIPTS = Path(__file__).parents[2] / "scripts" / "bench"
BORE, LENGTH, OUTER = 2e-4, 0.050, 0.012  # Bai and Zhao's radial clearance, bearing length, outer radius [m]


@pytest.mark.parametrize(("axial_clearance", "stopped_by"), [(50e-6, "flanges"), (200e-6, "bore")])
def test_the_smaller_play_stops_the_tilt(axial_clearance, stopped_by):
    """The bore allows a tilt of 2 C_r / L_i, the flanges one of C_a / R_io: they cross at 96 um."""
    by = {"bore": 2.0 * BORE / LENGTH, "flanges": axial_clearance / OUTER}
    changes = [
        "clearance.elevation.geometry=closed-form",
        f"clearance.elevation.axial_clearance={axial_clearance}",
    ]
    data = simulate(load_scenario("bai2020", case="case3", overrides=changes), duration=1.0).data
    assert min(by, key=by.__getitem__) == stopped_by
    tilt = float(data["journal_tilt"].max())
    depth = float(data["peak_depth"].max())
    # Contacts give way: the depth at one end, over the lever that it has about the other.
    lever = LENGTH if stopped_by == "bore" else 2.0 * OUTER
    assert by[stopped_by] < tilt < by[stopped_by] + 2.0 * depth / lever
    # What stops the tilt carries the couple; the other is touched in passing.
    impulse = data["normal_impulse"].isel(time=-1)
    axial = np.array(["axial" in str(name) for name in data["contact"].values])
    on_flanges, in_bore = float(impulse[axial].sum()), float(impulse[~axial].sum())
    assert (on_flanges > 10.0 * in_bore) if stopped_by == "flanges" else (in_bore > 10.0 * on_flanges)


@pytest.mark.slow
def test_the_table_of_bai_and_zhao_is_made(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["bai2020.py", "--quick"])
    monkeypatch.syspath_prepend(SCRIPTS)
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(SCRIPTS / "bai2020.py"), run_name="__main__")
    assert not ended.value.code
    assert "contacts" in capsys.readouterr().out
