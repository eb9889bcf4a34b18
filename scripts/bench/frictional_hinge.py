r"""The limit of a clearance joint with friction as its play goes to zero: an ideal hinge with friction.

Without play the journal stays centred, so the hinge's own constraint wrench says what the contacts carry.
Let :math:`F` and :math:`M` be force and moment on the journal about the joint's centre, split along the axis
:math:`z` and across it. The two ends of the bearing, a length :math:`L` apart, hold the cross force and, as a
couple, the tilting moment. A flange holds the axial force :math:`F_a` where the tilted journal meets the
bearing's edge of radius :math:`R_{io}`, in the direction :math:`t` of the tilt; that moment :math:`m_a` and the
flange's own friction :math:`f_a`, in the plane of that end, change what the ends hold:

.. math:: E_\pm = \tfrac12 F_\perp \pm \tfrac1L (M_\perp - m_a) \times z - f_a

(:math:`f_a` at one end only). At an end the contact point lies where normal force and friction together give
:math:`E`: the normal force is :math:`N = |E| / \sqrt{1 + \mu^2}` (the friction circle), and its direction is
that of :math:`E`, turned by :math:`\arctan \mu` against the spin. The tilt follows from the directions of both
normals. With the rate :math:`\omega` the friction torque is

.. math:: T = -\operatorname{sign}(\omega) \left[ R_i\, \mu(R_i |\omega|) (N_+ + N_-)
          + R_{io}\, \mu(R_{io} |\omega|) |F_a| \right]

The wrench depends on the acceleration and that on T: solved by iteration, which converges fast because the
lever R_i is short. All this holds while the flanges do not share the tilting moment, that is while the axial
play exceeds what the tilt takes of it: :math:`C_a > 2 R_{io} (C_r + \delta) / L`.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from bench_tools import Array

from antenna_pin import ClearanceJoint, System
from antenna_pin.geometry import RevoluteClearance
from antenna_pin.integrate import METHODS, Stepper
from antenna_pin.mechanism import frame_aligning_z

_Z = np.array([0.0, 0.0, 1.0])


class FrictionalHinge:
    """A system whose ideal joint has the friction of a clearance joint without play.

    It is a problem for :class:`antenna_pin.integrate.Stepper`, like the system itself.

    Args:
        system: The mechanism with the joint ideal (revolute), and its drives.
        joint: The clearance joint: dimensions and friction law are taken from it.
    """

    def __init__(self, system: System, joint: ClearanceJoint) -> None:
        """Find the joint in the system."""
        assert isinstance(joint.geometry, RevoluteClearance)
        self.system = system
        self.manifold = system.manifold
        self.shape = joint.geometry
        self.friction = joint.friction
        self.slot = system.mechanism.joint(joint.name)
        self._axes = frame_aligning_z(self.slot.axis)
        self._data = system.model.createData()
        self._torque = 0.0

    def torque(self, force: Array, moment: Array, rate: float) -> float:
        """Return the friction torque on the journal [N m].

        Args:
            force: On the journal, in bearing axes, (3,) [N].
            moment: About the joint's centre, (3,) [N m].
            rate: Of the joint [rad/s].
        """
        shape, spin = self.shape, np.sign(rate)
        radius, edge = shape.bearing_radius, shape.bearing_outer_radius
        mu = self.friction.coefficient(radius * abs(rate))
        mu_edge = self.friction.coefficient(edge * abs(rate))
        axial = force[2]
        flange = 0 if axial > 0.0 else 1  # which end's flange presses
        side = 1.0 - 2.0 * flange
        across = force - axial * _Z
        tilting = moment - moment[2] * _Z
        ends = self._ends(across, tilting)
        for _ in range(20 if axial != 0.0 else 0):
            normals = [self._normal(end, mu, spin) for end in ends]
            tilt = normals[1] - normals[0]
            tilt /= np.linalg.norm(tilt)
            arm = side * edge * tilt
            ends = self._ends(across, tilting - np.cross(arm, axial * _Z))
            ends[flange] += mu_edge * abs(axial) * spin * np.cross(_Z, side * tilt)
        normal_force = sum(float(np.linalg.norm(end)) for end in ends) / np.hypot(1.0, mu)
        return float(-spin * (radius * mu * normal_force + edge * mu_edge * abs(axial)))

    def _ends(self, across: Array, tilting: Array) -> Array:
        """Return what the bearing's two ends carry, (2, 3) [N]."""
        couple = np.cross(tilting, _Z) / self.shape.bearing_length
        return np.array([0.5 * across + couple, 0.5 * across - couple])

    def _normal(self, end: Array, mu: float, spin: float) -> Array:
        size = np.linalg.norm(end)
        direction = end / size if size > 0.0 else np.zeros(3)
        turned: Array = (direction - mu * spin * np.cross(_Z, direction)) / np.hypot(1.0, mu)
        return turned

    def derivative(self, t: float, y: Array, rates: Array) -> None:
        """Write acceleration and rates of x at time t [s] and state y into rates."""
        system, model = self.system, self.system.model
        system.derivative(t, y, rates)
        q, v = y[: model.nq], y[model.nq : model.nq + model.nv]
        j = self.slot.v.start
        tau = system.tau.copy()
        given = tau[j]
        for _ in range(50):
            tau[j] = given + self._torque
            acceleration = pin.aba(model, self._data, q, v, tau)
            pin.rnea(model, self._data, q, v, acceleration)
            wrench = self._data.f[self.slot.joint_id]
            before = self._torque
            self._torque = self.torque(self._axes.T @ wrench.linear, self._axes.T @ wrench.angular, v[j])
            if abs(self._torque - before) < 1e-14:
                break
        rates[: model.nv] = acceleration

    def angles(self, times: Array) -> Array:
        """Return the joint's angle from rest at zero, at equally spaced times from 0 [rad]."""
        components = 2 * self.manifold.nv + self.manifold.nx
        stepper = Stepper(self, METHODS["dormand-prince-853"], np.ones(components), 1e-10)
        stepper.restart(0.0, self.system.state(self.system.neutral(), np.zeros(self.system.model.nv)))
        found = [0.0]
        for size in np.diff(times):
            stepper.attempt(float(size))
            stepper.accept()
            found.append(float(stepper.start[self.slot.q][0]))
        return np.array(found)
