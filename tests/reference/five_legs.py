"""The parallel mechanism 4UPS-UPU as data: ideal joints, all legs driven, the platform on a circle.

Origin in the centre of the base plane, x down, gravity along x. Leg k runs from a universal joint in the base
at B_k to the platform's joint at S_k: a universal one for leg 1, balls for the others. Telescopic rods do not
turn in their swing rods. The platform is not turned, so each leg's length is |offset + path|, in closed form.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
from maximal import Maximal
from maximal_parts import WORLD, Body, Joint, Motion, Side
from single_loops import joint_text, link_text

GRAVITY = 9.81

BASE_RADII = np.array([0.71, 0.65, 0.65, 0.65, 0.65])
BASE_ANGLES = np.radians([180.0, 225.0, 135.0, 45.0, 315.0])
PLATFORM_RADIUS = 0.202
PLATFORM_ANGLES = np.radians([180.0, 252.0, 108.0, 36.0, 324.0])

_c = np.sqrt(0.5)
FIRST_AXES = np.array([[0, 0, 1], [0, -_c, _c], [0, -_c, -_c], [0, _c, -_c], [0, _c, _c]])
"""Of the base's universal joints, fixed in the base."""

SWING = Body(mass=25.96, inertia=(0.018, 1.250, 1.250), centre=(0.38, 0.0, 0.0))
TELESCOPIC = Body(mass=8.45, inertia=(0.0016, 0.545, 0.545), centre=(-0.45, 0.0, 0.0))
PLATFORM = Body(mass=37.48, inertia=(0.907, 0.457, 0.457))
"""Frames: swing rod at B_k, telescopic rod at S_k, x along the rod; platform at its mass centre."""

MEAN, AMPLITUDE, RATE = np.array([1.1, 0.0, 0.0]), np.array([0.0, 0.05, 0.05]), pi
PHASE = np.array([0.0, 0.0, pi / 2])
"""The path [m]: MEAN + AMPLITUDE sin(RATE t + PHASE)."""


def _around(radii: np.ndarray | float, angles: np.ndarray) -> np.ndarray:
    return np.stack([0.0 * angles, radii * np.cos(angles), radii * np.sin(angles)], axis=1)


BASE_POINTS, PLATFORM_POINTS = _around(BASE_RADII, BASE_ANGLES), _around(PLATFORM_RADIUS, PLATFORM_ANGLES)
OFFSETS = PLATFORM_POINTS - BASE_POINTS
"""(5, 3): base joint to platform joint, with the platform in the origin [m]."""


def path(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return position, velocity and acceleration of the platform [m, m/s, m/s^2]."""
    s, c = np.sin(RATE * t + PHASE), np.cos(RATE * t + PHASE)
    return MEAN + AMPLITUDE * s, RATE * AMPLITUDE * c, -(RATE**2) * AMPLITUDE * s


def leg(k: int, t: float) -> tuple[float, float, float]:
    """Return length of leg k (from 0), its rate and its acceleration [m, m/s, m/s^2]."""
    p, v, a = path(t)
    d = OFFSETS[k] + p
    length = np.sqrt(d @ d)
    rate = d @ v / length
    return float(length), float(rate), float((v @ v + d @ a - rate**2) / length)


def rod(k: int, d: np.ndarray) -> np.ndarray:
    """Return the attitude (3, 3) of leg k along d: z is d turned with the first axis, y the second axis."""
    x = d / np.sqrt((d * d).sum())
    y = np.cross(FIRST_AXES[k], x)
    y = y / np.sqrt((y * y).sum())
    return np.stack([x, y, np.cross(x, y)], axis=1)


def platform() -> Maximal:
    """Return the mechanism on its path at time zero, all velocities zero, the legs' lengths prescribed."""
    at = path(0.0)[0]
    o, x, y, z = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    bodies, joints, motions = {"platform": _placed(PLATFORM, at, np.eye(3))}, {}, []
    for k in range(5):
        name, attitude = str(k + 1), rod(k, OFFSETS[k] + at)
        bodies[f"swing{name}"] = _placed(SWING, BASE_POINTS[k], attitude)
        bodies[f"telescopic{name}"] = _placed(TELESCOPIC, at + PLATFORM_POINTS[k], attitude)
        joints[f"u{name}"] = Joint(
            "universal", Side(WORLD, BASE_POINTS[k], FIRST_AXES[k]), Side(f"swing{name}", o, y)
        )
        joints[f"p{name}"] = Joint(
            "prismatic", Side(f"swing{name}", o, x, y), Side(f"telescopic{name}", o, x, y)
        )
        tip, joint = Side(f"telescopic{name}", o, y if k == 0 else z), Side("platform", PLATFORM_POINTS[k], z)
        joints[f"s{name}"] = Joint("universal" if k == 0 else "spherical", tip, joint)
        motions.append(
            Motion(
                f"p{name}",
                lambda t, k=k: leg(k, t)[0],
                lambda t, k=k: leg(k, t)[1],
                lambda t, k=k: leg(k, t)[2],
            )
        )
    return Maximal(bodies, joints, motions, gravity=(GRAVITY, 0.0, 0.0))


def _placed(body: Body, position: np.ndarray, attitude: np.ndarray) -> Body:
    return replace(body, position=position, attitude=attitude)


# --- the same for the package ---


def urdf() -> str:
    """Return the URDF: a tree of five legs, the platform on leg 1; balls s2 to s5 are left open.

    Joints of leg k: ``firstk`` and ``secondk`` of the base's universal joint, both zero straight down, and
    ``legk``, the distance from base joint to platform joint; ``third`` and ``fourth`` of the platform, on
    leg 1. Its link's frame is there: the mass centre is at -S_1. Crosses are without mass.
    """
    down, e_x, e_y, e_z = np.array([1.0, 0.0, 0.0]), (1, 0, 0), (0, 1, 0), (0, 0, 1)
    o, one = (0.0, 0.0, 0.0), np.eye(3)
    parts = ['<robot name="five_legs">', '  <link name="ground"/>']
    for k in range(5):
        n, f = k + 1, FIRST_AXES[k]
        frame = np.column_stack([down, np.cross(f, down), f])
        parts += [
            f'  <link name="cross{n}"/>',
            link_text(f"swing{n}", SWING),
            link_text(f"telescopic{n}", TELESCOPIC),
            joint_text(f"first{n}", "revolute", "ground", f"cross{n}", BASE_POINTS[k], frame, e_z),
            joint_text(f"second{n}", "revolute", f"cross{n}", f"swing{n}", o, one, e_y),
            joint_text(f"leg{n}", "prismatic", f"swing{n}", f"telescopic{n}", o, one, e_x),
        ]
    # At zero the frame of leg 1 is turned against the world's by nothing: x down, z along the first axis.
    parts += [
        '  <link name="cross6"/>',
        link_text("platform", replace(PLATFORM, centre=tuple(-PLATFORM_POINTS[0]))),
        joint_text("third", "revolute", "telescopic1", "cross6", o, one, e_y),
        joint_text("fourth", "revolute", "cross6", "platform", o, one, e_z),
    ]
    return "\n".join([*parts, "</robot>\n"])


def scenario() -> str:
    """Return the scenario of ``loop.urdf``: four closures, five motions, nothing given of the start."""
    parts = [
        f"""\
format = 1
title = "4UPS-UPU, all legs driven, the platform on a circle"
duration = "1 s"

[mechanism]
urdf = "loop.urdf"
base = "fixed"
gravity = [{GRAVITY}, 0.0, 0.0]
"""
    ]
    for k in range(1, 5):
        parts.append(
            f"""\
[closures.s{k + 1}]
kind = "spherical"
first = {{ link = "telescopic{k + 1}", point = [0.0, 0.0, 0.0] }}
second = {{ link = "platform", point = {_listed(PLATFORM_POINTS[k] - PLATFORM_POINTS[0])} }}
"""
        )
    for k in range(5):
        parts.append(
            f"""\
[drives.leg{k + 1}]
kind = "distance"
joint = "leg{k + 1}"
offset = {_listed(OFFSETS[k])}
mean = {_listed(MEAN)}
amplitude = {_listed(AMPLITUDE)}
frequency = {RATE / (2 * pi)!r}
phase = {_listed(PHASE)}
"""
        )
    return "\n".join([*parts, '[integrator]\nrtol = 1e-12\n\n[output]\nrate = "20 Hz"\n'])


def _listed(values: np.ndarray) -> str:
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"
