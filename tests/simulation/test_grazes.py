"""Contacts at the edge of what a step sees: grazes, dips between two nodes; bristles of a new touch."""

import math

import numpy as np
import pytest

from antenna_pin import Outcome, RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.contact import Dahl, Hertz
from antenna_pin.dynamics import JointSpring, TableDrive
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.run.simulation.loop import Run
from tests.simulation.conftest import ANY_ERROR

MASS, PLAY = 2.0, 1e-3

# A sled that carries a hole, and a disc in the hole; the sled slides along x.
SLED = f"""
<robot name="sled">
  <link name="ground"/>
  <link name="sled"><inertial><mass value="1"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="body"><inertial><mass value="{MASS}"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="rail" type="prismatic"><parent link="ground"/><child link="sled"/><axis xyz="1 0 0"/>
    <limit lower="-9" upper="9" effort="9" velocity="9"/></joint>
  <joint name="hole" type="continuous"><parent link="sled"/><child link="body"/><axis xyz="0 0 1"/></joint>
</robot>
"""


def disc_on_sled(law, **elements):
    urdf = Urdf.from_text(SLED, "sled.urdf").variant(joints={"hole": "planar"})
    hole = ClearanceJoint(
        name="hole",
        geometry=PlanarClearance(bearing_radius=0.01, journal_radius=0.01 - PLAY),
        radial=law,
        backend="closed-form",
        maximum_depth=1e-2,
    )
    mechanism = build_mechanism(urdf, base="fixed")
    return System(mechanism, clearances=[hole], **elements)


def sprung_sled(pace, stiffness=1e6):
    law = Hertz(stiffness=stiffness, exponent=1.0)
    return disc_on_sled(law, springs={"s": JointSpring(joint="rail", stiffness=pace**2)})


def test_a_dip_of_changing_curvature_between_two_nodes_is_a_contact():
    """The tangents at its ends meet above its bottom: gap = 1.3 - s - 6 s^2 + 6 s^3 over a quarter of a step.

    A straight estimate from s = 0 and 1 says that the gap cannot fall below 0.3; it falls to -0.29.
    """
    unit, step = 1e-6, 2e-3
    quarter = step / 4.0
    # The sled's acceleration is the gap's: linear in time, so the method and its dense output are exact.
    slope = 36.0 * unit / quarter**3
    first = -12.0 * unit / quarter**2
    end = 10.0 * step
    drive = TableDrive(joint="rail", time=(0.0, end), torque=(first, first + slope * end))
    system = disc_on_sled(Hertz(stiffness=1e6, exponent=1.0), drives={"pull": drive})
    settings = RunSettings(rtol=0.5, scales=ANY_ERROR, first_step=step, max_step=step, output_rate=10.0)
    run = simulate(
        system,
        duration=3.0 * step,
        q=[0.0, PLAY - 1.3 * unit, 0.0, 1.0, 0.0],
        v=[0.0, unit / quarter, 0.0, 0.0],
        settings=settings,
    )
    touch = min(root.real for root in np.roots([6.0, -6.0, -1.0, 1.3]) if root.real > 0.0)
    assert 0.0 < touch < 1.0
    # The gap at the located instant is below 1e-9 of the play, 1e-6 of its size here.
    assert run.data["onset_time"].values[0] == pytest.approx(touch * quarter, rel=1e-5, abs=0.0)


@pytest.mark.parametrize("method", ["dormand-prince-853", "rk4"])
def test_a_wall_that_just_reaches_a_disc_goes_on(method):
    """A sled on a spring swings by the play, give or take a hair: its hole may graze the disc in it.

    Where the dense output sees a touch the step that ends there may see none, and the other way round; time
    must go on all the same.
    """
    pace = 20.0  # [rad/s]
    for miss in [
        sign * 10.0**-digits for digits in range(6, 14) for sign in (-3.0, -1.0, 0.0, 0.3, 1.0, 3.0)
    ]:
        system = sprung_sled(pace)
        speed = (PLAY + miss) * pace
        run = simulate(
            system,
            duration=2.0 * math.pi / pace,
            v=[speed, -speed, 0.0, 0.0],
            # An endless loop at one instant is what is feared; a run takes some 10 ms.
            settings=RunSettings(method=method, rtol=1e-8, step=5e-4, output_rate=50.0, max_wall_time=60.0),
        )
        assert run.outcome is Outcome.COMPLETED, (miss, run.message)
        if miss < 0.0:
            assert run.data.sizes["episode"] == 0


@pytest.mark.parametrize("method", ["bogacki-shampine-32", "rk4"])
def test_a_step_made_again_ends_on_the_surface(method, fixed_steps):
    """However coarse the steps: where the dense output puts the touch is a first guess only."""
    pace = 200.0  # [rad/s]: a tenth of a turn in a step
    system = sprung_sled(pace, stiffness=1e4)
    speed = 2.0 * PLAY * pace
    run = simulate(system, duration=0.02, v=[speed, -speed, 0.0, 0.0], settings=fixed_steps(method, 3e-3))
    onset = run.data.sel(time=run.data["onset_time"].values[0])
    # What the run asks of a located instant.
    assert abs(float(onset["gap"].values[0])) <= 1e-9 * PLAY


def test_a_new_contact_knows_nothing_of_the_bristles_of_the_one_before(impact_rig):
    """A run started anew in the flight after the first impact goes on as the one that came from there."""
    friction = Dahl(coefficient_of_friction=0.3, bristle_stiffness=1e4)
    system = impact_rig(Hertz(stiffness=1e6, exponent=1.0), MASS, PLAY, friction=friction)
    settings = RunSettings(rtol=1e-11, output_rate=1000.0)
    run = simulate(system, duration=0.045, v=[0.1, 0.02, 3.0], settings=settings)
    data = run.data
    assert data.sizes["episode"] == 2 and np.isfinite(data["release_time"].values).all()
    assert abs(data["friction_force"].sel(time=data["peak_time"].values).values).min() > 1.0
    middle = int(np.searchsorted(data["time"].values, data["release_time"].values[0])) + 5
    flown = data["time"].values[middle]
    assert flown < data["onset_time"].values[1]
    anew = simulate(
        system,
        duration=0.045 - flown,
        q=data["q"].values[middle],
        v=data["v"].values[middle],
        settings=settings,
    )
    # Some fifty steps at 1e-11, and onsets located to 1e-9 of the play.
    assert anew.data["v"].values[-1] == pytest.approx(data["v"].values[-1], rel=1e-8, abs=0.0)
    assert anew.data["impulse"].values[0] == pytest.approx(data["impulse"].values[1], rel=1e-8, abs=0.0)


def test_a_graze_costs_no_energy():
    """The exact graze of the test above, where the step that ends at the touch sees none."""
    pace = 20.0
    system = sprung_sled(pace)
    speed = PLAY * pace
    run = simulate(system, duration=2.0 * math.pi / pace, v=[speed, -speed, 0.0, 0.0])
    # Some hundred steps at 1e-8. Left touching, the law of exponent 1 would pull for a step: 2.5e-4.
    assert run.summary()["conservation"]["energy_error"] < 1e-7 * 0.5 * speed**2


def test_a_contact_that_touches_and_parts_at_one_instant_is_marked():
    """A third change there is not believed, or round-off could let them alternate without end."""
    pace = 20.0
    system = sprung_sled(pace)
    y = np.array([0.0, 0.0, 0.0, 1.0, 0.0, PLAY * pace, -PLAY * pace, 0.0, 0.0])
    run = Run(system, system.state(y[:5], y[5:]), 2.0 * math.pi / pace, RunSettings(), singly=True)
    marks = []
    run.advance(interrupted=lambda: marks.append(run.state.changed[0]) or False)
    assert run.outcome is Outcome.COMPLETED
    assert marks.count(1) == marks.count(2) == 1 and marks.index(2) == marks.index(1) + 1
