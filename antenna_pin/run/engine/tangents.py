"""Derivatives of a system's rates along displacements, cheaper than evaluations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import MEMORY, POSE, PROGRAM, words_of
from antenna_pin.compiled.decorators import in_python
from antenna_pin.dynamics import System, acting_in, kernels
from antenna_pin.dynamics.angle_change_kernels import MOST, ROWS
from antenna_pin.dynamics.constraints.layout_kernels import plan_of
from antenna_pin.dynamics.constraints.tangent_kernels import TIE
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.dynamics.tangent_kernels import ASKED, EFFORTS
from antenna_pin.dynamics.tangent_room_kernels import RowRoom, Shifts, TangentRoom
from antenna_pin.integrate import manifold_kernels
from antenna_pin.joints import layout_kernels, motion_change_kernels, slope_kernels
from antenna_pin.joints.geometry.kernels import CANDIDATE
from antenna_pin.joints.tangent_room_kernels import PART
from antenna_pin.mechanism import CHANGE, LANES, PLACE, ROOM, freedoms_below
from antenna_pin.run.engine.compiled import CompiledStepper
from antenna_pin.run.engine.impact_kernels import CLOSING, HEAVIER, MET, OPENING, write_met
from antenna_pin.run.engine.shifts import SystemSlopes, head_in, shifts_of, takes_slopes
from antenna_pin.run.engine.tangent_kernels import write_tangent

Array = NDArray[np.float64]


class Tangents:
    """Derivatives of a system's rates, assembled from those of its parts.

    The same as :class:`antenna_pin.run.engine.Slopes` by differences of the whole, with errors of round-off
    instead of the round-off of forces over a step: geometry, laws and elements are differentiated with
    respect to their own arguments, the tree and constraints in closed form. Each part has its own scale,
    refined near a kink. Not supported are friction under the load of an ideal joint, distributed loads, and
    gaps, laws or elements in Python (:meth:`takes`).

    Args:
        system: The system.
        stepper: Its stepper, at its present contact memory and program.
        units: Scales of displacements, rates and bristles, (2 nv + bristles,).
        weights: Weights of differences at 1, 2, ... steps, of sixth and of fourth order, (2, points).

    Attributes:
        room: Arrays of the kernels.
    """

    def __init__(self, system: System, stepper: CompiledStepper, units: Array, weights: Array) -> None:
        """Allocate once."""
        numbers, manifold = stepper.numbers, stepper.manifold
        nv, nx, contacts = manifold.nv, manifold.nx, len(numbers.memory)
        parts, links_x = _parts(system)
        bristles = np.asarray(system.bristle_x, dtype=np.int64)
        bristle_of = np.full(nx, -1, dtype=np.int64)
        bristle_of[bristles] = np.arange(len(bristles))
        of_parts = [int(part["freedoms"].sum() + part["x_end"] - part["x"]) + EFFORTS for part in parts]
        values, kinds = max(motion_change_kernels.LOOKED, *of_parts, nv + nx), len(weights)
        asked = slope_kernels.A_BRISTLE + slope_kernels.STATES
        said = slope_kernels.V_BRISTLE + slope_kernels.STATES
        self._answers = stepper.answers
        self._system, self._stepper, self._said = system, stepper, said
        self.room = TangentRoom(
            numbers=numbers,
            parts=parts,
            links_x=np.array([links_x]),
            weights=weights,
            layout=manifold.layout,
            bristles=bristles,
            bristle_of=bristle_of,
            units=np.ascontiguousarray(units),
            below=freedoms_below(numbers.tree),
            asks=np.zeros(2, dtype=np.int64),
            state=np.zeros((1, manifold.size)),
            step=np.zeros(nv),
            tau=np.zeros(nv),
            rates=np.zeros(nv + nx),
            drift=np.zeros(nx),
            poses=np.zeros(3, POSE),
            remembered=np.zeros(1, MEMORY),
            freedoms=np.zeros(max(nv, 6)),
            looked=np.zeros(values),
            change=np.zeros((kinds, motion_change_kernels.LOOKED)),
            shapes=np.zeros((2, CANDIDATE)),
            wrench=np.zeros((kinds, 6)),
            carried=np.zeros(6),
            trial=np.zeros((kinds + 2, max(values, said))),
            column=np.zeros((kinds, values)),
            middle=np.zeros(max(values, said)),
            sides=np.zeros((2, ROWS, MOST)),
            over=np.zeros(0, dtype=np.int64),
            of_law=np.zeros((0, kinds, values)),
            asked=np.zeros(asked),
            said=np.zeros(said),
            laws=np.zeros((contacts, asked, kinds, said)),
            places=_places(numbers),
            room=np.zeros(len(numbers.tree) + 1, ROOM),
            mass=np.zeros((nv, nv)),
            lanes=np.zeros((nv, LANES)),
            acceleration=np.zeros(nv),
            bodies=np.zeros(len(numbers.tree) + 1, CHANGE),
            body=np.zeros(1, CHANGE),
            first_number=np.array([2 * nv + len(bristles) + 2 * contacts]),
            seen=np.zeros(0, dtype=np.int64),
            shifts=self._shifts(_none(numbers), parts),
            rows=_row_room(system, nv, kinds),
        )
        self._rates = nv + nx
        self._number(self.room.shifts)
        self._joints = {int(one["block"]): k for k, one in enumerate(parts) if not one["element"]}

    def _number(self, shifts: Shifts) -> None:
        """Take numbers of the system as parts of displacements."""
        room, count = self.room, len(shifts.steps)
        parts: NDArray[Any] = room.parts
        slots = ASKED + int((parts["bristle_end"] - parts["bristle"]).max(initial=0)) + count + 1
        self.room = room._replace(
            shifts=shifts,
            seen=np.zeros(count, dtype=np.int64),
            over=np.zeros(slots, dtype=np.int64),
            of_law=np.zeros((slots, *room.column.shape)),
        )

    def _shifts(self, slopes: SystemSlopes, parts: NDArray[Any]) -> Shifts:
        return shifts_of(self._system, self._stepper, parts, self._said, slopes)

    def follow(self, slopes: SystemSlopes) -> bool:
        """Append numbers of the system to displacements, after the contact memory.

        Returns:
            Whether all are supported; none are appended if not.
        """
        if not takes_slopes(self._system, slopes):
            return False
        self._number(self._shifts(slopes, self.room.parts))
        return True

    @staticmethod
    def takes(system: System) -> bool:
        """Return whether a system's rates are differentiated part by part."""
        return Tangents.knows_contacts(system) and all(j.load == "point" for j in system.clearances)

    @staticmethod
    def knows_contacts(system: System) -> bool:
        """Return whether derivatives at onsets are known (:meth:`impact`, :meth:`opening`)."""
        compiled = all(j.compiled and j.backend == "closed-form" for j in system.clearances)
        loaded = system.plan is not None and system.plan.loaded
        return compiled and not loaded and not system.callables

    def rates(self, time: float, y: Array, ways: Array, steps: Array) -> Array:
        """Return the derivatives of [acceleration (nv), rate of x (nx)], (2, nv + nx, k).

        They are differences of sixth and of fourth order, where differences are used.

        Args:
            time: [s].
            y: State.
            ways: Displacements in the layout of :mod:`antenna_pin.run.engine.slope_kernels`, (displacement,
                k).
            steps: Steps of differences along them, (k,), for time and for elements on links.
        """
        out = np.zeros((len(self.room.weights), ways.shape[1], self._rates))
        write_tangent(time, np.ascontiguousarray(y), np.ascontiguousarray(ways.T), steps, self.room, out)
        self._answers.check()
        return np.asarray(out.transpose(0, 2, 1))

    def opening(self, y: Array, contact: int, ways: Array) -> Array:
        """Return the change of a contact's gap along displacements [m], (k,).

        Args:
            y: State.
            contact: Its number; it need not touch.
            ways: As for :meth:`rates`.
        """
        return self._met(y, contact, ways, False)[:, OPENING]

    def impact(self, y: Array, contact: int, ways: Array) -> tuple[Array, Array]:
        """Return the changes of a contact's memory of an onset along displacements, (k,) each.

        They are the approach speed [m/s], and the logarithm of the effective mass.

        Args:
            y: State of the onset.
            contact: Its number.
            ways: As for :meth:`rates`.
        """
        found = self._met(y, contact, ways, True)
        return found[:, CLOSING], found[:, HEAVIER]

    def _met(self, y: Array, contact: int, ways: Array, masses: bool) -> Array:
        out = np.zeros((ways.shape[1], MET))
        joint = self._joints[self._system.block_of_contact[contact]]
        y, ways = np.ascontiguousarray(y), np.ascontiguousarray(ways.T)
        write_met(joint, contact, y, ways, masses, self.room, out)
        return out


def _parts(system: System) -> tuple[NDArray[Any], int]:
    """Return the parts at joints, ``PART``, and the start of links' integrals in x."""
    factor_of, found, links_x = _factors(system), [], system.manifold.nx
    for block in system.clearance_blocks.values():
        joint = system.program[block:][: layout_kernels.JOINT_WORDS].view(layout_kernels.JOINT)[0]
        if joint["contacts"] > 0:
            part = np.zeros(1, PART)
            part["block"], part["v"][0, 0] = block, joint["v"]
            part["factor"][0, 0] = factor_of[int(joint["v"])]
            found.append(part)
    bristles = np.asarray(system.bristle_x)
    for acting in acting_in(system):
        head = head_in(system, acting.block)
        if acting.block >= int(system.program[: kernels.HEADER].view(PROGRAM)[0]["points"]):
            links_x = min(links_x, int(head["x"]))
            continue
        part = np.zeros(1, PART)
        part["element"], part["block"] = 1, acting.block
        part["x"], part["x_end"] = head["x"], int(head["x"]) + len(acting.element.integrals)
        own = (bristles >= part["x"][0]) & (bristles < part["x_end"][0])
        first = int(np.argmax(own)) if own.any() else 0
        part["bristle"], part["bristle_end"] = first, first + int(own.sum())
        other = int(head["partner"]) or int(head["sensed"])
        heads = [head, head_in(system, acting.block + other)] if other else [head]
        if other and heads[1]["v"] == head["v"]:
            heads = heads[:1]
        for s, one in enumerate(heads):
            part["v"][0, s], part["freedoms"][0, s] = _freedoms(system, one)
            part["factor"][0, s] = factor_of[int(one["v"])]
        found.append(part)
    parts = np.concatenate([np.zeros(0, PART), *found])
    parts["number"] = np.arange(len(parts))
    return parts, links_x


def _none(numbers: Numbers) -> SystemSlopes:
    """Return that no numbers of a system are displaced."""
    tree = np.zeros((0, numbers.tree.view(np.float64).size))
    nothing = np.zeros(0, dtype=np.int64)
    program, plan = np.zeros((0, len(numbers.program))), np.zeros((0, len(numbers.plan)))
    return SystemSlopes(program, tree, plan, np.zeros((0, 3)), nothing, np.zeros(0))


def _places(numbers: Numbers) -> NDArray[Any]:
    """Return where the kernels write where bodies are: where constraints do, if there are any."""
    bodies = len(numbers.tree) + 1
    if not len(numbers.plan):
        return np.zeros(bodies, PLACE)
    return np.asarray(numbers.held[: bodies * words_of(PLACE)].view(PLACE))


def _row_room(system: System, nv: int, kinds: int) -> RowRoom:
    """Return what rows of constraints are differentiated with."""
    closures = motions = rows = width = 0
    if system.plan is not None:
        head = in_python(plan_of)(system.plan.words)
        closures, motions, rows, width = head.closures, head.motions, head.rows, head.width
    return RowRoom(
        ties=np.zeros(closures, TIE),
        bias=np.zeros(nv),
        force=np.zeros(rows),
        force_change=np.zeros(rows),
        lacks=np.zeros((kinds, width)),
        speeds=np.zeros(motions),
        twist=np.zeros(4),
        wanted=np.zeros(motions),
        trial=np.zeros((kinds + 2, motions)),
        jerks=np.zeros((kinds, motions)),
        column=np.zeros((kinds, motions)),
    )


def _freedoms(system: System, head: np.void) -> tuple[int, int]:
    """Return first and number of the freedoms that affect the joint of an element's head.

    An element at a joint's angle does not depend on the place of the journal in its bearing.
    """
    first = int(head["v"])
    if head["play"] < 0:
        return first, 1
    joint = system.program[int(head["play"]) :][: layout_kernels.JOINT_WORDS].view(layout_kernels.JOINT)[0]
    every, turns = (3, 1) if joint["planar"] else (6, 3)
    if joint["slides"] or head["about"] == kernels.ABOUT_POSE:
        return first, every
    return first + every - turns, turns


def _factors(system: System) -> dict[int, int]:
    """Return the factor of the configuration space that each freedom is of."""
    layout, words = system.manifold.layout, manifold_kernels.FACTOR_WORDS
    factors = layout[manifold_kernels.SPACE_WORDS :].view(manifold_kernels.FACTOR)
    assert len(layout) == manifold_kernels.SPACE_WORDS + words * len(factors)
    return {int(one["v"]) + k: f for f, one in enumerate(factors) for k in range(int(one["nv"]))}
