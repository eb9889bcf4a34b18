"""Branches of periodic solutions against parameters at which closed forms say that they change."""

import math

import numpy as np
import pytest
from impact_oscillator import Impacts
from numba import njit
from scipy.optimize import brentq

from antenna_pin import RunSettings, load_scenario
from antenna_pin.elements import CallableDrive, SineDrive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.nonlinear import Chart, Flow, continued, flow_of, periodic_orbit
from antenna_pin.studies.nonlinear.bifurcation_points import flip_test, is_torus, torus_test
from antenna_pin.studies.nonlinear.pseudo_arclength import BranchStepper

NUMBERS = {"m": 1.0, "k": 1.0, "c": 0.1}


@pytest.fixture
def against_a_stop(oscillator, turned_back):
    """A function that makes a mass on a spring, driven against a stop: its flow, and the drive's period."""

    def make(force, frequency, stop, restitution, damping=NUMBERS["c"]):
        system, hit = oscillator(1.0, 1.0, damping, force, frequency), turned_back(stop, restitution)
        return Flow(system, RunSettings(rtol=1e-12, engine="compiled"), events=(hit,)), 1.0 / frequency

    return make


def test_a_fold(pendulum):
    """A constant torque holds a pendulum up to m g l, where its two equilibria meet: closed form.

    At rest any time is a period. The parameter is of second order about the fold: where its slope over the
    arc is known to 1e-6, so is the fold to much less, and what is left are the orbits' own 1e-9.
    """
    weight = 9.0  # of 1 kg at 1 m

    def family(torque):
        return Flow(
            pendulum(weight, damping=1.5, torque=torque), RunSettings(rtol=1e-12, engine="compiled")
        ), 0.5

    flow, _ = family(8.0)
    held = math.asin(8.0 / weight)
    guess = flow.first(np.array([math.cos(held), math.sin(held)]), np.zeros(1))
    branch = continued(family, guess, (8.0, 10.0), arc=0.3, most=20)
    (fold,) = branch.bifurcations
    assert fold.kind == "fold" and branch.points[fold.after].orbit.stable
    assert fold.value == pytest.approx(weight, abs=1e-8)
    assert abs(fold.value - weight) < fold.doubt < 2e-7
    # Round the fold the branch goes on to the other equilibrium, above the hinge's height, and to the value
    # that it began at: to the last bit.
    assert branch.message == "it came back to the beginning of the range"
    assert [branch.points[k].value for k in (0, -1)] == [8.0, 8.0]
    for point in branch.points[fold.after + 1 :]:
        cosine, sine = point.orbit.start.q
        assert cosine < 0.0 and sine == pytest.approx(point.value / weight, rel=1e-9)
        assert point.orbit.stable is False


@njit
def self_excited(t, x, v):
    """Return a force that drives slow motions and damps fast ones (Rayleigh)."""
    return 0.15 * v - 0.2 * v**3


@pytest.mark.slow
def test_a_torus_is_born(oscillator):
    """Of a driven oscillator that excites itself, where its damping over a period is none: closed form.

    The drive is what makes x = A sin(w t) a solution. By Liouville the product of its multipliers, a complex
    pair, is exp of the integral of 0.15 - 3 0.2 x'^2: it passes 1 where A^2 w^2 = 2 0.15 / (3 0.2).
    """
    w, stiffness, a, b = 1.3, 1.0, 0.15, 0.2
    period, exact = 2.0 * math.pi / w, math.sqrt(2.0 * a / (3.0 * b)) / w
    own = CallableDrive(joint="way", torque=self_excited)

    def family(size):
        cube = b * (size * w) ** 3
        one = (stiffness - w**2) * size + 1j * (0.75 * cube - a * size * w)
        third = SineDrive(joint="way", amplitude=0.25 * cube, frequency=3.0 / period, phase=0.5 * math.pi)
        system = oscillator(
            1.0, stiffness, 0.0, abs(one), 1.0 / period, float(np.angle(one)), own=own, third=third
        )
        return Flow(system, RunSettings(rtol=1e-12, engine="compiled")), period

    first, last = 1.1 * exact, 0.9 * exact
    flow, _ = family(first)
    branch = continued(family, flow.first(np.zeros(1), np.array([first * w])), (first, last), arc=0.5)
    (torus,) = branch.bifurcations
    assert torus.kind == "neimark-sacker" and torus.doubt < 1e-7 * (first - last)
    # Products of multipliers are known to 1e-11, and halving ends within its doubt.
    assert torus.value == pytest.approx(exact, abs=1.1 * torus.doubt)
    for point in branch.points:
        divergence = (a - 1.5 * b * (point.value * w) ** 2) * period
        assert point.orbit.start.v == pytest.approx([point.value * w], abs=1e-10)
        assert point.orbit.multipliers.prod() == pytest.approx(math.exp(divergence), rel=1e-10)
        assert np.abs(point.orbit.multipliers.imag).min() > 0.5


SWUNG = {
    "integrator.engine": "compiled",
    "drives.crank": {"replace": True, "kind": "sine", "amplitude": 0.2, "frequency": 10.0},
    "springs.crank": {"stiffness": 2.0, "damping": 0.02, "rest_angle": 0.8},
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "values"),
    [
        pytest.param("closures.guide.first.point", (0.0, 0.02), marks=pytest.mark.slow),
        ("mechanism.joints.pin.origin_xyz", (0.12, 0.15)),
    ],
)
def test_a_branch_over_a_length_of_a_loop(key, values):
    """A slider-crank that swings: the height of its guide, the length of its rod, by which the loop moves.

    Orbits of the branch are those that transients at their own values end in, and its direction is the
    difference of two orbits found on their own.
    """
    scenario = load_scenario("slider_crank", case="ideal", overrides=SWUNG)
    place = 2 if key.startswith("closures") else 0

    def family(value):
        return flow_of(scenario.with_overrides({key: [value * (k == place) for k in range(3)]}))[0], 0.1

    flow, start = flow_of(scenario)
    branch = continued(family, flow.after(start, 2.0), values, arc=0.2, most=8)
    assert branch.message == "it came to the end of the range"
    assert branch.points[-1].value == values[1]
    unit = values[1] - values[0]
    follower = BranchStepper(family, unit, 1e-9)
    for point in branch.points[1:3]:
        chart = follower.chart(point)
        here, _ = family(point.value)
        end = here.after(Chart(here.system, start).state(np.zeros(2), here.system), 4.0)
        # The multipliers are of size 0.37, so that in 40 periods nothing is left of the transient; of the
        # branch's orbits the ends of a period meet to 1e-9.
        assert np.abs(chart.coordinates(end)).max() < 1e-8
        ends = []
        for value in (point.value - 1e-3 * unit, point.value + 1e-3 * unit):
            flow, period = family(value)
            found = periodic_orbit(flow, chart.state(np.zeros(2), flow.system), period, tolerance=1e-11)
            ends.append(chart.coordinates(found.start))
        way = follower.node(point, None).tangent
        # Second order in a thousandth of the range, over which slopes change by their own size.
        assert way[:-1] / way[-1] == pytest.approx((ends[1] - ends[0]) / 2e-3, rel=2e-6, abs=2e-6)


@pytest.mark.slow
def test_a_graze(against_a_stop):
    """Where the steady state comes to the stop, its amplitude is the stop's distance: closed form."""
    frequency, stop = 0.3, 0.5
    w = 2.0 * math.pi * frequency
    exact = stop * abs(NUMBERS["k"] - NUMBERS["m"] * w**2 + 1j * NUMBERS["c"] * w)

    def family(force):
        return against_a_stop(force, frequency, stop, 0.8)

    # From the steady state: from rest it would come to an orbit with impacts, which is there too.
    steady = 0.9 * exact / (NUMBERS["k"] - NUMBERS["m"] * w**2 + 1j * NUMBERS["c"] * w)
    flow, _ = family(0.9 * exact)
    guess = flow.first(np.array([steady.imag]), np.array([(1j * w * steady).imag]))
    branch = continued(family, guess, (0.9 * exact, 1.1 * exact), arc=0.3, most=12)
    graze = branch.bifurcations[0]
    assert graze.kind == "grazing" and graze.doubt < 1e-6
    assert graze.value == pytest.approx(exact, abs=1e-6)


ISSUE = (0.04, 2.2, 0.8, (2.10765088, -0.19501412))


@pytest.mark.parametrize(
    ("rig", "stops", "arc"),
    [
        pytest.param(ISSUE, (0.2284, 0.25), 0.2, marks=pytest.mark.slow),
        pytest.param(ISSUE, (0.2284, 0.27), 0.2, marks=pytest.mark.slow),
        pytest.param((0.1, 2.1, 0.75, (2.14436961, -0.3621061)), (0.2572, 0.3), 0.15, marks=pytest.mark.slow),
    ],
)
def test_a_stop_that_is_moved_away(against_a_stop, rig, stops, arc):
    """The orbit with one impact doubles its period, and lives on until the impact has no speed: exact map.

    Over the stop's place; steps lead far beyond the flip, and beyond where there are orbits: what Newton's
    method does not find is no graze, and of what is outside of the range nothing is said.
    """
    damping, w, restitution, guess = rig
    frequency = 0.5 * w / math.pi

    def exact(stop, near):
        one = Impacts(1.0, 1.0, damping, 1.0, frequency, stop, restitution)
        return one, one.orbit(near)

    known = {stops[0]: exact(stops[0], guess)[1]}

    def orbit(stop):
        for s in np.linspace(stops[0], stop, 12):
            near = known[min(known, key=lambda one: abs(one - s))]
            one, known[s] = exact(s, near)
        return one, known[stop]

    def product(stop):
        one, (t, v) = orbit(stop)
        return float(np.prod(one.multipliers(t, v) + 1.0).real)

    # The speed passes zero where the impact goes.
    end = brentq(lambda stop: orbit(stop)[1][1], stops[0], 1.05 * stops[0] + 0.03, xtol=1e-13)
    wanted = [("flip", brentq(product, stops[0], 0.99 * end, xtol=1e-13))]
    wanted += [("grazing", end)] if end < stops[1] else []

    def family(stop):
        return against_a_stop(1.0, frequency, stop, restitution, damping)

    flow, period = family(stops[0])
    one, (t, v) = orbit(stops[0])
    # Flown on from the impact to where the drive begins anew.
    x, rate = one.flight(t, np.array([stops[0], v]), math.ceil(t / period) * period - t)
    start = flow.first(np.array([x]), np.array([rate]))
    branch = continued(family, start, stops, arc=arc)
    found = [(each.kind, each.value) for each in branch.bifurcations]
    assert [kind for kind, _ in found] == [kind for kind, _ in wanted]
    for each, (_, value) in zip(branch.bifurcations, wanted, strict=True):
        # Located to 1e-7 of the range.
        assert abs(each.value - value) <= 1.1 * each.doubt and each.doubt <= 2e-7 * (stops[1] - stops[0])
    last = branch.points[-1].value
    if end > stops[1]:
        assert branch.message == "it came to the end of the range" and last == stops[1]
    else:
        assert branch.message.startswith("it ends in a graze") and end - 1e-4 < last < end


@pytest.mark.parametrize("size", [0.8, 1.0, 1.25])
@pytest.mark.parametrize("other", [0.3, -0.6, 1.5])
def test_numbers_of_multipliers_pass_zero_where_one_or_two_leave_the_unit_circle(size, other):
    """Of a pair of this size and a real multiplier: that of a torus is negative while the pair is within."""
    turn = size * np.exp(0.7j)
    three = np.array([turn, turn.conjugate(), other])
    limited = [max(size**2, 1.0), max(size * abs(other), 1.0)]
    torus = (size**2 - 1.0) / limited[0] * abs((turn * other - 1.0) / limited[1]) ** 2
    assert torus_test(three) == pytest.approx(torus, rel=1e-14, abs=1e-15)
    assert is_torus(three)
    doubled = abs(1.0 + turn) ** 2 / limited[0]
    assert flip_test(three) == pytest.approx(doubled * (1.0 + other) / max(abs(other), 1.0), rel=1e-14)
    # A negative one leaves, with a real one that is no partner of it.
    assert flip_test(np.array([-size, 0.5])) == pytest.approx((1.0 - size) / max(size, 1.0) * 1.5, abs=1e-15)
    assert not is_torus(np.array([-size, -1.0 / size, other]))
    assert torus_test(three[2:]) == 1.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"values": (1.0, 1.0)}, "values must be two different, finite ones"),
        ({"values": (1.0, 2.0), "arc": 0.0}, "arc must be positive and finite"),
        ({"values": (1.0, 2.0), "most": 1}, "most must be 2 or more"),
    ],
)
def test_refusals(oscillator, given, message):
    flow = Flow(oscillator(damping=1.0))
    with pytest.raises(InvalidParameterError, match=message):
        continued(lambda value: (flow, 1.0), flow.first(np.zeros(1), np.zeros(1)), **given)
