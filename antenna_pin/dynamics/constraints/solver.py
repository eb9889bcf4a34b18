"""Solver of a run's constraints: accelerations, corrections, forces."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.records import PLANE, RIGID, words_of
from antenna_pin.compiled.lanes import LANES
from antenna_pin.dynamics.constraints import (
    factor_kernels,
    force_kernels,
    loaded_kernels,
    rows_kernels,
    solve_kernels,
)
from antenna_pin.dynamics.constraints import layout_kernels as _layout
from antenna_pin.dynamics.constraints.carried_kernels import room_for
from antenna_pin.dynamics.constraints.closure import Anchor, Closure
from antenna_pin.dynamics.constraints.coupling import Coupling
from antenna_pin.dynamics.constraints.solve_kernels import CLOSED, NEAR, OPEN, ROUNDS
from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.mechanism import WORLD, Mechanism, body_tree, frame_aligning_z
from antenna_pin.mechanism.inertia import mass_matrix

Array = NDArray[np.float64]


class Solution(NamedTuple):
    """Numbers of a solution."""

    rank: int  # number of independent rows
    least: float  # smallest remainder of an independent row, over its scale [-]
    most: float  # largest remainder of a dependent row, over its scale [-]
    gap: float  # largest residual of displacements [m]; ``turn``: angles [rad]; ``speed``, ``spin``: rates
    turn: float
    speed: float
    spin: float


class Constraints:
    """Solver of the equations of motion under constraints; one for each run.

    Args:
        plan: The constraints.
        model: ``pin.Model``.
        data: ``pin.Data`` of the run.
    """

    def __init__(self, plan: ConstraintPlan, model: Any, data: Any) -> None:
        """Allocate everything once."""
        self.plan = plan
        self.model = model
        self.data = data
        self.work = np.zeros(plan.size)
        head = plan.words[: _layout.PLAN_WORDS].view(_layout.PLAN)[0]
        nv, holds, every = int(head["nv"]), int(head["holds"]), int(head["rows"])
        #: Number of rows of motions, couplings and closures; the rows of elements that hold follow.
        rows = every - holds
        self.rows, self.nv = rows, nv

        def part(name: str, *shape: int) -> Array:
            at = int(head[name])
            return self.work[at : at + int(np.prod(shape))].reshape(shape)

        #: J, in metres; right sides of accelerations; residuals; multipliers.
        self.jacobian = part("jacobian", nv, int(head["width"]))[:, :rows].T
        self._all_forces = part("force", every)
        self.gap, self.speed, self.force = part("gap", rows), part("speed", rows), part("force", rows)
        self.lack = part("lack", rows)
        #: Remainder of each row, over its length and times its scale factor.
        self.shares = part("shares", rows)
        #: Actions of elements on links on bodies, if friction by load needs them, else empty.
        self.applied = self.work[int(head["loaded"]) :][: 6 * int(head["bodies"]) if head["loaded"] else 0]
        self._solution = part("found", _layout.FOUND_WORDS).view(_layout.FOUND)
        self._step = np.zeros(nv)
        #: Scratch for the least forces, and these forces, of redundant rows (``force_kernels.least_forces``).
        self.least_room = np.zeros(2 * every * (every + 1))
        self.least = np.zeros(every)
        #: All of J, in metres, rows of elements that hold included, and the residuals.
        self.every_row = part("jacobian", nv, int(head["width"]))[:, :every].T
        self.every_gap, self.every_speed = part("gap", every), part("speed", every)
        self._loads, self._holds = np.zeros(len(plan.motions) + len(plan.couplings) + holds), holds
        parts = plan.parts
        slides = [plan.words[parts.motions].view(_layout.DRIVEN)["slides"]]
        slides.append(plan.words[parts.couplings].view(_layout.COUPLED)["slides"])
        #: Whether the rows of motions and couplings, which come first, are of angles.
        self.turning = np.concatenate(slides) == 0

    @property
    def solution(self) -> Solution:
        """Numbers of the last solution."""
        return Solution._make(self._solution.item())

    @property
    def residual(self) -> tuple[float, float, float, float]:
        """The largest residuals of the rows that were written last [m], [rad], [m/s], [rad/s]."""
        found = self.solution
        return found.gap, found.turn, found.speed, found.spin

    def accelerate(self, t: float, y: Array, program: Array, effort: Array, rates: Array) -> None:
        """Write accelerations, and powers of motions.

        Args:
            t: Time [s].
            y: State [q, v, x].
            program: Program of the system's elements.
            effort: Generalized force of the elements, (nv,).
            rates: Written, (nv + nx,).
        """
        nq, model, data = self.model.nq, self.model, self.data
        mass, q, v = pin.crba(model, data, y[:nq]), y[:nq], y[nq : nq + self.nv]
        bias = pin.nonLinearEffects(model, data, q, v)
        loaded_kernels.accelerate(t, y, program, self.plan.words, self.work, effort, mass, bias, rates)

    def loads(self) -> Array:
        """Return loads of holding elements in the last solved state, (holds,) [N m] or [N]."""
        force_kernels.joint_forces(self.plan.words, self._all_forces, self._loads)
        return self._loads[len(self._loads) - self._holds :]

    def residuals(self, t: float, y: Array, program: Array) -> Solution:
        """Write the rows of a state; return what is found, with the largest residuals."""
        rows_kernels.write_rows(t, y, program, self.plan.words, self.work)
        return self.solution

    def mass(self, q: Array) -> Array:
        """Return the mass matrix of the constraints, (nv, nv), with couplings where necessary."""
        matrix = mass_matrix(self.model, self.data, q)
        factor_kernels.brace(self.plan.words, matrix)
        return matrix

    def factorize(self, q: Array) -> None:
        """Factorize the rows that were written last."""
        factor_kernels.factorize(self.plan.words, self.work, pin.crba(self.model, self.data, q))

    def step(self, *, of_speed: bool) -> Array:
        """Return the generalized step of least kinetic energy that removes the residuals, (nv,).

        The rows must be factorized. The array is the same each time.
        """
        solve_kernels.correction(self.plan.words, self.work, of_speed, self._step)
        return self._step

    def closed_at(self, t: float, y: Array, program: Array) -> bool:
        """Return whether the residuals of a state are round-off, of positions and of velocities."""
        self.residuals(t, y, program)
        return self._in_place() and self._in_motion()

    def _in_place(self) -> bool:
        found = self.solution
        return bool(found.gap <= CLOSED * self.plan.length and found.turn <= CLOSED)

    def _in_motion(self) -> bool:
        found = self.solution
        return bool(found.speed <= CLOSED * self.plan.length and found.spin <= CLOSED)

    def project(self, t: float, y: Array, program: Array, retract: Callable[[Array, Array], None]) -> bool:
        """Correct a state of small residuals onto the constraints, in place.

        Corrections are the least ones in kinetic energy, which conserves momentum.

        Args:
            t: Time [s].
            y: State [q, v, x].
            program: Program of the system's elements.
            retract: ``(y, step)``: moves the configuration in y by a generalized step.

        Returns:
            Whether it is closed; if not, the state is invalid.
        """
        nq, nv = self.model.nq, self.nv
        self.residuals(t, y, program)
        at_rest = self._in_place()
        length = self.plan.length
        last = np.maximum(self.solution.gap, self.solution.turn * length)  # NaN if any is NaN
        # The rows hardly change in such a correction: one factorization suffices, else another is made.
        near = last < NEAR * length
        self.factorize(y[:nq])
        for _ in range(ROUNDS):
            if at_rest:
                break
            retract(y, self.step(of_speed=False))
            found = self.residuals(t, y, program)
            now = np.maximum(found.gap, found.turn * length)
            at_rest = self._in_place() or now > 0.5 * last
            last = now
            if not near:
                self.factorize(y[:nq])
        y[nq : nq + nv] += self.step(of_speed=True)
        return bool(last <= OPEN * length)


# --- plan ---------------------------------------------------------------------------------------------------


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
        record["slides"], record["turn"] = slot.slides, one.turn
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
        follower, leader, third = (1.0 if slot.slides else length for slot in slots)
        largest = max(abs(multiplier) * follower / leader, abs(further) * follower / third)
        record["row"], record["slides"] = row + k, slots[0].slides
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
