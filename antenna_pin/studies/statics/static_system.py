"""System without time: motions at rest, dry friction by sense, a driven joint."""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.contact import NoFriction
from antenna_pin.dynamics import BASE, JointMotion, System, assemble, check_closed
from antenna_pin.elements import (
    GonthierFriction,
    JointFriction,
    Motion,
    PrescribedMotion,
    StickingFriction,
    Thruster,
)
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.scenario import Scenario, scenario_named
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state

Array = NDArray[np.float64]

#: Name of the motion that drives a joint through its travel.
DRIVING = "quasi-static travel"
_HOLDING = "hold of {}"

# Slip speeds among which the largest coefficient of a friction law is searched [m/s].
_SLIPS = np.geomspace(1e-9, 1e2, 551)


class Model(NamedTuple):
    """A mechanism and where it starts."""

    system: System
    state: Array  # [q, v, x] with v = 0
    scenario: Scenario | None


def start_of(model: Scenario | System | str | os.PathLike[str], q: ArrayLike | None = None) -> Model:
    """Return the system of a model, at rest in its initial pose or in another.

    Args:
        model: A scenario, or its name or path, or a system.
        q: Configuration instead of that at the start, (nq,).
    """
    given: Any = scenario_named(model)
    if isinstance(given, Scenario):
        system = build_system(given)
        first, _ = initial_state(given, system)
        angles = initial_angles(given, system) if q is None else None
    else:
        system = given
        first, angles = system.neutral(), None
    y = system.state(first if q is None else q, np.zeros(system.model.nv), angles)
    if q is not None:
        check_closed(system, y)
    elif not isinstance(given, Scenario):
        assemble(system, y, (), ())
        y[system.model.nq : system.model.nq + system.model.nv] = 0.0
    return Model(system, y, given if isinstance(given, Scenario) else None)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class StaticSystem:
    """A system as statics takes it.

    Attributes:
        original: The system that it is of.
        system: The same with motions at rest where they are, without friction in contacts, and with dry
            friction that is rounded off in time replaced by friction that sticks.
        joint: Joint that is driven; None without.
        places: Of elements that were replaced: their original place, by that in ``system``.
        play_friction: Dry friction at joints with play, which cannot stick: joint and torque [N*m] ([N]), by
            place.
        contact_friction: Coefficient of friction of the contacts of a joint with play [-], by joint.
        notes: Assumptions, in sentences.
    """

    original: System
    system: System
    joint: str | None
    places: Mapping[str, str]
    play_friction: Mapping[str, tuple[str, float]]
    contact_friction: Mapping[str, float]
    notes: tuple[str, ...]

    def state_from(self, y: Array) -> Array:
        """Return the static state in the pose of an original state."""
        model = self.system.model
        nq, nv = model.nq, model.nv
        angles = {name: float(y[nq + nv + x]) for name, x in self.original.turn_x.items()}
        return self.system.state(y[:nq], np.zeros(nv), angles)

    def state_of_original(self, y: Array) -> Array:
        """Return the original state, at rest, in the pose of a static state."""
        model = self.system.model
        nq, nv = model.nq, model.nv
        angles = {name: float(y[nq + nv + x]) for name, x in self.system.turn_x.items()}
        return self.original.state(y[:nq], np.zeros(nv), angles)

    def place(self, place: str) -> str:
        """Return the original place of an element."""
        return self.places.get(place, place)


def static_system(
    system: System,
    y: Array,
    *,
    time: float = 0.0,
    joint: str | None = None,
    hold: Sequence[str] = (),
    without: Sequence[str] = (),
) -> StaticSystem:
    """Return a system as statics takes it.

    Args:
        system: The system.
        y: Its state, at which motions and joints that are held rest.
        time: At which motions and forces are taken [s].
        joint: Joint to be driven: drives there are taken out.
        hold: Further joints that do not move; ``base`` is held in any case.
        without: Names of drives to be left out.

    Raises:
        AntennaPinError: A joint that does not exist or has no axis, or that a motion prescribes.
    """
    mechanism = system.mechanism
    for name in [*hold, *([] if joint is None else [joint])]:
        if name not in mechanism.joints and name != BASE:
            raise UnknownNameError("statics", "joint", name, mechanism.joints)
    if joint is not None and joint in hold:
        raise InvalidParameterError("statics", "hold", f"other joints than the driven one, {joint!r}", joint)
    if mechanism.base == "free" and np.any(system.model.gravity.linear):
        raise MechanismError(
            "statics: a free base under gravity must be held to rest, got mechanism.base = 'free'; set "
            "mechanism.base = 'fixed', or mechanism.gravity to zero"
        )
    notes: list[str] = []
    families = {table: dict(elements) for table, elements in system.families.items()}
    families["springs"] = {n: one for n, one in families["springs"].items() if n not in system.elastic}
    families["drives"] = {n: one for n, one in families["drives"].items() if n not in without}
    for name, one in families.get("forces", {}).items():
        if isinstance(one, Thruster):  # its force has come to that of its command
            families["forces"][name] = dataclasses.replace(one, rise_time=0.0, fall_time=0.0)
        elif getattr(one, "states", ()):
            notes.append(f"states of forces.{name} stay as they are at the start")
    _rest_motions(system, families, y, time, joint, [name for name in hold if name != BASE], notes)
    places, play = _with_sticking(system, families)
    clearances, contact = _without_contact_friction(system.clearances)
    own = mechanism.urdf.mimics
    drives: dict[str, Any] = dict(families.pop("drives"))
    found = System(
        mechanism,
        clearances=clearances,
        drives=drives,
        springs=families.pop("springs"),
        held=system.held,
        closures={name: one for name, one in system.closures.items() if name not in system.held},
        couplings={name: one for name, one in system.couplings.items() if name not in own},
        elements={table: one for table, one in families.items() if one},
        elastic=system.elastic,
    )
    if mechanism.base == "free":
        notes.append("the free base is held")
    return StaticSystem(
        original=system,
        system=found,
        joint=joint,
        places=places,
        play_friction=play,
        contact_friction=contact,
        notes=tuple(notes),
    )


def _rest_motions(
    system: System,
    families: dict[str, dict[str, Any]],
    y: Array,
    time: float,
    joint: str | None,
    hold: Sequence[str],
    notes: list[str],
) -> None:
    """Replace motions by rest where they are at a time; hold and drive joints."""
    drives: dict[str, Any] = {}
    for name, one in families["drives"].items():
        if one.joint == joint or one.joint in hold:
            if one.joint == joint and not isinstance(one, Motion):
                notes.append(f"drive {name!r} at {joint} is off: the torque is what it has to give")
            continue
        if isinstance(one, Motion):
            one = PrescribedMotion(joint=one.joint, position=float(one.at(time)[0]))
        drives[name] = one
    for name in hold:
        drives[_HOLDING.format(name)] = PrescribedMotion(
            joint=name, position=_position(system, name, y, "hold")
        )
    if joint is not None:
        drives[DRIVING] = PrescribedMotion(joint=joint, position=_position(system, joint, y, "joint"))
    families["drives"] = drives


def _position(system: System, joint: str, y: Array, key: str) -> float:
    try:
        return JointMotion(system, joint)(y)[0]
    except MechanismError:
        kind = system.mechanism.joint(joint).kind
        rule = "a joint with one axis, revolute, continuous or prismatic"
        raise InvalidParameterError("statics", key, rule, said=f"{joint!r}, which is {kind} here") from None


def _with_sticking(
    system: System, families: dict[str, dict[str, Any]]
) -> tuple[dict[str, str], dict[str, tuple[str, float]]]:
    """Replace dry friction that is rounded off; return places, and that of joints with play."""
    places: dict[str, str] = {}
    play: dict[str, tuple[str, float]] = {}
    frictions = dict(families.get("frictions", {}))
    for name, one in list(families["springs"].items()):
        if not isinstance(one, JointFriction) or one.friction == 0.0 or not one.on:
            continue
        place = f"springs.{name}"
        if system.mechanism.joint(one.joint).has_one_axis:
            own = name if name not in frictions else f"{name} of springs"
            frictions[own] = StickingFriction(joint=one.joint, coulomb=one.friction, viscous=one.damping)
            del families["springs"][name]
            places[f"frictions.{own}"] = place
        else:
            families["springs"][name] = dataclasses.replace(one, friction=0.0)
            play[place] = one.joint, one.friction
    if frictions:
        families["frictions"] = frictions
    return places, play


def check_rate_independent(system: System) -> None:
    """Refuse friction without a limit at vanishing rate."""
    for name, one in system.families.get("frictions", {}).items():
        if isinstance(one, GonthierFriction) and one.on:
            raise MechanismError(
                f"statics: friction {name!r} must have a limit at vanishing rate, got kind "
                "'gonthier-bristle', which depends on the time of rest; take 'sticking', 'dahl' or 'lugre'"
            )


def _without_contact_friction(
    clearances: Sequence[ClearanceJoint],
) -> tuple[list[ClearanceJoint], dict[str, float]]:
    """Return joints with play without friction, and their largest coefficients of friction."""
    found, largest = [], {}
    for one in clearances:
        mu = _largest_coefficient(one.friction)
        if mu > 0.0:
            largest[one.name] = mu
        more: dict[str, Any] = {"friction": NoFriction()}
        if one.backend == "coal":
            more["backend"] = "closed-form"  # the same gaps, without a query in Python for each
        found.append(dataclasses.replace(one, **more))
    return found, largest


def _largest_coefficient(law: Any) -> float:
    """Return the coefficient of friction that a motion at small rate has to overcome [-]."""
    known = [getattr(law, name) for name in ("static", "coefficient_of_friction") if hasattr(law, name)]
    if known:
        return float(max(known))
    values = [float(law.coefficient(float(speed))) for speed in _SLIPS]
    return max(one for one in values if math.isfinite(one))
