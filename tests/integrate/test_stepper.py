"""One step: tried, measured, accepted, or left without a trace; and the methods' tables."""

import contextlib
import math
import re

import numpy as np
import pytest
from scipy.integrate import DOP853, RK23, RK45, solve_ivp

from antenna_pin.errors import UnknownNameError
from antenna_pin.integrate import METHODS, Manifold, Stepper, method_named


class Forced:
    """Plain numbers only: two nonlinear equations driven over time."""

    manifold = Manifold((), 2)

    def derivative(self, t, y, rates):
        rates[0] = math.sin(2.0 * t) - y[0] * y[1]
        rates[1] = y[0] - 0.3 * y[1] ** 2


class Orbit:
    """A body, or a plate in its plane, on a Kepler orbit; it does not turn."""

    def __init__(self, kind):
        self.manifold = Manifold((kind,), 0)
        self.n = 3 if kind == "rigid" else 2

    def derivative(self, t, y, rates):
        rates[:] = 0.0
        rates[: self.n] = -y[: self.n] / np.linalg.norm(y[: self.n]) ** 3


class Exploding:
    manifold = Manifold((), 1)

    def derivative(self, t, y, rates):
        rates[0] = y[0] * y[0]


START = np.array([0.7, 1.1])
adaptive = pytest.mark.parametrize(
    "method", [m for m in METHODS.values() if m.adaptive and not m.implicit], ids=lambda m: m.name
)


def make(problem, method, y=None, *, scales=None, rtol=1e-6):
    manifold = problem.manifold
    scales = np.ones(2 * manifold.nv + manifold.nx) if scales is None else scales
    stepper = Stepper(problem, method, scales, rtol)
    stepper.restart(0.0, problem.initial() if y is None else y)
    return stepper


def dense_of(stepper, thetas=(0.0, 0.3, 0.8, 1.0)):
    stepper.prepare_dense()
    out = np.empty(stepper.manifold.size)
    rows = []
    for theta in thetas:
        stepper.interpolate(theta, out)
        rows.append(out.copy())
    return np.array(rows)


# --- a trial and its traces ---------------------------------------------------------------------------------


@pytest.mark.parametrize("rejected", [[3.0], [1e6, 50.0], [1e200], [0.02], [-1.0, 1e3]], ids=str)
def test_a_rejected_step_leaves_no_trace(method, rejected, body):
    """Bit by bit, dense output included: a stage that a trial overwrote would show in later digits only."""
    tried, fresh = make(body(2.0), method), make(body(2.0), method)
    for h in rejected:
        # Uncompiled, Python refuses the sine of infinity: a trial that breaks off leaves no trace either.
        with np.errstate(all="ignore"), contextlib.suppress(ValueError, OverflowError):
            tried.attempt(h)
            tried.prepare_dense()
    errors = [stepper.attempt(0.01) for stepper in (tried, fresh)]
    assert errors[0] == errors[1]
    assert (tried.y == fresh.y).all()
    assert (dense_of(tried) == dense_of(fresh)).all()
    tried.accept()
    fresh.accept()
    assert tried.t == fresh.t == 0.01
    assert tried.attempt(0.02) == fresh.attempt(0.02)
    assert (tried.y == fresh.y).all()


def test_asking_for_dense_output_changes_nothing(method, body):
    """Its extra stages use the same rows as the step."""
    asked, fresh = make(body(2.0), method), make(body(2.0), method)
    for _ in range(3):
        for stepper in (asked, fresh):
            stepper.attempt(0.05)
        dense_of(asked)
        dense_of(asked)
        assert (asked.y == fresh.y).all()
        for stepper in (asked, fresh):
            stepper.accept()
        assert (asked.y == fresh.y).all() and (asked.start == fresh.start).all()


def test_dense_output_is_that_of_the_last_trial(method, body):
    """A step made again, to end elsewhere, has a dense output of its own."""
    stepper, out = make(body(2.0), method), np.empty(14)
    for h in (0.1, 0.06):
        stepper.attempt(h)
        stepper.prepare_dense()
    stepper.interpolate(1.0, out)
    assert out == pytest.approx(stepper.y, rel=0.0, abs=1e-13)  # sums of coefficients up to 700


def test_the_last_stage_is_the_next_steps_first(method, body):
    """An accepted step continues as if it were restarted from its end, without an evaluation."""
    problem = body(2.0)
    going = make(problem, method)
    going.attempt(0.05)
    going.accept()
    anew = make(problem, method)
    anew.restart(going.t, going.y.copy())
    assert going.attempt(0.03) == anew.attempt(0.03)
    assert (going.y == anew.y).all()


def test_evaluations_are_counted(method, body):
    counts = []

    class Counted(body):
        def derivative(self, t, y, rates):
            counts.append(t)
            super().derivative(t, y, rates)

    stepper = make(Counted(2.0), method)
    for _ in range(2):
        stepper.attempt(0.1)
        stepper.prepare_dense()
        stepper.prepare_dense()
        stepper.accept()
    assert stepper.evaluations == len(counts) == 1 + 2 * (method.stages - 1)


def test_refresh_takes_up_a_change_of_the_problem(method, body):
    problem = body(0.0)
    stepper = make(problem, method)
    problem.torque = body(2.0).torque
    stepper.refresh()
    fresh = make(problem, method)
    stepper.attempt(0.1)
    fresh.attempt(0.1)
    assert (stepper.y == fresh.y).all()


# --- the error of a step ------------------------------------------------------------------------------------


def test_the_error_counts_in_units_of_the_tolerance(method, body):
    loose, tight = (make(body(2.0), method, rtol=rtol).attempt(0.05) for rtol in (1e-4, 1e-8))
    assert tight == pytest.approx(1e4 * loose, rel=1e-12, abs=0.0)  # round-off
    assert (tight > 0.0) == method.adaptive


@adaptive
def test_the_error_is_a_mean_over_the_components_that_count(method):
    """Scale + |value| of the larger end; infinite scales leave components out."""
    problem = Forced()

    def error(*scales):
        return make(problem, method, START, scales=np.array(scales)).attempt(0.2)

    both, first, second = error(1.0, 1.0), error(1.0, math.inf), error(math.inf, 1.0)
    if method.name != "dormand-prince-853":  # whose two estimates are combined, after the means
        assert both == pytest.approx(math.sqrt((first**2 + second**2) / 2.0), rel=1e-14, abs=0.0)
    assert min(first, second) < both < max(first, second)
    assert error(math.inf, math.inf) == 0.0
    stepper = make(problem, method, START)
    stepper.attempt(0.2)
    size = max(START[0], stepper.y[0])
    # A scale of 9 + 10 |value| instead of 1 + |value|.
    assert error(9.0 * size + 10.0, math.inf) == pytest.approx(
        first * (1.0 + size) / (10.0 + 10.0 * size), rel=1e-12, abs=0.0
    )


@adaptive
@pytest.mark.parametrize("kind", ["rigid", "plane"])
def test_the_error_does_not_depend_on_how_the_axes_lie(method, kind):
    """Of a translation the vector's length counts, not its components'."""
    problem, rng = Orbit(kind), np.random.default_rng(3)
    rest = [0.0, 0.0, 0.0, 1.0] if kind == "rigid" else [1.0, 0.0]
    spin = [0.0] * (3 if kind == "rigid" else 1)
    place, velocity = np.eye(problem.n)[0], 0.8 * np.eye(problem.n)[1]
    errors = []
    for _ in range(8):
        turn, _ = np.linalg.qr(rng.normal(size=(problem.n, problem.n)))
        start = np.concatenate([turn @ place, rest, turn @ velocity, spin])
        errors.append(
            make(problem, method, start, scales=np.full(2 * problem.manifold.nv, 1e-3)).attempt(0.4)
        )
    # Estimates are differences of rates of order one: round-off is 1e-16 over errors of 1e-7 and more.
    assert errors == pytest.approx([errors[0]] * 8, rel=1e-7, abs=0.0)


def test_a_component_that_does_not_count_is_integrated_all_the_same(method, body):
    scales = np.ones(13)
    scales[[2, 7, 12]] = math.inf
    partial, full = make(body(2.0), method, scales=scales), make(body(2.0), method)
    partial.attempt(0.05)
    full.attempt(0.05)
    assert (partial.y == full.y).all()


@adaptive
def test_the_error_estimate_has_its_order(method, body):
    sizes = (0.1, 0.05) if method.name == "dormand-prince-853" else (0.02, 0.01)
    errors = [make(body(2.0), method).attempt(h) for h in sizes]
    # An estimate against order q falls with h^(q + 1); that of 8(5,3) is combined to fall with h^8. The next
    # term has relative size h.
    expected = method.error_order + 1
    assert math.log2(errors[0] / errors[1]) == pytest.approx(expected, abs=0.3)


def test_a_step_that_leaves_the_numbers_has_an_error_that_is_none(method):
    for h in (1e160, 1e300):
        with np.errstate(all="ignore"):
            error = make(Exploding(), method, np.array([1.0])).attempt(h)
        assert not math.isfinite(error)


# --- tables -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "scipy"),
    [("bogacki-shampine-32", RK23), ("dormand-prince-54", RK45), ("dormand-prince-853", DOP853)],
)
def test_a_step_is_scipys(name, scipy):
    """The same methods from another hand, in a vector space; dense output where SciPy has the same one."""
    h = 0.2
    run = solve_ivp(
        lambda t, y: [math.sin(2.0 * t) - y[0] * y[1], y[0] - 0.3 * y[1] ** 2],
        (0.0, h),
        START,
        method=scipy,
        first_step=h,
        max_step=h,
        rtol=1.0,
        atol=1e6,
        dense_output=True,
    )
    assert run.t.tolist() == [0.0, h]
    stepper = make(Forced(), METHODS[name], START)
    stepper.attempt(h)
    assert stepper.y == pytest.approx(run.y[:, -1], rel=1e-15, abs=0.0)  # round-off
    thetas = [0.1, 0.4, 0.7]
    dense = dense_of(stepper, thetas)
    # SciPy's 5(4) has Shampine's dense output, another one of order 4; else alike but for cancelling terms.
    tolerance = 1e-5 if scipy is RK45 else 1e-14
    for row, theta in zip(dense, thetas, strict=True):
        assert row == pytest.approx(run.sol(theta * h), abs=tolerance)


def test_rk4_is_the_classical_method():
    h, y = 0.2, START.copy()

    def f(t, y):
        return np.array([math.sin(2.0 * t) - y[0] * y[1], y[0] - 0.3 * y[1] ** 2])

    a = f(0.0, y)
    b = f(h / 2, y + h / 2 * a)
    c = f(h / 2, y + h / 2 * b)
    d = f(h, y + h * c)
    stepper = make(Forced(), METHODS["rk4"], START)
    stepper.attempt(h)
    assert stepper.y == pytest.approx(y + h * (a + 2 * b + 2 * c + d) / 6, rel=1e-15, abs=0.0)  # round-off


def test_tables_are_consistent(method):
    """Each stage's weights sum up to its node; the error's and the dense output's to 0 and theta."""
    assert method.weights.sum(axis=1) == pytest.approx(method.nodes, abs=2e-15)  # sums of numbers up to 50
    assert np.triu(method.weights).max() == 0.0 == np.triu(method.weights).min()  # explicit
    assert method.nodes[0] == 0.0 and method.nodes[method.last] == 1.0
    assert method.errors.sum(axis=1) == pytest.approx(0.0, abs=1e-14)
    sums = method.polynomials.sum(axis=0)
    assert sums == pytest.approx([1.0, *np.zeros(len(sums) - 1)], abs=2e-12)  # numbers up to 700
    assert method.polynomials.sum(axis=1) == pytest.approx(method.weights[method.last], abs=1e-12)


def test_names_and_orders():
    stated = {m.name: (m.order, m.error_order, m.dense_order, m.adaptive) for m in METHODS.values()}
    assert stated == {
        "rk4": (4, None, 3, False),
        "bogacki-shampine-32": (3, 2, 3, True),
        "dormand-prince-54": (5, 4, 4, True),
        "dormand-prince-853": (8, 7, 7, True),
        "radau5": (5, 3, 3, True),
    }
    assert all(method_named(name).name == name for name in METHODS)


def test_unknown_method_is_refused_with_the_nearest_name():
    message = (
        "integrator.method: method 'dormand-prince-45' is unknown; did you mean dormand-prince-54? "
        "known: bogacki-shampine-32, dormand-prince-54, dormand-prince-853, radau5, rk4"
    )
    with pytest.raises(UnknownNameError, match=f"^{re.escape(message)}$"):
        method_named("dormand-prince-45")
    with pytest.raises(LookupError):
        method_named("euler")
