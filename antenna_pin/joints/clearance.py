"""The joint-contact plugin: geometry, laws and contact memory of one clearance joint.

A clearance joint is a 6-DOF free joint (planar: a 3-DOF planar joint) of the Pinocchio model; this adds the
forces. What a user adds to a model is a :class:`ClearanceJoint`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin._compile import record
from antenna_pin.contact import CompiledNormalLaw, FrictionLaw, NoFriction, NormalLaw
from antenna_pin.contact._friction_kernels import friction_force
from antenna_pin.contact._kernels import (
    DISSIPATION_RECORDS,
    ELASTIC_RECORDS,
    NORMAL_SIZE,
    elastic_energy,
    elastic_force,
    normal_force,
    takes_mass_of_contact,
)
from antenna_pin.contact._records import NORMAL_LAW
from antenna_pin.errors import InvalidParameterError
from antenna_pin.geometry import (
    CoalPlanar,
    CoalRevolute,
    CoalSpherical,
    PlanarClearance,
    RevoluteClearance,
    SphericalClearance,
)
from antenna_pin.geometry.shapes import TABLE_WIDTH
from antenna_pin.joints import _kernels

__all__ = ["ClearanceJoint", "JointContacts", "PythonPath"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class JointContacts:
    """What a clearance joint does in one state; arrays per contact are in bearing axes.

    Attributes:
        gap: (contacts,) [m].
        normal: From the bearing into the journal, (contacts, 3).
        point: Where the force acts, from the bearing's centre, (contacts, 3) [m]: the deepest point, but of a
            flange that presses flat under point load.
        rate: Penetration rate at the contact's point, (contacts,) [m/s].
        slip: Tangential velocity of the journal over the bearing, (contacts, 3) [m/s].
        normal_force: (contacts,) [N].
        friction_force: On the journal, (contacts, 3) [N].
        generalized_force: On the joint, in the child's axes, linear part first: (6,) or (3,) if planar [N, N
            m].
    """

    gap: Array
    normal: Array
    point: Array
    rate: Array
    slip: Array
    normal_force: Array
    friction_force: Array
    generalized_force: Array


def _has_code(law: object) -> bool:
    return hasattr(law, "code")


def _check_kinds(joint: str, law: Any) -> None:
    """Refuse a law whose code the kernels do not know."""
    code = law.code()
    for what, known in (("elastic", ELASTIC_RECORDS), ("dissipation", DISSIPATION_RECORDS)):
        kind = record(code, NORMAL_LAW)[what]
        if kind not in known:
            raise InvalidParameterError(
                f"joint {joint!r}: {type(law).__name__}",
                f"{what} kind",
                f"one of {', '.join(f'{k:g}' for k in known)}, which the kernels know; or give it no code()",
                float(kind),
            )


def _range_of(law: NormalLaw) -> float:
    return float(getattr(law, "depth_limit", math.inf))


def _law_name(law: NormalLaw) -> str:
    parts = getattr(law, "parts", None)
    return type(law if parts is None else parts.elastic).__name__


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClearanceJoint:
    """A joint with play: journal and bearing held together by contact alone.

    Attributes:
        name: The URDF joint it stands for; made free (or planar) in the model.
        geometry: Shape of the joint; a :class:`PlanarClearance` keeps the joint's plane and axis.
        radial: Normal law of the contacts in the bore.
        axial: Normal law of the contacts at the flanges; unused if planar.
        friction: Friction law of all contacts.
        backend: "coal" (distance queries) or "closed-form".
        offset: Bearing centre from the URDF joint's origin, along the joint's axis [m].
        approach_speed_floor: Least approach speed that a contact remembers [m/s].
        maximum_depth: Depth at which a run ends, because rigid bodies with contact stiffness no longer
            describe it [m]; a hundredth of the bearing radius if not given.
        load: "point": each law acts as one force at its contact; "distributed": it is shared out evenly over
            the patch whose law it is, ``radial`` over each half of the bore, ``axial`` over each flange, and
            each share acts at its own depth, rate and slip.
        strips: Of the whole bore under distributed load, even: each has 2 / strips of ``radial`` [-].
        sectors: Of the loaded arc of a flange under distributed load, 3 or more [-].
    """

    name: str
    geometry: RevoluteClearance | PlanarClearance | SphericalClearance
    radial: NormalLaw
    axial: NormalLaw | None = None
    friction: FrictionLaw = field(default_factory=NoFriction)
    backend: Literal["coal", "closed-form"] = "coal"
    offset: float = 0.0
    approach_speed_floor: float = 1e-4
    maximum_depth: float | None = None
    load: Literal["point", "distributed"] = "point"
    strips: int = 16
    sectors: int = 16

    def __post_init__(self) -> None:
        """Check what the parts do not check themselves."""
        if self.backend not in ("coal", "closed-form"):
            raise InvalidParameterError(
                f"joint {self.name!r}", "backend", "coal or closed-form", self.backend
            )
        if not 0.0 < self.approach_speed_floor < math.inf:
            raise InvalidParameterError(
                f"joint {self.name!r}", "approach_speed_floor", "positive [m/s]", self.approach_speed_floor
            )
        if self.axial is None and isinstance(self.geometry, RevoluteClearance):
            raise InvalidParameterError(f"joint {self.name!r}", "axial", "a normal law", None)
        for law in self.normal_laws:
            if _has_code(law):
                _check_kinds(self.name, law)
        self._check_load()
        if self.maximum_depth is None:
            object.__setattr__(self, "maximum_depth", 0.01 * self.geometry.bearing_radius)
        elif not 0.0 < self.maximum_depth < math.inf:
            raise InvalidParameterError(
                f"joint {self.name!r}", "maximum_depth", "a positive length [m]", self.maximum_depth
            )
        if getattr(self.friction, "states", 0) and not all(_has_code(law) for law in self.normal_laws):
            raise InvalidParameterError(
                f"joint {self.name!r}",
                "friction",
                "a law of the slip speed beside a normal law in Python (bristles need compiled laws)",
                self.friction,
            )

    def _check_load(self) -> None:
        place = f"joint {self.name!r}"
        if self.load not in ("point", "distributed"):
            raise InvalidParameterError(place, "load", "point or distributed", self.load)
        if self.load == "point":
            return
        if not isinstance(self.geometry, RevoluteClearance):
            raise InvalidParameterError(
                place, "load", "point where the joint is planar or spherical", self.load
            )
        if self.strips < 2 or self.strips % 2:
            raise InvalidParameterError(place, "strips", "an even number of 2 or more", self.strips)
        if self.sectors < 3:
            raise InvalidParameterError(place, "sectors", "3 or more", self.sectors)
        if not self.compiled:
            raise InvalidParameterError(
                place, "load", "point with laws in Python; distributed takes built-in laws", self.load
            )
        if getattr(self.friction, "states", 0):
            raise InvalidParameterError(
                place, "load", "point with a bristle friction law (it has one state per contact)", self.load
            )

    @property
    def planar(self) -> bool:
        """Whether the joint keeps its plane."""
        return isinstance(self.geometry, PlanarClearance)

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Names of the contacts, led by the joint's."""
        return tuple(f"{self.name}.{kind}{end}" for kind, end in self.geometry.contact_places)

    @property
    def contacts(self) -> int:
        """Number of candidate contacts."""
        return len(self.geometry.contact_places)

    @property
    def normal_laws(self) -> tuple[NormalLaw, ...]:
        """The normal law of each contact."""
        if self.planar or self.axial is None:
            return (self.radial,)
        return (self.radial, self.radial, self.axial, self.axial)

    @property
    def depth_limits(self) -> tuple[float, ...]:
        """Depth of each contact at which a run ends [m]: the least of ``maximum_depth`` and its law's own."""
        assert self.maximum_depth is not None
        return tuple(min(self.maximum_depth, _range_of(law)) for law in self.normal_laws)

    @property
    def limit_reasons(self) -> tuple[str, ...]:
        """What sets each of the ``depth_limits``, in words: the law's own range, or ``maximum_depth``."""
        assert self.maximum_depth is not None
        return tuple(
            f"the range of {_law_name(law)} ends there"
            if _range_of(law) < self.maximum_depth
            else "maximum_depth"
            for law in self.normal_laws
        )

    @property
    def compiled(self) -> bool:
        """Whether all laws run in the fused kernel; otherwise each touching contact costs a Python call."""
        return all(_has_code(law) for law in (*self.normal_laws, self.friction))

    @property
    def stride(self) -> int:
        """Numbers that each contact integrates: impulse, two losses, a bristle if there is one."""
        return 3 + int(getattr(self.friction, "states", 0))

    def block(
        self,
        axes: ArrayLike,
        axis: ArrayLike,
        q: int,
        v: int,
        first_contact: int,
        start_x: int,
        turn: int = 0,
    ) -> Array:
        """Return the joint as flat numbers for the fused kernel.

        Args:
            axes: Columns are the bearing frame's axes in the joint frame, (3, 3).
            axis: The joint's axis in the joint frame, (3,).
            q: Start of its configuration in q.
            v: Start of its velocity in v.
            first_contact: Row of its first contact.
            start_x: Where its integrated numbers start in x.
            turn: Where its turned angle stands in x; without meaning for a ball joint.
        """
        size = _kernels.LAWS + self.contacts * _kernels.LAW_SIZE
        block = np.zeros(size)
        mode = 0.0
        if not self.compiled:
            mode = _kernels.FORCES_GIVEN
        elif self.backend == "coal":
            mode = _kernels.GEOMETRY_GIVEN
        kind = _kernels.REVOLUTE
        if self.planar:
            kind = _kernels.PLANAR
        elif isinstance(self.geometry, SphericalClearance):
            kind = _kernels.SPHERICAL
        elif self.load == "distributed":
            kind = _kernels.DISTRIBUTED
            size += _kernels.SECTOR_NODES + 2 * self.sectors
            block = np.zeros(size)
        block[:10] = [kind, size, mode, q, v, first_contact, self.contacts, start_x, self.stride, turn]
        block[_kernels.AXES : _kernels.AXES + 9] = np.asarray(axes, dtype=float).ravel()
        block[_kernels.CENTRE : _kernels.CENTRE + 3] = self.offset * np.asarray(axis, dtype=float)
        shape = self.geometry.shape()
        block[_kernels.SHAPE : _kernels.SHAPE + len(shape)] = shape
        if self.compiled:
            friction: Any = self.friction
            for k, law in enumerate(self.normal_laws):
                start = _kernels.LAWS + k * _kernels.LAW_SIZE
                normal: Any = law
                block[start : start + NORMAL_SIZE] = normal.code()
                block[start + NORMAL_SIZE : start + _kernels.LAW_SIZE] = friction.code()
        return block

    def place_strips(self, block: Array, first: int) -> int:
        """Write into a block where its strips' rows start; return how many rows they are.

        The sectors stand on the circle whose radius squared is the mean of the annulus': its ring has the
        annulus' second moment, so a uniform modulus resists compression and tilt as over the whole annulus.
        """
        if self.load != "distributed" or not isinstance(self.geometry, RevoluteClearance):
            return 0
        outer = min(self.geometry.bearing_outer_radius, self.geometry.flange_radius)
        radius = math.sqrt(0.5 * (outer**2 + self.geometry.bearing_radius**2))
        tail = block[_kernels.DISTRIBUTED_TAIL :]
        tail[:4] = self.strips, self.sectors, first, radius
        t = math.pi * ((np.arange(self.sectors) + 0.5) / self.sectors - 0.5)
        nodes = tail[_kernels.SECTOR_NODES :]
        nodes[::2], nodes[1::2] = np.sin(t), np.cos(t) / self.sectors
        return self.strips + 2 * self.sectors

    def stored_energy(self, q: ArrayLike) -> float:
        """Return the energy that the contacts store in a pose in which all with a gap <= 0 touch [J].

        Args:
            q: Pose of the journal in the bearing (see :meth:`evaluate`), for a joint axis along z.
        """
        configuration = np.asarray(q, dtype=float)
        nv = 3 if self.planar else 6
        y = np.concatenate([configuration, np.zeros(nv + self.contacts * self.stride)])
        block = self.block(np.eye(3), (0.0, 0.0, 1.0), 0, 0, 0, 0)
        table = np.zeros((self.contacts + self.place_strips(block, self.contacts), TABLE_WIDTH))
        pose = np.zeros(_kernels.POSE_BUFFER)
        _kernels.journal_state(block, 0, y, configuration.size, pose)
        _kernels.contact_geometry(block, 0, pose, table, 0)
        energy = 0.0
        for k, law in enumerate(self.normal_laws):
            if self.load == "distributed":
                energy += _kernels.patch_energy(block, 0, k, table)
            elif table[k, 0] < 0.0:
                energy += law.elastic_energy(-float(table[k, 0]))
        return energy

    def evaluate(
        self,
        q: ArrayLike,
        v: ArrayLike,
        *,
        touching: ArrayLike | None = None,
        approach_speed: ArrayLike | None = None,
        effective_mass: ArrayLike | None = None,
        axis: ArrayLike = (0.0, 0.0, 1.0),
        axes: ArrayLike | None = None,
    ) -> JointContacts:
        """Return contacts and forces of the joint alone, in one state; not the fast path.

        Args:
            q: Pose of the journal in the bearing, Pinocchio's order: (x, y, z, quaternion xyzw), planar (x,
                y, cos, sin) [m].
            v: Twist of the journal in its own axes, linear first, (6,) or (3,) [m/s, rad/s].
            touching: Whether each contact touches; those with a gap <= 0 if not given.
            approach_speed: Of each contact [m/s]; the floor if not given.
            effective_mass: Of each contact [kg]; for laws that take it from there.
            axis: The joint's axis in the joint frame.
            axes: Bearing axes in the joint frame as columns; needed for an axis other than z.
        """
        frame = np.eye(3) if axes is None else np.asarray(axes, dtype=float)
        y = np.concatenate([np.asarray(q, dtype=float), np.asarray(v, dtype=float)])
        nv = 3 if self.planar else 6
        nq = y.size - nv
        x = np.zeros(self.contacts * self.stride)
        y = np.concatenate([y, x])
        block = self.block(frame, axis, 0, 0, 0, 0)
        rows = self.contacts + self.place_strips(block, self.contacts)
        table = np.zeros((rows, TABLE_WIDTH))
        memory = np.zeros((self.contacts, _kernels.MEMORY_WIDTH))
        pose = np.zeros(_kernels.POSE_BUFFER)
        _kernels.journal_state(block, 0, y, nq, pose)
        _kernels.contact_geometry(block, 0, pose, table, 0)
        inside = table[: self.contacts, 0] <= 0.0
        memory[:, 0] = inside if touching is None else np.asarray(touching, dtype=float)
        speed = self.approach_speed_floor if approach_speed is None else approach_speed
        memory[:, _kernels.APPROACH] = np.maximum(np.asarray(speed, dtype=float), self.approach_speed_floor)
        if effective_mass is not None:
            memory[:, _kernels.MASS] = np.asarray(effective_mass, dtype=float)
        elif any(
            isinstance(x, CompiledNormalLaw) and takes_mass_of_contact(x.code()) for x in self.normal_laws
        ):
            raise InvalidParameterError(
                f"joint {self.name!r}", "effective_mass", "given [kg], for its law depends on it", None
            )
        tau = np.zeros(nv)
        rates = np.zeros(nv + x.size)
        if block[_kernels.MODE] != 0.0:
            PythonPath(self, block, nq).prepare(y, memory, table, everything=True)
        _kernels.clearance_joint(block, 0, y, nq, nv, memory, table, pose, tau, rates)
        n = self.contacts
        return JointContacts(
            gap=table[:n, 0].copy(),
            normal=table[:n, 1:4].copy(),
            point=table[:n, 4:7].copy(),
            rate=table[:n, _kernels.RATE].copy(),
            slip=table[:n, _kernels.SLIP : _kernels.SLIP + 3].copy(),
            normal_force=table[:n, _kernels.FORCE].copy(),
            friction_force=table[:n, _kernels.FRICTION : _kernels.FRICTION + 3].copy(),
            generalized_force=tau,
        )


class LawInRun:
    """A contact's normal law as a run asks it: with the contact's mass, and past its range in a trial step.

    There a compiled law is continued by its kernel, and one in Python is asked at the end of its range.

    Args:
        law: The law.
    """

    __slots__ = ("_code", "_law", "_limit")

    def __init__(self, law: NormalLaw) -> None:
        """Compose a compiled law's numbers once."""
        self._law = law
        self._code = law.code() if isinstance(law, CompiledNormalLaw) else None
        self._limit = _range_of(law)

    def forces(self, depth: float, rate: float, approach_speed: float, mass: float) -> tuple[float, float]:
        """Return elastic and whole normal force [N] at a positive depth."""
        if self._code is not None:
            force = float(normal_force(self._code, depth, rate, approach_speed, mass))
            return float(elastic_force(self._code, depth)), force
        within = min(depth, self._limit)
        return self._law.elastic_force(within), max(0.0, self._law.force(within, rate, approach_speed))

    def energy(self, depth: float) -> float:
        """Return the energy stored at a positive depth [J]."""
        if self._code is not None:
            return float(elastic_energy(self._code, depth))
        return self._law.elastic_energy(min(depth, self._limit))


class PythonPath:
    """What of a clearance joint happens outside the fused kernel: coal's queries, and laws written in Python.

    Args:
        joint: The joint.
        block: Its flat numbers.
        nq: Size of the configuration: where the velocities start in a state.
    """

    def __init__(self, joint: ClearanceJoint, block: Array, nq: int) -> None:
        """Build coal's functors and the buffers once."""
        self.joint = joint
        #: Its laws, one for each contact.
        self.laws = tuple(LawInRun(law) for law in joint.normal_laws)
        self._block = block
        self._nq = nq
        #: Row of its first contact.
        self.row = int(block[_kernels.FIRST_CONTACT])
        self._pose = np.zeros(_kernels.POSE_BUFFER)
        self._shape = joint.geometry.shape()
        self._revolute = self._planar = self._spherical = None
        if joint.backend == "coal":
            if isinstance(joint.geometry, PlanarClearance):
                self._planar = CoalPlanar(joint.geometry)
            elif isinstance(joint.geometry, SphericalClearance):
                self._spherical = CoalSpherical(joint.geometry)
            else:
                self._revolute = CoalRevolute(joint.geometry)

    def prepare(self, y: Array, memory: Array, table: Array, everything: bool = False) -> None:
        """Fill the joint's rows of the table as far as its mode says they are given.

        Args:
            y: State [q, v, x].
            memory: Contact memory of the system.
            table: Contact table of the system.
            everything: Ask coal for contacts that do not touch, too; they have no force, whatever their gap.
        """
        row = self.row
        if self._revolute is not None and self.joint.load == "distributed":
            self._prepare_strips(self._revolute, y, table)
        elif self._revolute is not None:
            sine = _kernels.place_for_coal(
                self._block, 0, y, self._nq, self._shape, self._pose, self._revolute.work
            )
            touching = None if everything else memory[row : row + 4, _kernels.TOUCHING].tolist()
            self._revolute.query(sine, table, row, touching)
        else:
            _kernels.journal_state(self._block, 0, y, self._nq, self._pose)
            if self._planar is not None:
                self._planar.query(float(self._pose[0]), float(self._pose[1]), table, row)
            elif self._spherical is not None:
                self._spherical.query(self._pose[:3], table, row)
            else:
                _kernels.contact_geometry(self._block, 0, self._pose, table, row)
        if not self.joint.compiled:
            _kernels.contact_rates(self._block, 0, self._pose, table, row)
            self._apply_laws(memory, table)

    def _prepare_strips(self, backend: CoalRevolute, y: Array, table: Array) -> None:
        _kernels.journal_state(self._block, 0, y, self._nq, self._pose)
        tail = self._block[_kernels.DISTRIBUTED_TAIL :]
        strips, _, first = (int(number) for number in tail[:3])
        nodes = tail[_kernels.SECTOR_NODES :]
        backend.query_strips(
            self._pose, strips, nodes, float(tail[_kernels.SECTOR_RADIUS]), table, self.row, first
        )

    def _apply_laws(self, memory: Array, table: Array) -> None:
        friction: Any = self.joint.friction
        code = friction.code() if _has_code(friction) else None
        for k, law in enumerate(self.laws):
            r = self.row + k
            table[r, _kernels.FORCE : _kernels.ELASTIC + 1] = 0.0
            depth = -table[r, 0]
            if memory[r, _kernels.TOUCHING] == 0.0 or depth <= 0.0:
                continue
            elastic, force = law.forces(depth, table[r, _kernels.RATE], *memory[r, _kernels.APPROACH :])
            slip = table[r, _kernels.SLIP : _kernels.SLIP + 3]
            speed = float(np.linalg.norm(slip))
            table[r, _kernels.FORCE] = force
            table[r, _kernels.ELASTIC] = elastic
            if code is not None:
                table[r, _kernels.FRICTION : _kernels.FRICTION + 3] = friction_force(
                    code, force, *slip.tolist()
                )
            elif speed > 0.0:
                table[r, _kernels.FRICTION : _kernels.FRICTION + 3] = (
                    -friction.coefficient(speed) * force / speed * slip
                )
