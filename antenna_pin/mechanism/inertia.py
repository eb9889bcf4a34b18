"""Inertia of bodies: links joined by fixed joints, and the regularity of the mass matrix."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.errors import MechanismError
from antenna_pin.mechanism.robot import Joint, Link, Robot

# --- joined links -------------------------------------------------------------------------------------------
#
# What a body does hangs on its mass, mass centre and inertia as a whole. So a frame may have a mass of
# zero, a weight may be a point, and a rod thin, if what they are fixed to has what they lack; and numbers
# are judged on the sum. A point, a rod, a plate are bodies too: none of their moments is negative. Whether
# what has no moment about some line can be made to turn about it hangs on joints (below).

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
    def first_link(self) -> str:
        """Name of the first link."""
        return str(self.links[0].name)

    @property
    def name(self) -> str:
        """Name of the body: its first link with an inertial, else its first link."""
        return str(next((link.name for link in self.links if link.inertial is not None), self.first_link))

    @property
    def called(self) -> str:
        """Name in messages."""
        having = [link.name for link in self.links if link.inertial is not None] or [self.first_link]
        name, others = having[0], ", ".join(map(repr, having[1:]))
        return f"link {name!r}" + (f" together with {others}, fixed to it" if others else "")

    def composite(self) -> tuple[float, Array, Array]:
        """Return mass [kg], mass centre (3,) [m] and central inertia (3, 3) [kg m^2]."""
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
    """Refuse negative masses, link by link."""
    for link in robot.links:
        if link.inertial is not None and not link.inertial.mass >= 0.0:
            raise MechanismError(
                f"{where}: link {link.name!r}: mass must be zero or more, got {link.inertial.mass:g} kg; "
                "correct it, or give the link that it is cut out of what is left"
            )


class Impossible(NamedTuple):
    """A body whose principal moments of inertia are not those of any body.

    Attributes:
        said: What it is and why not, as text.
        negative: Whether one of them is negative: its joints may then move without inertia.
    """

    said: str
    negative: bool


def impossible_inertia(
    group: RigidGroup, allowed: Collection[str], rounding: Mapping[str, float]
) -> Impossible | None:
    """Return the violation by a group's principal moments of inertia; None without one.

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


# --- mass matrix --------------------------------------------------------------------------------------------

# Least inertia of a joint's motion, all that it carries let go, over that of all held as one body, in which
# it is found to some 1e-15: below it is round-off.
_NO_INERTIA = 1e-12
_POSES = 4
# The same of a body's own inertia over a bound on all that its joint carries, from which on no pose is tried:
# far above the least, for sliding joints reach farther than as they are drawn. Of joints that turn and shift
# at once it is a product of two.
_PLENTY, _PLENTY_OF_BOTH = 1e-9, 1e-5


class Idle(NamedTuple):
    """A joint that can move without any inertia.

    Attributes:
        joint: Its index in the model.
        turns: Whether it is a turn, rather than a shift.
    """

    joint: int
    turns: bool


def is_regular_everywhere(model: Any) -> bool:
    """Return whether own inertias make the mass matrix regular in every pose.

    The articulated inertia of a body is at least its own. False says nothing: then poses have to be tried.
    """
    mass, half_trace, reach = np.zeros((3, model.njoints))
    for i in range(model.njoints - 1, 0, -1):
        own, parent = model.inertias[i], model.parents[i]
        mass[i] += own.mass
        half_trace[i] += 0.5 * float(np.trace(own.inertia))
        reach[i] = max(reach[i], float(np.linalg.norm(own.lever)))
        about = half_trace[i] + 2.0 * mass[i] * reach[i] ** 2
        turns = _turns(model.joints[i])
        least = _PLENTY if turns.all() or len(turns) == 1 else _PLENTY_OF_BOTH
        if not (own.mass > least * mass[i] and np.linalg.eigvalsh(own.inertia)[0] > least * about):
            return False
        mass[parent] += mass[i]
        half_trace[parent] += half_trace[i]
        reach[parent] = max(
            reach[parent], float(np.linalg.norm(model.jointPlacements[i].translation)) + reach[i]
        )
    return True


def idle_joint(model: Any, q: Array) -> Idle | None:
    r"""Return the first joint from the tips without inertia in a pose; None without one.

    From the tips inwards each joint is taken out of the mass matrix: what is left of its block is the
    inertia of what it moves while all joints beyond are let go, by which forward dynamics divides
    (Featherstone (2008), Rigid Body Dynamics Algorithms, 7.3). The matrix is regular exactly where all of
    these are.

    Args:
        model: Pinocchio's.
        q: Configuration (nq,).
    """
    data, matrix = _at(model, q)
    carried = [pin.Inertia(inertia) for inertia in model.inertias]
    for i in range(model.njoints - 1, 0, -1):
        whole, start, size = carried[i], model.idx_vs[i], model.nvs[i]
        own = slice(start, start + size)
        block, turns = matrix[own, own], _turns(model.joints[i])
        lever = np.array(whole.lever)
        if size == 6:  # about the mass centre: where the frame's origin is says nothing
            shift = np.eye(6)
            shift[:3, 3:] = pin.skew(lever)
            block, lever = shift.T @ block @ shift, np.zeros(3)
        about = 0.5 * float(np.trace(whole.inertia)) + whole.mass * float(lever @ lever)
        scale = np.where(turns, about, whole.mass)
        if not np.all(scale > 0.0):
            return Idle(i, bool(turns[int(np.argmin(scale))]))
        root = np.sqrt(scale)  # first: the square of next to nothing is nothing
        values, ways = np.linalg.eigh(block / np.outer(root, root))
        if not values[0] > _NO_INERTIA:
            return Idle(i, bool(turns[int(np.argmax(np.abs(ways[:, 0])))]))
        before = matrix[:start, own]
        matrix[:start, :start] -= before @ np.linalg.solve(matrix[own, own], before.T)
        carried[model.parents[i]] += data.liMi[i].act(whole)
    return None


def idle_with(model: Any, q: Array, ties: Array) -> Idle | None:
    """Return the joint with the largest motion among motions without inertia in a pose.

    It is that of :func:`idle_joint` where there are no ties; None if all such motions have inertia.

    Args:
        model: Pinocchio's.
        q: Configuration (nq,).
        ties: What rates of joints are tied by, ties v = 0, (k, nv): those of couplings.
    """
    idle = idle_joint(model, q)
    if idle is None or not len(ties):
        return idle
    data, matrix = _at(model, q)
    carried = [pin.Inertia(inertia) for inertia in model.inertias]
    scale = np.zeros(model.nv)
    for i in range(model.njoints - 1, 0, -1):
        whole, own = carried[i], slice(model.idx_vs[i], model.idx_vs[i] + model.nvs[i])
        about = 0.5 * float(np.trace(whole.inertia)) + whole.mass * float(whole.lever @ whole.lever)
        scale[own] = np.where(_turns(model.joints[i]), about, whole.mass)
        carried[model.parents[i]] += data.liMi[i].act(whole)
    unit = np.sqrt(np.where(scale > 0.0, scale, 1.0))
    # In rates times the root of the inertia of all that a joint carries; ties among those that carry some.
    rows = ties / unit
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    free = np.linalg.svd(rows)[2][np.linalg.matrix_rank(rows) :].T
    values, ways = np.linalg.eigh(free.T @ (matrix / np.outer(unit, unit)) @ free)
    if not len(values) or values[0] > _NO_INERTIA:
        return None
    rates = np.abs(free @ ways[:, 0]) / unit
    most = next(
        i for i in range(1, model.njoints) if 0 <= int(np.argmax(rates)) - model.idx_vs[i] < model.nvs[i]
    )
    return Idle(most, bool(_turns(model.joints[most])[int(np.argmax(rates)) - model.idx_vs[most]]))


def check_regular(
    model: Any,
    where: str,
    moved: Mapping[str, RigidGroup],
    base: str,
    ties: Array,
    *,
    negative: str = "",
) -> None:
    """Refuse a tree with a joint that moves without any inertia in every pose.

    In some poses one may, as the first hinge of a universal joint whose cross has no mass while a thin rod
    points along it: only what is so in each of a few poses anywhere is no mechanism.

    Args:
        model: Pinocchio's.
        where: Name of the file, for messages.
        moved: The links that each joint moves as one body, by the joint's name.
        base: Name of the joint of a free base.
        ties: Rows of couplings, ties v = 0, (k, nv).
        negative: What has a negative moment, as text; all of these poses must do then, not one by chance.
    """
    idle: Idle | None = None
    for q in _poses(model):
        found = idle_with(model, q, ties)
        if found is None:
            if not negative:
                return
        else:
            idle = found
            if negative:
                break
    if idle is None:
        return
    said = said_of_idle(model, idle, moved, base)
    raise MechanismError(f"{where}: {negative}: {said}" if negative else f"{where}: {said}")


def said_of_idle(model: Any, idle: Idle, moved: Mapping[str, RigidGroup], base: str) -> str:
    """Return a message about a joint without inertia: body, numbers, way out."""
    name = model.names[idle.joint]
    body = moved[name]
    mass, _, inertia = body.composite()
    low, middle, high = np.linalg.eigvalsh(inertia)
    has = f"it has {mass:g} kg and principal moments of inertia {low:.6g}, {middle:.6g}, {high:.6g} kg m^2"
    if not any(link.inertial is not None for link in body.links):
        has = "it has no <inertial>"
    if idle.joint in list(model.parents)[1:]:
        has += ", and no locked joint attaches other bodies to it"
    way = "turn" if idle.turns else "shift"
    what, out = f"joint {name!r}", f'lock the joint (mechanism.joints.{name}.kind = "locked")'
    if name == base:
        what, out = "the free base", "take base = 'fixed'"
    elif others := [one for one in _carries_nothing(model) if one != name]:
        out += f", likewise {', '.join(others)}"
    return (
        f"{what} can {way} {body.called} without any inertia: {has}; "
        f"give it one (mechanism.links.{body.name}), or {out}"
    )


def _carries_nothing(model: Any) -> list[str]:
    """Return the names of joints beyond which there is no mass and no inertia."""
    carried = [inertia.mass + float(np.trace(inertia.inertia)) for inertia in model.inertias]
    for i in range(model.njoints - 1, 0, -1):
        carried[model.parents[i]] += carried[i]
    return [model.names[i] for i in range(1, model.njoints) if carried[i] == 0.0]


def mass_matrix(model: Any, data: Any, q: Array) -> Array:
    """Return the whole mass matrix, (nv, nv), of which ``pin.crba`` writes the upper triangle."""
    upper = np.triu(np.asarray(pin.crba(model, data, q)).reshape(model.nv, model.nv))
    return np.asarray(upper + np.triu(upper, 1).T)


def _at(model: Any, q: Array) -> tuple[Any, Array]:
    """Return Pinocchio's data with joints placed in a pose, and the mass matrix (nv, nv)."""
    data = model.createData()
    matrix = mass_matrix(model, data, q)
    pin.forwardKinematics(model, data, q)
    return data, matrix


def _turns(joint: Any) -> NDArray[np.bool_]:
    """Return which of a joint's velocities are turns."""
    kind = joint.shortname()
    if kind == "JointModelFreeFlyer":
        return np.array([False] * 3 + [True] * 3)
    if kind == "JointModelPlanar":
        return np.array([False, False, True])
    return np.full(joint.nv, not kind.startswith("JointModelP"))  # P, PX, PrismaticUnaligned


def _poses(model: Any) -> Iterator[Array]:
    """Yield random poses: angles up to 1 rad, displacements of the mechanism's size."""
    arms = [np.linalg.norm(place.translation) for place in model.jointPlacements]
    arms += [np.linalg.norm(inertia.lever) for inertia in model.inertias]
    size = float(max(arms)) or 1.0
    reach = np.concatenate([np.where(_turns(joint), 1.0, size) for joint in list(model.joints)[1:]])
    random = np.random.default_rng(1743)
    for _ in range(_POSES):
        yield pin.integrate(model, pin.neutral(model), reach * random.uniform(-1.0, 1.0, model.nv))
