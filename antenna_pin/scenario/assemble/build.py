"""Systems of scenarios: Pinocchio model, force elements, constraints, references."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Collection
from typing import Any, NamedTuple

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import readable
from antenna_pin.dynamics import HeldKind, System, settled
from antenna_pin.dynamics.constraints import Coupling
from antenna_pin.elements import JointFriction, Reference, StickingFriction
from antenna_pin.elements.control import measures_of
from antenna_pin.errors import (
    AssumedWarning,
    InvalidParameterError,
    MechanismError,
    NotSimulatedWarning,
    ScenarioError,
)
from antenna_pin.mechanism import JointSlot, Mechanism, WrittenUrdf, build_mechanism
from antenna_pin.scenario import (
    AllLinksSpec,
    AngleEvent,
    AtPointSpec,
    CouplingSpec,
    DifferentialSpec,
    ForceEvent,
    GapEvent,
    JointsSpec,
    PlanetarySpec,
    PointsSpec,
    RateEvent,
    Scenario,
    moved_joints,
)
from antenna_pin.scenario.assemble.closures import closures_of, link_of
from antenna_pin.scenario.assemble.laws import clearance_joint
from antenna_pin.scenario.assemble.places import (
    as_written,
    check_known,
    check_motion,
    slides,
    unchanged_joint_types,
    where,
)
from antenna_pin.scenario.assemble.temperature import at_temperature, said_of_temperature
from antenna_pin.scenario.assemble.variant import (
    armature_of,
    by_name,
    elements_by_family,
    variant_and_parts,
)
from antenna_pin.scenario.clearance import TouchingSpec, said_of_assumed

# --- references ---------------------------------------------------------------------------------------------


@takes()
def reference_for(scenario: Scenario, name: str, slot: JointSlot | None, pure: bool = False) -> Reference:
    """Return a reference of a scenario by name.

    Args:
        scenario: The scenario.
        name: Of the reference.
        slot: The joint that is to follow it; None if it is no joint that does.
        pure: Whether its values are to be pure numbers, by which something is multiplied.

    Raises:
        ScenarioError: Its units are those of another motion.
    """
    spec = scenario.references[name]
    if slot is not None:
        check_motion(scenario, slot, spec.motion, "references", name)
    if pure and spec.motion is not None:
        raise ScenarioError(
            f"{where(scenario, 'references', name)}: values must be pure numbers, for they multiply a force "
            f"that follows them, got units of a {spec.motion}; write bare numbers"
        )
    parts = getattr(spec, "parts", None)
    more = (
        {} if parts is None else {"parts": tuple(reference_for(scenario, one, slot, pure) for one in parts)}
    )
    try:
        found: Reference = spec.build(**more)
    except InvalidParameterError as error:
        raise ScenarioError(f"references.{name}.{error.parameter} {error.reason}") from None
    return found


# --- systems ------------------------------------------------------------------------------------------------

# --- friction of joints themselves: what the URDF's ``<dynamics>`` says and the scenario changes ---

# Of its limit: the load by which the creep of a friction that is rounded off is described.
_LOAD = 0.5


class Frictions(NamedTuple):
    """Friction of joints themselves.

    Attributes:
        smooth: That which is rounded off at rest, by name.
        sticking: That which sticks, by name.
        left_out: Lines on what is not simulated.
        assumed: Lines on friction that is rounded off by default.
    """

    smooth: dict[str, JointFriction]
    sticking: dict[str, StickingFriction]
    left_out: tuple[str, ...]
    assumed: tuple[str, ...]


def frictions_of(scenario: Scenario, mechanism: Mechanism, others: Collection[str]) -> Frictions:
    """Return the friction of each joint that has some, as ``JOINT.dynamics``.

    That of a joint with play acts about its axis, beside the friction of its contacts.

    Raises:
        ScenarioError: Units of another motion, a speed without friction, or a spring of that name.
    """
    urdf = as_written(scenario)
    types = {name: joint.type for name, joint in urdf.joints.items()}
    numbers = {name: dict(given) for name, given in urdf.joint_friction.items()}
    for name, change in scenario.mechanism.joints.items():
        for key in ("damping", "friction"):
            if (value := getattr(change, key)) is not None:
                numbers.setdefault(name, {})[key] = value
        place = where(scenario, "mechanism", "joints", name)
        for key in ("regularisation_speed", "sticks"):
            if getattr(change, key) is not None and not numbers.get(name, {}).get("friction"):
                raise ScenarioError(
                    f"{place}.{key}: must be left out of a joint without friction; give it friction, here or "
                    "in the URDF"
                )
        if change.regularisation_speed is not None:
            if change.sticks:
                raise ScenarioError(
                    f"{place}.regularisation_speed: must be left out of a joint whose friction sticks, for "
                    "that is not rounded off; leave out one of the two"
                )
            numbers[name]["regularisation_speed"] = change.regularisation_speed
    # Those have an axis though they are free.
    with_axis = {*scenario.clearance, *(one.joint for one in scenario.families.get("bearings", {}).values())}
    moved = moved_joints(scenario.model_dump(include={"drives", "couplings"}, exclude_none=True))
    found: dict[str, JointFriction] = {}
    sticking: dict[str, StickingFriction] = {}
    assumed: list[str] = []
    left_out = list(urdf.not_simulated)
    for name, given in numbers.items():
        if name not in mechanism.joints or not (given.get("damping") or given.get("friction")):
            continue
        slot = mechanism.joint(name)
        if name in scenario.mechanism.joints:
            check_motion(scenario, slot, scenario.mechanism.joints[name].motion, "mechanism", "joints", name)
        if slot.kind in ("floating", "planar") and name not in with_axis:
            left_out.append(
                f"{urdf.where}: joint {name!r}: its damping and friction are not simulated, because it "
                f"becomes "
                f"{slot.kind} from {types[name]} and has no axis"
            )
            continue
        own = f"{name}.dynamics"
        if own in others:
            family = "springs" if own in scenario.springs else "frictions"
            raise ScenarioError(
                f"{where(scenario, family, own)}: must have another name, which that of the joint's own "
                "friction bears"
            )
        dry, wet = given.get("friction", 0.0), given.get("damping", 0.0)
        spec = scenario.mechanism.joints.get(name)
        sticks = None if spec is None else spec.sticks
        can_stick = slot.kind not in ("floating", "planar") and name not in moved
        if sticks or (sticks is None and can_stick and dry > 0.0 and "regularisation_speed" not in given):
            sticking[own] = StickingFriction(joint=name, coulomb=dry, viscous=wet)
            continue
        found[own] = JointFriction(joint=name, **given)  # type: ignore[arg-type]  # of numbers only
        if dry > 0.0 and name not in moved:
            assumed.append(_said_of_creep(found[own], slides(scenario, slot), can_stick))
    return Frictions(found, sticking, tuple(left_out), tuple(assumed))


def _said_of_creep(friction: JointFriction, slid: bool, can_stick: bool) -> str:
    """Return by how much a joint creeps under a load that its friction should hold."""
    rate = friction.regularisation_speed * _LOAD / math.sqrt(1.0 - _LOAD**2)
    units = ("N", "m/s") if slid else ("N m", "rad/s")
    limit, creep = readable(friction.friction, units[0], 3), readable(rate, units[1], 3)
    way_out = (
        f"mechanism.joints.{friction.joint}.sticks = true holds it"
        if can_stick
        else "only a joint without play can stick; a lower regularisation_speed creeps less"
    )
    return (
        f"{friction.joint}: its friction of {limit} is rounded off at rest and does not stick: under half "
        f"that load it creeps at {creep}; {way_out}"
    )


# --- the force elements of a scenario ---


def elements_of(scenario: Scenario, mechanism: Mechanism, family: str) -> dict[str, Any]:
    """Return the elements of one family of a scenario by name.

    Raises:
        AntennaPinError: A joint, link or frame that there is not, or units of another motion.
    """
    found: dict[str, Any] = {}
    for name, spec in scenario.families.get(family, {}).items():
        if isinstance(spec, PointsSpec):
            ends = {}
            for side in ("first", "second"):
                end = getattr(spec, side)
                link, _ = link_of(scenario, mechanism, end, family, name, side)
                ends[side] = link, end.point or (0.0, 0.0, 0.0)
            found[name] = spec.build(**ends)
        elif isinstance(spec, AtPointSpec):
            link, _ = link_of(scenario, mechanism, spec.at, family, name, "at")
            found[name] = spec.build(
                at=(link, spec.at.point or (0.0, 0.0, 0.0)), **_reference_of(scenario, spec, None)
            )
        elif isinstance(spec, AllLinksSpec):
            found[name] = spec.build()
        elif isinstance(spec, JointsSpec):
            for side in ("input", "output"):
                joint = getattr(spec, side)
                check_known(scenario, [joint], "moving joint", mechanism.joints, family, name, side)
            found[name] = spec.build()
        else:
            place = (family, name)
            check_known(scenario, [spec.joint], "moving joint", mechanism.joints, *place, "joint")
            slot = mechanism.joint(spec.joint)
            check_motion(scenario, slot, spec.motion, *place)
            if (other := getattr(spec, "measures", None)) is not None:
                check_known(scenario, [other], "moving joint", mechanism.joints, *place, "measures")
            found[name] = spec.build(**_reference_of(scenario, spec, slot))
    return found


def _reference_of(scenario: Scenario, spec: Any, slot: JointSlot | None) -> dict[str, Any]:
    """Return the reference of a table as its argument ``follows``, if it names one."""
    follows = getattr(spec, "follows", None)
    return {} if follows is None else {"follows": reference_for(scenario, follows, slot, slot is None)}


# --- the couplings of a scenario, beside those of its URDF ---


def couplings_of(scenario: Scenario, mechanism: Mechanism) -> dict[str, Coupling]:
    """Return the couplings of a scenario by name; not those whose follower it locks.

    Raises:
        ScenarioError: Joints that there are not, units of other joints, a name that is taken.
    """
    joints = [joint.name for joint in mechanism.urdf.robot.joints]
    found = {}
    for name, spec in scenario.couplings.items():
        place = ("couplings", name)
        for key in spec.roles.values():
            if (joint := getattr(spec, key)) is not None:
                check_known(scenario, [joint], "joint", joints, *place, key)
        change = scenario.mechanism.joints.get(getattr(spec, spec.roles["follower"]))
        if change is not None and change.kind == "locked":
            continue
        for what, taken in (("closure", scenario.closures), ("joint with <mimic>", mechanism.urdf.mimics)):
            if name in taken:
                raise ScenarioError(
                    f"{where(scenario, *place)}: must have another name; there is a {what} {name!r}"
                )
        if isinstance(spec, CouplingSpec):
            _check_units(scenario, mechanism, spec, *place)
        try:
            found[name] = _built(spec)
        except InvalidParameterError as error:
            key = spec.roles.get(error.parameter, error.parameter)
            raise ScenarioError(f"{where(scenario, *place, key)}: {error.reason}") from None
    return found


def _built(spec: CouplingSpec | DifferentialSpec | PlanetarySpec) -> Coupling:
    makers: dict[str, Callable[..., Coupling]]
    makers = {"differential": Coupling.differential, "planetary": Coupling.planetary}
    fields = type(spec).model_fields.keys() - {"kind", "motion", "conversion"}
    return makers.get(spec.kind, Coupling)(**{name: getattr(spec, name) for name in fields})


def _check_units(scenario: Scenario, mechanism: Mechanism, spec: CouplingSpec, *place: str) -> None:
    """Refuse units that are not those of the joints."""
    if spec.follower not in mechanism.joints:
        return
    follower = mechanism.joint(spec.follower)
    check_motion(scenario, follower, spec.motion, *place, "offset")
    if spec.leader not in mechanism.joints:
        return
    units = ["m" if slot.slides else "rad" for slot in (follower, mechanism.joint(spec.leader))]
    ratio = "1" if units[0] == units[1] else "/".join(units)
    if spec.conversion not in (None, ratio):
        raise ScenarioError(
            f"{where(scenario, *place, 'multiplier')}: must be a number"
            f"{'' if ratio == '1' else f' in {ratio}'}, for {spec.follower!r} is {follower.kind} and "
            f"{spec.leader!r} {mechanism.joint(spec.leader).kind}, got units of {spec.conversion}"
        )


# To what a joint of the URDF is held by constraint.
_HELD: dict[str, HeldKind] = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "floating": "spherical",
}

# Joints that a line names.
_NAMED = 6


@takes()
def build_system(scenario: Scenario) -> System:
    """Return the system of a scenario's case.

    Raises:
        AntennaPinError: Names, dimensions or laws that do not go together; one line that says where.
    """
    thermal = tuple(said_of_temperature(scenario))
    scenario = at_temperature(scenario)
    urdf, parts = variant_and_parts(scenario)
    said = scenario.mechanism
    mechanism = build_mechanism(
        urdf, said.base, said.gravity, armature_of(scenario), regular=not scenario.couplings
    )
    found = {table: elements_of(scenario, mechanism, table) for table in scenario.families}
    found = dict(elements_by_family(scenario, found))
    drives, springs = found.pop("drives"), found.pop("springs")
    dry = found.pop("frictions", {})
    if said.strict and mechanism.impossible:
        raise MechanismError(
            f"{urdf.where}: {mechanism.impossible[0]}; correct it, name the link in "
            "mechanism.allow_impossible_inertia, or leave out mechanism.strict"
        )
    own = frictions_of(scenario, mechanism, {**springs, **dry})
    if dry or own.sticking:
        found["frictions"] = {**dry, **own.sticking}
    left_out = (*_urdf_warnings(as_written(scenario), mechanism), *own.left_out)
    assumed = (*said_of_assumed(scenario.clearance), *own.assumed)
    for lines, category in ((left_out, NotSimulatedWarning), (assumed, AssumedWarning)):
        for line in lines:
            warnings.warn(line, category, stacklevel=2)
    types = unchanged_joint_types(scenario)
    system = System(
        mechanism,
        clearances=[
            clearance_joint(scenario, name, spec)
            for name, spec in scenario.clearance.items()
            if isinstance(spec, TouchingSpec)
        ],
        drives=drives,
        springs={**springs, **own.smooth},
        elements=found,
        held={
            name: _HELD[types[name]]
            for name, spec in scenario.clearance.items()
            if spec.model == "constraint"
        },
        closures=closures_of(scenario, mechanism),
        couplings=couplings_of(scenario, mechanism),
        elastic=by_name(scenario, parts),
        left_out=left_out,
        assumed=(*thermal, *assumed),
    )
    _check_events(scenario, system)
    _check_controllers(scenario, system)
    return system


def _urdf_warnings(written: WrittenUrdf, mechanism: Mechanism) -> tuple[str, ...]:
    """Return the warnings of loading a URDF: elements passed over, defaults assumed."""
    urdf = mechanism.urdf
    lines = [written.said_of_passed_over()]
    lines += [
        f"{urdf.where}: the inertia of {one} is impossible for a body; it is used unchanged"
        for one in mechanism.impossible
    ]
    for names, said in (
        (urdf.unbounded, "no bounds in the <limit> of joints, which are unlimited"),
        (urdf.points, "a <mass> without <inertia> in links, which become point masses"),
    ):
        if names:
            more = len(names) - _NAMED
            rest = f" and {more} more" if more > 0 else ""
            lines.append(f"{urdf.where}: {said}: {', '.join(names[:_NAMED])}{rest}")
    return tuple(line for line in lines if line)


def _check_events(scenario: Scenario, system: System) -> None:
    """Refuse events at unknown joints and contacts, or in units of another motion."""
    for name, spec in scenario.events.items():
        place = ("events", name)
        if isinstance(spec, AngleEvent | RateEvent):
            check_known(scenario, [spec.joint], "moving joint", system.mechanism.joints, *place, "joint")
            check_motion(scenario, system.mechanism.joint(spec.joint), spec.motion, *place)
        elif isinstance(spec, GapEvent | ForceEvent):
            check_known(scenario, [spec.contact], "contact", system.contact_names, *place, "contact")


def _check_controllers(scenario: Scenario, system: System) -> None:
    """Refuse controllers that measure at unknown joints and contacts, or in other units."""
    own = {name: spec.build() for name, spec in scenario.controllers.items()}
    for name, one in settled(own, system).items():
        place, spec = ("controllers", name), scenario.controllers[name]
        for measure in measures_of(one):
            if measure.of == "joint":
                joints, motion = system.mechanism.joints, getattr(spec, "motion", None)
                check_known(scenario, [measure.name], "moving joint", joints, *place, "measures")
                check_motion(scenario, system.mechanism.joint(measure.name), motion, *place)
            elif measure.of == "contact":
                check_known(scenario, [measure.name], "contact", system.contact_names, *place, "measures")
