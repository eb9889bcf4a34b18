"""Constraints of a system in numbers: closures, motions, couplings, and their tree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.records import PLANE, RIGID, words_of
from antenna_pin.compiled.lanes import LANES
from antenna_pin.dynamics.constraints import layout_kernels as _layout
from antenna_pin.dynamics.constraints.carried_kernels import room_for
from antenna_pin.dynamics.constraints.closure import Anchor, Closure
from antenna_pin.dynamics.constraints.coupling import Coupling
from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.mechanism import WORLD, Mechanism, body_tree, frame_aligning_z

__all__ = ["DrivenJoint", "ConstraintPlan", "make_plan", "on_body"]

Array = NDArray[np.float64]

# Ratio of the least to the largest moment of a body below which it is a rod.
_THIN = 1e-9
# Joints with more freedoms than their axis.
_MORE = {"planar": PLANE, "floating": RIGID}


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenJoint:
    """A joint whose motion is prescribed, or that an element may hold.

    Attributes:
        name: Name of the drive, or place of the element (``latches.hinge``).
        joint: Name of the joint.
        turn: Place of the joint's turned angle in x, or -1.
        kind: Number of the kind of its element.
        words: Start of the element's own record in the program.
        x: Start of its works in x, or of its loss.
        loaded: Whether it has friction by its own load.
    """

    name: str
    joint: str
    turn: int
    kind: int
    words: int
    x: int
    loaded: bool = False


class PlanParts(NamedTuple):
    """Places of the parts' records in a plan's numbers."""

    tree: slice  # bodies, BODY
    closures: slice  # closures, CLOSURE
    motions: slice  # motions, DRIVEN
    couplings: slice  # couplings, COUPLED
    holds: slice  # elements that may hold, DRIVEN


@dataclass(frozen=True, slots=True, eq=False)
class ConstraintPlan:
    """Constraints in numbers.

    Attributes:
        words: Numbers for kernels (:mod:`antenna_pin.dynamics.constraints.layout_kernels`).
        size: Size of a work array.
        closures: Their names, in their order.
        rows: Descriptions of each closure's rows (``along x``, ...), in their order, by name.
        first_row: First row of each closure.
        motions: Names of the drives that prescribe motions; theirs are the first rows.
        couplings: Names of the couplings; theirs are the next rows.
        holds: Names of the elements that may hold their joint; theirs are the last rows.
        length: Length of 1 rad [m].
    """

    words: Array
    size: int
    closures: tuple[str, ...]
    rows: Mapping[str, tuple[str, ...]]
    first_row: Mapping[str, int]
    motions: tuple[str, ...]
    couplings: tuple[str, ...]
    holds: tuple[str, ...]
    length: float

    @property
    def parts(self) -> PlanParts:
        """Places of the parts' records in the plan's numbers."""
        head, at, found = self.words[: _layout.PLAN_WORDS].view(_layout.PLAN)[0], _layout.PLAN_WORDS, []
        for name, words in (
            ("bodies", _layout.BODY_WORDS),
            ("closures", _layout.CLOSURE_WORDS),
            ("motions", _layout.DRIVEN_WORDS),
            ("couplings", _layout.COUPLED_WORDS),
            ("holds", _layout.DRIVEN_WORDS),
        ):
            found.append(slice(at, at + words * int(head[name])))
            at = found[-1].stop
        return PlanParts(*found)

    @property
    def loaded(self) -> bool:
        """Return whether a joint has friction by its own load."""
        return bool(self.words[: _layout.PLAN_WORDS].view(_layout.PLAN)[0]["loaded"])

    @property
    def count(self) -> int:
        """Equations in all, but for what elements hold."""
        return len(self.motions) + len(self.couplings) + sum(map(len, self.rows.values()))

    @property
    def ties(self) -> Array:
        """Matrix T of the couplings' rates, T v = 0, (couplings, nv)."""
        nv = int(self.words[: _layout.PLAN_WORDS].view(_layout.PLAN)[0]["nv"])
        rows = np.zeros((len(self.couplings), nv))
        for row, one in zip(rows, self.words[self.parts.couplings].view(_layout.COUPLED), strict=True):
            for at, slope in zip(one["v"], (1.0, -one["multiplier"], -one["second"]), strict=True):
                row[at] += slope
        return rows

    def row_groups(self) -> Iterator[tuple[str, int, tuple[str, ...]]]:
        """Yield name, first row and row meanings of each coupling, then of each closure."""
        for row, name in enumerate(self.couplings, len(self.motions)):
            yield name, row, ("the coupling",)
        for name, words in self.rows.items():
            yield name, self.first_row[name], words


def make_plan(
    mechanism: Mechanism,
    closures: Mapping[str, Closure],
    motions: Sequence[DrivenJoint] = (),
    couplings: Mapping[str, Coupling] | None = None,
    turns: Mapping[str, int] | None = None,
    holding: Sequence[DrivenJoint] = (),
) -> ConstraintPlan:
    """Lay out the constraints of a mechanism.

    Args:
        mechanism: The mechanism.
        closures: Closures, by name.
        motions: Motions, in the order of the system's.
        couplings: Couplings, by name; followers move, leaders move or are fixed.
        turns: Places of turned angles in x, by joint.
        holding: Elements that may hold their joint.

    Raises:
        UnknownNameError: A closure on an unknown link.
        MechanismError: A closure whose sides are one body.
    """
    model = mechanism.model
    records = np.zeros(len(closures), dtype=_layout.CLOSURE)
    rows: dict[str, tuple[str, ...]] = {}
    first_row: dict[str, int] = {}
    couplings = couplings or {}
    row = len(motions) + len(couplings)
    points = [0.0]
    for record, (name, closure) in zip(records, closures.items(), strict=True):
        sides = [on_body(mechanism, f"closure {name!r}", side) for side in (closure.first, closure.second)]
        (first, place), (second, other) = sides
        if first == second:
            said = "the world" if first < 0 else f"body {mechanism.bodies[first]!r}"
            raise MechanismError(
                f"closure {name!r}: its links {closure.first.link!r} and {closure.second.link!r} are one "
                f"body, {said}, and cannot move against each other; name links between which a joint moves"
            )
        holds = closure.holds
        record["first"], record["second"] = first, second
        record["row"], record["rows"] = row, holds.rows
        record["along"] = [axis in holds.along for axis in "xyz"]
        record["about"] = [axis in holds.about for axis in "xyz"]
        record["square"], record["attitude"] = holds.square, holds.about == "xyz"
        record["first_rotation"], record["first_origin"] = place[:3, :3], place[:3, 3]
        record["second_rotation"], record["second_origin"] = other[:3, :3], other[:3, 3]
        points += [float(np.linalg.norm(frame[:3, 3])) for body, frame in sides if body >= 0]
        rows[name] = (
            *(f"along {axis}" for axis in holds.along),
            *(f"about {axis}" for axis in holds.about),
            *(("at right angles",) if holds.square else ()),
        )
        first_row[name] = row
        row += holds.rows
    points += [float(np.linalg.norm(placement.translation)) for placement in list(model.jointPlacements)[2:]]
    length = max(points) or 1.0
    driven = _driven(mechanism, motions, 0)
    own = _driven(mechanism, holding, row)
    row += len(holding)
    coupled = _coupled(mechanism, couplings, turns or {}, len(motions), length)
    tree = body_tree(mechanism)
    head = np.zeros(1, dtype=_layout.PLAN)
    size = _place_numbers(head, len(tree), row, model.nv)
    if any(one.loaded for one in holding):
        n = len(holding)
        head["loaded"] = size
        size += 6 * len(tree)
        size += model.nv + n + 6 * n * (n + 1) + max(room_for(len(tree), len(closures), row), n * (n + 1))
    head["gravity"] = model.gravity.linear
    head["bodies"], head["closures"], head["motions"] = len(tree), len(closures), len(motions)
    head["couplings"], head["holds"] = len(couplings), len(holding)
    head["rows"], head["nq"], head["nv"], head["length"] = row, model.nq, model.nv, length
    parts = [part.view(np.float64) for part in (head, tree, records, driven, coupled, own)]
    return ConstraintPlan(
        words=np.concatenate(parts),
        size=size,
        closures=tuple(closures),
        rows=rows,
        first_row=first_row,
        motions=tuple(motion.name for motion in motions),
        couplings=tuple(couplings),
        holds=tuple(one.name for one in holding),
        length=length,
    )


def _driven(mechanism: Mechanism, joints: Sequence[DrivenJoint], row: int) -> NDArray[np.void]:
    """Return the records of joints that are driven or held, whose rows begin at one."""
    records = np.zeros(len(joints), dtype=_layout.DRIVEN)
    for k, (record, one) in enumerate(zip(records, joints, strict=True)):
        slot = mechanism.joint(one.joint)
        record["row"], record["q"], record["v"] = row + k, slot.q.start, slot.v.start
        record["slides"], record["turn"] = slot.kind == "prismatic", one.turn
        record["kind"], record["words"], record["x"] = one.kind, one.words, one.x
        if slot.kind in _MORE:
            record["moves"] = _MORE[slot.kind]
            record["axes"] = np.eye(3) if slot.kind == "planar" else frame_aligning_z(slot.axis)
    return records


def _coupled(
    mechanism: Mechanism, couplings: Mapping[str, Coupling], turns: Mapping[str, int], row: int, length: float
) -> NDArray[np.void]:
    """Return the records of couplings whose rows begin at one."""
    records = np.zeros(len(couplings), dtype=_layout.COUPLED)
    for k, (record, coupling) in enumerate(zip(records, couplings.values(), strict=True)):
        own = coupling.follower
        # A missing or fixed joint is replaced by the follower, times zero.
        first, second = (
            name if name in mechanism.joints else None for name in (coupling.leader, coupling.second)
        )
        names = own, first or own, second or own
        slots = [mechanism.joint(name) for name in names]
        multiplier = coupling.multiplier if first else 0.0
        further = coupling.second_multiplier if second else 0.0
        follower, leader, third = (1.0 if slot.kind == "prismatic" else length for slot in slots)
        largest = max(abs(multiplier) * follower / leader, abs(further) * follower / third)
        record["row"], record["slides"] = row + k, slots[0].kind == "prismatic"
        record["multiplier"], record["offset"] = multiplier, coupling.offset
        record["second"] = further
        record["scale"] = 1.0 / max(1.0, largest)
        record["q"], record["v"] = [slot.q.start for slot in slots], [slot.v.start for slot in slots]
        record["turn"] = [turns.get(name, -1) for name in names]
    if len(records) and _may_be_singular(mechanism):
        inertia = np.diag(
            pin.crba(mechanism.model, mechanism.model.createData(), pin.neutral(mechanism.model))
        )
        for record in records:
            slopes = np.array([1.0, record["multiplier"], record["second"]])
            felt = inertia[record["v"]][slopes != 0.0] / slopes[slopes != 0.0] ** 2
            row = record["scale"] * (1.0 if record["slides"] else length)
            record["brace"] = (float(felt.max()) or float(inertia.max())) / row**2
    return records


def _may_be_singular(mechanism: Mechanism) -> bool:
    """Return whether a body has no inertia about some axis: frame, point or rod."""
    for body in list(mechanism.model.inertias)[1:]:
        moments = np.linalg.eigvalsh(body.inertia)
        if not (body.mass > 0.0 and moments[0] > _THIN * moments[-1]):
            return True
    return False


def _place_numbers(head: NDArray[np.void], bodies: int, rows: int, nv: int) -> int:
    """Say where in a work array the numbers stand; return its size."""
    at = (bodies + 3) * _layout.PLACE_WORDS
    width, span = (-(-number // LANES) * LANES for number in (rows, nv))
    head["width"], head["span"] = width, span
    sizes = {
        "jacobian": nv * width,
        "lack": width,
        "gap": width,
        "speed": width,
        "force": width,
        "shares": width,
        "reduced": nv * width,
        "directions": rows * span,
        "triangle": rows * width,
        "inverses": width,
        "squares": width,
        "weights": width,
        "order": width,
        "root": nv * nv,
        "first": nv,
        "scratch": 2 * max(span, width),
        "found": words_of(_layout.FOUND),
    }
    for name, size in sizes.items():
        head[name] = at
        at += size
    return at


def on_body(mechanism: Mechanism, place: str, side: Anchor) -> tuple[int, Array]:
    """Return the body of a side, -1 for the world, and the frame, (4, 4).

    Raises:
        UnknownNameError: There is no such link; ``place`` begins the message.
    """
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = side.rotation, side.origin
    if side.link == WORLD:
        return -1, frame
    links = [link.name for link in mechanism.urdf.robot.links]
    if side.link not in links:
        raise UnknownNameError(place, "link", side.link, dict.fromkeys([*links, WORLD]))
    found = mechanism.model.frames[mechanism.frame(side.link)]
    return int(found.parentJoint) - 1, np.asarray(found.placement.homogeneous @ frame)
