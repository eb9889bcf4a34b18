"""What every element that is registered has: a number and kernels of its own, words, keys in a scenario."""

import math

import numpy as np
import pytest
from value_classes import check_refusals

from antenna_pin.elements import (
    ELEMENTS,
    FAMILIES,
    GEARS,
    AxialPreload,
    BallBearing,
    Belt,
    BoucWen,
    Cable,
    CallableDrive,
    CallableElement,
    CallableForce,
    CallableMotion,
    ConstantDrive,
    ConstantSpring,
    DahlFriction,
    DistanceMotion,
    EndStop,
    Gear,
    GonthierFriction,
    GravityGradient,
    HarnessSpring,
    JointFriction,
    JointSpring,
    Latch,
    LuGreFriction,
    MaxwellSlip,
    Motor,
    OutsideForce,
    PDController,
    PointSpring,
    PrescribedMotion,
    Rack,
    RandomShake,
    RigidLatch,
    RigidStop,
    SineDrive,
    SineShake,
    Spline,
    StickingFriction,
    StiffnessBearing,
    SweepShake,
    TableDrive,
    TableShake,
    TableSpring,
    Thruster,
    desk_kernels,
    kernels,
    kind_of,
)
from antenna_pin.scenario import FAMILY_SPECS

EXAMPLES = {
    ConstantDrive: (ConstantDrive(joint="a", value=2.5), "constant 2.5 N m", 2.5),
    SineDrive: (
        SineDrive(joint="a", amplitude=4.0, frequency=1.5, phase=0.5),
        "4 N m × sin(2π · 1.5 Hz · t + 0.5 rad)",
        4.0 * math.sin(0.5),
    ),
    TableDrive: (
        TableDrive(joint="a", time=(0.0, 2.0), torque=(1.0, -3.0), file="pulse.csv"),
        "table of pulse.csv: 2 points from 0 to 2 s, linear between them, up to 3 N m",
        1.0,
    ),
    PDController: (
        PDController(joint="a", kp=8.0, kd=0.5, limit=2.0, angle=0.25, rate=0.5),
        "controller, kp 8 N m/rad, kd 0.5 N m s/rad, reference 0.25 rad + 0.5 rad/s · t, at most 2 N m",
        8.0 * 0.15 + 0.5 * 0.3,
    ),
    Motor: (
        Motor(joint="a", value=3.0, torque_constant=0.5, resistance=2.0, cogging=0.25, cycles=2),
        "motor, commanded 3 V, K_t 0.5 N m/A, R 2 ohm, cogging 0.25 N m, ratio 1",
        0.5 * (3.0 - 0.5 * 0.2) / 2.0 - 0.25 * math.sin(0.2),
    ),
    PrescribedMotion: (
        PrescribedMotion(
            joint="a", position=0.5, rate=2.0, coefficients=(0.0, 3.0), amplitude=4.0, frequency=1.5
        ),
        "motion 0.5 rad + 2 rad/s · t + 3 · t^3 + 4 rad × sin(2π · 1.5 Hz · t)",
        0.0,
    ),
    DistanceMotion: (
        DistanceMotion(joint="a", offset=(1.0, 2.0, 2.0), amplitude=(0.0, 0.1, 0.0), frequency=1.5),
        "motion: distance to a point on a path that swings at 1.5 Hz",
        0.0,
    ),
    SineShake: (
        SineShake(joint="x", direction=(0, 0, 2), frequency=8.0, acceleration=5.0, phase=0.5, fade_in=0.1),
        "base shaken along (0, 0, 2): sine of 8 Hz, phase 0.5 rad, 5 m/s² of acceleration, fades in within "
        "0.1 s",
        0.0,
    ),
    SweepShake: (
        SweepShake(
            joint="x",
            axis=(0, 0, 1),
            start_frequency=10.0,
            end_frequency=40.0,
            octaves_per_minute=60.0,
            displacement=0.25,
            acceleration=500.0,
            dwell=0.5,
            back=True,
        ),
        "base shaken about (0, 0, 1): sweep from 10 Hz to 40 Hz and back, 60 octaves/min, the least of "
        "0.25 rad of displacement and 500 rad/s² of acceleration, 0.5 s at the end, takes 4.52 s",
        0.0,
    ),
    RandomShake: (
        RandomShake(
            joint="x",
            direction=(1, 0, 0),
            frequency=(20.0, 80.0, 160.0),
            density=(1.0, 4.0, 4.0),
            period=2.0,
            seed=5,
        ),
        "base shaken along (1, 0, 0): random, 20 to 160 Hz, 21.68 m/s² rms, 3.01, 0 dB/octave, 281 lines, "
        "repeats after 2 s, seed 5",
        0.0,
    ),
    TableShake: (
        TableShake(joint="x", direction=(1, 0, 0), of="velocity", time=(0.0, 2.0), course=(1.0, 3.0)),
        "base shaken along (1, 0, 0): table of velocity, 2 points, ends at 4 m and 3 m/s",
        0.0,
    ),
    CallableMotion: (
        CallableMotion(joint="a", position=math.sin, velocity=math.cos, acceleration=lambda t: -math.sin(t)),
        "motion: functions in Python",
        0.0,
    ),
    CallableDrive: (CallableDrive(joint="a", torque=lambda t, a, r: 0.0), "a function in Python", 0.0),
    JointSpring: (
        JointSpring(joint="a", stiffness=5.0, damping=0.5, rest_angle=0.25),
        "stiffness 5 N m/rad, damping 0.5 N m s/rad, at rest at 0.25 rad",
        5.0 * 0.15 - 0.5 * 0.2,
    ),
    JointFriction: (
        JointFriction(joint="a", damping=0.5, friction=2.0, regularisation_speed=0.15),
        "damping 0.5 N m s/rad, friction 2 N m, rounded off below 0.15 rad/s",
        -0.5 * 0.2 - 2.0 * 0.8,
    ),
    BoucWen: (
        BoucWen(joint="a", alpha=0.25, stiffness=4.0, yield_angle=0.5, start=0.125),
        "Bouc-Wen, stiffness 4 N m/rad, yields at 0.5 rad, alpha 0.25, A 1, beta 0.5, gamma 0.5, n 1",
        -0.25 * 4.0 * 0.1 - 0.75 * 4.0 * 0.5 * 0.125,
    ),
    MaxwellSlip: (
        MaxwellSlip(joint="a", stiffness=(2.0, 8.0), slip=(1.0, 0.5)),
        "2 springs that slip at 1, 0.5 N m, stiffness 10 N m/rad in all",
        -2.0 * 0.1 - 0.5,
    ),
    TableSpring: (
        TableSpring(joint="a", angle=(0.0, 2.0), torque=(1.0, -3.0), interpolation="linear"),
        "table: 2 points from 0 to 2 rad, linear between them, held beyond, up to 3 N m",
        0.8,
    ),
    HarnessSpring: (
        HarnessSpring(
            joint="a", angle=(0.0, 2.0), torque=(1.0, -3.0), torque_back=(2.0, -2.0), reversal=0.5, start=0.5
        ),
        "both ways, table: 2 points from 0 to 2 rad, cubic between them, held beyond, up to 3 N m, goes over "
        "within 0.5 rad",
        1.5 - 0.2 - 0.25,
    ),
    ConstantSpring: (
        ConstantSpring(joint="a", torque=0.5, upper=1.5, ramp=0.25),
        "constant 0.5 N m, to 1.5 rad, ceases within 0.25 rad",
        0.5,
    ),
    RigidStop: (
        RigidStop(joint="a", lower=0.05, upper=1.5, restitution=0.25),
        "rigid end stop at 50 mrad and 1.5 rad, restitution 0.25",
        0.0,
    ),
    RigidLatch: (
        RigidLatch(joint="a", angle=0.5, greatest_rate=2.0),
        "rigid latch at 0.5 rad, captures up to 2 rad/s",
        0.0,
    ),
    # Pressed in by 0.05 rad: K d^2 + D d', out of the stop.
    EndStop: (
        EndStop(
            joint="a", upper=0.05, stiffness=100.0, exponent=2.0, law="kelvin-voigt", damping=3.0, mode=2
        ),
        "end stop at 50 mrad, stiffness 100 N m/rad, exponent 2, kelvin-voigt, damping 3 N m s/rad",
        -(100.0 * 0.05**2 + 3.0 * 0.2),
    ),
    # Held, 0.1 rad beyond its flank.
    Latch: (
        Latch(joint="a", angle=0.25, width=0.2, stiffness=10.0, damping=0.5, play=0.1, mode=2, flank=-1.0),
        "latch at 0.25 rad, window 0.2 rad to either side, stiffness 10 N m/rad, damping 0.5 N m s/rad, "
        "play 0.1 rad",
        10.0 * 0.1 - 0.5 * 0.2,
    ),
    DahlFriction: (
        DahlFriction(joint="a", coulomb=2.0, stiffness=40.0, viscous=0.5, start=0.25, shape=2.0),
        "Dahl, Coulomb friction 2 N m, bristle stiffness 40 N m/rad, viscous 0.5 N m s/rad",
        -0.5 - 0.5 * 0.2,
    ),
    LuGreFriction: (
        LuGreFriction(
            joint="a",
            coulomb=2.0,
            static=3.0,
            stribeck_rate=0.1,
            stiffness=40.0,
            damping=0.6,
            viscous=0.5,
            start=0.25,
        ),
        "LuGre, Coulomb friction 2 N m, static 3 N m, bristle stiffness 40 N m/rad, "
        "bristle damping 0.6 N m s/rad, Stribeck rate 0.1 rad/s, viscous 0.5 N m s/rad",
        -0.5 - 0.6 * (0.2 - 0.2 * 0.5 / (2.0 + math.exp(-4.0))) - 0.5 * 0.2,
    ),
    GonthierFriction: (
        # Bristles have what rests for no time.
        GonthierFriction(
            joint="a", coulomb=2.0, stribeck_rate=0.1, stiffness=40.0, damping=0.6, dwell_time=0.5, start=1.0
        ),
        "Gonthier, Coulomb friction 2 N m, bristle stiffness 40 N m/rad, bristle damping 0.6 N m s/rad, "
        "Stribeck rate 0.1 rad/s, dwell time 0.5 s",
        -2.0,
    ),
    StickingFriction: (
        # Slipping forward.
        StickingFriction(joint="a", coulomb=2.0, static=3.0, stribeck_rate=0.1, viscous=0.5, mode=1),
        "Coulomb friction 2 N m, holds up to 3 N m, viscous 0.5 N m s/rad, Stribeck rate 0.1 rad/s",
        -2.0 - math.exp(-4.0) - 0.5 * 0.2,
    ),
}


BETWEEN = PointSpring(
    first=("world", (0.0, 0.0, 0.0)),
    second=("arm", (1.0, 0.0, 0.0)),
    free_length=0.5,
    stiffness=8.0,
    damping=0.5,
)


#: Each with its words, its torque or force at a deflection of 0.1 and a rate of 0.2, and the power it takes.
MESHES = (
    (
        Gear(input="a", output="b", ratio=-50.0, stiffness=100.0, damping=5.0, play=0.1, efficiency=0.75),
        "from a to b, ratio \N{MINUS SIGN}50, stiffness 100 N m/rad, damping 5 N m s/rad, "
        "play 0.1 rad on the output side, efficiency 0.75, backward 1",
        (-6.0, 0.2),
    ),
    (
        Spline(input="a", output="b", stiffness=100.0),
        "from a to b, stiffness 100 N m/rad",
        (-10.0, 0.0),
    ),
    (
        Spline(input="a", output="b", stiffness=100.0, damping=40.0, play=0.1),
        "from a to b, stiffness 100 N m/rad, damping 40 N m s/rad, play 0.1 rad",
        (-10.0, 1.0),
    ),
    (
        Rack(input="a", output="b", radius=-0.05, stiffness=100.0, damping=5.0, play=0.1),
        "from a to b, radius \N{MINUS SIGN}50 mm, stiffness 100 N/m, damping 5 N s/m, play 0.1 m",
        (-6.0, 0.2),
    ),
    (
        Belt(input="a", output="b", input_radius=0.5, output_radius=2.0, stiffness=100.0, pretension=20.0),
        "from a to b, radii 0.5 m and 2 m, stiffness 100 N/m, pretension 20 N",
        (-20.0, 0.0),
    ),
    (
        Cable(
            input="a",
            output="b",
            input_radius=0.5,
            output_radius=2.0,
            stiffness=100.0,
            slack=0.5,
            crossed=True,
        ),
        "from a to b, crossed, radii 0.5 m and 2 m, stiffness 100 N/m, slack 0.5 m",
        (0.0, 0.0),
    ),
)


@pytest.mark.parametrize(("element", "words", "expected"), MESHES, ids=lambda one: type(one).__name__)
def test_an_element_between_joints_has_its_own_kernels_and_words(element, words, expected):
    """Beyond half the play 0.05: 5 N m and a damper of 1 N m, or of 8 N m that gives 5; strands; slack."""
    assert element.words().replace("\N{NO-BREAK SPACE}", " ") == words
    number, own = kind_of(type(element)), element.words_of_kernel()
    found = kernels.effort(number, own, 0, 0.0, 0.1, 0.2), kernels.dissipation(number, own, 0, 0.1, 0.2)
    assert found == pytest.approx(expected, rel=1e-14)
    assert {type(one) for one, _, _ in MESHES} == set(GEARS.values())


BEARINGS = {
    StiffnessBearing: (
        StiffnessBearing(joint="a", radial=2e6, tilt=5.0, offset=0.25, damping_time=1e-4),
        "ball bearing, radial stiffness 2 MN/m, tilt 5 N m/rad, damped in proportion by 0.1 ms, "
        "reference point at 0.25 m",
    ),
    BallBearing: (
        BallBearing(
            joint="a",
            count=9,
            ball_diameter=6e-3,
            pitch_diameter=0.04,
            contact_angle=0.25,
            preload=50.0,
        ),
        "ball bearing, single row, 9 balls of 6 mm, pitch diameter 40 mm, contact angle 0.25 rad, "
        "preload 50 N, stiffness at the preload",
    ),
    AxialPreload: (
        AxialPreload(joint="a", force=-30.0, stiffness=2e4),
        "preload \N{MINUS SIGN}30 N, stiffness 20 kN/m, force given where the face touches",
    ),
}


def act(t, p, links, joints, states, whole):
    """Push the second link by its place."""
    links[1].force[:] = p[0] * links[1].place


HULL = ("hull", (0.0, 0.0, 0.0))
#: Each with its words, and its force and torque on its last link at time 0.
FORCES = {
    OutsideForce: (
        OutsideForce(
            at=HULL, force=(0.0, 4.0, 0.0), torque=(1.0, 0.0, 2.0), frequency=1.5, phase=0.5,
            value=2.0,
        ),
        "force (0 N, 4 N, 0 N) and torque (1 N m, 0 N m, 2 N m) on hull, axes of the link, times 2, "
        "times sin(2π · 1.5 Hz · t + 0.5 rad)",
        (0.0, 8.0 * math.sin(0.5), 0.0, 2.0 * math.sin(0.5), 0.0, 4.0 * math.sin(0.5)),
    ),
    Thruster: (
        Thruster(
            at=HULL, direction=(0, 0, 3), thrust=2.0, starts=(0.5, 1.0), durations=(0.25,), throttle=0.25,
            misalignment=0.125,
        ),
        "thruster on hull, 2 N, 2 pulses of 0.5 s in all, 1 N s, throttle 0.25, direction off by 0.125 rad",
        (0.5 * math.sin(0.125), 0.0, 0.5 * math.cos(0.125), 0.0, 0.0, 0.0),
    ),
    GravityGradient: (
        GravityGradient(rate=0.5),
        "gravity gradient of a circular orbit, 0.5 rad/s, a revolution in 12.5664 s",
        # Of 2 kg at (1, 2, 3) m: m n^2 (3 z e_z - p); the frame's moments are all alike.
        (-0.5, -1.0, 3.0, 0.0, 0.0, 0.0),
    ),
    CallableElement: (
        CallableElement(act=act, links=(HULL, ("arm", (0.0, 0.0, 0.0))), parameters={"k": 3.0}),
        "a function in Python of hull, arm",
        (3.0, 6.0, 9.0, 0.0, 0.0, 0.0),
    ),
    CallableForce: (
        CallableForce(at=HULL, wrench=lambda t, pose, twist: [*pose[:3, 3], *twist[3:]]),
        "a function in Python on hull",
        (1.0, 2.0, 3.0, 0.0, 0.0, 0.0),
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", FORCES, ids=lambda kind: kind.__name__)
def test_a_force_has_its_own_kernels_and_words(kind):
    """On links whose axes are the world's, at (1, 2, 3) m."""
    element, words, expected = FORCES[kind]
    assert element.words().replace("\N{NO-BREAK SPACE}", " ") == words
    links = np.zeros(max(1, len(element.places)), desk_kernels.LINK).view(np.recarray)
    links["rotation"], links["place"], links["mass"] = np.eye(3), (1.0, 2.0, 3.0), 2.0
    empty = (np.zeros(0, kind).view(np.recarray) for kind in (desk_kernels.JOINT, desk_kernels.STATE))
    desk = (np.zeros(1, desk_kernels.WHOLE).view(np.recarray), links, *empty)
    if getattr(element, "called", True):
        kernels.act(kind_of(kind), element.words_of_kernel(), 0, 0.0, desk)
    else:
        element.ask("it", 0.0, desk)
    found = (*links[-1].force, *links[-1].torque)
    assert found == pytest.approx(expected, rel=1e-14, abs=1e-15)


def test_every_element_has_an_example():
    assert {*EXAMPLES, type(BETWEEN), *GEARS.values(), *BEARINGS, *FORCES} == set(ELEMENTS)
    assert len({kind_of(element) for element in ELEMENTS}) == len(ELEMENTS)


ALL = [*(one for one, *_ in [*EXAMPLES.values(), *MESHES, *BEARINGS.values(), *FORCES.values()]), BETWEEN]


@pytest.mark.parametrize("element", ALL, ids=lambda one: type(one).__name__)
def test_an_element_refuses_numbers_that_break_their_rules(element):
    check_refusals(element)


@pytest.mark.parametrize("kind", EXAMPLES, ids=lambda kind: kind.__name__)
def test_an_element_has_its_own_kernels_and_words(kind):
    """At time 0, angle 0.1 rad and rate 0.2 rad/s."""
    element, words, expected = EXAMPLES[kind]
    assert element.words(slides=False).replace("\N{NO-BREAK SPACE}", " ") == words
    number, own = kind_of(kind), element.words_of_kernel()
    states = np.zeros(len(element.integrals)), 0
    torque = kernels.effort_of(number, own, 0, (0.0, 0.1, 0.2), states)
    assert torque == pytest.approx(expected, rel=1e-15, abs=1e-15)  # round-off
    rates = np.full(len(element.integrals) + 1, np.nan)
    kernels.write_rates_of(number, own, 0, (0.1, 0.2, 0.2 * torque), states, rates, 0)
    assert np.isnan(rates).tolist() == [False] * len(element.integrals) + [True]


@pytest.mark.parametrize("kind", BEARINGS, ids=lambda kind: kind.__name__)
def test_a_bearing_says_what_it_is(kind):
    """And has no torque about its axis."""
    element, words = BEARINGS[kind]
    assert element.words(slides=False).replace("\N{NO-BREAK SPACE}", " ") == words
    assert kernels.effort(kind_of(kind), element.words_of_kernel(), 0, 0.0, 0.1, 0.2) == 0.0


def test_a_kind_that_there_is_not_gives_no_number():
    assert math.isnan(kernels.effort(99, np.zeros(20), 0, 0.0, 0.0, 0.0))


def test_an_element_between_points_has_its_own_kernels_and_words():
    """Its points 0.6 m apart, moving apart at 0.2 m/s: k (l - l0) + c l', c l'^2, k (l - l0)^2 / 2."""
    words = "from world to arm, free length 0.5 m, stiffness 8 N/m, damping 0.5 N s/m"
    assert BETWEEN.words().replace("\N{NO-BREAK SPACE}", " ") == words
    number, own = kind_of(PointSpring), BETWEEN.words_of_kernel()
    found = (
        kernels.tension(number, own, 0, 0.6, 0.2),
        kernels.loss(number, own, 0, 0.2),
        kernels.stored(number, own, 0, 0.6),
    )
    assert found == pytest.approx((0.9, 0.02, 0.04), rel=1e-14)  # round-off of 0.6 - 0.5


def test_a_scenario_knows_every_element():
    found = {
        table: {kind: spec.fills for kind, spec in specs.items()} for table, specs in FAMILY_SPECS.items()
    }
    assert found == {table: dict(family.kinds) for table, family in FAMILIES.items()}
