"""Inertia where it acts: of links that fixed joints make one body.

What a body does hangs on its mass, mass centre and inertia as a whole. So a frame may have a mass of zero, a
weight may be a point, and a rod thin, if what they are fixed to has what they lack; and numbers are judged on
the sum. A point, a rod, a plate are bodies too: none of their moments is negative. Whether what has no moment
about some line can be made to turn about it hangs on joints (:mod:`antenna_pin.mechanism._regular`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import MechanismError
from antenna_pin.mechanism._robot import Joint, Link, Robot

Array = NDArray[np.float64]

#: Of the largest principal moment: how far the others may fall short of what a body has. Programs write six
#: digits if nobody asks for more, so that each number is off by up to 5e-6 of itself, and two sides of the
#: triangle rule, of up to the largest moment, by as much each.
INEXACT = 1e-5

#: Radius of gyration below which a body is a point [m]: some programs write moments that are the round-off
#: of zeros, 1e-35 kg m^2 of a head of 0.5 kg, of which neither sign nor the triangle rule means anything. No
#: part that a URDF has is as small.
POINT = 1e-6


@dataclass(frozen=True, slots=True)
class RigidGroup:
    """Links that fixed joints make one body.

    Attributes:
        links: The first is the root, or the one that a moving joint moves.
        placements: (4, 4) of each link's frame in the first one's.
    """

    links: tuple[Link, ...]
    placements: tuple[Array, ...]

    @property
    def first(self) -> str:
        """Name of the first link."""
        return str(self.links[0].name)

    @property
    def name(self) -> str:
        """Name of the body: that of its first link that has an inertial, or of the first of all."""
        return str(next((link.name for link in self.links if link.inertial is not None), self.first))

    @property
    def called(self) -> str:
        """What messages call it."""
        having = [link.name for link in self.links if link.inertial is not None] or [self.first]
        name, others = having[0], ", ".join(map(repr, having[1:]))
        return f"link {name!r}" + (f" together with {others}, fixed to it" if others else "")

    def composite(self) -> tuple[float, Array, Array]:
        """Return mass [kg], mass centre (3,) [m] and inertia about it (3, 3) [kg m^2], as the first link."""
        masses, centres, inertias = [], [], []
        for link, placement in zip(self.links, self.placements, strict=True):
            if (own := link.inertial) is not None:
                at = placement @ (np.eye(4) if own.origin is None else own.origin)
                masses.append(own.mass)
                centres.append(at[:3, 3])
                inertias.append(at[:3, :3] @ own.inertia @ at[:3, :3].T)
        mass, centre, inertia = sum(masses), np.zeros(3), np.zeros((3, 3))
        if mass > 0.0:
            centre = sum((m * c for m, c in zip(masses, centres, strict=True)), centre) / mass
        for m, c, own_inertia in zip(masses, centres, inertias, strict=True):
            arm = c - centre
            inertia = inertia + own_inertia + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        return mass, centre, inertia


def rigid_groups(robot: Robot) -> dict[str, RigidGroup]:
    """Return the links that fixed joints make one body, by the first link of each.

    The first link is the root or one that a moving joint moves; from it outwards, in the file's order.
    """
    links = {link.name: link for link in robot.links}
    fixed: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        if joint.type == "fixed":
            fixed.setdefault(joint.parent, []).append(joint)
    children = {joint.child for joint in robot.joints}
    roots = (name for name in links if name not in children)
    groups: dict[str, RigidGroup] = {}
    for first in (next(roots), *(joint.child for joint in robot.joints if joint.type != "fixed")):
        placed = [(first, np.eye(4))]
        for name, placement in placed:  # grows while it is walked: breadth first
            for joint in fixed.get(name, ()):
                own = np.eye(4) if joint.origin is None else joint.origin
                placed.append((joint.child, placement @ own))
        groups[first] = RigidGroup(
            tuple(links[name] for name, _ in placed), tuple(placement for _, placement in placed)
        )
    return groups


def check_masses(robot: Robot, where: str) -> None:
    """Refuse negative masses, of each link: a wrong sign and a hole look alike."""
    for link in robot.links:
        if link.inertial is not None and not link.inertial.mass >= 0.0:
            raise MechanismError(
                f"{where}: link {link.name!r}: mass must be zero or more, got {link.inertial.mass:g} kg; "
                "correct it, or give the link that it is cut out of what is left"
            )


class Impossible(NamedTuple):
    """A body with principal moments of inertia about its mass centre that no body can have.

    Attributes:
        said: What it is and why not, in words.
        negative: Whether one of them is negative: its joints may then move without inertia.
    """

    said: str
    negative: bool


def impossible_inertia(
    group: RigidGroup, allowed: Collection[str], rounding: Mapping[str, float]
) -> Impossible | None:
    """Return what no body can have of a group's principal moments of inertia; None if one may have them.

    Args:
        group: The links.
        allowed: Links that may break the triangle rule, each with those that it is fixed to.
        rounding: By link, how much of that rule may be broken by the rounding of what is written [kg m^2].
    """
    mass, _, inertia = group.composite()
    low, middle, high = (float(moment) for moment in np.linalg.eigvalsh(inertia))
    inexact = max(INEXACT * max(abs(low), abs(high)), mass * POINT**2)
    moments = f"{low:.6g}, {middle:.6g}, {high:.6g} kg m^2"
    if not low >= -inexact:
        return Impossible(f"{group.called}: a negative principal moment of inertia: {moments}", True)
    excess = high - (low + middle)
    rounded = sum(rounding.get(link.name, 0.0) for link in group.links)
    if excess > max(inexact, rounded) and not any(link.name in allowed for link in group.links):
        return Impossible(
            f"{group.called}: the largest principal moment of inertia exceeds the sum of the other two: "
            f"{moments}, by {excess:.6g}",
            False,
        )
    return None
