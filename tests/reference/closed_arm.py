"""An arm of eight links in space, its last held to its first by a closure of any kind."""

from __future__ import annotations

import numpy as np
from maximal import Maximal
from maximal_parts import WORLD, Body, Joint, Side
from scipy.spatial.transform import Rotation
from single_loops import GRAVITY, Loop

AXES = ((0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 1, 1), (1, 0, 1), (0, 0, 1), (1, -1, 0), (0, 1, 0))
"""Of the joints, in the axes of their links; the fourth slides."""

WAYS = (
    (0, 0, 0), (0.2, 0, 0.1), (0.2, 0.1, 0), (0, 0.2, 0.1),
    (-0.1, 0, 0.2), (-0.2, 0.1, 0), (0, -0.2, 0.1), (-0.1, -0.1, -0.2),
)  # fmt: skip
"""From each joint to the next, in world axes at the start [m]."""

POINT = (0.05, -0.03, 0.08)
"""Where the closure sits in the last link [m]."""

# Where a kind has an axis, it is that of either side; beside a universal one's the two are square.
FIRST_AXIS, ACROSS = np.array([2.0, -1.0, 2.0]) / 3.0, np.array([1.0, 2.0, 0.0])


def closed_arm(kind: str) -> Loop:
    """Return the arm closed by one kind of joint between its first and its last link, let go from rest."""
    bodies, joints, tree, before = {}, {}, {}, WORLD
    place, pose = np.zeros(3), np.eye(3)
    for k, (axis, way) in enumerate(zip(AXES, WAYS, strict=True)):
        turned = Rotation.from_rotvec(0.4 * k * np.array([1.0, -0.5, 0.7])).as_matrix() if k else np.eye(3)
        new, name, joint = place + way, f"link{k + 1}", f"joint{k + 1}"
        bodies[name] = Body(
            mass=1.0 - 0.08 * k,
            inertia=((0.010, 0.001, 0.0), (0.001, 0.012, -0.001), (0.0, -0.001, 0.009)),
            centre=(0.05, 0.02 * k, -0.04),
            position=new,
            attitude=turned,
        )
        unit = np.array(axis, float) / np.linalg.norm(axis)
        across = np.cross(unit, (0.3, 0.5, 0.8))
        slides = k == 3
        at = Side(name, (0.0, 0.0, 0.0), unit, across)
        on = Side(before, pose.T @ (new - place), pose.T @ turned @ unit, pose.T @ turned @ across)
        joints[joint] = Joint("prismatic" if slides else "revolute", on, at)
        tree[joint] = ("prismatic" if slides else "continuous", before, name, unit)
        place, pose, before = new, turned, name
    first = bodies["link1"]
    point = np.array(first.attitude).T @ (place + pose @ POINT - np.array(first.position))
    seen = pose.T @ np.array(first.attitude)  # from the first link's axes to the last's
    second_axis = seen @ (np.cross(FIRST_AXIS, ACROSS) if kind == "universal" else FIRST_AXIS)
    sides = Side("link1", point, FIRST_AXIS, ACROSS), Side("link8", POINT, second_axis, seen @ ACROSS)
    if kind == "universal":
        sides = Side("link1", point, FIRST_AXIS), Side("link8", POINT, second_axis)
    joints["closure"] = Joint(kind, *sides)
    system = Maximal(bodies, joints, gravity=(0.0, 0.0, -GRAVITY))

    def table(side: Side) -> str:
        values = {"point": side.point, "axis": side.axis}
        if side.across is not None:
            values["across"] = side.across
        words = ", ".join(f"{key} = {[float(x) for x in value]!r}" for key, value in values.items())
        return f'{{ link = "{side.body}", {words} }}'

    scenario = f"""\
format = 1
title = "An arm closed by a joint: {kind}"
duration = "0.4 s"

[mechanism]
urdf = "loop.urdf"
base = "fixed"
gravity = [0.0, 0.0, {-GRAVITY}]

[closures.closure]
kind = "{kind}"
first = {table(sides[0])}
second = {table(sides[1])}

[integrator]
rtol = 1e-12

[output]
rate = "20 Hz"
"""
    return Loop(name=f"arm_{kind}", system=system, start=system.start, tree=tree, scenario=scenario)
