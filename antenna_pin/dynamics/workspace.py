"""Workspace of a run: buffers, contact memory, Pinocchio's data and coal's objects."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.records import CONTACT, MEMORY, PLANE, POSE, memory_records, words_of
from antenna_pin.contact.onset import approach_speed_in_contact
from antenna_pin.dynamics import kernels, link_kernels, point_kernels, query_kernels, trial_kernels
from antenna_pin.dynamics.constraints import Constraints
from antenna_pin.dynamics.links import OnLinksInPython
from antenna_pin.dynamics.system import System
from antenna_pin.errors import FunctionError
from antenna_pin.integrate.manifold_kernels import FACTOR, SPACE_WORDS
from antenna_pin.joints import PythonPath
from antenna_pin.joints.geometry.coal_query_kernels import most_words
from antenna_pin.joints.kernels import unit_normal_force
from antenna_pin.joints.layout_kernels import JOINT, JOINT_WORDS
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.mechanism import PLACE, body_tree
from antenna_pin.mechanism.tree_kernels import place_bodies

Array = NDArray[np.float64]

ON_SURFACE = 1e-15  # [m]: a starting gap this small is a gap of zero


class Workspace:
    """Workspace for a system's equations of motion; one for each run.

    As with Pinocchio's ``model, data`` two workspaces of one system do not see each other.

    Args:
        system: The system.
        memory: Contact memory, (contacts, 3); nothing touches if not given (see
            :func:`antenna_pin.dynamics.contact_memory`).

    Attributes:
        memory: The contact memory that the derivative uses, :data:`antenna_pin.base.records.MEMORY`,
            (contacts,); to be written to.
        table: Contact table of the last evaluation, :data:`antenna_pin.base.records.CONTACT`, (rows,).
        tau: Generalized force of the elements at the last evaluation, (nv,).
        paths: What happens in Python, of the joints of which anything does.
        program: The system's program, with the values of drives in Python of the last evaluation.
    """

    @functools.cached_property
    def data(self) -> Any:
        """Pinocchio's buffers, allocated at first use: they grow with the cube of the freedoms."""
        return self.model.createData()

    def __init__(self, system: System, memory: ArrayLike | None = None) -> None:
        """Allocate everything once, but for what only Pinocchio needs."""
        self.system = system
        self.model = system.model
        self.manifold = system.manifold
        self.program = system.program.copy()
        nv, contacts = self.model.nv, len(system.contact_names)
        first = nv + words_of(POSE)
        table = first + words_of(MEMORY) * contacts
        end = table + system.rows * words_of(CONTACT)
        # Behind the table is room for what may be asked of coal.
        most = [
            most_words(joint.contacts, joint.strips * (joint.load == "distributed"), joint.sectors)
            for joint in system.clearances
        ]
        room = np.zeros(end + sum(most) + query_kernels.HEAD * len(most))
        self.tau = room[:nv]
        self._pose = room[nv:first].view(POSE)
        self.memory = room[first:table].view(MEMORY)
        self.table = room[table:end].view(CONTACT)
        if memory is not None:
            self.memory[:] = memory_records(memory)
        self.paths: list[PythonPath] = []
        for joint in system.clearances:
            start = system.clearance_blocks[joint.name]
            head = self.program[start : start + JOINT_WORDS].view(JOINT)
            block = self.program[start : start + int(head["length"][0])]
            path = joint.python_path(block, self.memory, self.table, self.model.nq)
            if path is None:
                continue
            self.paths.append(path)
            if path.queried is None:
                continue
            words = query_kernels.HEAD + path.queried.words
            queried = room[end : end + query_kernels.HEAD].view(query_kernels.QUERIED)
            queried["block"], queried["words"] = start, words
            path.queried.take(room[end + query_kernels.HEAD : end + words])
            end += words
        backends = [path.queried for path in self.paths if path.queried is not None]
        #: Whether machine code evaluates coal's distances: of all joints that can be asked so, or of none.
        self.is_queried = bool(backends) and all(one.evaluator is not None for one in backends)
        self._backends = backends
        #: Those of the paths that are Python's to go.
        self.python_paths = [path for path in self.paths if path.queried is None or not self.is_queried]
        #: Array that contains ``tau``, a pose, ``memory`` and ``table``, as kernels require it.
        self.work = room[:end]
        #: Those whose gaps are what a backend measures and nothing else.
        self.measured = [path for path in self.paths if path.measured]
        #: Those whose laws no compiled look at a contact can ask: in Python, or on gaps that are measured.
        self.asked_laws = [path for path in self.paths if path.measured or not path.compiled]
        #: Whether each drive in Python is on at present.
        self._on = [
            self.program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)["on"]
            for block, *_ in system.callables
        ]
        factors = self.manifold.layout[SPACE_WORDS:].view(FACTOR)
        #: Where in q and in v joints are that move in a plane.
        self._planes = [(int(one["q"]), int(one["v"])) for one in factors if one["kind"] == PLANE]
        #: The bodies, and room for where they are, if elements on links ask for that.
        self._bodies: tuple[NDArray[Any], NDArray[Any]] | None = None
        if system.point_springs or system.forces:
            tree = body_tree(system.mechanism)
            self._bodies = tree, np.zeros(len(tree) + 1, PLACE)
        #: What is held besides the tree; None if nothing is.
        self.constraints = None if system.plan is None else Constraints(system.plan, self.model, self.data)

    @property
    def bodies(self) -> NDArray[Any] | None:
        """Bodies of elements on links, BODY, (bodies,); None without such elements."""
        return None if self._bodies is None else self._bodies[0]

    @property
    def coupled(self) -> NDArray[np.int64]:
        """Places in x of what the derivative depends on: bristles, states; the rest are integrals."""
        return np.asarray(self.system.bristle_x, dtype=np.int64)

    def acceleration(self, t: float, y: Array, tau: Array) -> Array:
        """Return the acceleration of a state under a generalized force, constraints held, (nv,)."""
        if self.constraints is not None:
            self.prepare_motions(t, y)
        return self._accelerate(t, y, tau)

    def _accelerate(self, t: float, y: Array, tau: Array) -> Array:
        nq, nv = self.model.nq, self.model.nv
        if self.constraints is None:
            found: Array = pin.aba(self.model, self.data, y[:nq], y[nq : nq + nv], tau)
            return found
        rates = np.zeros(nv + self.manifold.nx)
        self.constraints.accelerate(t, y, self.program, tau, rates)
        return rates[:nv]

    def prepare_motions(self, t: float, y: Array) -> None:
        """Write the numbers of Python elements at time t [s] and state y."""
        for on, one in zip(self._on, self.system.callables, strict=True):
            if on[0] == 0.0:
                continue
            if isinstance(one, OnLinksInPython):
                assert self._bodies is not None
                one.write(self.program, t, y, *self._bodies)
                continue
            angle, rate, _, _ = kernels.joint_motion(self.program, one.block, y, self.model.nq)
            self.program[one.words] = one.values(t, angle, rate)

    def tell_energies(self, y: Array) -> None:
        """Evaluate the stored energy of Python elements on links at their last time."""
        for on, one in zip(self._on, self.system.callables, strict=True):
            if on[0] != 0.0 and isinstance(one, OnLinksInPython) and one.element.passive:
                assert self._bodies is not None
                one.write(self.program, None, y, *self._bodies)

    def see_on_links(self, block: int, t: float, y: Array, element: Any) -> None:
        """Write the action of an element on links, by program place, to its desk."""
        assert self._bodies is not None
        if getattr(element, "called", True):
            place_bodies(y, self.model.nq, *self._bodies)
            link_kernels.see(t, y, self.program, block, self._bodies[1])
            link_kernels.do(self.program, block)
        else:
            one = OnLinksInPython(block, element, "", self.model.nq)
            one.write(self.program, t, y, *self._bodies)

    def kink_on_links(self, block: int, t: float, y: Array) -> float:
        """Return the kink function of an element on links, by program place."""
        assert self._bodies is not None
        self.prepare_motions(t, y)
        return float(link_kernels.kink_on_links(t, y, self.program, block, *self._bodies))

    def locate(self, y: Array, table: NDArray[Any]) -> None:
        """Fill gap, normal, point, rate and slip of all contacts by event location.

        That is the closed form where there is one, coal's gaps being those; else it is the backend.
        """
        trial_kernels.contacts_in(y, self.program, self._pose, table)
        self.measure_into(table, y)

    def measure_into(self, table: NDArray[Any], y: Array, contact: int = -1) -> None:
        """Fill the rows of a contact's joint, or of all (-1), with backend gaps."""
        for path in self.measured:
            if contact < 0 or contact in path:
                path.locate(y, table)

    def ask_laws(self, table: NDArray[Any], contact: int = -1) -> None:
        """Write the normal forces of a contact, or of all (-1), by Python laws."""
        for path in self.asked_laws:
            path.ask_laws(table, contact)

    def measure(self, y: Array) -> None:
        """Update all rows of ``table`` for a state: gap, normal, point and rates.

        The derivative itself updates the touching contacts only. Coal's gaps are requested where it is the
        backend.
        """
        trial_kernels.contacts_in(y, self.program, self._pose, self.table)
        if self.is_queried and query_kernels.answer_queries(y, self.program, self.work, True):
            raise self.failed_query()
        for path in self.python_paths:
            path.prepare(y, everything=True)

    def prepare(self, t: float, y: Array) -> None:
        """Do what of the elements happens in Python: gaps, laws, numbers of drives."""
        for path in self.python_paths:
            path.prepare(y)
        self.prepare_motions(t, y)

    def asked_in_steps(self) -> Callable[[float, Array], None]:
        """Return an equivalent of :meth:`prepare` with coal's queries in compiled code."""
        queried = [] if self.is_queried else [one.answer for one in self._backends]
        paths = [path.prepare for path in self.paths if path.queried is None]
        motions = self.prepare_motions if self.system.callables else None

        def ask(t: float, y: Array) -> None:
            for answer in queried:
                answer()
            for prepare in paths:
                prepare(y)
            if motions is not None:
                motions(t, y)

        return ask

    @property
    def coal_failure(self) -> FunctionError | None:
        """Exception of coal in machine code, as an error; None without any."""
        return next((one.failure for one in self._backends if one.failed), None)

    def failed_query(self) -> FunctionError:
        """Return the exception of a query that has failed in machine code."""
        found = self.coal_failure
        assert found is not None
        return found

    def apply_elements(self, t: float, y: Array, rates: Array) -> None:
        """Evaluate the elements: ``tau``, the contacts' ``table``, and x rates behind rates[nv]."""
        self.prepare(t, y)
        if not self.is_queried:
            kernels.evaluate(t, y, self.program, self.work, rates)
        elif query_kernels.evaluate_queried(t, y, self.program, self.work, rates):
            raise self.failed_query()
        if self._bodies is not None:
            link_kernels.add_forces(t, y, self.program, *self._bodies, self.tau, rates)
            if self.constraints is not None:
                link_kernels.write_wrenches(self.program, self._bodies[1], self.constraints.applied)

    def derivative(self, t: float, y: Array, rates: Array) -> None:
        """Write [acceleration (nv), rate of x (nx)] at t [s] and y into rates.

        For occasional calls; the steps of a run have the same compiled
        (:mod:`antenna_pin.run.engine`).
        """
        self.apply_elements(t, y, rates)
        if self.constraints is not None:
            self.constraints.accelerate(t, y, self.program, self.tau, rates)
        else:
            rates[: self.model.nv] = self._accelerate(t, y, self.tau)

    def hold(self, t: float, y: Array, program: Array) -> None:
        """Bring a state onto a program's holds, in place, without bookkeeping."""
        assert self.constraints is not None
        present = self.program.copy()
        self.program[:] = program
        try:
            self.prepare_motions(t, y)
            self.constraints.project(t, y, self.program, self.retract)
        finally:
            self.program[:] = present

    def retract(self, y: Array, step: Array) -> None:
        """Move the configuration in y, in place, by a tangent step, (nv,).

        Pinocchio's own divides by the turn what cancels except for that, where a joint moves in a plane: of a
        turn of 1e-13 rad a step keeps three digits.
        """
        there = pin.integrate(self.model, y[: self.model.nq], step)
        for i, j in self._planes:
            there[i : i + 2] = _moved_in_plane(y[i : i + 4], step[j : j + 3])
        y[: self.model.nq] = there

    def lengths(self, y: Array) -> Array:
        """Return the lengths of the springs between points, (springs,) [m]; 0 where points coincide."""
        stretches = np.zeros(len(self.system.point_springs), point_kernels.STRETCH)
        if self._bodies is not None:
            tree, places = self._bodies
            place_bodies(y, self.model.nq, tree, places)
            point_kernels.look_at(self.program, places, stretches)
        return np.asarray(stretches["length"])

    def first_memory(self, y: Array) -> NDArray[Any]:
        """Return the memory of a state without one (:func:`antenna_pin.dynamics.contact_memory`)."""
        table = np.zeros_like(self.table)
        self.locate(y, table)
        memory = np.zeros_like(self.memory)
        for c, floor in enumerate(self.system.approach_speed_floors):
            if table[c].gap <= ON_SURFACE:
                speed = approach_speed_in_contact(-float(table[c].gap), float(table[c].rate), floor)
                memory[c] = 1.0, speed, self.effective_mass(y, c)
        return memory

    def effective_mass(self, y: Array, contact: int) -> float:
        """Return the mass that an impact along a contact's normal sees there and then [kg].

        With the normal's direction n in the space of generalized velocities, of the material points at the
        contact, it is ``(n^T M^-1 n)^-1``: the acceleration along n under a unit force gives it, constraints
        included.

        Args:
            y: State [q, v, x].
            contact: Number of the contact.
        """
        nq, nv = self.model.nq, self.model.nv
        direction, _ = self.along_normal(y, contact)
        at_rest = y.copy()
        at_rest[nq : nq + nv] = 0.0
        # What motions ask for, and gravity, goes in the difference.
        free = np.array(self._accelerate(0.0, at_rest, np.zeros(nv)))
        return float(1.0 / (direction @ (self._accelerate(0.0, at_rest, direction) - free)))

    def along_normal(self, y: Array, contact: int) -> tuple[Array, float]:
        """Return a contact's normal in the space of generalized velocities, (nv,), and its gap [m].

        With the velocity of a state it gives the rate at which the gap opens, and as a generalized force it
        is a unit force along the normal.

        Args:
            y: State [q, v, x].
            contact: Number of the contact.
        """
        pose, table = np.zeros(1, POSE), np.zeros_like(self.table)
        self.locate(y, table)
        block = self.system.block_of_contact[contact]
        place_journal(self.program, block, y, self.model.nq, pose)
        direction = np.zeros(self.model.nv)
        unit_normal_force(self.program, block, pose, table, contact, direction)
        return direction, float(table[contact].gap)


def _moved_in_plane(place: Array, way: Array) -> tuple[float, float]:
    """Return x and y after a planar motion at constant velocity in body axes.

    The place is x, y, cosine and sine of the turn; the way is in body axes, with the turn.
    """
    x, y, c, s = place.tolist()
    u, v, turn = way.tolist()
    along = math.sin(turn) / turn if turn != 0.0 else 1.0
    across = along * math.tan(0.5 * turn)  # (1 - cos) / turn, of which no digits cancel
    u, v = along * u - across * v, across * u + along * v
    return x + c * u - s * v, y + s * u + c * v
