"""What a run refuses to start from, where it must end, and that it does end."""

import math

import numpy as np
import pinocchio as pin
import pytest
from wheel import wheel_urdf

from antenna_pin import Outcome, RunSettings, System, build_mechanism, load_scenario, simulate
from antenna_pin.analysis.law_studies import closed_form_restitution
from antenna_pin.contact import make_normal_law
from antenna_pin.dynamics import CallableDrive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import RevoluteClearance, pose_of
from antenna_pin.joints.geometry.shape import queried_contacts
from antenna_pin.mechanism import frame_aligning_z
from antenna_pin.run.simulation import steps
from antenna_pin.scenario.assemble import build_system, initial_state

# A slender pin in a long bore: 10 mm and 40 mm, with 50 um of play.
SLENDER = (
    "clearance.hinge.bearing_radius=5 mm",
    "clearance.hinge.radial_clearance=50 um",
    "clearance.hinge.bearing_length=40 mm",
    "clearance.hinge.axial_clearance=50 mm",
    "clearance.hinge.bearing_outer_radius=8 mm",
    "clearance.hinge.flange_radius=9 mm",
    "mechanism.gravity=[0, 0, 0]",
)


@pytest.mark.parametrize("geometry", ["coal", "closed-form"])
@pytest.mark.parametrize("tilt", [0.3, 1, 5, 20, 45, 80, 89, 91, 120, 150, 179, 180])
def test_a_pose_that_the_parts_cannot_have_is_no_start(tilt, geometry):
    """Tilted by more than the play allows, 2 x 50 um over 40 mm, the pin is in the wall, however far."""
    asked = load_scenario(
        "pendulum",
        case="contact",
        overrides=[
            *SLENDER,
            f"clearance.hinge.geometry={geometry}",
            f"initial.joints.hinge.journal_tilt=['{tilt} deg', 0, 0]",
        ],
    )
    rule = "penetration of hinge.radial" if tilt < 90 else "tilt of hinge must be below 90 deg"
    with pytest.raises(InvalidParameterError, match=f"initial pose: {rule}"):
        simulate(asked, duration=1e-3)


def test_the_gap_falls_all_the_way_to_a_pin_across_the_bore():
    """The deeper in the wall, the smaller the gap, also past the pose whose axis meets the end circle."""
    shape = RevoluteClearance.from_clearances(
        bearing_radius=5e-3,
        radial_clearance=5e-5,
        bearing_length=0.04,
        axial_clearance=0.05,
        bearing_outer_radius=8e-3,
        flange_radius=9e-3,
    )
    tilts = np.radians(np.concatenate([np.linspace(0.0, 89.0, 90), [89.9, 90.0]]))
    coal = shape.coal(np.eye(3))
    gaps = []
    for tilt in tilts:
        axis = [math.sin(tilt), 0.0, math.cos(tilt)]
        closed = [c.gap for c in shape.contacts([0, 0, 0], axis)]
        # Round-off of 5 cm; at right angles the journal's axis never meets the planes of the end circles.
        by_coal = [c.gap for c in queried_contacts(coal, 4, pose_of([0, 0, 0], axis))]
        assert by_coal[:2] == pytest.approx(closed[:2], abs=1e-15)
        gaps.append(closed[0])
    assert (np.diff(gaps) < 0.0).all()
    # Across the bore, in its middle: half its length from the end circle's plane.
    assert gaps[-1] == pytest.approx(-(0.02 + shape.journal_radius), rel=1e-12)


@pytest.mark.parametrize("geometry", ["coal", "closed-form"])
@pytest.mark.parametrize("rtol", [1e-8, 1e-4, 0.1])
def test_a_run_ends_where_a_contact_is_as_deep_as_it_may_be(rtol, geometry):
    """At the very depth, not at the end of the step that passed it."""
    # 0.1 m/s would go 5.8 um deep.
    overrides = [
        "clearance.bore.maximum_depth=5 um",
        f"clearance.bore.geometry={geometry}",
        f"integrator.rtol={rtol}",
    ]
    for case in ("planar", "flange", "spherical"):
        run = simulate(load_scenario("impact_pair", case=case, overrides=overrides))
        assert run.outcome is Outcome.TOO_DEEP, (case, run.message)
        # The event is located to a billionth of the play, 0.1 mm.
        assert run.data["depth"].values.max() == pytest.approx(5e-6, abs=1e-12)
        assert "limit 5e-06 m: maximum_depth" in run.message


@pytest.mark.parametrize("geometry", ["coal", "closed-form"])
@pytest.mark.parametrize("case", ["planar", "contact", "flange", "spherical"])
@pytest.mark.parametrize("speed", [1e3, 1e5])
def test_no_step_jumps_over_a_bearing(case, geometry, speed):
    """However fast: in free flight a step has no error, and would be 10 ms long."""
    key = {"flange": f"[0, 0, {speed}]"}.get(case, f"[{speed}, 0, 0]")
    overrides = [f"initial.joints.bore.journal_velocity={key}", f"clearance.bore.geometry={geometry}"]
    run = simulate(load_scenario("impact_pair", case=case, overrides=overrides))
    assert run.outcome is Outcome.TOO_DEEP, run.message
    assert run.data["depth"].values.max() == pytest.approx(1e-4, abs=1e-10)
    for name, variable in run.data.data_vars.items():
        if variable.dtype.kind == "f" and "episode" not in variable.dims:
            assert np.isfinite(variable.values).all(), name


# --- configurations -----------------------------------------------------------------------------------------


def spun(factor):
    """The flange pair with its journal's quaternion stretched."""
    asked = load_scenario("impact_pair", case="flange", overrides=["clearance.bore.geometry=closed-form"])
    system = build_system(asked)
    q, v = initial_state(asked, system)
    q[system.mechanism.joint("bore").q.start + 3 :] *= factor
    return asked, q, v


@pytest.mark.parametrize("factor", [2.0, 1.0001, 0.9, 0.0])
def test_a_quaternion_that_is_not_unit_is_refused(factor):
    asked, q, v = spun(factor)
    with pytest.raises(
        InvalidParameterError, match=r"quaternion of joint 'bore' must be of length 1 to 1e-06"
    ):
        simulate(asked, q=q, v=v, duration=1e-3)


def test_a_quaternion_unit_but_for_round_off_is_made_so():
    asked, q, v = spun(1.0 + 5e-7)
    run = simulate(asked, q=q, v=v, duration=5e-3)
    plain = simulate(asked, duration=5e-3)
    assert run.data["q"].values[0] == pytest.approx(plain.data["q"].values[0], abs=1e-16)
    assert run.summary()["conservation"]["linear_momentum_drift_relative"] < 1e-13


def test_cosine_and_sine_of_an_angle_are_checked_too():
    system = System(build_mechanism(wheel_urdf(), base="fixed"))
    with pytest.raises(
        InvalidParameterError, match=r"q\[0:2\]: cosine and sine of joint 'axle' must be of length"
    ):
        simulate(system, q=[1.0, 0.1], v=[0.0], duration=1.0)
    q = np.array([0.6, 0.8]) * (1.0 + 1e-9)
    assert system.state(q, [0.0])[:2] == pytest.approx([0.6, 0.8], abs=1e-16)


# --- a run that makes no way --------------------------------------------------------------------------------


def wheel(torque):
    return System(
        build_mechanism(wheel_urdf(), base="fixed"), drives={"d": CallableDrive(joint="axle", torque=torque)}
    )


@pytest.mark.slow
def test_a_run_that_chatters_ends_and_says_so():
    """A brake that jumps with the sign of the rate holds the wheel at steps of 1e-10 s and less."""

    def brake(t, angle, rate):
        return 1.0 - 50.0 * math.copysign(1.0, rate)

    run = simulate(wheel(brake), duration=1.0)
    assert run.outcome in (Outcome.NO_PROGRESS, Outcome.STEP_TOO_SMALL), run.message
    assert run.counts.accepted + run.counts.rejected < 200_000
    assert "the run makes no way" in run.message or "floor" in run.message


def test_a_step_that_no_longer_changes_the_time_ends_a_run():
    """Whatever the floor of the step says."""

    def wall(t, angle, rate):
        return 1.0 if t < 0.5 else math.inf

    run = simulate(wheel(wall), duration=1.0, settings=RunSettings(min_step=1e-90))
    assert run.outcome in (Outcome.STEP_TOO_SMALL, Outcome.NOT_FINITE)
    assert run.data["time"].values[-1] == pytest.approx(0.5, abs=1e-9)


def test_steps_and_wall_time_can_be_limited():
    def idle(t, angle, rate):
        return 0.0

    run = simulate(wheel(idle), duration=10.0, settings=RunSettings(max_steps=100))
    assert run.outcome is Outcome.STEP_LIMIT
    assert run.counts.accepted + run.counts.rejected == 100
    assert 0.0 < run.data["time"].values[-1] < 10.0
    run = simulate(wheel(idle), duration=1e6, settings=RunSettings(max_wall_time=0.2, output_rate=1.0))
    assert run.outcome is Outcome.TIME_LIMIT
    assert 0.2 <= run.counts.wall_seconds < 20.0
    # Fixed steps far too short for the span: known before the first.
    with pytest.raises(InvalidParameterError, match="step must be 1e-09 s or more in a run of 1 s"):
        simulate(wheel(idle), duration=1.0, settings=RunSettings(method="rk4", step=1e-13))


@pytest.mark.parametrize(("expected", "made"), [(899, 100), (901, 1000)])
def test_a_run_is_given_up_at_the_steps_it_would_take(monkeypatch, expected, made):
    """1000 fixed steps: after the first 100, in a tenth of the time, 900 are left to be expected."""
    monkeypatch.setattr(steps, "_PACE_STEPS", 100)
    settings = RunSettings(method="rk4", step=1e-3, max_steps=10_000, max_expected_steps=expected)
    run = simulate(wheel(lambda t, angle, rate: 0.0), duration=1.0, settings=settings)
    assert run.outcome is (Outcome.COMPLETED if made == 1000 else Outcome.NO_PROGRESS)
    assert run.counts.accepted == made


def test_limits_are_a_scenarios_too():
    asked = load_scenario(
        "impact_pair", overrides=["integrator.max_steps=20", "integrator.max_wall_time=1 min"]
    )
    run = simulate(asked)
    assert run.outcome is Outcome.STEP_LIMIT
    assert run.scenario.integrator.max_wall_time == 60.0
    for change in ("max_steps=0", "max_wall_time=-1 s", "max_expected_steps=0"):
        with pytest.raises(ValueError, match=f"integrator.{change.split('=')[0]}"):
            load_scenario("impact_pair", overrides=[f"integrator.{change}"])


# --- effective mass -----------------------------------------------------------------------------------------


def test_each_contact_has_the_effective_mass_of_its_own_pose_and_normal():
    """(n^T M^-1 n)^-1 with the point's own Jacobian and Pinocchio's inverse of M, at every onset."""
    asked = load_scenario("bai2020", case="case3", overrides=["clearance.elevation.geometry=closed-form"])
    run = simulate(asked, duration=0.1)
    system = build_system(asked)
    model, slot, shape = system.model, system.mechanism.joint("elevation"), system.clearances[0].geometry
    data = model.createData()
    masses, onsets = run.data["effective_mass"].values, run.data["onset_time"].values
    assert len(masses) > 20 and np.ptp(masses) > 0.1 * masses.mean()
    for mass, onset, contact in zip(masses, onsets, run.data["episode_contact"].values, strict=True):
        at = run.data.sel(time=onset)
        q = at["q"].values
        upper = np.triu(pin.computeMinverse(model, data, q))
        inverse = (upper + np.triu(upper, 1).T)[slot.v, slot.v]
        frame, bearing = pin.Quaternion(q[slot.q][3:]).matrix(), frame_aligning_z(slot.axis)
        point = bearing @ at["contact_point"].values[contact] - q[slot.q][:3]  # from the child's origin
        attitude = pin.Quaternion(at["journal_attitude"].values[0]).matrix()
        candidates = shape.contacts(at["journal_position"].values[0], attitude[:, 2])
        normal = bearing @ candidates[contact].normal
        row = np.concatenate([frame.T @ normal, frame.T @ np.cross(point, normal)])
        assert mass == pytest.approx(1.0 / (row @ inverse @ row), rel=1e-9, abs=0.0)


@pytest.mark.parametrize("law", ["tsuji", "jankowski"])
def test_a_law_that_knows_the_mass_delivers_what_it_promises_off_centre(law):
    """Struck beside the mass centres two free bodies turn: only with the mass of that contact is c_r met."""
    overrides = [
        f"clearance.bore.normal={{law='{law}', restitution=0.7, replace=true}}",
        "clearance.bore.geometry=closed-form",
        "mechanism.joints.bore.origin_xyz=[0, 0.05, 0.02]",
    ]
    run = simulate(load_scenario("impact_pair", case="planar", overrides=overrides), duration=5e-3)
    data = run.data
    mass, speed = float(data["effective_mass"][0]), float(data["approach_speed"][0])
    release = float(data["release_time"][0])
    after = -float(data["depth_rate"].sel(time=release, contact=data["contact"].values[0]))
    made = make_normal_law(law, {"stiffness": 1e11, "restitution": 0.7, "effective_mass": 1.0})
    promised = closed_form_restitution(made, mass=1.0, speed=0.1)
    # The effective mass changes as the bodies turn in the contact, by 1e-5.
    assert after / speed == pytest.approx(promised, abs=1e-4)
    # Both masses at the joint: 1/m = 1/m_1 + 1/m_2 is what it would be struck centrally.
    central = simulate(load_scenario("impact_pair", case="planar", overrides=overrides[:2]), duration=5e-3)
    assert mass < 0.9 * float(central.data["effective_mass"][0])
