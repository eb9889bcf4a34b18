"""What counts as one unit of each component of a system's state."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.settings import ErrorScales
from antenna_pin.dynamics import System

__all__ = ["BEARING_LEVER", "BEARING_PLAY", "scale_vector"]

#: What counts as the play of a joint on bearings, which has none and deflects by micrometres, and as half its
#: length [m].
BEARING_PLAY, BEARING_LEVER = 1e-4, 0.01


def scale_vector(system: System, scales: ErrorScales) -> NDArray[np.float64]:
    """Return the error scale of each component of [u, v, x], (2 nv + nx,); of x energies and bristles.

    That of works and losses is what the moving bodies have at a velocity of one unit of tolerance.
    """
    model = system.model
    position = np.full(model.nv, scales.angle)
    velocity = np.full(model.nv, scales.angular_velocity)
    for slot in system.mechanism.joints.values():
        position[slot.ways] = scales.position
        velocity[slot.ways] = scales.velocity
    if system.mechanism.base == "free":
        masses = [inertia.mass for inertia in model.inertias]
        factor = scales.base if scales.base is not None else max(sum(masses[2:]) / sum(masses), 1e-6)
        position[:3] = factor * scales.position
        position[3:6] = factor * scales.angle
        velocity[:3] = factor * scales.velocity
        velocity[3:6] = factor * scales.angular_velocity
    for joint in system.clearances:
        slot = system.mechanism.joint(joint.name)
        play = scales.clearance * joint.geometry.radial_clearance
        start = slot.v.start
        linear = 2 if joint.planar else 3
        position[start : start + linear] = play
        velocity[start : start + linear] = scales.clearance_velocity
        half = joint.geometry.half_length
        if joint.geometry.motion == "slide":
            along = np.abs(slot.axis) > 1.0 - 1e-9
            position[start : start + 3] = np.where(along, scales.position, play)
            velocity[start : start + 3] = np.where(along, scales.velocity, scales.clearance_velocity)
        if half is not None and joint.geometry.motion == "slide":
            position[start + 3 : start + 6] = play / half
            velocity[start + 3 : start + 6] = scales.clearance_velocity / half
        elif half is not None:
            # About the axis the motion angle, across it the tilt; in between, for an axis askew, the
            # finer.
            about = np.abs(slot.axis) > 1.0 - 1e-9
            position[start + 3 : start + 6] = np.where(about, scales.angle, play / half)
            velocity[start + 3 : start + 6] = np.where(
                about, scales.angular_velocity, scales.clearance_velocity / half
            )
    for name in system.on_bearings:
        # As play is counted in plays, in what stands for one.
        slot = system.mechanism.joint(name)
        start = slot.v.start
        position[start : start + 3] = scales.clearance * BEARING_PLAY
        velocity[start : start + 3] = scales.clearance_velocity
        about = np.abs(slot.axis) > 1.0 - 1e-9
        tilt = scales.clearance * BEARING_PLAY / BEARING_LEVER, scales.clearance_velocity / BEARING_LEVER
        position[start + 3 : start + 6] = np.where(about, scales.angle, tilt[0])
        velocity[start + 3 : start + 6] = np.where(about, scales.angular_velocity, tilt[1])
    x = np.full(system.manifold.nx, math.inf)
    forces = system.force_x["work"], system.force_x["loss"]
    booked = (system.lost_normal_x, system.lost_friction_x, system.work_x, system.damper_x, system.element_x)
    energies = np.concatenate([places[places >= 0] for places in (*booked, *forces)])
    others = 2 if system.mechanism.base == "free" and model.njoints > 2 else 1
    moving = list(model.inertias)[others:]
    slow = scales.clearance_velocity if system.clearances or system.on_bearings else scales.velocity
    x[energies] = sum(i.mass for i in moving) * slow**2
    if not any(i.mass for i in moving):  # rotors that have an inertia alone
        x[energies] = sum(float(np.trace(i.inertia)) for i in moving) * scales.angular_velocity**2
    bristles = [
        scale
        for joint in system.clearances
        for _ in joint.contact_names
        for scale in getattr(joint.friction, "state_scales", ())
    ]
    # Those of elements are numbers of size 1.
    x[system.bristle_x] = bristles + [1.0] * (len(system.bristle_x) - len(bristles))
    return np.concatenate([position, velocity, x])
