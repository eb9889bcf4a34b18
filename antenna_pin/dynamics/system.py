"""The equations of motion: a Pinocchio tree and the force elements on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes, unknown_type
from antenna_pin.base.parameters import beyond
from antenna_pin.base.records import PROGRAM, place_of
from antenna_pin.base.views import as_html
from antenna_pin.dynamics import kernels, turn_kernels
from antenna_pin.dynamics.blocks import (
    Blocks,
    HeldKind,
    InPython,
    check_booked,
    check_holds,
    check_motion,
    clearance_block,
    closures_by_name,
    element_block,
    held_block,
    kinds_about_axis,
    on_bearings,
    places_in_x,
    slides,
    states_in_x,
    turning,
    with_friction_of_bearings,
    with_preloads_placed,
)
from antenna_pin.dynamics.constraints import Closure, ConstraintPlan, Coupling, DrivenJoint, make_plan
from antenna_pin.dynamics.coordinates import coordinate_names
from antenna_pin.dynamics.coupled import couplings_of, fit_turns, put_followers
from antenna_pin.dynamics.links import ForcePlace, OnLinksInPython, books_in_x, place_on_links
from antenna_pin.elements import (
    FAMILIES,
    GROSS_WORK,
    LOSS,
    WORK,
    BetweenPoints,
    Element,
    ForceElement,
    JointSpring,
    Motion,
    OnLinks,
    check_together,
    kind_of,
)
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.integrate import Manifold
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints import layout_kernels as _layout
from antenna_pin.mechanism import WORLD, Mechanism
from antenna_pin.mechanism.flexible import ElasticPart

# --- the elements of a system: its springs with those of elastic parts, and all by family ---


def springs_and_parts(
    springs: Mapping[str, ForceElement], elastic: Mapping[str, ElasticPart]
) -> dict[str, ForceElement]:
    """Return springs and, behind them, those of elastic parts, by name.

    Raises:
        InvalidParameterError: A spring has the name of a part, or a part another name than its own.
    """
    found = dict(springs)
    for name, part in elastic.items():
        if name in springs:
            rule = "of another name than an elastic part's, whose own spring bears it"
            raise InvalidParameterError("System", f"springs[{name!r}]", rule, name)
        if name != part.name:
            raise InvalidParameterError("System", f"elastic[{name!r}]", "by the part's name", part.name)
        found[name] = JointSpring(joint=name, stiffness=part.stiffness, damping=part.damping)
    return found


def families_of(
    drives: Mapping[str, Element],
    springs: Mapping[str, ForceElement],
    others: Mapping[str, Mapping[str, ForceElement]],
) -> dict[str, dict[str, ForceElement]]:
    """Return all elements by family, in the families' order, without empty optional families.

    Raises:
        UnknownNameError: There is no such family.
        MechanismError: Stops and latches contradict each other.
        InvalidParameterError: A family has an argument of its own, or an element acts elsewhere.
    """
    own: dict[str, dict[str, ForceElement]] = {"drives": dict(drives), "springs": dict(springs)}
    for table, elements in others.items():
        if table not in FAMILIES:
            raise UnknownNameError("System", "family of elements", table, FAMILIES)
        given = FAMILIES[table].among or table
        if given in own:
            rule = f"left out: it is given as {given}="
            raise InvalidParameterError("System", f"elements[{table!r}]", rule, [*elements])
        for name, element in elements.items():
            if not FAMILIES[table].has(element):
                kinds = (*FAMILIES[table].kinds.values(), *FAMILIES[table].in_python.values())
                rule = f"one of {', '.join(cls.__name__ for cls in kinds)}"
                place = f"elements[{table!r}][{name!r}]"
                raise InvalidParameterError("System", place, rule, said=type(element).__name__)
    found = own | {table: dict(others[table]) for table in FAMILIES if others.get(table)}
    check_together(found)
    return found


# --- configurations of a mechanism: the space of each joint, and which of their numbers are of length one ---

_SPACES = {
    "JointModelFreeFlyer": "rigid",
    "JointModelSpherical": "rotation",
    "JointModelPlanar": "plane",
}

# Deviation of a quaternion's length from 1 that counts as round-off.
_UNIT_TOLERANCE = 1e-6


def spaces(model: Any) -> tuple[str, ...]:
    """Return the configuration space of each joint of a Pinocchio model."""
    kinds = []
    for joint in list(model.joints)[1:]:
        name = joint.shortname()
        if name in _SPACES:
            kinds.append(_SPACES[name])
        elif (joint.nq, joint.nv) == (1, 1):
            kinds.append("vector")
        elif (joint.nq, joint.nv) == (2, 1):
            kinds.append("circle")
        else:
            raise MechanismError(
                f"joint {model.names[joint.id]!r}: {name} has no place in the state space; use revolute, "
                "continuous, prismatic, planar, floating or spherical joints"
            )
    return tuple(kinds)


def numbers(values: ArrayLike, count: int, name: str, unit: str) -> NDArray[np.float64]:
    """Return a copy of a state's numbers, or refuse non-finite or too large ones."""
    try:
        found = np.array(values, dtype=float)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape == (count,) and np.isfinite(found).all():
        rule = beyond(found.tolist(), unit)
    else:
        rule = "finite" if count == 1 else f"{count} finite numbers"
    if rule:
        raise InvalidParameterError("System", name, rule, said=unknown_type(values))
    return found


def make_unit(mechanism: Mechanism, configuration: NDArray[np.float64]) -> None:
    """Make quaternions, and cosines and sines, of a configuration unit, in place.

    Raises:
        InvalidParameterError: A deviation exceeds round-off.
    """
    for name, place in _unit_parts(mechanism):
        length = float(np.linalg.norm(configuration[place]))
        if not abs(length - 1.0) <= _UNIT_TOLERANCE:
            what = "quaternion" if place.stop - place.start == 4 else "cosine and sine"
            raise InvalidParameterError(
                f"q[{place.start}:{place.stop}]",
                f"{what} of {name}",
                f"of length 1 to {_UNIT_TOLERANCE:g}; divide it by its length",
                length,
            )
        configuration[place] /= length


def _unit_parts(mechanism: Mechanism) -> Iterator[tuple[str, slice]]:
    """Yield name and place in q of each part of unit length."""
    if mechanism.base == "free":
        yield "the base", slice(3, 7)
    inside = {
        "floating": slice(3, 7),
        "planar": slice(2, 4),
        "continuous": slice(0, 2),
        "spherical": slice(0, 4),
    }
    for slot in mechanism.joints.values():
        if slot.kind in inside:
            part, start = inside[slot.kind], slot.q.start
            yield f"joint {slot.name!r}", slice(start + part.start, start + part.stop)


Array = NDArray[np.float64]


@takes()
class System:
    """A mechanism with its force elements, as data.

    It is immutable: runs and threads share it, and it can be pickled (with drives
    in Python as far as those can). The arrays of a run are in :class:`antenna_pin.dynamics.Workspace`.

    The state is ``y = [q, v, x]``: Pinocchio's configuration and velocity, and in x the turned angles of
    joints without limits (see :meth:`turn_on`) and integrals of the elements (per contact impulse,
    work lost in normal direction and to friction, bristles; per drive work and gross work; per spring the
    work lost in its damper; internal states of other elements).

    The contact memory, the contacts' discrete state, has one record each
    (:data:`antenna_pin.base.records.MEMORY`: touching, approach speed, effective mass). It is not part of
    ``y`` and changes at located events only.

    Args:
        mechanism: Joints with play, held or on bearings must be floating there (planar for a planar play).
        clearances: Joints with play.
        drives: Torques and prescribed motions, by name.
        springs: Springs, dampers, friction and springs between points, by name.
        held: Floating joints of the tree, held by constraint to their ideal kind, by name.
        closures: Joints that close loops, by name.
        couplings: Joints that follow others, by name, in addition to the URDF's ``<mimic>``.
        elements: Elements of further families, by the family's table and then by name: ``{"stops": {...}}``.
        elastic: Elastic parts of flexible links, by name, which is also that of their joint and their spring.
        left_out: Lines on ignored or unsimulated parts of the URDF, for results.
        assumed: Lines on assumptions, for results.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        *,
        clearances: Sequence[ClearanceJoint] = (),
        drives: Mapping[str, Element] | None = None,
        springs: Mapping[str, ForceElement] | None = None,
        held: Mapping[str, HeldKind] | None = None,
        closures: Mapping[str, Closure] | None = None,
        couplings: Mapping[str, Coupling] | None = None,
        elements: Mapping[str, Mapping[str, ForceElement]] | None = None,
        elastic: Mapping[str, ElasticPart] | None = None,
        left_out: Sequence[str] = (),
        assumed: Sequence[str] = (),
    ) -> None:
        """Lay out the state and compose the program of force elements."""
        self.mechanism = mechanism
        #: Ignored parts of the URDF, and assumptions, as text.
        self.left_out, self.assumed = tuple(left_out), tuple(assumed)
        self.model = mechanism.model
        self.clearances = tuple(clearances)
        names = [joint.name for joint in self.clearances]
        if len(set(names)) != len(names):
            raise InvalidParameterError("System", "clearances", "of different joints", names)
        self.drives = dict(drives or {})
        #: Elastic parts of flexible links by name; their springs follow all others.
        self.elastic = dict(elastic or {})
        self.springs = springs_and_parts(springs or {}, self.elastic)
        #: All elements by family, then by name.
        own = families_of(self.drives, self.springs, elements or {})
        self.families = with_friction_of_bearings(with_preloads_placed(own, self.clearances))
        self.springs = self.families["springs"]
        #: Springs whose torque is in results.
        self.traced = tuple(name for name, spring in self.springs.items() if spring.traced)
        #: Springs between points.
        self.point_springs = {n: s for n, s in self.springs.items() if isinstance(s, BetweenPoints)}
        #: Elements on links: forces, and those of a user's on several joints.
        self.forces: dict[str, Any] = self.families.get("forces", {})
        self.held = dict(held or {})
        #: All closures by name, those of joints held by constraint first.
        self.closures = closures_by_name(mechanism, self.held, closures or {})
        #: All couplings by name, those of the URDF first.
        self.couplings = couplings_of(mechanism, couplings or {}, self.closures)
        #: Joints without play that bearings carry; motion about the axis of these and of held ones, by name.
        self.on_bearings = on_bearings(mechanism, self.families, names, self.held)
        self.free_with_axis = kinds_about_axis(self.held, self.on_bearings)
        self._compose()
        if couplings and self.plan is not None:  # those of the URDF were reported where it was built
            mechanism.check_regular(self.plan.ties)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Restore a pickled system, with user functions at new addresses."""
        self.__dict__.update(state)
        self._compose()

    def __repr__(self) -> str:
        """Show its name and how much of what it has."""
        parts: dict[str, Any] = {"joints with play": self.clearances, **self.families}
        parts |= {"closures": self.closures, "elastic parts": self.elastic}
        said = "".join(f", {name}: {len(part)}" for name, part in parts.items() if part)
        return f"System({self.mechanism.name!r}, nq={self.model.nq}, nv={self.model.nv}{said})"

    _repr_html_ = as_html

    # --- layout ---------------------------------------------------------------------------------------------

    def _compose(self) -> None:
        #: Names of the numbers of q and of v, as in a result.
        self.names_q, self.names_v = coordinate_names(self.mechanism)
        #: Place in x of the turned angle of each joint that has one, by name.
        self.turn_x = turning(self)
        blocks = Blocks(len(self.turn_x))
        self._place_joints(blocks)
        self._place_integrals_of_contacts()
        self._place_elements(blocks)
        #: Points of application of forces.
        self.force_places: list[ForcePlace] = []
        points = place_on_links(self, blocks)
        #: Its constraints in numbers; None for a tree without constraints.
        self.plan: ConstraintPlan | None = None
        #: Place in x of the energy added by corrections of position and velocity, if any.
        self.projection_x = np.zeros(0, dtype=int)
        if self.closures or self.motions or self.couplings or self.holds:
            held = self.closures, self.motions, self.couplings, self.turn_x, self.holds
            self.plan = make_plan(self.mechanism, *held)
            self.projection_x = np.array([blocks.x])
            blocks.x += 1
        self.program = np.concatenate(blocks.all)
        #: Places in x of the works of drives and the losses of springs, in their order; -1: none.
        self.work_x, self.gross_work_x = (
            places_in_x(self.program, self.drives, self.drive_blocks, one) for one in (WORK, GROSS_WORK)
        )
        self.damper_x = places_in_x(self.program, self.springs, self.spring_blocks, LOSS)
        #: The same of the integrals of forces, by name.
        self.force_x = books_in_x(self)
        self.state_x = states_in_x(self)
        #: Arguments of the derivative in x: bristles of contacts, and after them states of elements.
        self.bristle_x: NDArray[np.int_] = np.append(self._bristles, self.state_x)
        #: The same of the losses of elements of further families, one family after another.
        own = ((self.families[one], self.element_blocks[one]) for one in self.others)
        losses = (places_in_x(self.program, *one, LOSS) for one in own)
        self.element_x = np.concatenate([np.zeros(0, dtype=int), *losses])
        head = self.program[: kernels.HEADER].view(PROGRAM)
        head["nq"], head["nv"] = self.model.nq, self.model.nv
        head["contacts"], head["rows"], head["points"] = len(self.contact_names), self.rows, points
        slots = {name: self.mechanism.joint(name) for name in self.turn_x}
        #: The turned angles for :func:`turn_kernels.turn_on`, ``TURN``.
        self.turns = np.array(
            [
                (x, self.clearance_blocks.get(name, -1), slots[name].q.start, slots[name].v.start)
                for name, x in self.turn_x.items()
            ],
            dtype=turn_kernels.TURN,
        )
        self.manifold = Manifold(spaces(self.model), blocks.x)

    def _place_joints(self, blocks: Blocks) -> None:
        """Lay out the joints with play, and those held by constraint or carried by bearings."""
        self.contact_names = tuple(name for joint in self.clearances for name in joint.contact_names)
        #: Places in the program of the block of each joint with play, or held one with an axis.
        self.clearance_blocks: dict[str, int] = {}
        row, own = 0, []
        for joint in self.clearances:
            turn = self.turn_x.get(joint.name, -1)
            own.append(clearance_block(self.mechanism, joint, row, blocks.x, turn))
            self.clearance_blocks[joint.name] = blocks.add(own[-1], joint.contacts * joint.stride)
            row += joint.contacts
        for name, kind in self.free_with_axis.items():
            slides = kind == "prismatic"
            block = held_block(self.mechanism, name, slides, row, blocks.x, self.turn_x.get(name, -1))
            self.clearance_blocks[name] = blocks.add(block, 0)
        # Strips and sectors of joints with distributed load have their rows after those of all contacts.
        for joint, block in zip(self.clearances, own, strict=True):
            row += joint.place_strips(block, row)
        #: Rows of a contact table: those of the contacts, then those of strips and sectors.
        self.rows = row

    def _place_integrals_of_contacts(self) -> None:
        """Collect the program place and integrals in x of each contact's joint."""
        of_contact = [joint for joint in self.clearances for _ in joint.contact_names]
        #: Least approach speed of each contact [m/s].
        self.approach_speed_floors = tuple(joint.approach_speed_floor for joint in of_contact)
        #: Place in the program of the joint of each contact.
        self.block_of_contact = tuple(self.clearance_blocks[joint.name] for joint in of_contact)
        strides = np.array([joint.stride for joint in of_contact], dtype=int)
        # Integrals are contact by contact, after the turned angles.
        starts = len(self.turn_x) + np.cumsum(strides) - strides
        self.impulse_x = starts + place_of(_layout.INTEGRALS, "impulse")
        self.lost_normal_x = starts + place_of(_layout.INTEGRALS, "lost_normal")
        self.lost_friction_x = starts + place_of(_layout.INTEGRALS, "lost_friction")
        bristles = [np.arange(a + _layout.BRISTLES, a + n) for a, n in zip(starts, strides, strict=True)]
        self._bristles: NDArray[np.int_] = np.concatenate([np.zeros(0, dtype=int), *bristles])

    def _place_elements(self, blocks: Blocks) -> None:
        """Lay out the elements at joints."""
        #: Elements in Python.
        self.callables: list[InPython | OnLinksInPython] = []
        #: Joints whose motion is prescribed.
        self.motions: list[DrivenJoint] = []
        #: Elements that may hold their joint.
        self.holds: list[DrivenJoint] = []
        #: Places in the program of the block of each element, by family, then by name.
        self.element_blocks: dict[str, dict[str, int]] = {table: {} for table in self.families}
        self.drive_blocks, self.spring_blocks = (self.element_blocks[one] for one in ("drives", "springs"))
        for table, elements in self.families.items():
            family, places = FAMILIES[table].word, self.element_blocks[table]
            for name, element in elements.items():
                if isinstance(element, BetweenPoints | OnLinks):
                    continue
                check_booked(family, name, element)
                x, place = blocks.x, f"{family} {name!r}"
                block = element_block(self, place, element, x)
                places[name] = at = blocks.add(block, len(element.integrals))
                if not isinstance(element, Element):
                    continue
                own = at + int(kernels.PARAMETERS)
                if element.in_python:
                    asked = element.callbacks(place, self.slides(element.joint))
                    self.callables.append(InPython(at, slice(own, at + len(block)), element, asked))
                if holds := element.has_row:
                    check_holds(place, self.mechanism, element)
                elif isinstance(element, Motion):
                    check_motion(place, self.mechanism, self.turn_x, self.drives, name, element)
                else:
                    continue
                (self.holds if holds else self.motions).append(
                    DrivenJoint(
                        name=f"{table}.{name}" if holds else name,
                        joint=element.joint,
                        turn=self.turn_x.get(element.joint, -1),
                        kind=kind_of(type(element)),
                        words=own,
                        x=x,
                        loaded=element.under_load,
                    )
                )

    @property
    def others(self) -> tuple[str, ...]:
        """The families that it has besides drives, springs and forces."""
        return tuple(table for table in self.families if table not in ("drives", "springs", "forces"))

    def check_pose(self, q: NDArray[np.float64], where: str) -> None:
        """Refuse a configuration, (nq,), in which a joint can move without any inertia, couplings held.

        Args:
            q: Configuration.
            where: Beginning of messages.

        Raises:
            MechanismError: The message names the joint.
        """
        ties = np.zeros((0, self.model.nv)) if self.plan is None else self.plan.ties
        self.mechanism.check_pose(q, where, ties)

    def slides(self, joint: str) -> bool:
        """Return whether a joint slides along its axis rather than turning about it."""
        held = self.free_with_axis.get(joint) == "prismatic"
        return held or slides(self.mechanism, self.clearances, joint)

    @property
    def closed_to_world(self) -> bool:
        """Return whether a closure holds the mechanism to the world."""
        return WORLD in {side.link for one in self.closures.values() for side in (one.first, one.second)}

    @property
    def sprung_to_world(self) -> bool:
        """Return whether a spring between points is fixed to the world."""
        return WORLD in {link for one in self.point_springs.values() for link, _ in (one.first, one.second)}

    @property
    def keeps_momentum(self) -> bool:
        """Return whether momenta less impulses of forces are conserved: free base, no gravity, no hold."""
        return (
            self.mechanism.base == "free"
            and not self.closed_to_world
            and not self.sprung_to_world
            and not np.any(self.model.gravity.linear)
        )

    # --- states ---------------------------------------------------------------------------------------------

    def state(self, q: ArrayLike, v: ArrayLike, angles: Mapping[str, float] | None = None) -> Array:
        """Return the state [q, v, x] with zero integrals, (nq + nv + nx,).

        Args:
            q: Configuration, (nq,). Its quaternions, and the cosine and sine of continuous and planar joints,
                are normalised if they are unit to 1e-6, and refused otherwise.
            v: Velocity, (nv,).
            angles: Angles of joints without limits [rad]: q gives the angle without whole turns. Others
                follow from couplings, or are in (-pi, pi].
        """
        y = self.state_as_given(q, v, angles)
        self.turn_on(y)
        fit_turns(self.mechanism, self.couplings.values(), y, self.turn_x, angles or {})
        return y

    def state_as_given(self, q: ArrayLike, v: ArrayLike, angles: Mapping[str, float] | None = None) -> Array:
        """Return :meth:`state`, checked as there, with no more of the angles than is given."""
        configuration, velocity = numbers(q, self.model.nq, "q", "m"), numbers(v, self.model.nv, "v", "m/s")
        make_unit(self.mechanism, configuration)
        x = np.zeros(self.manifold.nx)
        for name, angle in (angles or {}).items():
            if name not in self.turn_x:
                kind = "joint that turns without end"
                raise UnknownNameError("System.state: angles", kind, name, self.turn_x)
            x[self.turn_x[name]] = numbers([angle], 1, f"angles[{name!r}]", "rad")[0]
        return np.concatenate([configuration, velocity, x])

    def turn_on(self, y: Array) -> float:
        """Update the turned angles in y, in place; return the fastest rate [rad/s].

        Call it at accepted steps: no joint may have turned by half a turn since the last call.
        """
        return float(turn_kernels.turn_on(self.program, self.turns, y))

    def neutral(self) -> Array:
        """Return the configuration with joints at zero, or as couplings want, and journals centred, (nq,)."""
        q: Array = pin.neutral(self.model)
        put_followers(self.mechanism, self.couplings.values(), q)
        return q
