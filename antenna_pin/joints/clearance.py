"""The joint-contact plugin: geometry, laws and contact memory of one clearance joint.

A clearance joint is a 6-DOF free joint (planar: a 3-DOF planar joint) of the Pinocchio model; this adds the
forces. What a user adds to a model is a :class:`ClearanceJoint`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import check_takes, takes
from antenna_pin.base.records import CONTACT, MEMORY, POSE
from antenna_pin.compiled.decorators import in_python, record
from antenna_pin.contact import CompiledNormalLaw, FrictionLaw, NoFriction, NormalLaw
from antenna_pin.contact.friction import check_at_rest
from antenna_pin.contact.normal import normal_questions
from antenna_pin.contact.records import NORMAL_LAW, NORMAL_SIZE, number_of
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints import kernels
from antenna_pin.joints import layout_kernels as _layout
from antenna_pin.joints.geometry import ClearanceGeometry, Distances
from antenna_pin.joints.geometry.own_backend import OwnBackend
from antenna_pin.joints.patch_kernels import patch_energy
from antenna_pin.joints.python_path import LawInRun, PythonPath, has_code, range_of

Array = NDArray[np.float64]


def _law_name(law: NormalLaw) -> str:
    parts = getattr(law, "parts", None)
    return type(law if parts is None else parts.elastic).__name__


@takes(offset="m", approach_speed_floor="m/s", maximum_depth="m")
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClearanceJoint:
    """A joint with play: journal and bearing held together by contact alone.

    Attributes:
        name: The URDF joint it replaces; free (or planar) in the model.
        geometry: Shape of the joint, one of ``antenna_pin.joints.geometry``; a planar one keeps its plane and
            axis.
        radial: Normal law of the contacts, in the bore where there are flanges too.
        axial: Normal law of the contacts at the flanges, where there are any.
        friction: Friction law of all contacts.
        backend: Method for the gaps: "coal" (distance queries), "closed-form", or your own object
            (:class:`antenna_pin.joints.geometry.Distances`).
        offset: Bearing centre from the URDF joint's origin, along the joint's axis [m].
        bearing_on: Which of the joint's links has the bearing (socket, guide): "parent", its journal then
            being on the child, or "child".
        approach_speed_floor: Least approach speed stored at an onset [m/s].
        maximum_depth: Depth at which a run ends, because rigid bodies with contact stiffness no longer
            describe it [m]; a hundredth of the bearing radius if not given.
        load: "point": each law acts as one force at its contact; "distributed": it is distributed evenly over
            the patch whose law it is, ``radial`` over each half of the bore, ``axial`` over each flange, and
            each share acts at its own depth, rate and slip.
        strips: Of the whole bore under distributed load, even: each has 2 / strips of ``radial`` [-].
        sectors: Of the loaded arc of a flange under distributed load, 3 or more [-].
    """

    name: str
    geometry: ClearanceGeometry
    radial: NormalLaw
    axial: NormalLaw | None = None
    friction: FrictionLaw = field(default_factory=NoFriction)
    backend: Literal["coal", "closed-form"] | Distances = "coal"
    offset: float = 0.0
    bearing_on: Literal["parent", "child"] = "parent"
    approach_speed_floor: float = 1e-4
    maximum_depth: float | None = None
    load: Literal["point", "distributed"] = "point"
    strips: int = 16
    sectors: int = 16

    def __post_init__(self) -> None:
        """Check what the parts do not check themselves."""
        place = f"joint {self.name!r}"
        if self.bearing_on not in ("parent", "child"):
            raise InvalidParameterError(place, "bearing_on", "parent or child", self.bearing_on)
        if not 0.0 < self.approach_speed_floor < math.inf:
            raise InvalidParameterError(
                place, "approach_speed_floor", "positive [m/s]", self.approach_speed_floor
            )
        if self.axial is None and any(place.kind == "axial" for place in self.geometry.contact_places):
            raise InvalidParameterError(place, "axial", "a normal law", None)
        check_asked(place, self.normal_laws, self.friction, self.backend)
        bristles = bool(getattr(self.friction, "states", 0))
        check_load(
            place,
            self.load,
            geometry=self.geometry,
            backend=self.backend,
            strips=self.strips,
            sectors=self.sectors,
            compiled=self.compiled,
            bristles=bristles,
        )
        if self.maximum_depth is None:
            object.__setattr__(self, "maximum_depth", 0.01 * self.geometry.section_radius)
        elif not 0.0 < self.maximum_depth < math.inf:
            raise InvalidParameterError(place, "maximum_depth", "a positive length [m]", self.maximum_depth)
        check_friction(place, self.friction, all(map(has_code, self.normal_laws)))

    @property
    def planar(self) -> bool:
        """Return whether the joint is planar."""
        return self.geometry.planar

    @property
    def axial_clearance(self) -> float | None:
        """Play at each flange [m]; None without flanges."""
        found: float | None = getattr(self.geometry, "axial_clearance", None)
        return found

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Names of the contacts, led by the joint's."""
        return tuple(f"{self.name}.{place.name}" for place in self.geometry.contact_places)

    @property
    def contacts(self) -> int:
        """Number of candidate contacts."""
        return len(self.geometry.contact_places)

    @property
    def normal_laws(self) -> tuple[NormalLaw, ...]:
        """The normal law of each contact."""
        kinds = (place.kind for place in self.geometry.contact_places)
        return tuple(self.axial if kind == "axial" and self.axial else self.radial for kind in kinds)

    @property
    def law_names(self) -> tuple[str, ...]:
        """Description of the normal law of each contact."""
        return tuple(f"joint {self.name!r}: {place.kind} law" for place in self.geometry.contact_places)

    @property
    def own_backend(self) -> OwnBackend | None:
        """User's backend, wrapped for a run; None without."""
        if isinstance(self.backend, str):
            return None
        return OwnBackend(f"joint {self.name!r}: geometry: query", self.backend, self.contacts)

    @property
    def takes_mass(self) -> tuple[bool, ...]:
        """Return of each contact whether its law depends on the remembered effective mass."""
        return tuple(
            isinstance(law, CompiledNormalLaw) and law.parts.dissipation.takes_mass
            for law in self.normal_laws
        )

    def python_path(
        self, block: Array, memory: NDArray[Any], table: NDArray[Any], nq: int
    ) -> PythonPath | None:
        """Return the parts of the joint that run in Python; None without.

        Args:
            block: The joint's numbers in a system's program.
            memory: Contact memory of the system.
            table: Contact table of the system.
            nq: Size of the configuration.
        """
        if self.compiled and self.backend == "closed-form":
            return None
        backend: Distances | None = self.own_backend
        if self.backend == "coal":
            backend = self.geometry.coal(block[: _layout.JOINT_WORDS].view(_layout.JOINT)["axes"][0])
        friction = None if self.compiled else (self.friction, f"joint {self.name!r}")
        measured = not isinstance(self.backend, str)
        laws = list(zip(self.normal_laws, self.law_names, strict=True))
        return PythonPath(block, memory, table, nq, backend, laws, friction, measured)

    @property
    def depth_limits(self) -> tuple[float, ...]:
        """Depth of each contact at which a run ends [m], by joint and law."""
        assert self.maximum_depth is not None
        return tuple(min(self.maximum_depth, range_of(law)) for law in self.normal_laws)

    @property
    def limit_reasons(self) -> tuple[str, ...]:
        """Reason of each of the ``depth_limits``: the law's own range, or ``maximum_depth``."""
        assert self.maximum_depth is not None
        return tuple(
            f"the range of {_law_name(law)} ends there"
            if range_of(law) < self.maximum_depth
            else "maximum_depth"
            for law in self.normal_laws
        )

    @property
    def compiled(self) -> bool:
        """Return whether all laws run in the fused kernel, without Python calls per touching contact."""
        return all(has_code(law) for law in (*self.normal_laws, self.friction))

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
        """Return the joint as flat numbers for the fused kernel (:mod:`antenna_pin.joints.layout_kernels`).

        Args:
            axes: Columns are the axes of bearing and journal frame in the joint's frames, (3, 3).
            axis: The joint's axis in the joint's frames, (3,).
            q: Start of its configuration in q.
            v: Start of its velocity in v.
            first_contact: Row of its first contact.
            start_x: Start of its integrals in x.
            turn: Place of its turned angle in x; unused for a joint that does not turn.
        """
        distributed = self.load == "distributed"
        size = _layout.JOINT_WORDS + self.contacts * _layout.CANDIDATE_WORDS
        if distributed:
            size += _layout.PATCHES_WORDS + 2 * self.sectors
        block = np.zeros(size)
        head = block[: _layout.JOINT_WORDS].view(_layout.JOINT)
        head["kind"], head["length"] = _layout.CLEARANCE, size
        if not self.compiled:
            head["mode"] = _layout.FORCES_GIVEN
        elif self.backend != "closed-form":
            head["mode"] = _layout.GEOMETRY_GIVEN
        head["q"], head["v"], head["row"], head["contacts"] = q, v, first_contact, self.contacts
        head["x"], head["stride"], head["turn"] = start_x, self.stride, turn
        head["planar"], head["distributed"] = self.planar, distributed
        head["slides"] = self.geometry.motion == "slide"
        head["on_child"] = self.bearing_on == "child"
        head["axes"] = np.asarray(axes, dtype=float)
        head["centre"] = self.offset * np.asarray(axis, dtype=float)
        for k, (candidate, law) in enumerate(
            zip(self.geometry.candidates(axes), self.normal_laws, strict=True)
        ):
            start = in_python(_layout.candidate_at)(0, k)
            laws = start + len(candidate)
            block[start:laws] = candidate
            if self.compiled:
                normal: Any = law
                friction: Any = self.friction
                block[laws : laws + NORMAL_SIZE] = normal.code()
                block[laws + NORMAL_SIZE : start + _layout.CANDIDATE_WORDS] = friction.code()
        return block

    def place_strips(self, block: Array, begin: int) -> int:
        """Write into a block where its strips' rows start; return how many rows they are."""
        if self.load != "distributed":
            return 0
        tail, nodes = _layout.tail_of(block)
        tail["strips"], tail["sectors"], tail["first"] = self.strips, self.sectors, begin
        tail["radius"] = self.geometry.patch_radius
        t = math.pi * ((np.arange(self.sectors) + 0.5) / self.sectors - 0.5)
        nodes["sine"], nodes["share"] = np.sin(t), np.cos(t) / self.sectors
        return self.strips + 2 * self.sectors

    def stored_energy(self, q: ArrayLike) -> float:
        """Return the stored energy of the contacts in a pose [J].

        Contacts with a gap <= 0 touch.

        Args:
            q: The joint's configuration (see :meth:`evaluate`), for a joint axis along z.
        """
        configuration = np.asarray(q, dtype=float)
        nv = 3 if self.planar else 6
        y = np.concatenate([configuration, np.zeros(nv + self.contacts * self.stride)])
        block = self.block(np.eye(3), (0.0, 0.0, 1.0), 0, 0, 0, 0)
        table = np.zeros(self.contacts + self.place_strips(block, self.contacts), CONTACT)
        kernels.geometry_alone(block, 0, y, configuration.size, table, np.zeros(1, POSE))
        energy = 0.0
        for k, law in enumerate(zip(self.normal_laws, self.law_names, strict=True)):
            if self.load == "distributed":
                energy += patch_energy(block, 0, k, table)
            elif table[k].gap < 0.0:
                energy += LawInRun(*law).energy(-float(table[k].gap))
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
            q: The joint's configuration, the pose of its child in its parent: of the journal in the bearing,
                or with ``bearing_on = "child"`` the other way round. Pinocchio's order: (x, y, z, quaternion
                xyzw), planar (x, y, cos, sin) [m].
            v: Twist of the child in its own axes, linear first, (6,) or (3,) [m/s, rad/s].
            touching: Whether each contact touches; those with a gap <= 0 if not given.
            approach_speed: Of each contact [m/s]; the floor if not given.
            effective_mass: Of each contact [kg]; for laws that take it from there.
            axis: The joint's axis in the joint frame.
            axes: Bearing axes in the joint frame as columns; needed for an axis other than z.
        """
        n, nv = self.contacts, 3 if self.planar else 6
        x = np.zeros(n * self.stride)
        y = np.concatenate([np.asarray(q, dtype=float), np.asarray(v, dtype=float), x])
        nq = y.size - nv - x.size
        block = self.block(np.eye(3) if axes is None else axes, axis, 0, 0, 0, 0)
        table = np.zeros(n + self.place_strips(block, n), CONTACT)
        memory = np.zeros(n, MEMORY)
        pose = np.zeros(1, POSE)
        kernels.geometry_alone(block, 0, y, nq, table, pose)
        kernels.rates_alone(block, 0, table, pose)  # contacts that are apart, which the fast path omits
        memory["touching"] = table["gap"][:n] <= 0.0 if touching is None else np.asarray(touching)
        speed = self.approach_speed_floor if approach_speed is None else np.asarray(approach_speed)
        memory["approach_speed"] = np.maximum(speed, self.approach_speed_floor)
        if effective_mass is not None:
            memory["effective_mass"] = np.asarray(effective_mass, dtype=float)
        elif any(self.takes_mass):
            raise InvalidParameterError(
                f"joint {self.name!r}", "effective_mass", "given [kg], for its law depends on it", None
            )
        tau = np.zeros(nv)
        rates = np.zeros(nv + x.size)
        path = self.python_path(block, memory, table, nq)
        if path is not None:
            path.prepare(y, everything=True)
        kernels.alone(block, 0, y, nq, nv, memory, table, pose, tau, rates)
        columns = ("gap", "normal", "point", "rate", "slip", "force", "friction")
        arrays = [table[name][:n].copy() for name in columns]
        return JointContacts(*[*arrays, tau])


# --- checks -------------------------------------------------------------------------------------------------


_ROOM = "antenna_pin.contact."


def _check_kinds(place: str, law: CompiledNormalLaw) -> None:
    """Refuse a law with a code that kernels do not support."""
    kinds = record(law.code(), NORMAL_LAW)
    for what, part in (("elastic", law.parts.elastic), ("dissipation", law.parts.dissipation)):
        own = getattr(part, "kernel", None)
        if own is None or not own.__module__.startswith(_ROOM) or kinds[what] != number_of(own):
            rule = "that of a kernel of antenna_pin.contact; or give it no code()"
            raise InvalidParameterError(
                f"{place}: {type(law).__name__}", f"{what} kind", rule, float(kinds[what])
            )


def check_asked(place: str, normal_laws: Sequence[Any], friction: Any, backend: object) -> None:
    """Refuse laws and a backend that a run cannot use.

    Args:
        place: The joint, for the message.
        normal_laws: Normal laws of its contacts.
        friction: Its friction law.
        backend: Backend of its gaps, or its name.
    """
    if backend not in ("coal", "closed-form") and not hasattr(backend, "query"):
        raise InvalidParameterError(place, "backend", "coal, closed-form or an object with query()", backend)
    for law in normal_laws:
        if isinstance(law, CompiledNormalLaw):
            _check_kinds(place, law)
        elif not hasattr(law, "code"):
            for name, function, words in normal_questions(law):
                check_takes(f"{place}: {type(law).__name__}", name, function, *(word for word, _ in words))
    if not hasattr(friction, "code"):
        law = f"{place}: {type(friction).__name__}"
        check_takes(law, "coefficient", friction.coefficient, "slip speed")
    if not isinstance(backend, str):
        query: Any = getattr(backend, "query", None)
        check_takes(f"{place}: {type(backend).__name__}", "query", query, "pose", "table", "row", "wanted")


def check_friction(place: str, law: Any, compiled: bool) -> None:
    """Refuse friction that jumps at rest, or bristles beside Python laws.

    Args:
        place: The joint, for the messages.
        law: The law.
        compiled: Whether all normal laws run compiled.
    """
    if not hasattr(law, "code") and hasattr(law, "coefficient"):
        check_at_rest(f"{place}: {type(law).__name__}", law.coefficient)
    if getattr(law, "states", 0) and not compiled:
        rule = "a law of the slip speed beside a normal law in Python (bristles need compiled laws)"
        raise InvalidParameterError(place, "friction", rule, law)


def check_load(
    place: str,
    load: str,
    *,
    geometry: ClearanceGeometry,
    backend: object,
    strips: int,
    sectors: int,
    compiled: bool,
    bristles: bool,
) -> None:
    """Refuse a kind of load, or combinations that distributed load excludes.

    Args:
        place: The joint, for the message.
        load: "point" or "distributed".
        geometry: Shape of the joint.
        backend: Backend of its gaps.
        strips: Number of strips of the bore.
        sectors: Number of sectors of a flange.
        compiled: Whether all laws run compiled.
        bristles: Whether the friction law has states.
    """
    if load not in ("point", "distributed"):
        raise InvalidParameterError(place, "load", "point or distributed", load)
    if load == "point":
        return
    if geometry.patch_radius is None:
        raise InvalidParameterError(
            place, "load", "point where the joint is not one of journal, bore and flanges", load
        )
    if not isinstance(backend, str):
        raise InvalidParameterError(
            place, "load", "point with a backend of one's own; distributed takes coal or closed-form", load
        )
    if strips < 2 or strips % 2:
        raise InvalidParameterError(place, "strips", "an even number of 2 or more", strips)
    if sectors < 3:
        raise InvalidParameterError(place, "sectors", "3 or more", sectors)
    if not compiled:
        raise InvalidParameterError(
            place, "load", "point with laws in Python; distributed takes built-in laws", load
        )
    if bristles:
        raise InvalidParameterError(
            place, "load", "point with a bristle friction law (it has one state per contact)", load
        )


# --- contacts in one state ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class JointContacts:
    """Contacts of a clearance joint in one state; arrays per contact are in bearing axes.

    Attributes:
        gap: (contacts,) [m].
        normal: From the bearing into the journal, (contacts, 3).
        point: Point of the force, from the bearing's centre, (contacts, 3) [m]: the deepest point, except for
            a flange that presses flat under point load.
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
