"""Kernels of motion angles and of elements' derivatives one by one: differences, and a second formula."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from plain_kernels import inner, plain

from antenna_pin.base.records import PROGRAM, words_of
from antenna_pin.dynamics import tangent_kernels
from antenna_pin.dynamics.sample_kernels import clearance_motion, tilt_rate
from antenna_pin.integrate import Manifold
from antenna_pin.joints.layout_kernels import JOINT
from antenna_pin.joints.pose_kernels import wrapped_angle
from antenna_pin.mechanism import frame_aligning_z
from antenna_pin.mechanism.spatial_kernels import twist_slopes

AXES = frame_aligning_z(np.array([0.6, -0.48, 0.64]))


def turned():
    """Return a joint's head and quaternions in its frames, turned by anything short of over."""
    joint = np.zeros(1, JOINT)
    joint["axes"] = AXES
    rng = np.random.default_rng(3)
    return joint[0], [pin.exp3(turn) for turn in rng.normal(size=(8, 3))], rng.normal(size=(8, 3))


def state_of(rotation):
    return np.array([0.0, 0.0, 0.0, *pin.Quaternion(rotation).coeffs()])


def test_tilt_rate_is_the_derivative_of_the_gradient_of_the_motion_angle():
    """gx and gy along a turn at a spin in the journal's axes; and :func:`twist_slopes`, written otherwise."""
    joint, rotations, spins = turned()
    h, gradient = 1e-4, plain(wrapped_angle)
    for rotation, spin in zip(rotations, spins, strict=True):
        found = plain(tilt_rate)(joint, state_of(rotation), *spin)
        moved = {
            k: np.array(gradient(joint, state_of(rotation @ pin.exp3(k * h * AXES @ spin)))[1:])
            for k in (-2, -1, 1, 2)
        }
        slope = (8.0 * (moved[1] - moved[-1]) - moved[2] + moved[-2]) / (12.0 * h)
        # Of fourth order: h^4 over the tilt's own scale, and round-off over h.
        assert found == pytest.approx(slope, rel=1e-9, abs=1e-10)
        quaternion = pin.Quaternion(rotation).coeffs()
        other = plain(twist_slopes)(tuple(AXES.T @ quaternion[:3]), quaternion[3], tuple(spin))
        assert found == pytest.approx(other, rel=1e-12)


def test_the_acceleration_of_a_motion_angle_is_the_derivative_of_its_rate():
    """Of a body that turns at a spin that changes evenly: clearance_motion, by differences of the rate."""
    head = words_of(PROGRAM)
    joint, rotations, spins = turned()
    program = np.zeros(head + words_of(JOINT))
    program[:head].view(PROGRAM)["nq"], program[:head].view(PROGRAM)["nv"] = 7, 6
    program[head:].view(JOINT)[0] = joint
    h, change = 1e-4, np.array([0.3, -0.7, 0.4])
    for rotation, spin in zip(rotations, spins, strict=True):
        states, accelerations, out = np.zeros((5, 14)), np.zeros((5, 6)), np.zeros((5, 3))
        for row, k in enumerate((-2, -1, 0, 1, 2)):
            # To third order in time: rates commute but for the bracket of spin and change.
            t = k * h
            step = pin.exp3(t * spin + 0.5 * t**2 * change + t**3 / 12.0 * np.cross(spin, change))
            states[row, :7] = state_of(rotation @ step)
            states[row, 10:13], accelerations[row, 3:] = spin + t * change, change
        plain(clearance_motion)(program, head, states, accelerations, out)
        slope = 8.0 * (out[3, :2] - out[1, :2]) - out[4, :2] + out[0, :2]
        assert out[2, 1:] == pytest.approx(slope / (12.0 * h), rel=1e-7, abs=1e-9)


def test_elements_are_displaced_forwards_in_all_that_they_know():
    """Rates and own states, by the step with its sign: what add_element_changes differentiates by."""
    manifold = Manifold(("rigid", "rigid"), 3)
    y = np.random.default_rng(2).normal(size=manifold.size)
    part = SimpleNamespace(v=(6, 0))
    move = inner(tangent_kernels, "_move")
    for kind, n, place in ((tangent_kernels._RATE, 2, 14 + 6 + 2), (tangent_kernels._STATE, 0, 14 + 12 + 1)):
        room = SimpleNamespace(layout=manifold.layout, state=y[None].copy(), bristles=np.array([1]))
        for h in (1e-3, -2e-3, 0.0):
            move(part, kind, 0, n, y, h, room)
            moved = np.zeros_like(y)
            moved[place] = h
            assert room.state[0] - y == pytest.approx(moved, abs=1e-15)
