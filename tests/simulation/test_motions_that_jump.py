"""Prescribed motions whose rate jumps: impulses in closed form, their work in the ledger; what is refused."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import RunSettings, simulate
from antenna_pin.contact import LankaraniNikravesh, NoFriction
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    PrescribedMotion,
    Ramp,
    Reference,
    RigidStop,
    Sine,
    StickingFriction,
    Sum,
    Table,
)
from antenna_pin.elements.prescribed import continued, jumps
from antenna_pin.elements.reference import pieces
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.session import start
from antenna_pin.run.simulation import Angle, Event, Set, Time
from antenna_pin.trajectory import Outcome

LIMIT = '<limit lower="-9" upper="9" effort="1e9" velocity="1e9"/>'
CRANE = f"""<robot name="crane"><link name="rail"><inertial><mass value="40"/>
<inertia ixx="2" iyy="3" izz="2" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="trolley" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>{LIMIT}
</joint>
<link name="cart"><inertial><mass value="100"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="cable" type="continuous"><parent link="cart"/><child link="ball"/><axis xyz="0 1 0"/></joint>
<link name="ball"><inertial><origin xyz="0 0 -3"/><mass value="50"/>
<inertia ixx="0.8" iyy="0.8" izz="0.8" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
CART, BALL, LENGTH, INERTIA = 100.0, 50.0, 3.0, 0.8
SETTINGS = RunSettings(rtol=1e-10, output_rate=100.0)
STOP = Ramp(rate=1.0, duration=0.5)
TABLE = Table(time=(0.0, 1.0, 2.0), values=(0.0, 1.0, 0.0), interpolation="linear")


def crane(motion: PrescribedMotion, base: str = "fixed", **more) -> System:
    mechanism = build_mechanism(Urdf.from_text(CRANE, "crane.urdf"), base, (0, 0, 0))
    return System(mechanism, drives={"trolley": motion}, **more)


def follow(reference: Reference, **more) -> PrescribedMotion:
    return PrescribedMotion(joint="trolley", follows=reference, **more)


def ran(system: System, v: float = 1.0, duration: float = 1.0, **options):
    first = np.zeros(system.model.nv)
    first[system.mechanism.joint("trolley").v] = v
    options.setdefault("settings", SETTINGS)
    return simulate(system, q=system.neutral(), v=first, duration=duration, **options)


def kinetic_after_stop(speed: float) -> float:
    """The ball swings on about the cart that stands: its angular momentum about the joint stays."""
    return 0.5 * (BALL * LENGTH * speed) ** 2 / (BALL * LENGTH**2 + INERTIA)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize(
    "course",
    [
        STOP,
        Table(time=(0.0, 0.5, 2.0), values=(0.0, 0.5, 0.5), interpolation="linear"),
        Sum(parts=(Ramp(rate=1.0), Ramp(rate=-1.0, start=0.5))),
    ],
    ids=["ramp", "table", "sum"],
)
def test_a_motion_that_stops_at_once_takes_the_kinetic_energy_that_is_lost(course, engine):
    """Closed form of the work; the ball's rate is that of its angular momentum about the cart."""
    run = ran(crane(follow(course)), settings=RunSettings(rtol=1e-10, output_rate=100.0, engine=engine)).data
    work = kinetic_after_stop(1.0) - 0.5 * (CART + BALL)
    assert run["drive_work"].values[-1, 0] == pytest.approx(work, rel=1e-12)  # round-off: all else is at rest
    assert abs(run["energy_error"].values).max() < 1e-11 * abs(work)  # round-off of energies
    t = run["time"].values
    assert abs(run["q"].values[:, 0] - np.minimum(t, 0.5)).max() < 1e-14
    rate = -BALL * LENGTH / (BALL * LENGTH**2 + INERTIA) * np.where(t < 0.5, 0.0, 1.0)
    assert abs(abs(run["v"].values[:, 1]) - abs(rate)).max() < 1e-11


def test_samples_before_a_jump_know_nothing_of_it():
    """The dense output of the step that ends there is as smooth as any: a body at constant speed."""
    run = ran(crane(follow(STOP)), settings=RunSettings(output_rate=1e4)).data
    before = run["time"].values < 0.5
    assert abs(run["v"].values[before, 0] - 1.0).max() < 1e-13
    assert abs(run["v"].values[before, 1]).max() < 1e-13


@pytest.mark.parametrize("base", ["fixed", "free"])
def test_all_momentum_is_kept_where_the_base_is_free(base):
    """The impulse is an inner one; the ledger closes with the drive's work alone."""
    run = ran(crane(follow(Ramp(rate=1.0, start=0.2, duration=0.3)), base), v=0.0).data
    largest = run["kinetic_energy"].values.max()
    assert abs(run["energy_error"].values).max() < 1e-9 * largest  # the tolerance of the run
    assert run["drive_work"].values[-1, 0] == pytest.approx(run["kinetic_energy"].values[-1], rel=1e-8)
    if base == "free":
        p = run["linear_momentum"].values
        assert abs(p).max() < 1e-12 * CART  # from rest, by round-off


def test_two_motions_that_jump_at_once_share_the_work_as_their_impulses_do():
    """With both joints moved, impulses are M (v+ - v-), and works those times the mean rates."""
    urdf = Urdf.from_text(CRANE, "crane.urdf")
    ramps = [Ramp(rate=rate, start=0.25) for rate in (0.7, -1.9)]
    drives = {
        name: PrescribedMotion(joint=joint, rate=rate, follows=ramp)
        for name, joint, rate, ramp in zip(("t", "c"), ("trolley", "cable"), (0.2, 0.4), ramps, strict=True)
    }
    system = System(build_mechanism(urdf, "fixed", (0, 0, 0)), drives=drives)
    settings = RunSettings(rtol=1e-11, output_rate=1.0, output_times=(0.2499999999, 0.25))
    run = simulate(system, q=system.neutral(), v=[0.2, 0.4], duration=0.5, settings=settings).data
    k = int(np.searchsorted(run["time"].values, 0.25))
    mass = pin.crba(system.model, system.model.createData(), run["q"].values[k])
    mass = np.triu(mass) + np.triu(mass, 1).T
    before, after = np.array([0.2, 0.4]), np.array([0.9, -1.5])
    assert run["v"].values[k] == pytest.approx(after, abs=1e-12)
    works = mass @ (after - before) * 0.5 * (before + after)
    # What the drives do in the 1e-10 s from the sample before, at most 200 W.
    assert run["drive_work"].values[k] - run["drive_work"].values[k - 1] == pytest.approx(works, abs=2e-8)
    assert abs(run["energy_error"].values).max() < 1e-9


@pytest.mark.parametrize("split", [0.3, 0.5, 0.7])
def test_two_halves_are_one_run_bit_for_bit(split):
    """Whether the rate has jumped, by its course and by an event, belongs to a state."""
    events = [Event(name="e", when=Time(0.4, 0.6), after=2, action=Set("drives.trolley.rate", 0.3))]
    system = crane(follow(STOP))
    whole = ran(system, events=events)
    first = ran(system, duration=split, events=events)
    second = simulate(system, start=first.end, duration=1.0 - split, settings=SETTINGS, events=events)
    assert whole.end == second.end
    # A record counts works from its begin on.
    works = [float(run.data["drive_work"].values[-1, 0]) for run in (first, second, whole)]
    assert works[0] + works[1] == pytest.approx(works[2], rel=1e-14)


def test_a_rate_that_is_set_goes_on_from_where_the_motion_is():
    """From 1 m/s to a third of it at 0.5 s: the position is continuous, the work that of the blow."""
    events = [Event(name="e", when=Time(0.5), action=Set("drives.trolley.rate", 0.25))]
    motion = PrescribedMotion(joint="trolley", rate=1.0)
    run = ran(crane(motion), events=events).data
    t = run["time"].values
    assert abs(run["q"].values[:, 0] - np.where(t < 0.5, t, 0.5 + 0.25 * (t - 0.5))).max() < 1e-13
    assert abs(run["energy_error"].values).max() < 1e-9
    assert abs(run["event_energy"].values).max() < 1e-10  # it is the drive's work, and counts once
    session = start(crane(motion), q=np.array([0.0, 1.0, 0.0]), v=np.array([1.0, 0.0]), settings=SETTINGS)
    session.step(0.5)
    session.set("drives.trolley.rate", 0.25)
    session.step(0.5)
    assert session["trolley.angle"] == run["q"].values[-1, 0]


def test_a_rate_that_is_set_at_zero_holds_from_the_start():
    """The cart has it at the first sample, and nothing is booked for it."""
    events = [Event(name="e", when=Time(0.0), action=Set("drives.trolley.rate", 0.25))]
    run = ran(crane(PrescribedMotion(joint="trolley", rate=1.0)), events=events, duration=0.1).data
    assert abs(run["v"].values[:, 0] - 0.25).max() < 1e-13
    assert abs(run["energy_error"].values).max() < 1e-9
    assert run["drive_work"].values[0, 0] == 0.0


def test_a_jump_at_the_end_of_a_run_belongs_to_it():
    """The last sample is that behind the jump, with its work."""
    run = ran(crane(follow(STOP)), duration=0.5).data
    assert run["v"].values[-1, 0] == pytest.approx(0.0, abs=1e-13)
    assert run["drive_work"].values[-1, 0] == pytest.approx(kinetic_after_stop(1.0) - 75.0, rel=1e-12)


@pytest.mark.parametrize("name", ["on", "stuck"])
def test_what_holds_by_a_push_or_a_grip_lets_go(name):
    """A cable at rest on a stop is taken off it by the blow, one held by friction slips: nothing is torn."""
    elements = {
        "on": {"stops": {"cable": RigidStop(joint="cable", lower=-1.0, upper=0.0, restitution=0.0)}},
        "stuck": {"frictions": {"cable": StickingFriction(joint="cable", coulomb=1.0)}},
    }[name]
    run = ran(crane(follow(STOP), elements=elements))
    assert run.outcome is Outcome.COMPLETED
    assert abs(run.data["energy_error"].values).max() < 1e-8
    if name == "stuck":
        rate = abs(run.data["v"].values[int(np.searchsorted(run.data["time"].values, 0.5)), 1])
        assert rate == pytest.approx(BALL * LENGTH / (BALL * LENGTH**2 + INERTIA), rel=1e-11)


def test_a_blow_of_a_motion_passes_a_joint_with_play_as_contact_forces_only():
    """The impulse acts on the cart alone; the ball follows by impacts, and the ledger closes."""
    urdf = Urdf.from_text(CRANE, "crane.urdf").variant(joints={"cable": "planar"})
    mechanism = build_mechanism(urdf, "fixed", (0, 0, 0))
    joint = ClearanceJoint(
        name="cable", geometry=PlanarClearance(bearing_radius=0.01, journal_radius=0.009), maximum_depth=1e-2,
        radial=LankaraniNikravesh(stiffness=1e8, restitution=0.8), friction=NoFriction(),
        backend="closed-form",
    )  # fmt: skip
    system = System(mechanism, clearances=[joint], drives={"trolley": follow(STOP)})
    v = np.zeros(system.model.nv)
    v[0] = 1.0
    run = simulate(system, q=system.neutral(), v=v, duration=0.6, settings=SETTINGS)
    data = run.data
    at = int(np.searchsorted(data["time"].values, 0.5))
    # The ball rests in the room until its journal, carried along by the cart, meets the bearing.
    assert run.outcome is Outcome.COMPLETED
    assert abs(data["energy_error"].values).max() < 1e-7 * data["kinetic_energy"].values.max()
    step = data["drive_work"].values[at, 0] - data["drive_work"].values[at - 1, 0]
    # What the drive does in the 10 ms from the sample before: nothing, for all move at one speed.
    assert step == pytest.approx(-0.5 * CART, abs=1e-6)
    assert run.data.sizes["episode"] > 0


# --- what is refused ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Leap(Reference):
    """A course that is 0.3 m further on from 0.5 s on."""

    def terms(self):
        return pieces([0.0, 0.5, np.inf], [[0.0], [0.3]])

    def words(self, slides=False):
        return "a leap"

    @property
    def instants(self):
        return (0.5,)


@pytest.mark.parametrize(
    ("motion", "said"),
    [
        (follow(Leap()), "position of its reference must not jump within the run, got 0.3 m at t = 0.5 s"),
        (
            follow(STOP, rate_jumps="refused"),
            "rate of its reference must not jump within the run, got \N{MINUS SIGN}1 m/s",
        ),
        (
            follow(replace(TABLE, periodic=True)),
            "without jumps that come again for ever",
        ),
    ],
    ids=["position", "rate", "again"],
)
def test_courses_that_jump_are_refused_before_the_run(motion, said):
    with pytest.raises(AntennaPinError, match="motion 'trolley'") as refusal:
        ran(crane(motion), v=motion.at(0.0)[1])
    assert said in str(refusal.value)


def test_what_lies_behind_the_run_is_not_refused():
    assert ran(crane(follow(Leap())), v=0.0, duration=0.4).outcome is Outcome.COMPLETED


SINE = PrescribedMotion(joint="trolley", amplitude=0.1, frequency=1.0)


@pytest.mark.parametrize(
    ("key", "value", "when", "jump"),
    [
        ("position", 0.3, Time(0.5), "0.3 m"),
        ("position", 0.3, Angle("cable", 0.1), "0.3 m"),
        ("amplitude", 0.3, Time(0.25), "0.2 m"),
        ("phase", np.pi, Time(0.25), "\N{MINUS SIGN}0.2 m"),
        ("frequency", 2.0, Time(0.25), "\N{MINUS SIGN}0.1 m"),
    ],
)
def test_events_that_would_move_a_motion_at_once_are_refused_before_the_run(key, value, when, jump):
    event = Event(name="e", when=when, action=Set(f"drives.trolley.{key}", value))
    with pytest.raises(
        InvalidParameterError, match=f"event 'e': drives.trolley.{key} .* the motion would jump"
    ) as found:
        ran(crane(SINE), v=0.2 * np.pi * 0.1 * 10, events=[event])
    assert f"got {jump} at t =" in str(found.value)


def test_a_run_ends_where_an_event_would_move_a_motion_at_once():
    """When an angle is passed is known in the run only: it ends there, by name, with nothing moved."""
    event = Event(name="e", when=Angle("trolley", 0.05), action=Set("drives.trolley.amplitude", 0.3))
    run = ran(crane(SINE), v=0.2 * np.pi, events=[event])
    assert run.outcome is Outcome.REFUSED
    assert "event 'e' sets drives.trolley.amplitude = 0.3: " in run.message
    assert "got 0.1 m" in run.message
    assert run.data["q"].values[-1, 0] == pytest.approx(0.05, abs=1e-12)


def test_an_amplitude_set_where_the_sine_is_zero_is_a_blow():
    """At 1 s the rate jumps from 0.2 pi to 0.6 pi m/s: the work of that is the drive's."""
    event = Event(name="e", when=Time(1.0), action=Set("drives.trolley.amplitude", 0.3))
    run = ran(crane(SINE), v=0.2 * np.pi, duration=1.2, events=[event]).data
    assert abs(run["energy_error"].values).max() < 1e-8
    assert run["v"].values[int(np.searchsorted(run["time"].values, 1.0)), 0] == pytest.approx(0.6 * np.pi)


def test_a_session_refuses_a_position_and_changes_nothing():
    session = start(crane(SINE), q=np.array([0.0, 1.0, 0.0]), v=np.array([0.2 * np.pi, 0.0]))
    session.step(0.1)
    with pytest.raises(InvalidParameterError, match=r"drives\.trolley\.position .* set its rate"):
        session.set("drives.trolley.position", 0.3)
    assert session["drives.trolley.position"] == 0.0
    assert session.step(0.1)


def test_jumps_of_terms_are_found_and_continued():
    """Left of a jump the continued course is the course; there it has the rate from before."""
    course = Sum(
        parts=(
            Ramp(rate=1.0, start=0.1, duration=0.2),
            Ramp(rate=3.0, start=0.3),
            Sine(amplitude=1.0, frequency=2.0),
        )
    )
    first, second = jumps(course.terms())
    # 0.1 + 0.2 is an ulp more than 0.3: one jump, of both.
    assert (first.time, first.rate) == (0.1, 1.0)
    assert second.rate == pytest.approx(2.0, abs=1e-15)
    assert second.begin <= 0.3 <= second.time

    @dataclass(frozen=True, kw_only=True)
    class Given(Reference):
        def terms(self):
            return tuple(continued(course.terms(), second.begin))

    t = 0.05
    assert Given().at(t) == course.at(t)
    assert Given().at(0.2) == course.at(0.2)
    here, there = Given().at(0.4), course.at(0.4)
    assert np.subtract(there, here) == pytest.approx((0.2, 2.0, 0.0), abs=1e-12)
