"""Columns of the Jacobian of an implicit step by single kernels: vary and keep_column, by differences."""

from types import SimpleNamespace

import numpy as np
import pytest
from plain_kernels import plain

from antenna_pin.integrate import METHODS, Manifold, Stepper
from antenna_pin.integrate.kernels import RATES, START, STATE
from antenna_pin.integrate.newton_kernels import keep_column, vary

METHOD = METHODS["radau5"]
STAGES = METHOD.stages


def slopes(y):
    """Return the rates of three coupled components that are defined from zero on."""
    return np.array([y[0] * y[1], np.sqrt(y[1]) * y[1], 1.0 - y[2] ** 1.5])


def test_a_column_is_the_derivative_over_a_component_moved_forwards():
    """One component moves by a little of its size or scale, never below zero from there; others stand."""
    y = np.array([3.0, 0.7, 0.0])
    layout, scales = Manifold((), 3).layout, np.array([1.0, 1.0, 1e-3])
    work, jacobian = np.zeros((STAGES + 8, 3)), np.zeros((3, 3))
    work[STAGES + START], work[0] = y, slopes(y)
    for column in range(3):
        radau = SimpleNamespace(
            columns=np.arange(3),
            progress=[SimpleNamespace(column=column)],
            z=np.zeros((4, 3)),
            jacobian=jacobian,
        )
        plain(vary)(radau, STAGES, layout, work, scales)
        moved = work[STAGES + STATE] - y
        assert 0.0 < moved[column] < 1e-7 * max(y[column], scales[column])
        assert not np.delete(moved, column).any()
        work[STAGES + RATES] = slopes(work[STAGES + STATE])
        plain(keep_column)(radau, STAGES, layout, work, scales)
    exact = [[0.7, 3.0, 0.0], [0.0, 1.5 * np.sqrt(0.7), 0.0], [0.0, 0.0, 0.0]]
    # By the step's size, and round-off over it; the last is the root of the step of its scale.
    assert jacobian == pytest.approx(np.array(exact), abs=1e-5)


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
