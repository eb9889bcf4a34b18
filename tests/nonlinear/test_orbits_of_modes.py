"""Periodic solutions and exponents of elements with modes, against closed forms."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import RunSettings, System, Urdf, build_mechanism
from antenna_pin.elements import EndStop, Gear, PrescribedMotion, RigidLatch, RigidStop, StickingFriction
from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.nonlinear import Flow, NotAlikeError, lyapunov_spectrum, periodic_orbit

GRAVITY, FREQUENCY, RESTITUTION = 9.81, 5.0, 0.6
OMEGA, PERIOD = 2.0 * math.pi * FREQUENCY, 1.0 / FREQUENCY
RUN = RunSettings(rtol=1e-12, engine="compiled")


def shaken(instant, amplitude):
    """Acceleration of the ball as the table sees it [m/s^2]."""
    return -GRAVITY + amplitude * OMEGA**2 * math.sin(OMEGA * instant)


def ball(oscillator, amplitude):
    """A ball of 1 kg seen from a table that shakes: its weight, and the table's acceleration."""
    force = {"amplitude": amplitude * OMEGA**2, "frequency": FREQUENCY}
    system = oscillator(stiffness=0.0, pull=GRAVITY, **force)
    stop = RigidStop(joint="way", lower=0.0, restitution=RESTITUTION)
    return Flow(System(system.mechanism, drives=system.drives, elements={"stops": {"table": stop}}), RUN)


def flight(span):
    """Displacements of place and speed over a flight: the force goes by time alone."""
    return np.array([[1.0, span], [0.0, 1.0]])


def bounce(acceleration, speed):
    """The same across a bounce: a neighbour dx off comes dt = -dx / v later, and has -e of its own speed.

    dx is -e dx behind it; the acceleration a acts on it for dt with the one speed instead of the other.
    """
    e = RESTITUTION
    return np.array([[-e, 0.0], [(1.0 + e) * acceleration / speed, -e]])


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["node", "saddle"])
def test_a_ball_that_bounces_once_in_a_period(oscillator, side):
    """Its phase cos p = (g T / 2 - V) / (A w), V = g T e / (1 + e); two orbits, one of them a saddle."""
    amplitude = 0.0095
    v = GRAVITY * PERIOD * RESTITUTION / (1.0 + RESTITUTION)
    phase = side * math.acos((0.5 * GRAVITY * PERIOD - v) / (amplitude * OMEGA))
    t0, s = phase / OMEGA % PERIOD, 0.4 * PERIOD
    # Where it flies 0.4 of a period behind a bounce.
    x = v * s - 0.5 * GRAVITY * s**2
    x -= amplitude * (math.sin(OMEGA * (t0 + s)) - math.sin(phase) - OMEGA * s * math.cos(phase))
    rate = v - GRAVITY * s - amplitude * OMEGA * (math.cos(OMEGA * (t0 + s)) - math.cos(phase))
    flow = ball(oscillator, amplitude)
    start = dataclasses.replace(flow.first(np.array([x]), np.array([rate])), time=t0 + s, reached=t0 + s)
    orbit = periodic_orbit(flow, start, PERIOD)
    through = flight(s) @ bounce(shaken(t0, amplitude), -v / RESTITUTION) @ flight(PERIOD - s)
    expected = np.linalg.eigvals(through)
    assert orbit.iterations == 0 and orbit.onsets == (0, 1)
    # Pieces of steps are good to 1e-10; found 1e-12.
    assert np.sort_complex(orbit.multipliers) == pytest.approx(np.sort_complex(expected), abs=1e-9)
    assert orbit.stable is (side > 0.0)


def test_exponents_of_a_ball_that_bounces_without_order(oscillator):
    """Interval by interval what flights and bounces make of neighbours, made orthogonal after each."""
    amplitude, count = 0.02, 20
    flow = ball(oscillator, amplitude)
    start = flow.after(flow.first(np.array([0.02]), np.array([0.3])), 50.3 * PERIOD)
    found = lyapunov_spectrum(flow, start, PERIOD, count)
    changes = flow.sampled(start, count * PERIOD, 1).data
    blows = list(
        zip(*(changes[f"change_{name}"].values for name in ("time", "rate", "rate_after")), strict=True)
    )
    assert len(blows) > count / 2
    for _, before, after in blows:  # none comes to rest
        assert after == pytest.approx(-RESTITUTION * before, rel=1e-12)
    ways, growth, here = np.eye(2), [], start.time
    for k in range(count):
        end, matrix = start.time + (k + 1) * PERIOD, np.eye(2)
        for instant, speed, _ in [one for one in blows if here < one[0] <= end]:
            matrix = bounce(shaken(instant, amplitude), speed) @ flight(instant - here) @ matrix
            here = instant
        matrix, here = flight(end - here) @ matrix, end
        ways, triangle = np.linalg.qr(matrix @ ways)
        growth.append(np.log(np.abs(np.diag(triangle))))
    # The motion is without order: two runs at 1e-12 are 1e-5 apart after 20 periods.
    assert found.growth == pytest.approx(np.array(growth), abs=1e-4)
    # A volume is e^2 of itself behind each bounce, whatever the motion.
    whole = 2.0 * len(blows) * math.log(RESTITUTION)
    assert found.values.sum() * count * PERIOD == pytest.approx(whole, rel=1e-9)


def test_a_mass_that_is_driven_against_a_stop_that_gives_way(oscillator):
    """Multipliers of a steady motion against differences of second order of the map."""
    system = oscillator(stiffness=4.0, damping=0.2, amplitude=2.0, frequency=0.5)
    stop = EndStop(joint="way", upper=0.2, stiffness=200.0, restitution=0.6)
    parts = {"springs": system.springs, "drives": system.drives}
    flow = Flow(System(system.mechanism, elements={"stops": {"end": stop}}, **parts), RUN)
    guess = flow.after(flow.first(np.zeros(1), np.zeros(1)), 40.0)
    orbit = periodic_orbit(flow, guess, 2.0)
    assert orbit.stable and orbit.onsets[1] == 3  # it touches, turns back, and comes off
    runs = np.linalg.eigvals(flow.tangent_by_runs(orbit.start, 2.0, step=1e-5).matrix)
    assert np.sort_complex(orbit.multipliers) == pytest.approx(np.sort_complex(runs), abs=1e-6)


LINK = (
    '<link name="{0}"><inertial><mass value="1"/>'
    '<inertia ixx="0.05" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="continuous"><parent link="{1}"/><child link="{2}"/><axis xyz="0 0 1"/></joint>'
)


@pytest.fixture(scope="module")
def rubbing():
    """A pad on a spring that a drum rubs on, which turns once while the pad sticks and slips once.

    With D = (T_s - T_c) / k the pad goes with the drum for 2 D / W, and slips for
    2 (pi - atan(D w / W)) / w.
    """
    inertia, turning, static, coulomb = 0.05, 3.0, 0.4, 0.25
    period = 2.0 * math.pi / turning

    def lasts(stiffness):
        w, way = math.sqrt(stiffness / inertia), (static - coulomb) / stiffness
        return 2.0 * way / turning + 2.0 * (math.pi - math.atan(way * w / turning)) / w

    k = float(brentq(lambda stiffness: lasts(stiffness) - period, 0.05, 10.0, xtol=1e-15))
    links = "".join(LINK.format(name) for name in ("ground", "drum", "pad"))
    joints = JOINT.format("spin", "ground", "drum") + JOINT.format("rub", "drum", "pad")
    urdf = Urdf.from_text(f'<robot name="belt">{links}{joints}</robot>', "belt")
    system = System(
        build_mechanism(urdf, "fixed"),
        drives={"spin": PrescribedMotion(joint="spin", rate=turning)},
        elements={
            "frictions": {"rub": StickingFriction(joint="rub", coulomb=coulomb, static=static)},
            # From the ground to the pad: at the sum of both angles.
            "gears": {"coil": Gear(input="spin", output="rub", ratio=-1.0, stiffness=k)},
        },
    )
    flow, angle = Flow(system, RUN), coulomb / k
    q = np.array([1.0, 0.0, math.cos(angle), math.sin(angle)])
    return flow, flow.first(q, np.array([turning, 0.0])), period


@pytest.mark.parametrize("phase", [0.0, 0.6], ids=["sticks", "slips"])
@pytest.mark.parametrize("free", [False, True])
def test_a_pad_that_sticks_and_slips_on_a_drum(rubbing, phase, free):
    """Its period is that of the closed form; a multiplier is 0, for it sticks, and 1 along the orbit."""
    flow, start, period = rubbing
    if phase:
        start = flow.after(start, phase * period)
    assert dict(start.adjusted)["frictions.rub.mode"] == (2.0 if phase else 3.0)
    orbit = periodic_orbit(flow, start, period, free_period=free)
    assert orbit.iterations == 0 and orbit.onsets == (0, 2)
    # Located instants are good to 1e-13 s.
    assert orbit.residual < 1e-11 and orbit.period == pytest.approx(period, rel=1e-12)
    assert orbit.multipliers[-1] == 0.0
    ones = orbit.neutral + int(np.count_nonzero(np.abs(orbit.multipliers - 1.0) < 1e-9))
    assert ones == 1 and len(orbit.multipliers) + orbit.neutral == 2
    assert orbit.exponents[-1] == -math.inf


@pytest.mark.slow
def test_exponents_of_a_pad_that_sticks_and_slips(rubbing):
    """Two begin, one is lost where it sticks; along the orbit nothing grows but before it has settled."""
    flow, start, period = rubbing
    found = lyapunov_spectrum(flow, flow.after(start, 0.6 * period), period, 4)
    assert found.values.shape == (1,)
    assert np.abs(found.growth[1:]).max() < 1e-8


def test_where_all_neighbours_come_onto_a_motion_there_is_no_exponent(oscillator):
    """A ball that stays on the table where it falls, and leaves it again with the table's own throw."""
    force = {"amplitude": 20.0, "frequency": FREQUENCY}
    system = oscillator(stiffness=0.0, pull=GRAVITY, **force)
    stop = RigidStop(joint="way", lower=0.0, restitution=0.0)
    flow = Flow(System(system.mechanism, drives=system.drives, elements={"stops": {"table": stop}}), RUN)
    start = flow.after(flow.first(np.zeros(1), np.zeros(1)), 0.35 * PERIOD)
    orbit = periodic_orbit(flow, start, PERIOD)
    assert orbit.stable and orbit.multipliers.tolist() == [0.0, 0.0]
    with pytest.raises(InvalidParameterError, match="no direction is left"):
        lyapunov_spectrum(flow, start, PERIOD, 40)


def test_a_latch_that_captures_in_a_period_is_refused(oscillator):
    """It goes one way: the state behind a period is none near that before it."""
    system = oscillator(stiffness=4.0, damping=0.2, amplitude=2.0, frequency=0.5)
    latch = RigidLatch(joint="way", angle=0.2, width=0.05)
    parts = {"springs": system.springs, "drives": system.drives}
    flow = Flow(System(system.mechanism, elements={"latches": {"end": latch}}, **parts), RUN)
    start = flow.first(np.zeros(1), np.zeros(1))
    with pytest.raises(NotAlikeError, match="latch 'end' must be 'outside' as at the origin; .*, got 'held'"):
        periodic_orbit(flow, start, 2.0)
    held = periodic_orbit(flow, flow.after(start, 2.0), 2.0)  # it stays where it is for good
    assert held.neutral == 1 and held.multipliers.tolist() == [0.0]
