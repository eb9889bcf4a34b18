"""A fit whose process is killed, at any place, goes on with the same command as if nothing had been."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr

FILE = Path(__file__).parents[2] / "scripts" / "examples" / "hinge.fit.toml"


def begun(folder, out):
    program = "from antenna_pin._entry import main; main()"
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
