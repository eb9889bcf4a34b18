"""Radau IIA of order 5: its order on the group, stiff problems at steps that no explicit method can take."""

import math

import numpy as np
import pytest
from scipy.integrate import Radau, solve_ivp

from antenna_pin.integrate import METHODS, Manifold, Stepper

METHOD = METHODS["radau5"]
#: So small that Newton's steps go on to round-off.
EXACTLY = 1e-13


def march(problem, end, steps, rtol=EXACTLY):
    size = 2 * problem.manifold.nv + problem.manifold.nx
    stepper = Stepper(problem, METHOD, np.ones(size), rtol)
    stepper.restart(0.0, problem.initial())
    for _ in range(steps):
        stepper.attempt(end / steps)
        stepper.accept()
    return stepper


def test_the_table_is_the_collocation_at_radaus_points():
    """Exact for polynomials up to degree 2 at each stage, up to degree 4 at the end: that makes order 5."""
    weights, nodes = METHOD.weights[1:4, 1:4], METHOD.nodes[1:4]
    for k in range(1, 4):
        assert weights @ nodes ** (k - 1) == pytest.approx(nodes**k / k, abs=1e-15)
    for k in range(1, 6):
        assert METHOD.weights[METHOD.last, 1:4] @ nodes ** (k - 1) == pytest.approx(1.0 / k, abs=1e-15)
    assert METHOD.polynomials.sum(axis=1) == pytest.approx(METHOD.weights[METHOD.last], abs=1e-15)
    assert METHOD.implicit and not any(m.implicit for m in METHODS.values() if m is not METHOD)


def test_order_five_on_a_tumbling_body(body, state_difference):
    """Driven, all of pose, twist and a quadrature counted."""
    problem = body(2.0)
    exact = problem.reference([2.0])[-1]
    errors = [state_difference(march(problem, 2.0, n).y, exact) for n in (20, 40)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.25)  # the next term, of size h


def test_the_error_estimate_is_of_order_four(body):
    """As for h^4 in the step."""
    found = []
    for h in (0.05, 0.025):
        stepper = Stepper(body(2.0), METHOD, np.ones(13), 1e-5)
        stepper.restart(0.0, body().initial())
        found.append(stepper.attempt(h))
    assert math.log2(found[0] / found[1]) == pytest.approx(4.0, abs=0.4)


class Forced:
    """Two nonlinear equations driven over time."""

    manifold = Manifold((), 2)

    def initial(self):
        return np.array([0.7, 1.1])

    def derivative(self, t, y, rates):
        rates[0] = math.sin(2.0 * t) - y[0] * y[1]
        rates[1] = y[0] - 0.3 * y[1] ** 2


def test_a_step_is_scipys():
    """The same method from another hand, its end and its collocation polynomial."""
    h, rates = 0.2, np.empty(2)

    def derivative(t, y):
        Forced().derivative(t, y, rates)
        return rates.copy()

    other = Radau(derivative, 0.0, Forced().initial(), h, rtol=1e-3, atol=1.0, max_step=h, first_step=h)
    other.newton_tol = 1e-7
    other.step()
    assert other.t == h
    stepper = march(Forced(), h, 1)
    # Where Newton's steps of the other one end.
    assert stepper.y == pytest.approx(other.y, abs=1e-8)
    fine = solve_ivp(derivative, (0.0, h), Forced().initial(), method="DOP853", rtol=1e-13, atol=1e-14)
    assert stepper.y == pytest.approx(fine.y[:, -1], abs=2e-6)  # error of one long step
    stepper = march(Forced(), h, 0)
    stepper.attempt(h)
    stepper.prepare_dense()
    out = np.empty(2)
    for theta in (0.0, 0.3, 0.7, 1.0):
        stepper.interpolate(theta, out)
        assert out == pytest.approx(other.dense_output()(theta * h), abs=1e-8)


class Follower(Forced):
    """Prothero and Robinson: y' = -rate (y - cos t) - sin t, whose solution is cos t at any rate."""

    manifold = Manifold((), 1)
    rate = 1e8

    def initial(self):
        return np.array([1.0])

    def derivative(self, t, y, rates):
        rates[0] = -self.rate * (y[0] - math.cos(t)) - math.sin(t)


def test_a_stiff_equation_at_steps_ten_million_times_too_long_for_others():
    """Whatever the rate, the error is at most that of the stages, of order 3, over rate times h."""
    stepper = march(Follower(), 2.0, 20, rtol=1e-10)
    assert abs(stepper.y[0] - math.cos(2.0)) < 1e-10
    explicit = Stepper(Follower(), METHODS["dormand-prince-853"], np.ones(1), 1e-10)
    explicit.restart(0.0, np.array([1.0]))
    assert explicit.attempt(0.1) > 1e6


class Held:
    """A body whose spin is pulled to a given one at a rate: stiff on the group."""

    manifold = Manifold(("rotation",), 0)

    def __init__(self, rate):
        self.rate = rate

    def given(self, t):
        return np.array([0.9, 1.3, -0.7]) * [math.cos(t), math.cos(2.0 * t), 1.0]

    def initial(self):
        return np.array([0.0, 0.0, 0.0, 1.0, *self.given(0.0)])

    def derivative(self, t, y, rates):
        slope = np.array([-0.9 * math.sin(t), -2.6 * math.sin(2.0 * t), 0.0])
        rates[:] = slope - self.rate * (y[4:] - self.given(t))


def test_stiff_on_the_group():
    """The attitude that the given spin leads to, whatever the rate of the pull."""
    loose, stiff = (march(Held(rate), 2.0, 40, rtol=1e-10).y for rate in (0.0, 1e8))
    # Errors of 40 steps of order 5 (loose) and 3 at least (stiff: where the pull hides the stages').
    assert stiff == pytest.approx(loose, abs=1e-5)
    assert np.linalg.norm(stiff[:4]) == pytest.approx(1.0, abs=1e-15)


def test_a_rejected_step_leaves_no_trace(body):
    """The step's start alone decides what comes of it, the Jacobian included."""
    plain, tried = (Stepper(body(2.0), METHOD, np.ones(13), 1e-6) for _ in range(2))
    for stepper in (plain, tried):
        stepper.restart(0.0, body().initial())
    for h in (3.0, 50.0, -0.3):
        tried.attempt(h)
    assert plain.attempt(0.1) == tried.attempt(0.1)
    assert (plain.y == tried.y).all()


def test_a_step_depends_on_its_start_alone(body):
    """Bit for bit: no Jacobian and no guess of the step before; so runs can go on from any state."""
    marched, fresh = march(body(2.0), 0.6, 3, rtol=1e-6), march(body(2.0), 0.6, 0, rtol=1e-6)
    fresh.restart(marched.t, marched.start[:14])
    assert marched.attempt(0.2) == fresh.attempt(0.2)
    assert (marched.y == fresh.y).all()


def test_evaluations_are_counted(body):
    counts = []

    class Counted(body):
        def derivative(self, t, y, rates):
            counts.append(t)
            super().derivative(t, y, rates)

    stepper = march(Counted(2.0), 0.2, 3)
    assert stepper.evaluations == len(counts)


class Exploding(Forced):
    manifold = Manifold((), 1)

    def initial(self):
        return np.array([1.0])

    def derivative(self, t, y, rates):
        rates[0] = y[0] * y[0]


def test_a_step_without_a_solution_is_to_be_halved():
    """y' = y^2 has none behind t = 1."""
    stepper = march(Exploding(), 1.0, 0)
    error = stepper.attempt(30.0)
    assert not error < 10.0
    assert stepper.attempt(1e-3) < 1e9  # and a shorter one has


def test_only_what_matters_has_a_column():
    """A problem that names what it depends on is asked less often; integrals come out the same."""

    class Integral(Forced):
        manifold = Manifold((), 3)

        def initial(self):
            return np.array([0.7, 1.1, 0.0])

        def derivative(self, t, y, rates):
            super().derivative(t, y, rates)
            rates[2] = y[0] * y[1]

    class Named(Integral):
        coupled = (0, 1)

    every, named = (march(kind(), 1.0, 5) for kind in (Integral, Named))
    assert every.newton.columns.tolist() == [0, 1, 2] and named.newton.columns.tolist() == [0, 1]
    assert named.evaluations < every.evaluations
    assert named.y == pytest.approx(every.y, abs=1e-12)  # where Newton's steps end


class Draining:
    """A level that is defined from zero on: y' = 1 - 100 y^1.5."""

    manifold = Manifold((), 1)

    def initial(self):
        return np.zeros(1)

    def derivative(self, t, y, rates):
        assert y[0] >= 0.0
        rates[0] = 1.0 - 100.0 * y[0] ** 1.5


def test_a_state_at_its_least_is_not_displaced_below_it():
    """An implicit step from zero of what has no derivative below."""
    stepper = Stepper(Draining(), METHOD, np.ones(1), 1e-6)
    stepper.restart(0.0, np.zeros(1))
    assert stepper.attempt(1e-3) < 1.0
    assert stepper.y[0] == pytest.approx(1e-3 - 40.0 * 1e-3**2.5, rel=1e-5)
