"""Random hands and grippers as their URDFs are: fingers that mimic, knuckles without mass, numbers that slip.

A palm carries fingers of two to four joints. What is odd about a finger is drawn from what the URDFs of hands
and arms have: links without an inertial behind coupled joints, followers that move nothing, points, inertia
that no body has, bounds that mean none, continuous joints with bounds, leftovers of xacro. One file in
:data:`NO_MECHANISM` has what no simulation can move: a joint that turns nothing, or a negative mass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: One file in so many is no mechanism.
NO_MECHANISM = 40

_BOUNDS = (
    'lower="-1" upper="2" effort="9" velocity="9"',
    'lower="-1.7976931348623157e308" upper="1.7976931348623157e308" effort="1e308" velocity="1e16"',
    'lower="-1e16" upper="1e16" effort="1e16" velocity="1.7976931348623157e308"',
    'lower="0" upper="1e30" effort="1e9" velocity="1e9"',
)


@dataclass(frozen=True)
class Hand:
    """A URDF of a hand."""

    name: str  # of the file, without suffix
    text: str  # its XML
    moves: bool  # whether it is a mechanism


def draw_hand(seed: int, number: int) -> Hand:
    """Return the hand of a number."""
    rng = np.random.default_rng([seed, number, 2])
    moves = number % NO_MECHANISM != NO_MECHANISM - 1
    palm = f'<link name="palm">{_inertial(rng, 0.5, 0.05)}</link>'
    parts = [_finger(rng, k) for k in range(int(rng.integers(1, 6)))]
    if not moves:
        child = "" if rng.random() < 0.5 else _inertial(rng, -0.1, 0.01)
        parts.append(f'<link name="dead">{child}</link>{_joint("dead_joint", "palm", "dead", "0 1 0", "")}')
    left = ' xmlns:xacro="http://www.ros.org/wiki/xacro" xacro:version="1"' if rng.random() < 0.3 else ""
    return Hand(
        f"hand_{seed}_{number}",
        f'<robot name="hand"{left}>\n{palm}\n{chr(10).join(parts)}\n</robot>\n',
        moves,
    )


def _finger(rng: np.random.Generator, k: int) -> str:
    """Return a finger: all joints about one axis, straight where all are at zero; the last mimics."""
    joints = int(rng.integers(2, 5))
    axis = ("0 1 0", "0 0 1")[int(rng.integers(2))]
    massless = bool(rng.random() < 0.5) and joints > 2
    parts, before = [], "palm"
    for i in range(joints):
        name = f"f{k}_{i}"
        last = i == joints - 1
        inside = "" if massless and not last else _inertial(rng, rng.uniform(0.01, 0.1), 0.02, point=not last)
        mimic = ""
        # All but two freedoms of a finger are tied: of more a tip alone has no inertia to give.
        if last or (massless and i >= 2):
            factor = rng.choice([1.0, 1.0454, 0.75, -0.6])
            mimic = f'<mimic joint="f{k}_{i - 1}_joint" multiplier="{factor}"/>'
            if rng.random() < 0.2 and not massless:
                inside = ""  # a follower that moves nothing
        parts.append(f'<link name="{name}">{inside}</link>')
        parts.append(_joint(f"{name}_joint", before, name, axis, mimic, rng, at=0.05 if i else 0.1))
        before = name
    return "\n".join(parts)


def _joint(
    name: str,
    parent: str,
    child: str,
    axis: str,
    mimic: str,
    rng: np.random.Generator | None = None,
    at: float = 0.05,
) -> str:
    kind, bounds = "revolute", _BOUNDS[0]
    if rng is not None:
        kind = ("revolute", "continuous")[int(rng.random() < 0.2)]
        bounds = _BOUNDS[int(rng.choice(4, p=[0.5, 0.2, 0.2, 0.1]))]
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at} 0 0"/><axis xyz="{axis}"/><limit {bounds}/>{mimic}</joint>'
    )


def _inertial(rng: np.random.Generator, mass: float, size: float, point: bool = False) -> str:
    """Return an inertial: of a body, of one whose moments break the triangle rule, or of a point."""
    moments = mass * size**2 * rng.uniform(0.5, 0.9, 3)
    odd = rng.random()
    if odd < 0.15:
        moments[int(rng.integers(3))] *= 10.0
    elif point and odd < 0.2:
        moments *= 0.0
    xx, yy, zz = (f"{moment:.4g}" for moment in moments)
    return (
        f'<inertial><origin xyz="{size:.3g} 0 0.002"/><mass value="{mass:.4g}"/>'
        f'<inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
