"""Schema of results: the table of dimensions and variables.

Recorder, files, ``Trajectory.load`` and docs/trajectory.md use it. A variable is there if all its dimensions
are: contacts, drives or springs that a mechanism does not have, have no dimension. A *lean* result has no
``time``, and so none of the series.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from typing import Any

from antenna_pin.joints.geometry import AxialScenario, RadialScenario
from antenna_pin.trajectory.columns import ColumnRule, Coordinate, Variable, rows
from antenna_pin.trajectory.quantities import COUPLED, EPISODES, LOST, ORDERED, SIZE, SUMMARIES, TOTAL

#: Every dimension and what runs along it.
DIMENSIONS: dict[str, str] = {
    "time": "samples",
    "axis": "x, y, z",
    "quaternion": "x, y, z, w",
    "configuration": "numbers of `q`, in Pinocchio's order; named after the joint and the coordinate",
    "coordinate": "numbers of `v` and `a`",
    "joint": "joints that turn about an axis: ideal ones, and clearance joints by their motion angle",
    "sliding_joint": "joints that slide along their axis",
    "clearance_joint": "joints with play, by their URDF name",
    "contact": "candidate contacts, by their joint, kind and end",
    "drive": "drives, by name",
    "controller": "drives that follow a reference, by name",
    "motion": "drives that prescribe their joint's motion, by name",
    "motor": "drives that are motors, by name",
    "spring": "springs, dampers and joint friction, by name",
    "traced_spring": "springs at joints with a table, hysteresis or constant torque",
    "element": "elements of other families (stops, latches, bearings), by family and name",
    "bristle": "friction elements with bristles, by family and name",
    "dwelling": "friction elements with bristles and a dwell",
    "change": "changes of mode of elements, in order of time, by element and event",
    "bearing": "ball bearings and preloads, by name",
    "point_spring": "springs between points",
    "force": "forces on links, by name",
    "force_place": "points of application of forces, by force; for a force on several links by link",
    "elastic_part": "elastic parts of flexible links, by name",
    "closure": "closures of loops, by name",
    "coupling": "coupled joints, by name; for couplings of the URDF by follower",
    "event": "events of the user, by name",
    "sampled": "sampled controllers, by name",
    "tick": "samples of controllers, in order of time",
    "signal": "recorded signals and commands, by controller and name",
    "episode": "contacts from onset to release, in order of onset",
}

#: Labels of contacts beside their names.
COORDINATES: tuple[Coordinate, ...] = (
    Coordinate("contact_joint", "contact", "clearance joint of the contact"),
    Coordinate("contact_kind", "contact", "radial (in the bore), axial (at a flange), spherical or another"),
    Coordinate("traced_joint", "traced_spring", "joint that the spring acts at"),
    Coordinate("contact_end", "contact", "the bearing's end along its axis: +, - or none"),
)


_UNIT, _FREE = ColumnRule(unit=True), {"free_base": True}
_STORED = ColumnRule(summed=True)  # below zero of a table: where it stores nothing is a matter of choice
_PRESSED = ColumnRule(least=0.0, beside="touching")
#: What the times of samples may be.
TIME = ORDERED


def _scenario_row(name: str, kinds: type[RadialScenario | AxialScenario]) -> tuple[Any, ...]:
    """Return the row of a contact scenario, whose numbers stand for its kinds."""
    flags = tuple((int(kind.value), kind.name.lower()) for kind in kinds)
    rule = ColumnRule(only=tuple(float(value) for value, _ in flags))
    return f"{name}_scenario", "1", f"contact scenario, {name}", rule, {"flags": flags}


_APART = "bodies without the base"

# State, accelerations and loads at the samples.
_STATES: tuple[Variable, ...] = rows(
    "state: time configuration",
    ("q", "m, rad or 1", "configuration, Pinocchio's order"),
    "state: time coordinate",
    ("v", "m/s or rad/s", "generalized velocity, body axes"),
    "derivative: time coordinate",
    ("a", "m/s^2 or rad/s^2", "generalized acceleration, body axes"),
    "state: time axis",
    ("base_position", "m", "base in the world", _FREE),
    ("base_velocity", "m/s", "base, in its own axes", _FREE),
    ("base_angular_velocity", "rad/s", "base, in its own axes", _FREE),
    "state: time quaternion",
    ("base_attitude", "1", "base in the world, quaternion", _UNIT, _FREE),
    "derivative: time drive",
    ("drive_torque", "N m|N", "torque of the drive (a force [N] if it slides)"),
    "derivative: time motor",
    ("motor_current", "A", "current of the winding"),
    ("motor_electric_energy", "J", "energy from the supply since the start"),
    ("motor_heat", "J", "heat of the winding since the start", TOTAL),
    "derivative: time controller",
    ("control_reference", "rad|m", "angle that the controller follows (a way [m] if it slides)"),
    ("control_error", "rad|m", "reference less the joint's angle (way [m])"),
    "derivative: time point_spring",
    ("spring_length", "m", "distance of the spring's points", SIZE),
    ("spring_tension", "N", "force of spring and damper that draws the points together"),
    "derivative: time point_spring axis",
    ("spring_force", "N", "force of the spring on its second link, world axes"),
    "derivative: time closure axis",
    ("closure_force", "N", "force of the closure on its second link, axes of its first side"),
    ("closure_moment", "N m", "its moment about the second side's point"),
    "derivative: time coupling",
    ("coupling_torque", "N m|N", COUPLED),
)
# Contacts, and the journals that they are at.
_CONTACTS: tuple[Variable, ...] = rows(
    "contact: time contact",
    ("gap", "m", "distance of the surfaces, negative in contact"),
    ("depth", "m", "penetration depth", SIZE),
    ("depth_rate", "m/s", "rate of penetration, positive closing"),
    ("slip_speed", "m/s", "tangential speed of the journal over the bearing", SIZE),
    ("normal_force", "N", "normal force on the journal", _PRESSED),
    ("friction_force", "N", "friction on the journal", _PRESSED),
    ("touching", "1", "whether the contact touches", ColumnRule(only=(0.0, 1.0))),
    "contact: time contact axis",
    ("contact_force", "N", "force on the journal, bearing axes", ColumnRule(beside="touching")),
    ("contact_point", "m", "candidate contact, from the bearing's centre"),
    "contact: time clearance_joint axis",
    ("journal_position", "m", "journal's centre in the bearing"),
    ("joint_force", "N", "contact force on the journal"),
    ("joint_torque", "N m", "contact torque about the journal's centre"),
    "contact: time clearance_joint quaternion",
    ("journal_attitude", "1", "journal in the bearing, quaternion", _UNIT),
    "contact: time clearance_joint",
    (
        "journal_tilt",
        "rad",
        "angle between the axes of journal and bearing",
        ColumnRule(least=0.0, most=math.pi),
    ),
    "bearing: time bearing axis",
    ("bearing_place", "m", "journal at the bearing's reference point, bearing axes"),
    ("bearing_tilt", "1", "tilt of the journal's axis, z x axis; its size is the sine"),
    ("bearing_force", "N", "force of the bearing on the journal, bearing axes"),
    ("bearing_moment", "N m", "its moment about the reference point, bearing axes"),
    "contact: time clearance_joint",
    _scenario_row("radial", RadialScenario),
    _scenario_row("axial", AxialScenario),
)
# Energies, what is put in and lost, momenta.
_ENERGIES: tuple[Variable, ...] = rows(
    "audit: time",
    ("kinetic_energy", "J", "kinetic energy", TOTAL),
    ("contact_energy", "J", "energy stored in contacts"),
    ("spring_energy", "J", "energy stored in springs, at joints and between points", _STORED),
    ("gravity_energy", "J", "potential energy of gravity"),
    "audit: time elastic_part",
    ("elastic_energy", "J", "energy stored in the part's spring", TOTAL),
    "ledger: time elastic_part",
    ("dissipation_elastic", "J", "energy lost in the part's damper", TOTAL),
    "motion: time elastic_part",
    ("deflection", "rad|m", "of the part from rest (a way [m] if it slides)"),
    ("deflection_rate", "rad/s|m/s", "its rate (m/s)"),
    ("deflection_acceleration", "rad/s^2|m/s^2", "its acceleration (m/s^2)"),
    "ledger: time drive",
    ("drive_work", "J", "work of the drive since the start"),
    ("drive_gross_work", "J", "integral of |power| of the drive", TOTAL),
    "ledger: time contact",
    ("dissipation_normal", "J", "energy lost to normal contact", LOST),
    ("dissipation_friction", "J", "energy lost to friction", LOST),
    ("normal_impulse", "N s", "integral of normal force", TOTAL),
    "ledger: time spring",
    ("dissipation_damper", "J", "energy lost in the damper, or to a joint's own friction", TOTAL),
    "derivative: time traced_spring",
    ("spring_torque", "N m|N", "torque on the child (a force [N])"),
    "derivative: time element",
    ("element_effort", "N m|N", "torque about the joint's axis, what holds it included (a force [N])"),
    (
        "element_deflection",
        "rad|m",
        "argument of the force: its joint's angle, a gear's deflection (a displacement [m])",
    ),
    ("element_energy", "J", "energy stored"),
    ("element_mode", "1", "number of the mode"),
    "state: time bristle",
    ("bristle_bend", "1", "deflection, over that at Coulomb friction"),
    "state: time dwelling",
    ("bristle_dwell", "1", "dwell, 1 after a long rest"),
    "ledger: time element",
    ("element_loss", "J", "energy lost in dampers and impulses", LOST),
    "ledger: time",
    ("energy_error", "J", "stored - start - work of drives and forces + losses"),
    "audit: time axis",
    ("linear_momentum", "kg m/s", "of the whole, world axes"),
    ("angular_momentum", "kg m^2/s", "of the whole about its mass centre, world axes"),
    "audit: time",
    ("momentum_scale", "kg m/s", f"summed magnitudes, {_APART}", SIZE),
    (
        "angular_momentum_scale",
        "kg m^2/s",
        f"summed magnitudes about the mass centre, {_APART}",
        SIZE,
    ),
)
# Joints with one axis.
_MOTIONS: tuple[Variable, ...] = rows(
    "motion: time joint",
    ("motion_angle", "rad", "rotation about the joint's axis"),
    ("motion_rate", "rad/s", "its rate"),
    ("motion_acceleration", "rad/s^2", "its acceleration"),
    "motion: time sliding_joint",
    ("slide_position", "m", "way along the joint's axis"),
    ("slide_rate", "m/s", "its rate"),
    ("slide_acceleration", "m/s^2", "its acceleration"),
)
# Forces on links.
_FORCES: tuple[Variable, ...] = rows(
    "derivative: time force_place axis",
    ("applied_force", "N", "force at the place, world axes"),
    ("applied_torque", "N m", "torque about the place, world axes"),
    "derivative: time force",
    ("force_energy", "J", "energy stored, of one that puts nothing in"),
    "ledger: time force",
    ("force_work", "J", "work of the force since the start"),
    ("force_gross_work", "J", "integral of |power| of the force", TOTAL),
    ("force_loss", "J", "energy lost, of one that puts nothing in"),
    "ledger: time force axis",
    ("force_impulse", "N s", "integral of the force, world axes"),
    ("force_angular_impulse", "N m s", "integral of its moment about the world's origin, world axes"),
    ("force_central_impulse", "N m s", "integral of its moment about the mass centre of all"),
)
#: Every variable of a result, by name.
VARIABLES: dict[str, Variable] = {
    variable.name: variable
    for part in (_STATES, _CONTACTS, _ENERGIES, _FORCES, _MOTIONS, SUMMARIES, EPISODES)
    for variable in part
}


def variables_of(dimensions: Collection[str], free_base: bool | None = None) -> Iterator[Variable]:
    """Yield the variables of a result with these dimensions."""
    for variable in VARIABLES.values():
        if all(dim in dimensions for dim in variable.dims) and (free_base or not variable.free_base):
            yield variable
