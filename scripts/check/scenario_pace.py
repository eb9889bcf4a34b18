"""A random scenario brought to the speeds of impacts.

Rates are multiplied by a factor and forces by its square. That leaves the shape of the first motion as it was
and only changes how fast it is, so that journals meet bearings at millimetres to decimetres per second. The
factor stays below those at which an impact by its energy, or a load that the joint passes on, would press a
contact near the depth where its law, or a run, ends.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin import ClearanceJoint, Scenario, System, build_system
from antenna_pin.dynamics import Workspace, acceleration
from antenna_pin.joints.geometry import RevoluteClearance
from antenna_pin.scenario.assemble import initial_state

Array = NDArray[np.float64]
Random = np.random.Generator
Table = dict[str, Any]

SPEEDS = (3e-3, 0.3)  # [m/s]
DURATIONS = (0.02, 0.06)  # [s]
LARGEST_FACTOR = 4.0  # lest a balanced rotor be spun until it meets its bearing
DEPTH_SHARE = 0.2  # of the depth at which a run ends


def numbers(values: Any) -> list[float]:
    """Return an array as a scenario has it."""
    return [float(value) for value in values]


def inverse_mass(system: System, q: Array) -> Array:
    """Return the inverse of the mass matrix, (nv, nv)."""
    upper = np.triu(pin.computeMinverse(system.model, system.model.createData(), q))
    inverse: Array = upper + np.triu(upper, 1).T
    return inverse


def effective_mass(scenario: Scenario, system: System, joint: str) -> float:
    """Return the largest mass that a contact of a joint with play sees at the start [kg]."""
    y = system.state(*initial_state(scenario, system))
    contacts = [k for k, name in enumerate(system.contact_names) if name.rpartition(".")[0] == joint]
    workspace = Workspace(system)
    return max(workspace.effective_mass(y, contact) for contact in contacts)


def at_speed(table: Table, speed: float, rng: Random) -> Scenario | None:
    """Return the scenario with its fastest impact near a speed [m/s], or None if that takes too long."""
    scenario = Scenario.model_validate(table)
    system = build_system(scenario)
    fastest = _approach_speeds(scenario, system)
    largest = 1.0 if any(scenario.mechanism.gravity) else LARGEST_FACTOR
    factor = min(speed / max(fastest.values()), largest)
    loads = _loads(scenario, system)
    for joint in system.clearances:
        mass = effective_mass(scenario, system, joint.name)
        speed_limit, load_limit = _limits(joint, mass)
        factor = min(factor, speed_limit / fastest[joint.name], math.sqrt(load_limit / loads[joint.name]))
    times = [2.0 * j.geometry.radial_clearance / (factor * fastest[j.name]) for j in system.clearances]
    if factor * max(fastest.values()) < SPEEDS[0] or 5.0 * min(times) > DURATIONS[1]:
        return None
    duration = min(times) * rng.uniform(4.0, 12.0)
    table["duration"] = float(np.clip(duration, *DURATIONS))
    _multiply(table, factor)
    return Scenario.model_validate(table)


def _approach_speeds(scenario: Scenario, system: System) -> dict[str, float]:
    """Return about how fast each journal meets its bearing: what it has, and what it gains over the play."""
    q, v = initial_state(scenario, system)
    a = acceleration(system, 0.0, q, v)
    found = {}
    for joint in system.clearances:
        slot = system.mechanism.joint(joint.name)
        play = 2.0 * max(joint.geometry.radial_clearance, joint.axial_clearance or 0.0)
        reach = 0.5 * float(getattr(joint.geometry, "bearing_length", 0.0))
        speed, gain = (_of_surface(slot, one[slot.v], joint.offset, reach) for one in (v, a))
        found[joint.name] = speed + math.sqrt(2.0 * play * gain)
    return found


def _of_surface(slot: Any, twist: Array, offset: float, reach: float) -> float:
    """Return the size of a twist's motion at the journal's surface, the turn about its own axis left out."""
    if slot.kind == "planar":
        return float(np.linalg.norm(twist[:2]))
    centre = twist[:3] + np.cross(twist[3:], offset * slot.axis)
    tilting = np.linalg.norm(twist[3:] - (twist[3:] @ slot.axis) * slot.axis)
    return float(np.linalg.norm(centre) + reach * tilting)


def _loads(scenario: Scenario, system: System) -> dict[str, float]:
    """Return about what each joint with play would carry if it were locked: force, and moment over its lever.

    A light link between heavy ones carries far more than it takes to move it.
    """
    q, v = initial_state(scenario, system)
    slots = [system.mechanism.joint(joint.name) for joint in system.clearances]
    freed = np.concatenate([np.arange(slot.v.start, slot.v.stop) for slot in slots])
    inverse = inverse_mass(system, q)[np.ix_(freed, freed)]
    held = np.zeros(system.model.nv)
    held[freed] = np.linalg.solve(inverse, acceleration(system, 0.0, q, v)[freed])
    found = {}
    for joint, slot in zip(system.clearances, slots, strict=True):
        wrench = held[slot.v]
        load = float(np.linalg.norm(wrench[:2] if slot.kind == "planar" else wrench[:3]))
        if isinstance(joint.geometry, RevoluteClearance):
            moment = wrench[3:] - np.cross(joint.offset * slot.axis, wrench[:3])
            across = float(np.linalg.norm(moment - (moment @ slot.axis) * slot.axis))
            load += across / max(joint.geometry.bearing_length, joint.geometry.bearing_outer_radius)
        found[joint.name] = max(load, 1e-9)
    return found


def _limits(joint: ClearanceJoint, mass: float) -> tuple[float, float]:
    """Return speed and load that press a contact to a share of the depth at which a run ends [m/s, N]."""
    depths = [DEPTH_SHARE * limit for limit in joint.depth_limits]
    laws = list(zip(joint.normal_laws, depths, strict=True))
    energy = min(law.elastic_energy(depth) for law, depth in laws)
    return math.sqrt(2.0 * energy / mass), min(law.elastic_force(depth) for law, depth in laws)


def _multiply(table: Table, factor: float) -> None:
    """Multiply rates by a factor, forces by its square and dampers by itself."""
    square = factor * factor
    table["mechanism"]["gravity"] = numbers(square * np.array(table["mechanism"]["gravity"]))
    rates = ("velocity", "rate", "journal_velocity", "journal_angular_velocity", "angular_velocity")
    for state in (*table["initial"]["joints"].values(), table["initial"].get("base", {})):
        for name in rates:
            if name in state:
                values = state[name]
                state[name] = (
                    factor * values if isinstance(values, float) else numbers(factor * np.array(values))
                )
    for drive in table["drives"].values():
        for name in ("value", "amplitude"):
            if name in drive:
                drive[name] *= square
        if "torque" in drive:
            drive["torque"] = numbers(square * np.array(drive["torque"]))
    for spring in table["springs"].values():
        spring["stiffness"] *= square
        spring["damping"] *= factor
