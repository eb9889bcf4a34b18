"""From a scenario to a system."""

from __future__ import annotations

import warnings

from antenna_pin.assemble.closures import closures_of
from antenna_pin.assemble.couplings import couplings_of
from antenna_pin.assemble.elements import elements_of
from antenna_pin.assemble.flexible import by_name
from antenna_pin.assemble.friction import frictions_of
from antenna_pin.assemble.laws import clearance_joint
from antenna_pin.assemble.places import check_known, check_motion
from antenna_pin.assemble.rotors import armature_of
from antenna_pin.assemble.shaken import among_others
from antenna_pin.assemble.variant import as_written, types_as_written, variant_and_parts
from antenna_pin.base.arguments import takes
from antenna_pin.control import measures_of
from antenna_pin.dynamics import HeldKind, System, settled
from antenna_pin.errors import AssumedWarning, MechanismError, NotSimulatedWarning
from antenna_pin.mechanism import Mechanism, WrittenUrdf, build_mechanism
from antenna_pin.scenario import AngleEvent, ForceEvent, GapEvent, RateEvent, Scenario
from antenna_pin.scenario.assumed import said_of_assumed
from antenna_pin.scenario.clearance import TouchingSpec

__all__ = ["build_system"]

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
    urdf, parts = variant_and_parts(scenario)
    said = scenario.mechanism
    mechanism = build_mechanism(
        urdf, said.base, said.gravity, armature_of(scenario), regular=not scenario.couplings
    )
    found = {table: elements_of(scenario, mechanism, table) for table in scenario.families}
    found = dict(among_others(scenario, found))
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
    left_out = (*said_of_file(as_written(scenario), mechanism), *own.left_out)
    assumed = (*said_of_assumed(scenario.clearance), *own.assumed)
    for lines, category in ((left_out, NotSimulatedWarning), (assumed, AssumedWarning)):
        for line in lines:
            warnings.warn(line, category, stacklevel=2)
    types = types_as_written(scenario)
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
        assumed=assumed,
    )
    _check_events(scenario, system)
    _check_controllers(scenario, system)
    return system


def said_of_file(written: WrittenUrdf, mechanism: Mechanism) -> tuple[str, ...]:
    """Return what is said when a URDF is loaded: how much was passed over, what was taken for granted."""
    urdf = mechanism.urdf
    lines = [written.said_of_passed_over()]
    lines += [
        f"{urdf.where}: no body has the inertia of {one}; it is taken as it is"
        for one in mechanism.impossible
    ]
    for names, said in (
        (urdf.unbounded, "no bounds in the <limit> of joints, which are taken as without"),
        (urdf.points, "no <inertia> beside the <mass> of links, which are taken as points"),
    ):
        if names:
            more = len(names) - _NAMED
            rest = f" and {more} more" if more > 0 else ""
            lines.append(f"{urdf.where}: {said}: {', '.join(names[:_NAMED])}{rest}")
    return tuple(line for line in lines if line)


def _check_events(scenario: Scenario, system: System) -> None:
    """Refuse events on joints and contacts that there are not, or in units of another motion."""
    for name, spec in scenario.events.items():
        place = ("events", name)
        if isinstance(spec, AngleEvent | RateEvent):
            check_known(scenario, [spec.joint], "moving joint", system.mechanism.joints, *place, "joint")
            check_motion(scenario, system.mechanism.joint(spec.joint), spec.motion, *place)
        elif isinstance(spec, GapEvent | ForceEvent):
            check_known(scenario, [spec.contact], "contact", system.contact_names, *place, "contact")


def _check_controllers(scenario: Scenario, system: System) -> None:
    """Refuse controllers that measure at joints and contacts that there are not, or in other units."""
    own = {name: spec.build() for name, spec in scenario.controllers.items()}
    for name, one in settled(own, system).items():
        place, spec = ("controllers", name), scenario.controllers[name]
        for measure in measures_of(one):
            if measure.of == "joint":
                joints = system.mechanism.joints
                check_known(scenario, [measure.name], "moving joint", joints, *place, "measures")
                check_motion(scenario, system.mechanism.joint(measure.name), spec.motion, *place)
            elif measure.of == "contact":
                check_known(scenario, [measure.name], "contact", system.contact_names, *place, "measures")
