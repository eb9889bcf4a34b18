"""``antenna-pin fit --identify`` and ``--next``, figures of datasets: what they print, save, refuse."""

from pathlib import Path

import numpy as np
import pytest

from antenna_pin.studies.fit import open_experiments, open_identifiability

FIT = """
scenario = "pendulum"
case = "ideal"
[set]
duration = "0.5 s"
mechanism.gravity = [0.0, 0.0, 0.0]
springs.hinge = { stiffness = 40.0, damping = 0.2 }
springs.twin = { joint = "hinge", stiffness = 10.0 }
initial.joints.hinge.angle = "0.1 rad"
integrator.engine = "compiled"
[parameters.stiffness]
key = "springs.hinge.stiffness"
start = "40 N*m/rad"
[parameters.damping]
key = "springs.hinge.damping"
start = "0.2 N*m*s/rad"
[records.swing]
file = "swing.csv"
[records.swing.columns.angle]
of = "motion_angle[hinge]"
sd = "1e-3 rad"
"""
TWIN = """
[parameters.twin]
key = "springs.twin.stiffness"
start = "10 N*m/rad"
"""
NEXT = """
criterion = "c"
wanted = "damping"
total = 3
[experiments.again]
[experiments.larger]
set = { "initial.joints.hinge.angle" = "0.2 rad" }
"""


@pytest.fixture
def files(cli):
    """Write what the commands are given where they are run; numbers of the record do not matter here."""
    time = np.linspace(0.0, 0.5, 51)
    rows = np.column_stack([time, 0.1 * np.cos(24.0 * time)])
    np.savetxt("swing.csv", rows, delimiter=",", header="time,angle", comments="")
    Path("swing.fit.toml").write_text(FIT)
    Path("twin.fit.toml").write_text(FIT + TWIN)
    Path("next.toml").write_text(NEXT)


def test_what_a_test_cannot_tell_is_said_before_it_is_made(cli, files):
    said = cli("fit", "twin.fit.toml", "--identify", "--no-progress", "--out", "tells.nc")
    assert said.code == 0, said.err
    assert "not identifiable" in said.out + said.err and "only in combination" in said.out + said.err
    assert "and the others become identifiable" in said.out + said.err
    told = open_identifiability("tells.nc")
    assert told["determined"].values.tolist() == [0, 1, 0]
    drawn = cli("plot", "tells.nc", "--out", "pictures")
    assert drawn.code == 0 and Path("pictures/tells-identifiability.png").is_file()


def test_the_next_test_is_told_best_first(cli, files):
    said = cli("fit", "swing.fit.toml", "--next", "next.toml", "--no-progress", "--out", "next.nc")
    assert said.code == 0, said.err
    lines = [line.split()[0] for line in said.out.splitlines() if line.strip()]
    assert lines.index("before") < lines.index("larger") < lines.index("again")
    found = open_experiments("next.nc")
    assert found["experiment"].values.tolist() == ["larger", "again"]
    assert found["count"].values.tolist() == [3, 0]


def test_what_does_not_go_together_is_refused_in_a_line(cli, refused, files):
    for given, words in (
        (("--identify", "--next", "next.toml"), "--identify must be left out with --next"),
        (("--at", "swing.nc"), "--at must be given with --identify or --next"),
        (("--identify", "--profile"), "are of a fit; leave them out here"),
        (("--draws", "1"), "'--draws': must be 2 or more"),
        (("--next", "none.toml"), "none.toml: no such file"),
    ):
        assert words in refused(cli("fit", "swing.fit.toml", *given)), given
    Path("next.toml").write_text(NEXT.replace("damping", "dampin"))
    said = cli("fit", "swing.fit.toml", "--next", "next.toml", "--no-progress")
    assert "did you mean damping" in refused(said)
