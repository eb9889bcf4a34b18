"""The group operation against Pinocchio's, and the rate of the chart against the exponential's derivative."""

import math
import re

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin.base.records import RIGID, ROTATION, VECTOR
from antenna_pin.integrate import Manifold, kernels
from antenna_pin.integrate.manifold_kernels import move_by_velocity
from antenna_pin.integrate.stepper import KINDS

MODELS = {
    "vector": pin.JointModelPX,
    "circle": pin.JointModelRUBZ,
    "plane": pin.JointModelPlanar,
    "rotation": pin.JointModelSpherical,
    "rigid": pin.JointModelFreeFlyer,
}


def model_of(kinds):
    """A chain of joints of those kinds."""
    model = pin.Model()
    for k, kind in enumerate(kinds):
        model.addJoint(k, MODELS[kind](), pin.SE3.Identity(), f"joint{k}")
    return model


def random_point(model, rng):
    return pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))


@pytest.fixture(params=KINDS)
def kind(request):
    return request.param


def linear_part(kind):
    """How many of a velocity's components are linear and turned by the configuration."""
    return {"plane": 2, "rigid": 3}.get(kind, 0)


def charted(kind, q, v):
    """The chart coordinates of a small motion: its linear part from body axes to those of the parent."""
    u = np.array(v)
    if kind == "plane":
        u[:2] = [q[2] * v[0] - q[3] * v[1], q[3] * v[0] + q[2] * v[1]]
    elif kind == "rigid":
        u[:3] = pin.Quaternion(np.asarray(q[3:7])).matrix() @ v[:3]
    return u


def displacement(kind, q, r):
    """From q to r in body axes, linear part as the crow flies; to first order ``pin.difference``."""
    if kind == "vector":
        return r - q
    if kind in ("circle", "plane"):
        a, b, c, d = *q[-2:], *r[-2:]
        x, y = r[:2] - q[:2]
        turn = math.atan2(a * d - b * c, a * c + b * d)
        return np.array([a * x + b * y, a * y - b * x, turn] if kind == "plane" else [turn])
    rotation = pin.Quaternion(np.array(q[-4:])).matrix()
    turn = pin.log3(rotation.T @ pin.Quaternion(np.array(r[-4:])).matrix())
    return turn if kind == "rotation" else np.array([*(rotation.T @ (r[:3] - q[:3])), *turn])


def right_jacobian(u):
    """Body angular velocity over the rate of the rotation vector, in long doubles: textbook forms cancel."""
    x = np.asarray(u, dtype=np.longdouble)
    t = np.sqrt((x**2).sum())
    if t < 0.05:
        a = np.longdouble(1) / 2 - t**2 / 24 + t**4 / 720 - t**6 / 40320
        b = np.longdouble(1) / 6 - t**2 / 120 + t**4 / 5040 - t**6 / 362880
    else:
        a, b = (1 - np.cos(t)) / t**2, (t - np.sin(t)) / t**3
    cross = np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])
    return (np.eye(3) - a * cross + b * cross @ cross).astype(float)


def test_sizes_are_pinocchios(kind):
    model, manifold = model_of([kind]), Manifold((kind,), 4)
    assert (manifold.nq, manifold.nv, manifold.size) == (model.nq, model.nv, model.nq + model.nv + 4)


def test_compose_is_pinocchios_integrate(kind):
    """Exactly so for turns and lengths; of a rigid motion the chart takes position and turn apart."""
    rng, model, manifold = np.random.default_rng(1), model_of([kind]), Manifold((kind,))
    linear = linear_part(kind)
    for size in (1e-9, 1e-4, 9e-3, 0.011, 0.3, 3.0):
        for _ in range(20):
            q, u = random_point(model, rng), size * rng.normal(size=model.nv)
            turn = u.copy()
            turn[:linear] = 0.0
            expected = pin.integrate(model, q, turn)
            expected[:linear] += u[:linear]  # position, in the axes of the parent
            found = manifold.compose(q, u)
            if kind in ("rotation", "rigid") and found[-4:] @ expected[-4:] < 0.0:
                expected[-4:] *= -1.0  # the same rotation
            assert found == pytest.approx(expected, abs=1e-15 * (1.0 + np.abs(expected).max()))  # round-off


def test_compose_keeps_quaternions_unit(kind):
    rng, model, manifold = np.random.default_rng(4), model_of([kind]), Manifold((kind,))
    q = random_point(model, rng)
    for _ in range(1000):
        q = manifold.compose(q, 0.1 * rng.normal(size=model.nv))
    assert pin.isNormalized(model, q, 1e-15)  # no drift: made unit at each step


def test_chart_rate_is_the_rate_of_the_chart(kind):
    """Following u + rate h keeps the configuration's velocity v, by a central difference."""
    rng, model, manifold = np.random.default_rng(5), model_of([kind]), Manifold((kind,))
    for size in (1e-3, 0.04, 0.3, 1.0):
        for _ in range(20):
            q, u, v = random_point(model, rng), size * rng.normal(size=model.nv), rng.normal(size=model.nv)
            rate, here, h = manifold.chart_rate(q, u, v), manifold.compose(q, u), 1e-3
            ends = [manifold.compose(q, u + k * h * rate) for k in (-2, -1, 1, 2)]
            a, b, c, d = (displacement(kind, here, end) for end in ends)
            # Truncation h^4 / 30 times a fifth derivative below 1000; round-off 1e-15 / h.
            assert (a - 8 * b + 8 * c - d) / (12 * h) == pytest.approx(v, abs=3e-11)


def test_chart_rate_inverts_the_derivative_of_the_exponential():
    rng = np.random.default_rng(6)
    manifold = Manifold(("rotation",))
    for size in (0.0, 1e-8, 1e-3, 0.0577, 0.1, 0.5, 1.5):  # both sides of the switch to a series at 0.1
        for _ in range(20):
            u, w = size * rng.normal(size=3) / math.sqrt(3.0), rng.normal(size=3)
            rate = manifold.chart_rate([0, 0, 0, 1], u, w)
            assert right_jacobian(u) @ rate == pytest.approx(w, abs=3e-15)  # round-off


def test_series_join_the_closed_forms():
    """Across the switches at 0.01 rad (turn) and 0.1 rad (rate) nothing jumps."""
    manifold, direction = Manifold(("rotation",)), np.array([0.36, -0.48, 0.8])
    w = np.array([0.3, 1.1, -0.4])
    for angle in (0.01, 0.1):
        below, above = (angle * (1.0 + s * 1e-12) * direction for s in (-1.0, 1.0))
        one, other = (manifold.compose([0, 0, 0, 1], u) for u in (below, above))
        assert one == pytest.approx(other, abs=2e-12 * angle + 2e-16)
        one, other = (manifold.chart_rate([0, 0, 0, 1], u, w) for u in (below, above))
        assert one == pytest.approx(other, abs=2e-12 * angle + 1e-15)


def test_factors_do_not_mix():
    """A product moves each factor as it would alone."""
    kinds = ("rigid", "vector", "plane", "circle", "rotation", "vector")
    manifold, model = Manifold(kinds, 2), model_of(kinds)
    rng = np.random.default_rng(7)
    q, u, v = random_point(model, rng), rng.normal(size=model.nv), rng.normal(size=model.nv)
    whole, rates = manifold.compose(q, u), manifold.chart_rate(q, u, v)
    i = j = 0
    for kind in kinds:
        part = Manifold((kind,))
        at, by = slice(i, i + part.nq), slice(j, j + part.nv)
        assert (part.compose(q[at], u[by]) == whole[at]).all()
        assert (part.chart_rate(q[at], u[by], v[by]) == rates[by]).all()
        i, j = at.stop, by.stop
    assert (i, j, manifold.size) == (model.nq, model.nv, model.nq + model.nv + 2)


def test_part_names_some_factors():
    manifold = Manifold(("rigid", "vector", "rotation"), 3)
    assert manifold.part([2]).tolist() == [12, 10, 0, 1, ROTATION, 8, 7, 3]
    factors = [RIGID, 0, 0, 6, VECTOR, 7, 6, 1]
    assert manifold.part([0, 1]).tolist() == [12, 10, 0, 2, *factors]
    assert manifold.part([0, 1, 2]).tolist()[3:] == manifold.layout.tolist()[3:]


def test_refuses_an_unknown_kind():
    message = "Manifold: kinds must be of ['circle', 'plane', 'rigid', 'rotation', 'vector'], got 'sphere'"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        Manifold(("rigid", "sphere"))


def test_a_row_is_moved_as_by_compose_to_first_order_and_stays_unit(kind):
    """By what displacements of differences go: parts that turn exactly, parts that shift along them."""
    rng, model, manifold = np.random.default_rng(9), model_of([kind]), Manifold((kind,))
    rows = random_point(model, rng)[np.newaxis].copy()
    for _ in range(100):
        before, step = rows[0].copy(), 1e-6 * rng.normal(size=model.nv)
        move_by_velocity(manifold.layout, rows, 0, step)
        assert rows[0] == pytest.approx(
            manifold.compose(before, charted(kind, before, step)), rel=0, abs=1e-11
        )
    assert pin.isNormalized(model, rows[0], 1e-15)


def test_dense_output_that_is_bent_leads_to_the_moved_end(kind):
    """All of the move at the end, half of it in the middle, nothing at the start."""
    rng, model, manifold = np.random.default_rng(5), model_of([kind]), Manifold((kind,), 2)
    nq, rates = model.nq, model.nv + 2
    work, out = np.zeros((1, manifold.size)), np.zeros((2, manifold.size))
    work[0] = np.concatenate([random_point(model, rng), rng.normal(size=rates)])
    dense = 1e-3 * rng.normal(size=(4, model.nv + rates))

    def at(theta):
        kernels.dense_state(theta, manifold.layout, dense, work, 0, out)
        return out[kernels.STATE_ROW].copy()

    straight = [at(theta) for theta in (0.0, 0.5, 1.0)]
    way = 1e-7 * rng.normal(size=model.nv)
    moved = np.concatenate(
        [Manifold((kind,)).compose(straight[2][:nq], way), straight[2][nq:] + 1e-7 * rng.normal(size=rates)]
    )
    kernels.bend(manifold.layout, straight[2], moved, dense)
    bent = [at(theta) for theta in (0.0, 0.5, 1.0)]
    # Charts at the start and at the end differ by some 1e-3 of the move.
    assert bent[2] == pytest.approx(moved, abs=1e-9)
    assert bent[1] - straight[1] == pytest.approx(0.5 * (moved - straight[2]), abs=1e-9)
    assert np.array_equal(bent[0], straight[0])


@pytest.mark.parametrize(("freedoms", "plain"), [(1, 0), (1, 3), (2, 3), (3, 2), (4, 0), (5, 7)])
def test_sums_over_stages_are_plain_sums_to_the_last_bit(freedoms, plain):
    """Fewer components than a block, whole blocks, and a last block that overlaps."""
    rng, manifold, stages, h = np.random.default_rng(6), Manifold(("vector",) * freedoms, plain), 5, 0.3
    n, nv, start = 2 * freedoms + plain, freedoms, stages + kernels.START
    work = rng.normal(size=(stages + kernels.EXTRA_ROWS, manifold.size))
    weights, polynomials = rng.normal(size=(2, stages, stages))
    weights[4, 1] = polynomials[2, 0] = 0.0
    kernels.stage(4, h, weights, manifold.layout, work, False)
    total = sum(h * weights[4, j] * work[j] for j in range(4))
    assert np.array_equal(work[stages + kernels.TOTAL, :n], total[:n])
    assert np.array_equal(work[stages + kernels.STATE], work[start] + total)
    dense, out = np.zeros((stages, manifold.size)), np.zeros((2, manifold.size))
    kernels.dense_coefficients(h, polynomials, n, work, dense)
    for p in range(stages):
        assert np.array_equal(dense[p, :n], sum(h * polynomials[j, p] * work[j] for j in range(stages))[:n])
    kernels.dense_state(0.7, manifold.layout, dense, work, start, out)
    value = np.zeros(manifold.size)
    for row in dense[::-1]:
        value = value * 0.7 + row
    assert np.array_equal(out[kernels.STATE_ROW], work[start] + value * 0.7)
    assert np.array_equal(out[kernels.CHART_ROW, :nv], (value * 0.7)[:nv])
