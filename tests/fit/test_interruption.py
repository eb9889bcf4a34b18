"""A fit whose process is killed, at any place, goes on with the same command as if nothing had been."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from antenna_pin.studies.fit import open_fit, run_fit
from antenna_pin.studies.fit.assessment import certain
from antenna_pin.studies.sweep import Cluster
from antenna_pin.trajectory import save_table

from .conftest import closed_form

FILE = Path(__file__).parents[2] / "scripts" / "examples" / "hinge.fit.toml"


def begun(folder, out):
    program = "from antenna_pin.apps._entry import main; main()"
    asked = ["fit", str(FILE), "--out", out, "--no-progress", "--quiet"]
    command = [sys.executable, "-c", program, *asked]
    return subprocess.Popen(command, cwd=folder)


def size_of(folder):
    return sum(one.stat().st_size for one in folder.rglob("*") if one.is_file()) if folder.exists() else 0


@pytest.mark.slow
def test_a_fit_killed_at_three_places_is_the_fit_bit_for_bit(tmp_path):
    assert begun(tmp_path, "whole.nc").wait() == 0
    reached = 0
    for _ in range(3):
        process = begun(tmp_path, "killed.nc")
        seen = reached
        while process.poll() is None and not size_of(tmp_path / "killed.nc.parts") > 1.1 * seen + 1000:
            time.sleep(0.002)
        time.sleep(0.05)  # into the middle of a run, or of what is written of it
        assert process.poll() is None, "it ended before it was killed"
        process.send_signal(signal.SIGKILL)
        process.wait()
        reached = size_of(tmp_path / "killed.nc.parts")
        assert reached > seen and not (tmp_path / "killed.nc").exists()
    assert begun(tmp_path, "killed.nc").wait() == 0
    assert not (tmp_path / "killed.nc.parts").exists()
    whole, killed = (
        xr.load_dataset(tmp_path / name, engine="h5netcdf") for name in ("whole.nc", "killed.nc")
    )
    for one in (whole, killed):
        one.attrs.pop("command")
    xr.testing.assert_identical(whole, killed)


DAMPER = '[parameters.damping]\nkey = "springs.hinge.damping"\nstart = "0.25 N*m*s/rad"\n'


@pytest.mark.slow
def test_profiles_are_the_same_to_the_bit_by_two_workers_and_after_two_interruptions(write, tmp_path):
    """Which runs are asked for hangs on what the last ones came to: one bit elsewhere, and others are."""
    time = np.linspace(0.0, 1.0, 201)
    noise = 1e-3 * np.random.default_rng(5).standard_normal(201)
    plan = write(columns={"angle": closed_form(time) + noise}, parameters=DAMPER)
    plan = plan.model_copy(update={"noise": "estimated"})
    made = []  # runs, one after the other, of a fit with its profiles

    def profiled(out, executor=None, until=None):
        def told(runs):
            made.append(runs)
            if until is not None and runs >= until:
                raise KeyboardInterrupt

        def judged(found):
            table, _ = certain(found, profile=True)
            save_table(table, tmp_path / out)

        run_fit(plan, tmp_path / out, executor=executor, progress=told, then=judged)
        return open_fit(tmp_path / out)

    here = profiled("here.nc")
    of_fit, whole = int(here.attrs["runs"]), made[-1]
    assert whole > of_fit + 100 and np.isfinite(here["profile_end"]).all()
    cluster = Cluster(2)
    try:
        xr.testing.assert_identical(profiled("workers.nc", cluster), here)
        for share in (0.3, 0.6):  # of the profiles' runs
            with pytest.raises(KeyboardInterrupt):
                profiled("cut.nc", cluster, of_fit + int(share * (whole - of_fit)))
    finally:
        cluster.close()
    assert (tmp_path / "cut.nc.parts").exists()
    assert open_fit(tmp_path / "cut.nc").attrs["converged"] == 1  # the fit itself is there
    made.clear()
    xr.testing.assert_identical(profiled("cut.nc"), here)
    assert len(made) < 0.45 * whole  # what was kept was not run again
    assert not (tmp_path / "cut.nc.parts").exists()
