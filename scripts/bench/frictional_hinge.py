r"""The limit of a clearance joint with friction as its play goes to zero: an ideal hinge with friction.

Without play the journal stays centred, so the hinge's own constraint wrench says what the contacts carry.
Let :math:`F` and :math:`M` be force and moment on the journal about the joint's centre, split along the axis
:math:`z` and across it. The two ends of the bearing, a length :math:`L` apart, hold the cross force and, as a
couple, the tilting moment. A flange holds the axial force :math:`F_a` where the tilted journal meets the
bearing's edge of radius :math:`R_{io}`, in the direction :math:`t` of the tilt; its moment :math:`m_a` and
its own friction :math:`f_a`, in the plane of that end, change what the ends hold:

.. math:: E_\pm = \tfrac12 F_\perp \pm \tfrac1L (M_\perp - m_a) \times z - f_a

(:math:`f_a` at one end only). At an end the contact point lies where normal force and friction together give
:math:`E`: the normal force is :math:`N = |E| / \sqrt{1 + \mu^2}` (the friction circle), and its direction is
that of :math:`E`, turned by :math:`\arctan \mu` against the spin. The tilt follows from the directions of
both normals. With the rate :math:`\omega` the friction torque is

.. math:: T = -\operatorname{sign}(\omega) \left[ R_i\, \mu(R_i |\omega|) (N_+ + N_-)
          + R_{io}\, \mu(R_{io} |\omega|) |F_a| \right]

The wrench depends on the acceleration and that on T: solved by iteration, which converges fast because the
lever R_i is short. All this holds while the flanges do not share the tilting moment, that is while the axial
play exceeds what the tilt takes of it: :math:`C_a > 2 R_{io} (C_r + \delta) / L`.
"""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
from bench_tools import Array

from antenna_pin import ClearanceJoint, System
from antenna_pin.dynamics import Workspace
from antenna_pin.integrate import METHODS, Stepper
from antenna_pin.joints.geometry import RevoluteClearance
from antenna_pin.mechanism import frame_aligning_z


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
        self._workspace = Workspace(system)
        self.manifold = system.manifold
        self.shape = joint.geometry
        self.friction = joint.friction
        self.slot = system.mechanism.joint(joint.name)
        self._axes = frame_aligning_z(self.slot.axis)
        self._data = system.model.createData()
        self._torque = 0.0

    def torque(self, force: Array, moment: Array, rate: float) -> float:
        """Return the friction torque on the journal [N m].

        Vectors across the axis are complex numbers here, so that the cross product z x e is 1j * e.

        Args:
            force: On the journal, in bearing axes, (3,) [N].
            moment: About the joint's centre, (3,) [N m].
            rate: Of the joint [rad/s].
        """
        shape, spin = self.shape, math.copysign(1.0, rate) if rate else 0.0
        radius, edge = shape.bearing_radius, shape.bearing_outer_radius
        mu = self.friction.coefficient(radius * abs(rate))
        mu_edge = self.friction.coefficient(edge * abs(rate))
        across, axial = complex(force[0], force[1]), float(force[2])
        tilting = complex(moment[0], moment[1])
        side = math.copysign(1.0, axial)  # the end whose flange presses
        turn = (1.0 - 1j * mu * spin) / math.hypot(1.0, mu)
        arm = drag = before = 0j
        for _ in range(50):
            couple = -1j * (tilting + 1j * arm * axial) / shape.bearing_length
            plus, minus = 0.5 * across + couple, 0.5 * across - couple
            if side > 0.0:
                plus -= drag
            else:
                minus -= drag
            if abs(plus) == 0.0 or abs(minus) == 0.0 or axial == 0.0:
                break
            tilt = turn * (minus / abs(minus) - plus / abs(plus))
            if abs(tilt) == 0.0 or abs(tilt - before) < 1e-14:
                break
            before = tilt
            arm = side * edge * tilt / abs(tilt)
            drag = -mu_edge * abs(axial) * spin * 1j * arm / edge
        normal_force = (abs(plus) + abs(minus)) / math.hypot(1.0, mu)
        return -spin * (radius * mu * normal_force + edge * mu_edge * abs(axial))

    def derivative(self, t: float, y: Array, rates: Array) -> None:
        """Write acceleration and rates of x at time t [s] and state y into rates."""
        workspace, model = self._workspace, self.system.model
        workspace.derivative(t, y, rates)
        q, v = y[: model.nq], y[model.nq : model.nq + model.nv]
        j = self.slot.v.start
        tau = workspace.tau.copy()
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
        found = [stepper.start[self.slot.q].copy()]
        for size in np.diff(times):
            stepper.attempt(float(size))
            stepper.accept()
            found.append(stepper.start[self.slot.q].copy())
        q = np.array(found)
        # A continuous joint's coordinates are cosine and sine.
        return np.unwrap(np.arctan2(q[:, 1], q[:, 0])) if self.slot.kind == "continuous" else q[:, 0]
