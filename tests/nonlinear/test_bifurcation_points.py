"""Where branches of periodic solutions cross one another, and what happens about a fold: closed forms."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import RunSettings
from antenna_pin.studies.nonlinear import Flow, continued
from antenna_pin.studies.nonlinear.bifurcation_points import hidden_change, is_torus, locate_crossing

WEIGHT = 9.0  # m g l of 1 kg at 1 m


def upright(pendulum):
    """A pendulum that stands on its hinge, held by a spring, over the stiffness: k phi = m g l sin(phi)."""

    def family(stiffness):
        system = pendulum(-WEIGHT, damping=3.0, stiffness=stiffness)
        return Flow(system, RunSettings(rtol=1e-12, engine="compiled")), 0.5

    return family


@pytest.mark.parametrize("end", [6.0, 7.0])
def test_an_upright_pendulum_loses_its_stability(pendulum, end):
    """Where the spring is as stiff as the weight is heavy; with an end of 6, orbits fall upon that value.

    On the symmetric branch, where the multiplier depends on the stiffness by its logarithm.
    """
    family = upright(pendulum)
    flow, _ = family(12.0)
    branch = continued(family, flow.first(np.array([1.0, 0.0]), np.zeros(1)), (12.0, end), arc=0.25)
    (crossing,) = branch.bifurcations
    assert crossing.kind == "branch-point" and crossing.doubt < 1e-7 * (12.0 - end)
    # Multipliers are known to 1e-10, and change by 0.15 for each N m/rad.
    assert crossing.value == pytest.approx(WEIGHT, abs=1e-8)
    stable = [point.orbit.stable for point in branch.points]
    assert all(stable[: crossing.after + 1]) and not any(stable[crossing.after + 1 :])
    assert all(abs(point.value - WEIGHT) > 1e-6 for point in branch.points)


@pytest.mark.slow
def test_a_leaning_pendulum_comes_upright(pendulum):
    """The branch without the symmetry turns back there, and is no fold: on both sides it is stable.

    The values go with the square of the angle, so that a place along it to 1e-4 is one to 1e-8.
    """
    family = upright(pendulum)
    flow, _ = family(8.0)
    leans = brentq(lambda phi: 8.0 * phi - WEIGHT * math.sin(phi), 0.1, 3.0)
    state = flow.first(np.array([math.cos(leans), math.sin(leans)]), np.zeros(1), {"hinge": leans})
    branch = continued(family, state, (8.0, 10.0), arc=0.3)
    (crossing,) = branch.bifurcations
    assert crossing.kind == "branch-point"
    assert crossing.value == pytest.approx(WEIGHT, abs=1e-8)
    assert branch.message == "it came back to the beginning of the range"
    assert all(point.orbit.stable for point in branch.points)
    assert branch.points[-1].orbit.start.q[1] == pytest.approx(-math.sin(leans), abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("side", [0.0, 1.0])
def test_two_branches_exchange_their_stability(mapped, side):
    """x -> x + sin(p) y - y^2 with y = x - p^2: orbits at y = 0 and y = sin(p), which cross at p = 0."""

    def family(p):
        def of(x, v):
            y = x - p**2
            return x + math.sin(p) * y - y**2, 0.4 * v

        return mapped(of)

    first = -0.4
    flow, _ = family(first)
    start = flow.first(np.array([first**2 + side * math.sin(first)]), np.zeros(1))
    branch = continued(family, start, (first, 0.4), arc=0.4)
    (crossing,) = branch.bifurcations
    assert crossing.kind == "branch-point"
    # Its determinant, by differences of runs at 1e-12, is known to 1e-10, and its slope over p is 0.75.
    assert crossing.value == pytest.approx(0.0, abs=1e-9) and crossing.doubt < 1e-7
    for point in branch.points:
        assert point.orbit.start.q[0] == pytest.approx(
            point.value**2 + side * math.sin(point.value), abs=1e-8
        )


@pytest.mark.parametrize(
    ("x", "arc", "order"),
    [
        pytest.param(0.06, 0.18, ["flip", "fold"], marks=pytest.mark.slow),
        pytest.param(-0.16, 0.3, ["fold", "flip"], marks=pytest.mark.slow),
    ],
)
def test_a_flip_beside_a_fold(mapped, x, arc, order):
    """Henon's map has both where 2 x = -+(1 - b), here within one step: before the fold, or behind it."""
    b = 0.9

    def family(p):
        return mapped(lambda x, y: (p - x**2 + b * y, x))

    p = x**2 + (1.0 - b) * x
    flow, _ = family(p)
    branch = continued(family, flow.first(np.array([x]), np.array([x])), (p, p - 1.0), arc=arc, most=2)
    assert [one.kind for one in branch.bifurcations] == order
    assert {one.after for one in branch.bifurcations} == {0}
    exact = {"fold": -0.25 * (1.0 - b) ** 2, "flip": 0.75 * (1.0 - b) ** 2}
    for one in branch.bifurcations:
        assert one.value == pytest.approx(exact[one.kind], abs=1.1e-7) and one.doubt <= 1e-7


@pytest.mark.parametrize(
    ("multipliers", "torus"),
    [
        ((0.6 + 0.8j, 0.6 - 0.8j, 0.5, -2.0), True),  # on the circle, beside two with the product -1
        ((0.3 + 0.4j, 0.3 - 0.4j, 0.5, 2.0), False),  # a saddle of two real ones has the product 1, too
    ],
)
def test_a_torus_is_told_from_two_real_multipliers(multipliers, torus):
    assert is_torus(np.array(multipliers)) == torus


def cubic_step(turns, unit, low, high):
    """A step whose parameter is a cubic that turns back at two places; nothing else happens to its orbit."""
    value = np.polynomial.Polynomial.fromroots(turns).integ()
    orbit = SimpleNamespace(onsets=(), multipliers=np.array([0.5 + 0.0j, -0.3 + 0.0j]), doubt=0.0)
    node = SimpleNamespace(tangent=np.ones(3), crossing=1.0, point=SimpleNamespace(orbit=orbit))
    return SimpleNamespace(
        stepper=SimpleNamespace(unit=unit),
        node=lambda along: node,
        nodes=lambda: {low: node, high: node, high + 1.0: node},
        point=lambda along: SimpleNamespace(value=value(along)),
        slope=lambda along: value.deriv()(along) / unit,
    )


def test_a_parameter_that_turns_twice_within_a_step_is_looked_at_between():
    """Once back and forth, both ends go on in one way: only the cubic through them tells of it."""
    random = np.random.default_rng(1)
    seen = {True: 0, False: 0}
    for _ in range(200):
        low, size, unit = random.normal(), random.uniform(0.1, 2.0), random.choice([-0.5, 3.0])
        shares = random.uniform(-0.7, 1.7, 2)
        if min(abs(shares[1] - shares[0]), *abs(shares), *abs(shares - 1.0)) < 0.04:
            continue  # between two places that are looked at, or as good as at an end
        found = hidden_change(cubic_step(low + size * shares, unit, low, low + size), low, low + size)
        twice = bool(((shares > 0.0) & (shares < 1.0)).all())
        assert (found is not None) == twice, shares
        assert found is None or low < found < low + size
        seen[twice] += 1
    assert min(seen.values()) > 20


def node(multipliers, way=(1.0, 1.0), crossing=1.0, doubt=1e-9):
    """Return of an orbit what is asked of it."""
    orbit = SimpleNamespace(multipliers=np.array(multipliers, dtype=complex), doubt=doubt, onsets=1)
    return SimpleNamespace(point=SimpleNamespace(orbit=orbit), tangent=np.array(way), crossing=crossing)


def between(low, high, beside):
    """Return a straight step from 0 to 1 between two orbits, behind a third."""
    nodes = {-1.0: beside, 0.0: low, 1.0: high}
    return SimpleNamespace(
        stepper=SimpleNamespace(unit=1.0),
        node=nodes.__getitem__,
        nodes=lambda: nodes,
        slope=lambda along: 1.0,
        point=lambda along: SimpleNamespace(value=along),
    )


@pytest.mark.parametrize(
    ("last", "more", "where"),
    [
        ((0.6,), {}, None),  # all stay within the unit circle
        ((1.5,), {"crossing": -1.0}, None),  # one has left it, through a branch point
        ((1.5,), {}, 0.5),  # one has left it, and nothing says how
        ((-1.5,), {}, None),  # through -1, where the period doubles
        ((1.0,), {}, None),  # it is on neither side
        ((1.5, 0.1), {}, None),  # a contact that lasted ends: of another map as many do not count
    ],
)
def test_a_multiplier_does_not_leave_the_unit_circle_unseen(last, more, where):
    """Where it has with no sign that says so, an orbit in between is looked at."""
    assert hidden_change(between(node((0.5,)), node(last, **more), node((0.4,))), 0.0, 1.0) == where


def test_a_crossing_is_doubted_as_its_orbits_are():
    """By what the map's derivative is wrong by, and by what is left of an orbit over how far that is away.

    Of a branch on which the determinant falls to zero at 0.1, evenly, as the least singular value does.
    """
    residual, doubt, off = 2e-9, 1e-9, 0.1

    def at(along):
        orbit = SimpleNamespace(doubt=doubt, residual=residual)
        point = SimpleNamespace(orbit=orbit, value=2.0 + 3.0 * along)
        return SimpleNamespace(
            point=point, crossing=5.0 * (along - off), margin=abs(along - off), regular=True
        )

    step = SimpleNamespace(arc=2.0, node=at, point=lambda along: at(along).point)
    found = locate_crossing(step, -1.0, 1.0, 0.0)
    assert found.value == pytest.approx(2.3, abs=1e-12) and found.along == pytest.approx(off, abs=1e-12)
    # The first orbits about it are an eighth of the step to either side; nearer ones are doubted more.
    assert found.doubt == pytest.approx(3.0 * (doubt + residual / 0.25), rel=1e-6)
