"""Bifurcation diagrams: a pendulum's period doubling, hysteresis of a Duffing oscillator, kills, failures."""

import math

import numpy as np
import pytest

from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.nonlinear import Stroboscope, bifurcation, open_diagram, section_of

# Taylor, Classical Mechanics (2005), section 12.4: damping w0 / 4, drive at w0 / 1.5; here w = 2 pi.
W0 = 3.0 * math.pi
PENDULUM = f"""
[springs.hinge]
damping = {W0 / 2.0!r}
[drives.motor]
joint = "hinge"
kind = "sine"
amplitude = 1.0
frequency = 1.0
phase = "90 deg"
"""


def taylor(rig):
    """The pendulum of 1 kg and 1 m with w0 = 3 pi, let go at -90 degrees as the book does."""
    tables = PENDULUM + '[initial.joints.hinge]\nangle = "-90 deg"\n'
    return rig(tables, True, -(W0**2), rtol=1e-9)


def period_of(points, within=0.02):
    """After how many points they come again; 0 if after none up to 8."""
    for m in (1, 2, 3, 4, 6, 8):
        if np.ptp(points[: len(points) // m * m].reshape(-1, m), axis=0).max() < within:
            return m
    return 0


def test_the_driven_pendulum_doubles_its_period_where_it_is_published(rig):
    """Period 1 below 1.0663 of the critical drive, 2 up to 1.0793, 4 up to 1.0821 (Taylor, table 12.1)."""
    strengths = {1.060: 1, 1.065: 1, 1.068: 2, 1.078: 2, 1.0808: 4, 1.087: 0}
    found = bifurcation(
        taylor(rig),
        "drives.motor.amplitude",
        [one * W0**2 for one in strengths],
        Stroboscope(),
        ["v[hinge]"],
        branches=["forward"],
        count=32,
        transient=150,
    )
    assert found["settled"].all()
    points = found["v[hinge]"].sel(branch="forward").values
    assert [period_of(row) for row in points] == list(strengths.values())


@pytest.mark.slow  # 30 s: springs between points
def test_a_branch_forward_and_one_backward_differ_where_attractors_coexist(stiffening):
    """The Duffing oscillator of a stiffening spring: resonant until it falls off, calm on the way back."""
    values = np.linspace(0.16, 0.34, 13)
    found = bifurcation(
        stiffening(1e-9),
        "drives.motor.frequency",
        values,
        section_of("rate.way=0", "falling"),
        ["q[way]"],
        branches=["forward", "backward"],
        count=32,
        transient=60,
    )
    forward, backward = found["q[way]"].mean("point").values
    apart = np.flatnonzero(np.abs(forward - backward) > 1e-3)
    # The fall is at 0.205 Hz on one way, at 0.22 Hz on the other.
    assert np.allclose(values[apart], 0.205)
    assert forward[apart] > 1.5 and backward[apart] < 0.5


def test_what_was_killed_goes_on_to_the_same_diagram(rig, tmp_path):
    """After any number of values, with a torn line: the same bits; a diagram of another kind is refused."""
    scenario = taylor(rig)
    values = [1.05 * W0**2, 1.06 * W0**2, 1.07 * W0**2]

    def diagram(out=None, progress=None, count=32):
        return bifurcation(
            scenario,
            "drives.motor.amplitude",
            values,
            Stroboscope(),
            ["v[hinge]"],
            branches=["forward", "fresh"],
            count=count,
            transient=5,
            out=out,
            progress=progress,
        )

    whole = diagram()
    out = tmp_path / "diagram.nc"

    class KilledError(Exception):
        pass

    def kill(at):
        def look(made):
            if made.done >= at:
                raise KilledError

        return look

    for at in (1, 2, 4):
        with pytest.raises(KilledError):
            diagram(out, kill(at))
    journal = tmp_path / "diagram.nc.parts" / "journal"
    made = journal.read_bytes()
    assert made.count(b"\n") >= 4
    journal.write_bytes(made[:-7])
    with pytest.raises(AntennaPinError, match="unfinished part of another diagram; what differs: points"):
        diagram(out, count=33)
    diagram(out)
    assert not journal.parent.exists()
    found = open_diagram(out)
    for name in whole.data_vars:
        assert np.array_equal(whole[name].values, found[name].values, equal_nan=whole[name].dtype == float), (
            name
        )
    assert found.attrs["key" if "key" in found.attrs else "parameter"] == "drives.motor.amplitude"


def test_a_value_that_fails_is_an_entry(rig):
    """A controller whose table ends: refused in its midst; the other values are there."""
    scenario = rig(PENDULUM + "[integrator.scales]\nangle = 1.0\n", True, -(W0**2), rtol=1e-9)
    found = bifurcation(
        scenario,
        "integrator.max_steps",
        [50, 100000],
        Stroboscope(),
        ["v[hinge]"],
        branches=["fresh", "forward"],
        count=32,
        transient=0,
    )
    assert found["points"].values.tolist() == [[0, 32], [0, 32]]
    assert not found["settled"].values[:, 0].any()
    assert "most" in found["message"].values[0, 0] or "step" in found["message"].values[0, 0]
    # The branch begins at the next value as if it were the first.
    assert np.array_equal(found["v[hinge]"][0, 1], found["v[hinge]"][1, 1])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"parameter": "drives.motor.amplitud"}, "did you mean amplitude"),
        ({"parameter": "drives.moter.amplitude"}, "moter"),
        ({"values": [1.0]}, "values must be two or more"),
        ({"values": [1.0, 2.0, 1.5]}, "values must be in order"),
        ({"values": [1.0, "2 m"]}, "amplitude"),
        ({"branches": ["sideways"]}, "branch 'sideways' is unknown"),
        ({"count": 31}, "count must be a whole number of 32 or more"),
        ({"quantities": []}, "quantities"),
        ({"quantities": ["v[hing]"]}, "did you mean hinge"),
        ({"section": Stroboscope(drive="moter")}, "did you mean motor"),
    ],
)
def test_refusals(rig, change, words):
    given = {
        "parameter": "drives.motor.amplitude",
        "values": [1.0, 2.0],
        "section": Stroboscope(),
        "quantities": ["v[hinge]"],
    } | change
    with pytest.raises(AntennaPinError, match=words) as error:
        bifurcation(taylor(rig), **given)
    assert "\n" not in str(error.value)
