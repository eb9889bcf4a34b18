"""Three closed loops of one freedom as data: a four-bar, a Bricard ring and a spatial slider-crank.

Each is there twice: in maximal coordinates, and as a URDF with a scenario, cut open at one joint. In both the
bodies start in the same pose, which is the URDF's at zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, radians, sin, sqrt

import numpy as np
from maximal import Maximal
from maximal_parts import WORLD, Body, Joint, Motion, Side
from scipy.spatial.transform import Rotation

GRAVITY = 9.81


@dataclass(frozen=True, kw_only=True)
class Loop:
    """A mechanism and how the package is to be told of it.

    Attributes:
        system: In maximal coordinates.
        start: State to start from, (n, 13).
        tree: Joints of the URDF: name to type, parent, child, axis; each at the child's origin, in its axes.
        scenario: TOML text; the URDF is ``loop.urdf``.
    """

    name: str
    system: Maximal
    start: np.ndarray
    tree: Mapping[str, tuple[str, str, str, Sequence[float]]]
    scenario: str

    @property
    def urdf(self) -> str:
        """The URDF's text."""
        return urdf_text(self.name, self.system, self.tree)


def at_rate(system: Maximal, joint: str, rate: float) -> np.ndarray:
    """Return the start with the velocities that a rate of one joint asks for [rad/s, m/s]."""
    driven = system.with_motions([Motion(joint, lambda t: rate * t, lambda t: rate, lambda t: 0.0)])
    return driven.projected(0.0, system.start)


def urdf_text(name: str, system: Maximal, tree: Mapping[str, tuple[str, str, str, Sequence[float]]]) -> str:
    """Return a URDF of the bodies, each with the frame and the place that it starts in."""

    def pose(body: str) -> tuple[np.ndarray, np.ndarray]:
        if body == WORLD:
            return np.zeros(3), np.eye(3)
        return np.array(system.bodies[body].position, float), np.array(system.bodies[body].attitude, float)

    parts = [f'<robot name="{name}">', '  <link name="ground"/>']
    for link, body in system.bodies.items():
        parts.append(link_text(link, body))
    for joint, (kind, parent, child, axis) in tree.items():
        (p, P), (c, C) = pose(parent), pose(child)
        parent = "ground" if parent == WORLD else parent
        parts.append(joint_text(joint, kind, parent, child, P.T @ (c - p), P.T @ C, axis))
    return "\n".join([*parts, "</robot>\n"])


def link_text(name: str, body: Body) -> str:
    """Return the URDF of one link."""
    i = body.moments
    moments = {"ixx": i[0, 0], "iyy": i[1, 1], "izz": i[2, 2], "ixy": i[0, 1], "ixz": i[0, 2], "iyz": i[1, 2]}
    return (
        f'  <link name="{name}">\n    <inertial><origin xyz="{_numbers(body.centre)}"/>'
        f'<mass value="{body.mass!r}"/>\n      <inertia '
        + " ".join(f'{key}="{float(value)!r}"' for key, value in moments.items())
        + "/></inertial>\n  </link>"
    )


def joint_text(
    name: str,
    kind: str,
    parent: str,
    child: str,
    position: Sequence[float],
    attitude: np.ndarray,
    axis: Sequence[float],
) -> str:
    """Return the URDF of one joint."""
    angles = Rotation.from_matrix(attitude).as_euler("xyz")
    bounded = kind in ("prismatic", "revolute")
    limit = '<limit lower="-2" upper="2" effort="1e6" velocity="1e3"/>' if bounded else ""
    return (
        f'  <joint name="{name}" type="{kind}">\n    <parent link="{parent}"/><child link="{child}"/>\n'
        f'    <origin xyz="{_numbers(position)}" rpy="{_numbers(angles)}"/>'
        f'<axis xyz="{_numbers(axis)}"/>{limit}\n  </joint>'
    )


def _numbers(values: Sequence[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


# --- a four-bar in the plane x-z, its bodies not in that plane: 20 rows of rank 17 ---

CRANK, COUPLER, ROCKER, GROUND = 0.1, 0.3, 0.25, 0.32
"""Lengths from pin to pin [m]; the ground's along x."""

CRANK_ANGLE, CRANK_RATE = radians(60.0), 12.0
"""Of the crank at the start, from x towards z [rad], [rad/s]."""


def four_bar_angles(crank: float) -> tuple[float, float]:
    """Return the angles of coupler and rocker, from x towards z, for the crank's [rad]: the coupler above."""
    A = CRANK * np.exp(1j * crank)
    D = GROUND - A
    along = (COUPLER**2 - ROCKER**2 + abs(D) ** 2) / (2.0 * abs(D))
    B = A + D / abs(D) * (along + 1j * sqrt(COUPLER**2 - along**2))
    return float(np.angle(B - A)), float(np.angle(B - GROUND))


def four_bar() -> Loop:
    """Return the four-bar, its crank set going, under gravity."""
    y = (0.0, -1.0, 0.0)  # turning about it, x goes towards z
    coupler, rocker = four_bar_angles(CRANK_ANGLE)

    def turned(angle: float) -> np.ndarray:
        return Rotation.from_rotvec(angle * np.array(y)).as_matrix()

    tip = (CRANK * cos(CRANK_ANGLE), 0.0, CRANK * sin(CRANK_ANGLE))
    bodies = {
        "crank": Body(
            mass=0.6, inertia=(3e-4, 9e-4, 7e-4), centre=(0.04, 0.02, 0.01), attitude=turned(CRANK_ANGLE)
        ),
        "coupler": Body(
            mass=0.9,
            inertia=((5e-4, 1e-4, 0.0), (1e-4, 7.1e-3, -5e-5), (0.0, -5e-5, 7e-3)),
            centre=(0.14, -0.03, 0.02),
            position=tip,
            attitude=turned(coupler),
        ),
        "rocker": Body(
            mass=0.7,
            inertia=(3e-4, 4e-3, 3.9e-3),
            centre=(0.12, 0.01, -0.01),
            position=(GROUND, 0.0, 0.0),
            attitude=turned(rocker),
        ),
    }
    o = (0.0, 0.0, 0.0)
    joints = {
        "drive_pin": Joint("revolute", Side(WORLD, o, y, tip), Side("crank", o, y, (1.0, 0.0, 0.0))),
        "crank_pin": Joint("revolute", Side("crank", (CRANK, 0.0, 0.0), y), Side("coupler", o, y)),
        "rocker_pin": Joint("revolute", Side("coupler", (COUPLER, 0.0, 0.0), y),
                            Side("rocker", (ROCKER, 0.0, 0.0), y)),
        "ground_pin": Joint("revolute", Side(WORLD, (GROUND, 0.0, 0.0), y), Side("rocker", o, y)),
    }  # fmt: skip
    system = Maximal(bodies, joints, gravity=(0.0, 0.0, -GRAVITY))
    scenario = f"""\
format = 1
title = "Four-bar, set going under gravity"
duration = "1 s"

[mechanism]
urdf = "loop.urdf"
base = "fixed"
gravity = [0.0, 0.0, {-GRAVITY}]

[closures.rocker_pin]
kind = "revolute"
first = {{ link = "coupler", point = [{COUPLER}, 0.0, 0.0], axis = [0, -1, 0] }}
second = {{ link = "rocker", point = [{ROCKER}, 0.0, 0.0], axis = [0, -1, 0] }}

[initial.joints.drive_pin]
position = 0.0
velocity = {CRANK_RATE}

[integrator]
rtol = 1e-12

[output]
rate = "20 Hz"
"""
    tree = {
        "drive_pin": ("continuous", WORLD, "crank", y),
        "crank_pin": ("continuous", "crank", "coupler", y),
        "ground_pin": ("continuous", WORLD, "rocker", y),
    }
    start = at_rate(system, "drive_pin", CRANK_RATE)
    return Loop(name="four_bar", system=system, start=start, tree=tree, scenario=scenario)


# --- Bricard's ring of right angles, the benchmark A04 of the IFToMM library: 30 rows of rank 29 ---

BRICARD_POINTS = ((0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1))
"""Pins at the start [m]; bar k from pin k to k + 1, ground from the last to the first, on a cube."""

BRICARD_AXES = ((0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0))
"""Axes of the pins at the start."""


def bricard() -> Loop:
    """Return the ring of five bars of 1 m and 1 kg, 0.1 m square, let go from rest under gravity along -y."""
    points, axes = np.array(BRICARD_POINTS, float), np.array(BRICARD_AXES, float)
    bodies, joints, tree, before = {}, {}, {}, WORLD
    for k in range(5):
        bar = points[k + 1] - points[k]
        along = np.abs(bar)
        inertia = (1.0 - along) * (1.0 + 0.1**2) / 12.0 + along * 0.1**2 / 6.0
        bodies[f"bar_{k + 1}"] = Body(mass=1.0, inertia=inertia, centre=0.5 * bar, position=points[k])
        joints[f"pin_{k + 1}"] = Joint(
            "revolute",
            Side(before, points[0] if k == 0 else points[k] - points[k - 1], axes[k]),
            Side(f"bar_{k + 1}", (0.0, 0.0, 0.0), axes[k]),
        )
        tree[f"pin_{k + 1}"] = ("continuous", before, f"bar_{k + 1}", axes[k])
        before = f"bar_{k + 1}"
    joints["pin_6"] = Joint(
        "revolute", Side("bar_5", points[5] - points[4], axes[5]), Side(WORLD, points[5], axes[5])
    )
    system = Maximal(bodies, joints, gravity=(0.0, -GRAVITY, 0.0))
    scenario = f"""\
format = 1
title = "Bricard's ring, let go under gravity"
duration = "1 s"

[mechanism]
urdf = "loop.urdf"
base = "fixed"
gravity = [0.0, {-GRAVITY}, 0.0]

[closures.pin_6]
kind = "revolute"
first = {{ link = "bar_5", point = [0.0, 1.0, 0.0], axis = [1, 0, 0] }}
second = {{ link = "world", point = [0.0, 0.0, 1.0], axis = [1, 0, 0] }}

[initial.joints.pin_1]
position = 0.0
velocity = 0.0

[integrator]
rtol = 1e-12

[output]
rate = "20 Hz"
"""
    return Loop(name="bricard", system=system, start=system.start, tree=tree, scenario=scenario)


# --- a spatial slider-crank: 17 rows of rank 17 ---

SPATIAL_PIVOT, SPATIAL_CRANK, SPATIAL_ROD = (0.0, 0.10, 0.12), 0.08, 0.30
"""Pivot of the crank, which turns about x, and lengths of crank and rod [m]. The slider runs along x."""

SPATIAL_RATE = 6.0
"""Of the crank at the start, where it points along z [rad/s]."""


def spatial_slider(angle: float) -> float:
    """Return where the slider is for the crank's angle about x, from z [m]."""
    _, b, c = SPATIAL_PIVOT
    y, z = b - SPATIAL_CRANK * sin(angle), c + SPATIAL_CRANK * cos(angle)
    return sqrt(SPATIAL_ROD**2 - y * y - z * z)


def spatial_slider_crank() -> Loop:
    """Return crank, rod (ball at the crank, universal at the slider) and slider, set going under gravity."""
    tip = np.array(SPATIAL_PIVOT) + (0.0, 0.0, SPATIAL_CRANK)
    slide = np.array([spatial_slider(0.0), 0.0, 0.0])
    x = (tip - slide) / SPATIAL_ROD  # along the rod, from slider to ball
    y = np.cross((0.0, 0.0, 1.0), x)  # the cross's axis in the rod, perpendicular to the one in the slider, z
    y /= np.linalg.norm(y)
    rod = np.column_stack([x, y, np.cross(x, y)])
    bodies = {
        "crank": Body(
            mass=0.12, inertia=(1e-4, 1.1e-4, 0.3e-4), centre=(0.005, 0.0, 0.03), position=SPATIAL_PIVOT
        ),
        "rod": Body(
            mass=0.5, inertia=(4e-4, 4e-3, 3.8e-3), centre=(-0.14, 0.003, 0.002), position=tip, attitude=rod
        ),
        "slider": Body(mass=2.0, inertia=(1e-3, 2e-3, 1.5e-3), centre=(0.01, 0.0, -0.02), position=slide),
    }
    o, e_x, e_y, e_z = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    end = (-SPATIAL_ROD, 0.0, 0.0)
    joints = {
        "pivot": Joint("revolute", Side(WORLD, SPATIAL_PIVOT, e_x, e_z), Side("crank", o, e_x, e_z)),
        # Its bearing's axes are those of the URDF's joint, the rod's at the start.
        "ball": Joint("spherical", Side("crank", (0.0, 0.0, SPATIAL_CRANK), rod[:, 2], x), Side("rod", o)),
        "cross": Joint("universal", Side("rod", end, e_y), Side("slider", o, e_z)),
        "guide": Joint("prismatic", Side(WORLD, o, e_x, e_y), Side("slider", o, e_x, e_y)),
    }
    system = Maximal(bodies, joints, gravity=(0.0, 0.0, -GRAVITY))
    scenario = f"""\
format = 1
title = "Spatial slider-crank, set going under gravity"
duration = "1 s"

[mechanism]
urdf = "loop.urdf"
base = "fixed"
gravity = [0.0, 0.0, {-GRAVITY}]

[clearance.ball]
model = "constraint"

[closures.cross]
kind = "universal"
first = {{ link = "rod", point = [{-SPATIAL_ROD}, 0.0, 0.0], axis = [0, 1, 0] }}
second = {{ link = "slider", point = [0.0, 0.0, 0.0], axis = [0, 0, 1] }}

[initial.joints.pivot]
position = 0.0
velocity = {SPATIAL_RATE}

[integrator]
rtol = 1e-12

[output]
rate = "20 Hz"
"""
    tree = {
        "pivot": ("continuous", WORLD, "crank", e_x),
        "ball": ("floating", "crank", "rod", e_z),
        "guide": ("prismatic", WORLD, "slider", e_x),
    }
    start = at_rate(system, "pivot", SPATIAL_RATE)
    return Loop(name="spatial_slider_crank", system=system, start=start, tree=tree, scenario=scenario)
