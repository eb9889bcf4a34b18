"""A body that tumbles, as a problem on the group and as plain quaternion equations."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from antenna_pin.integrate import METHODS, Manifold, Stepper

INERTIA = np.array([1.0, 2.1, 2.9])  # [kg m^2], asymmetric
MASS = 3.0


def quaternion_product(a, b):
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return np.array(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by + ay * bw + az * bx - ax * bz,
            aw * bz + az * bw + ax * by - ay * bx,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    )


def turned(quaternion, vector):
    """The vector of body axes in world axes."""
    r, w = quaternion[:3], quaternion[3]
    return vector + 2.0 * np.cross(r, np.cross(r, vector) + w * vector)


class TumblingBody:
    """Twist in body axes; ``torque`` times sin(3 t) about a body axis, whose work is x."""

    manifold = Manifold(("rigid",), 1)

    def __init__(self, torque=0.0):
        self.torque = torque * np.array([0.3, -1.0, 0.6])

    def derivative(self, t, y, rates):
        velocity, spin = y[7:10], y[10:13]
        torque = self.torque * math.sin(3.0 * t)
        rates[:3] = -np.cross(spin, velocity)
        rates[3:6] = (torque - np.cross(spin, INERTIA * spin)) / INERTIA
        rates[6] = torque @ spin

    def initial(self):
        attitude = np.array([0.1, -0.2, 0.3, 0.9])
        return np.array(
            [0.5, -0.4, 0.3, *(attitude / np.linalg.norm(attitude)), 0.3, -0.5, 0.2, 0.9, 1.3, -0.7, 0.0]
        )

    def reference(self, times):
        """Solutions at some times: quaternion equations by SciPy's DOP853, whose own error is about 1e-12."""

        def rates(t, y):
            out = np.empty(14)
            own = np.empty(7)
            self.derivative(t, y, own)
            out[:3] = turned(y[3:7], y[7:10])
            out[3:7] = 0.5 * quaternion_product(y[3:7], [*y[10:13], 0.0])
            out[7:] = own
            return out

        run = solve_ivp(
            rates,
            (0.0, max(times)),
            self.initial(),
            method="DOP853",
            rtol=5e-14,
            atol=1e-15,
            t_eval=times,
            max_step=0.05,
        )
        y = run.y.T
        y[:, 3:7] /= np.linalg.norm(y[:, 3:7], axis=1, keepdims=True)
        return y


def difference(y, z):
    """Largest difference of two states of the body, quaternions alike but for their sign."""
    y = y.copy()
    if y[3:7] @ z[3:7] < 0.0:
        y[3:7] *= -1.0
    return np.abs(y - z).max()


def march(problem, method, end, steps):
    """States after ``steps`` equal steps."""
    stepper = Stepper(problem, METHODS[method], np.ones(2 * problem.manifold.nv + problem.manifold.nx), 1.0)
    stepper.restart(0.0, problem.initial())
    for _ in range(steps):
        stepper.attempt(end / steps)
        stepper.accept()
    return stepper


@pytest.fixture(params=[name for name, one in METHODS.items() if not one.implicit])
def method(request):
    return METHODS[request.param]


@pytest.fixture(scope="session")
def body():
    return TumblingBody


@pytest.fixture(scope="session")
def marcher():
    return march


@pytest.fixture(scope="session")
def state_difference():
    return difference
