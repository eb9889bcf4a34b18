"""Every method has the order it states, on the group; without the group's correction it has two."""

import math

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin.contact import LankaraniNikravesh
from antenna_pin.integrate import METHODS, Manifold, Stepper

END = 2.0
# Steps over two seconds: the leading term of the error rules, and is far above round-off.
STEPS = {"rk4": 100, "bogacki-shampine-32": 200, "dormand-prince-54": 60, "dormand-prince-853": 10}


@pytest.fixture(scope="module")
def solution(body):
    problem = body(torque=2.0)
    return problem, problem.reference([END])[-1]


def order(coarse, fine):
    return math.log2(coarse / fine)


def test_full_order_on_a_tumbling_body(method, solution, marcher, state_difference):
    """Driven, so that a stage at a wrong time shows; all of pose, twist and a quadrature counted."""
    problem, exact = solution
    errors = [
        state_difference(marcher(problem, method.name, END, n * STEPS[method.name]).y, exact) for n in (1, 2)
    ]
    assert errors[1] > 1e-12  # far above the error of the reference, some 1e-14
    # The next term of the error, of relative size h.
    assert order(*errors) == pytest.approx(method.order, abs=0.25)


def test_dense_output_has_its_order(method, body, state_difference):
    """The error inside one step falls with h to the dense output's order plus one."""
    problem = body(torque=2.0)
    sizes = {"rk4": 0.04, "bogacki-shampine-32": 0.04, "dormand-prince-54": 0.05, "dormand-prince-853": 0.2}
    thetas = np.array([0.2, 0.45, 0.7, 0.9])
    errors = []
    for h in (sizes[method.name], 0.5 * sizes[method.name]):
        stepper = Stepper(problem, method, np.ones(13), 1.0)
        stepper.restart(0.0, problem.initial())
        stepper.attempt(h)
        stepper.prepare_dense()
        out = np.empty(14)
        worst = 0.0
        for theta, exact in zip(thetas, problem.reference(thetas * h), strict=True):
            stepper.interpolate(theta, out)
            worst = max(worst, state_difference(out, exact))
        errors.append(worst)
    assert errors[1] > 1e-12
    # The next term of the error, of relative size h; in Dormand-Prince 5(4) the leading one is small.
    assert method.dense_order + 0.7 < order(*errors) < method.dense_order + 1.5


def test_dense_output_joins_its_ends(method, body, state_difference):
    problem = body(torque=2.0)
    stepper = Stepper(problem, method, np.ones(13), 1.0)
    stepper.restart(0.0, problem.initial())
    stepper.attempt(0.1)
    stepper.prepare_dense()
    out = np.empty(14)
    stepper.interpolate(0.0, out)
    assert state_difference(out, stepper.start) < 2e-16  # a product by the unit quaternion
    stepper.interpolate(1.0, out)
    # The polynomials' coefficients, up to 700 in the 8(5,3) pair, sum up to the step's weights.
    assert state_difference(out, stepper.y) < 1e-13


@pytest.mark.parametrize("name", ["dormand-prince-54", "dormand-prince-853"])
def test_a_tumbling_body_keeps_energy_and_angular_momentum(name, body, marcher):
    problem = body()
    stepper = marcher(problem, name, 5.0, {"dormand-prince-54": 2000, "dormand-prince-853": 200}[name])
    inertia = np.array([1.0, 2.1, 2.9])

    def invariants(y):
        spin = y[10:13]
        world = pin.Quaternion(y[3:7]).matrix()
        return [0.5 * spin @ (inertia * spin), *(world @ (inertia * spin)), *(world @ y[7:10])]

    first, last = invariants(problem.initial()), invariants(stepper.y)
    # Truncation of order h^p below 1e-12, and round-off of some thousand steps.
    assert last == pytest.approx(first, abs=3e-12)
    # So the mass centre goes straight.
    expected = problem.initial()[:3] + 5.0 * np.array(first[4:])
    assert stepper.y[:3] == pytest.approx(expected, abs=3e-11)


class Impact:
    """A unit mass that meets a wall at unit speed; x is the impulse."""

    manifold = Manifold(("vector",), 1)

    def __init__(self, law, depth=0.0):
        self.law, self.depth = law, depth

    def derivative(self, t, y, rates):
        force = self.law.force(y[0], y[1], 1.0)
        rates[0], rates[1] = -force, force

    def initial(self):
        return np.array([self.depth, 1.0, 0.0])


def impact_solution(problem, end):
    """By steps graded towards the onset, (k / 300)^5 of the end: of the first, h^2.5 is below round-off."""
    stepper = Stepper(problem, METHODS["dormand-prince-853"], np.ones(3), 1.0)
    stepper.restart(0.0, problem.initial())
    times = (np.arange(301) / 300) ** 5 * end
    for h in np.diff(times):
        stepper.attempt(h)
        stepper.accept()
    return stepper.y.copy()


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("restitution", [1.0, 0.7])
def test_order_of_an_impact_from_its_located_onset(method, exponent, restitution, marcher):
    """The method's for an integer exponent n of the law; min(p, n + 1) where the onset is a kink."""
    problem = Impact(LankaraniNikravesh(stiffness=1.0, restitution=restitution, exponent=exponent))
    exact = impact_solution(problem, 1.2)
    steps = {"rk4": 40, "bogacki-shampine-32": 160, "dormand-prince-54": 32, "dormand-prince-853": 4}
    if exponent == 1.0:
        steps["dormand-prince-853"] = 2  # eight would be exact but for round-off
    errors = [
        np.abs(marcher(problem, method.name, 1.2, n * steps[method.name]).y - exact).max() for n in (1, 2)
    ]
    assert errors[1] > 3e-13  # above round-off
    expected = method.order if exponent.is_integer() else min(method.order, exponent + 1.0)
    # The next term of the error, of relative size h or, of the third-order method at n = 3/2, sqrt(h).
    assert order(*errors) == pytest.approx(expected, abs=0.4)
