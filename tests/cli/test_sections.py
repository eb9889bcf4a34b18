"""``antenna-pin poincare`` and ``bifurcation``: what they save and say, what they refuse, and kills."""

import json
import shlex
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

from antenna_pin.studies.nonlinear import open_diagram
from antenna_pin.trajectory import open_table

DRIVE = "drives.motor={joint='hinge', kind='sine', amplitude='1 N*m', frequency='0.625 Hz'}"
PENDULUM = ("pendulum", "--case", "ideal", "--set", DRIVE)
HERE = ("-q", "motion_angle[hinge]", "-q", "v[hinge]")
OVER = ("--over", "drives.motor.amplitude", "--values", "1 N*m:6 N*m:6", "-q", "v[hinge]")


def words_of(command):
    """The words of a command as a report shows it, without the program's name."""
    program, *words = shlex.split(command)
    assert program == "antenna-pin"
    return words


def test_a_section_is_saved_drawn_and_told(cli, tmp_path):
    """By --json, in the file and in the table stand the same numbers; the file repeats itself."""
    said = cli(
        "poincare", *PENDULUM, *HERE, "--count", 32, "--out", "section.nc", "--plot", "a.svg", "--json"
    )
    facts = json.loads(said.out)
    kept = open_table("section.nc", "section")
    assert said.code == 0 and facts["settled"] and bool(kept["settled"])
    for name in ("motion_angle[hinge]", "v[hinge]", "time"):
        assert kept[name].values.tolist() == facts[name]
    # Once a period of 1.6 s, to the last bit of what is printed.
    assert np.diff(facts["time"]) == pytest.approx(1.6, abs=1e-12)
    assert (tmp_path / "a.svg").read_text().count("<use ") >= 32
    told = cli("poincare", *PENDULUM, *HERE, "--count", 32)
    assert f"{facts['v[hinge]'][-1]:.6g}" in told.out and "settled, drift" in told.out
    before = (tmp_path / "section.nc").read_bytes()
    assert cli(*words_of(kept.attrs["command"])).code == 0
    assert (tmp_path / "section.nc").read_bytes() == before


def test_a_diagram_is_saved_drawn_and_told(cli, tmp_path):
    how = ("--count", 32, "--workers", 1, "--branch", "backward", "--no-progress")
    said = cli("bifurcation", *PENDULUM, *OVER, *how, "--out", "diagram.nc", "--plot", "a.png")
    assert said.code == 0 and said.out.startswith("saved diagram.nc\nsaved a.png\n")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert " backward         6             0        0" in said.out
    kept = open_diagram("diagram.nc")
    assert kept["value"].values.tolist() == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert kept["value"].attrs["units"] == "N*m" and kept.attrs["name"] == "pendulum"
    # One point is of the same orbit as a section of that value: settled to the tolerance of 1e-4.
    one = json.loads(cli("poincare", *PENDULUM, "-q", "v[hinge]", "--count", 32, "--json").out)
    assert kept["v[hinge]"].values[0, 0, -1] == pytest.approx(one["v[hinge]"][-1], rel=1e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("poincare", *PENDULUM, *HERE, "--section", "angle.hinge=3 rad"), "not once in"),
        (("poincare", *PENDULUM, *HERE, "--section", "angle.hing=0"), "did you mean hinge"),
        (("poincare", "pendulum", "--case", "ideal", *HERE), "drives must be periodic"),
        (("poincare", *PENDULUM, *HERE, "--section", "period=moter"), "did you mean motor"),
        (("poincare", *PENDULUM, *HERE, "--count", "31"), "count must be a whole number of 32 or more"),
        (("poincare", *PENDULUM, "-q", "v[hing]"), "did you mean hinge"),
        (("poincare", *PENDULUM, *HERE, "--out", "section.txt"), "name must end in .nc"),
        (("poincare", *PENDULUM, *HERE, "--plot", "a.gif"), "--plot must be a file that ends in .png"),
        (("bifurcation", *PENDULUM, "--over", "drives.motor.amplitud", *OVER[2:]), "did you mean amplitude"),
        (("bifurcation", "pendulum", "--case", "ideal", *OVER), "drives"),
        (("bifurcation", *PENDULUM, *OVER, "--count", "8"), "count must be a whole number of 32 or more"),
        (("bifurcation", *PENDULUM, *OVER[:3], "1 N*m:6 m:6", *OVER[4:]), "one unit from first to last"),
        (("bifurcation", *PENDULUM, *OVER, "--transient", "5", "--most", "200"), "most must be left out"),
    ],
)
def test_refusals(cli, refused, tmp_path, arguments, message):
    assert message in refused(cli(*arguments))
    assert list(tmp_path.iterdir()) == []  # nothing is left behind


def test_what_was_killed_goes_on_to_the_same_file(cli, tmp_path):
    """By SIGKILL after some values; then the same command ends in the file of one that was never killed."""
    over = (*OVER[:3], "1 N*m:6 N*m:3", *OVER[4:])
    words = ("bifurcation", *PENDULUM, *over, "--set", "integrator.engine=compiled", "--count", "32")
    words += ("--branch", "fresh", "--branch", "forward", "--workers", "1", "--no-progress", "--out", "d.nc")
    program = [sys.executable, "-c", "from antenna_pin.apps._entry import main; main()", *words]
    journal, values = tmp_path / "d.nc.parts" / "journal", 6

    def made():
        return journal.read_bytes().count(b"\n") if journal.exists() else 0

    with subprocess.Popen(program, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        while made() < 2:
            assert process.poll() is None, process.communicate()
            time.sleep(0.002)
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    assert not (tmp_path / "d.nc").exists() and 2 <= made() < values
    goes_on = cli(*words)
    assert goes_on.code == 0 and goes_on.out.startswith("saved d.nc") and not journal.exists()
    one = open_diagram("d.nc")
    (tmp_path / "d.nc").unlink()
    assert cli(*words).code == 0
    xr.testing.assert_identical(one, open_diagram("d.nc"))  # bit for bit, attributes too
