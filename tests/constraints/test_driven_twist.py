"""The row of a motion at a joint that is free to swing too: its change along a displacement."""

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin.base.records import PLANE, RIGID
from antenna_pin.compiled.decorators import record
from antenna_pin.dynamics.constraints.driven_kernels import change_motions
from antenna_pin.dynamics.constraints.layout_kernels import DRIVEN, DRIVEN_WORDS, PLAN, PLAN_WORDS

LENGTH = 0.7
V = 6  # of a free joint


def of_twist(u, w):
    """Return the gradient of the twist about z and the twist's acceleration at constant w.

    With u the joint's axis before the turn, in axes of the turned body, the gradient is (z + u) / (1 + u_z),
    and u' = u x w. Algebraic in both arguments, so that a complex step differentiates it.
    """
    z, moves = np.array([0.0, 0.0, 1.0]), np.cross(u, w)
    bias = (moves / (1.0 + u[2]) - (z + u) * moves[2] / (1.0 + u[2]) ** 2) @ w
    return (z + u) / (1.0 + u[2]), bias


def plan_with(moves, axes):
    """Return a plan of one motion, of a single joint whose q and v are the first."""
    words = np.zeros(PLAN_WORDS + DRIVEN_WORDS)
    head, driven = record(words[:PLAN_WORDS], PLAN), record(words[PLAN_WORDS:], DRIVEN)
    head.motions, head.rows, head.width, head.nq, head.nv, head.length = 1, 1, 1, 7, V, LENGTH
    driven.moves, driven.axes[:] = moves, axes
    return words


def change(y, way, acceleration, force, plan):
    """Return the changes of the row's acceleration and of its rate, and of J^T lambda."""
    lack, speeds, out = np.zeros(1), np.zeros(1), np.zeros(V)
    change_motions(y, way, acceleration, np.array([force]), plan, (lack, speeds, np.zeros(4)), out)
    return -lack[0], speeds[0], out


@pytest.mark.parametrize("seed", range(5))
def test_a_driven_twist_changes_along_a_displacement_as_its_closed_form(seed):
    """A swing and a twist of any size, at speed, displaced in attitude and in angular velocity."""
    rng = np.random.default_rng(seed)
    axes, turn = (pin.exp3(rng.normal(size=3)) for _ in range(2))
    y = np.concatenate([rng.normal(size=3), pin.Quaternion(turn).coeffs(), rng.normal(size=V)])
    way, acceleration, force = rng.normal(size=2 * V), rng.normal(size=V), 3.0
    u, w, step = axes.T @ turn.T @ axes[:, 2], axes.T @ y[10:13], 1e-30
    u_off = u + 1j * step * np.cross(u, axes.T @ way[3:6])
    w_off = w + 1j * step * axes.T @ way[9:12]
    gradient, bias = of_twist(u_off, w_off)
    total = gradient @ (axes.T @ acceleration[3:]) + bias
    found = change(y, way, acceleration, force, plan_with(RIGID, axes))
    scale = np.abs([total.imag, bias.imag]).max() / step
    assert found[0] == pytest.approx(LENGTH * total.imag / step, abs=1e-9 * scale)
    assert found[1] == pytest.approx((gradient @ w_off).imag / step, abs=1e-12 * scale)
    assert found[2][:3] == pytest.approx(np.zeros(3), abs=0.0)
    assert found[2][3:] == pytest.approx(LENGTH * force * axes @ gradient.imag / step, abs=1e-9 * scale)


def test_a_driven_turn_in_a_plane_has_a_constant_row():
    """It turns about one axis only: its rate changes, its gradient and acceleration do not."""
    y, way = np.arange(13.0), np.arange(12.0) + 1.0
    found = change(y, way, np.ones(V), 3.0, plan_with(PLANE, np.eye(3)))
    assert found[:2] == (0.0, way[V + 2])
    assert not found[2].any()
