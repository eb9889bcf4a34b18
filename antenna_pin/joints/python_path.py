"""Python parts of a joint with play: backend distances and Python laws."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import AskedFunction, told_numbers
from antenna_pin.base.records import POSE
from antenna_pin.compiled.given_functions import callable_of
from antenna_pin.contact import FrictionLaw, NormalLaw
from antenna_pin.contact.kernels import elastic_energy, elastic_force, friction_force, normal_force
from antenna_pin.contact.normal import normal_questions
from antenna_pin.joints import kernels
from antenna_pin.joints.geometry import Distances
from antenna_pin.joints.geometry.coal_backend import CoalBackend
from antenna_pin.joints.geometry.coal_patches import PatchLayout
from antenna_pin.joints.geometry.coal_revolute import CoalRevolute
from antenna_pin.joints.layout_kernels import JOINT, JOINT_WORDS, tail_of
from antenna_pin.joints.pose_kernels import place_journal

Array = NDArray[np.float64]

_ROW = ("gap", "rate", "slip", "force", "friction", "elastic")


def has_code(law: object) -> bool:
    """Return whether a law runs compiled."""
    return hasattr(law, "code") and getattr(law, "is_compiled", True)


def range_of(law: NormalLaw) -> float:
    """Return the depth limit of a law [m]."""
    return float(getattr(law, "depth_limit", math.inf))


def functions_of_law(law: NormalLaw, place: str) -> tuple[AskedFunction, ...]:
    """Return the functions of a normal law: force, elastic part, energy."""
    return tuple(
        AskedFunction(f"{place}: {name}", callable_of(function, len(words)), told_numbers(words))
        for name, function, words in normal_questions(law)
    )


def coefficient_of(law: Any, place: str) -> AskedFunction:
    """Return the function of a friction law of the slip speed for a run."""
    told = told_numbers([("slip speed", "m/s")])
    return AskedFunction(f"{place}: friction law: coefficient", callable_of(law.coefficient, 1), told, 0.0)


class LawInRun:
    """Normal law of a contact in a run, with its mass and beyond its range.

    There a compiled law is continued by its kernel, and one in Python is called at the end of its range.

    Args:
        law: The law.
        place: Owner of the law, for messages about its functions.
    """

    __slots__ = ("_code", "_elastic_energy", "_elastic_force", "_force", "_limit")

    def __init__(self, law: NormalLaw, place: str) -> None:
        """Compose a compiled law's numbers once."""
        known: Any = law
        self._code = known.code() if has_code(law) else None
        self._limit = range_of(law)
        self._force, self._elastic_force, self._elastic_energy = functions_of_law(law, place)

    def forces(self, depth: float, rate: float, approach_speed: float, mass: float) -> tuple[float, float]:
        """Return elastic and whole normal force [N] at a positive depth."""
        if self._code is not None:
            force = float(normal_force(self._code, depth, rate, approach_speed, mass))
            return float(elastic_force(self._code, depth)), force
        within = min(depth, self._limit)
        return self._elastic_force(within), max(0.0, self._force(within, rate, approach_speed))

    def energy(self, depth: float) -> float:
        """Return the energy stored at a positive depth [J]."""
        if self._code is not None:
            return float(elastic_energy(self._code, depth))
        return self._elastic_energy(min(depth, self._limit))


class PythonPath:
    """Parts of a clearance joint outside the fused kernel.

    Args:
        block: The joint's numbers.
        memory: Contact memory of the system, :data:`antenna_pin.base.records.MEMORY`.
        table: Contact table of the system, :data:`antenna_pin.base.records.CONTACT`.
        nq: Size of the configuration: start of velocities in a state.
        distances: Backend; None for the compiled closed form.
        laws: Its normal laws, one for each contact, and the owner of each, as text.
        friction: Its friction law if laws run in Python, None if all are compiled; and its owner.
        is_measured: Whether no closed form is known for the gaps of ``distances``.
    """

    def __init__(
        self,
        block: Array,
        memory: NDArray[Any],
        table: NDArray[Any],
        nq: int,
        distances: Distances | None,
        laws: Sequence[tuple[NormalLaw, str]],
        friction: tuple[FrictionLaw, str] | None,
        is_measured: bool = False,
    ) -> None:
        """Build the buffers once."""
        #: Whether ``distances`` is the only source of its gaps.
        self.measured = is_measured
        #: Whether all its laws are compiled.
        self.compiled = friction is None
        self._given_laws = laws
        self._friction: Any = None if friction is None else friction[0]
        self._coefficient = None
        if friction is not None and not has_code(friction[0]):
            self._coefficient = coefficient_of(*friction)
        self._block = block
        self._nq = nq
        head = block[:JOINT_WORDS].view(JOINT)
        #: Row of its first contact.
        self.row = int(head["row"][0])
        self._distributed = bool(head["distributed"][0])
        self._pose = np.zeros(1, POSE)
        if bool(head["distributed"][0]) and isinstance(distances, CoalRevolute):
            (patches,), nodes = tail_of(block)
            first = int(patches["first"]) - self.row
            distances = distances.patches(
                PatchLayout(int(patches["strips"]), first, float(patches["radius"]), nodes)
            )
        self._distances = distances
        #: Function that queries coal, if touching contacts need nothing else in Python.
        self.queried: CoalBackend | None = None
        if self.compiled and isinstance(distances, CoalBackend):
            self.queried = distances
        self._table = table
        # The joint's rows by name: a look-up costs as much as a query of coal.
        rows = slice(self.row, self.row + len(laws))
        self._memory = memory[rows]
        self._touching: Array = memory["touching"][rows]
        self._rows: dict[str, Array] = {name: table[name][rows] for name in _ROW}

    @functools.cached_property
    def laws(self) -> tuple[LawInRun, ...]:
        """Laws, one for each contact, made at first use: kernels call most of them."""
        return tuple(LawInRun(*law) for law in self._given_laws)

    def locate(self, y: Array, table: NDArray[Any]) -> None:
        """Fill gap, normal, point, rate and slip of the joint's rows, by the backend."""
        assert self._distances is not None
        place_journal(self._block, 0, y, self._nq, self._pose)
        self._distances.query(self._pose, table, self.row)
        kernels.rates_alone(self._block, 0, table, self._pose)

    def __contains__(self, contact: int) -> bool:
        """Return whether a contact, by its number, belongs to the joint."""
        return self.row <= contact < self.row + len(self._given_laws)

    def ask_laws(self, table: NDArray[Any], contact: int) -> None:
        """Write the normal forces of a contact, or of all (-1), from its gaps."""
        for c, law in enumerate(self.laws, self.row):
            if contact not in (-1, c):
                continue
            row, (touching, approach_speed, mass) = table[c], self._memory[c - self.row].item()
            depth = -float(row.gap)
            row.force = 0.0
            if touching != 0.0 and depth > 0.0:
                row.force = law.forces(depth, float(row.rate), approach_speed, mass)[1]

    def prepare(self, y: Array, everything: bool = False) -> None:
        """Fill the joint's rows of the table as far as its mode requires.

        Args:
            y: State [q, v, x].
            everything: Whether contacts that do not touch are queried too; they have no force, whatever their
                gap.
        """
        row, table = self.row, self._table
        distances = self._distances
        if distances is None:
            kernels.geometry_alone(self._block, 0, y, self._nq, table, self._pose)
        else:
            place_journal(self._block, 0, y, self._nq, self._pose)
            wanted = None if everything or self._distributed else self._touching.tolist()
            distances.query(self._pose, table, row, wanted)
        if not self.compiled or (everything and self.measured):
            kernels.rates_alone(self._block, 0, table, self._pose)
        if not self.compiled:
            self._apply_laws()

    def _apply_laws(self) -> None:
        coefficient, rows = self._coefficient, self._rows
        code: NDArray[np.float64] = self._friction.code() if coefficient is None else np.empty(0)
        rows["force"][:] = 0.0
        rows["elastic"][:] = 0.0
        rows["friction"][:] = 0.0
        gaps = rows["gap"].tolist()
        for k, touching in enumerate(self._touching.tolist()):
            depth = -gaps[k]
            if touching == 0.0 or depth <= 0.0:
                continue
            _, approach_speed, mass = self._memory[k].item()
            elastic, force = self.laws[k].forces(depth, float(rows["rate"][k]), approach_speed, mass)
            rows["force"][k] = force
            rows["elastic"][k] = elastic
            slip = rows["slip"][k]
            speed = math.sqrt(slip.dot(slip))
            if coefficient is None:
                rows["friction"][k] = friction_force(code, force, *slip.tolist())
            elif speed > 0.0:
                rows["friction"][k] = -coefficient(speed) * force / speed * slip
