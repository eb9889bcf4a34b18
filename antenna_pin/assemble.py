"""From a scenario to a system: URDF variant, Pinocchio model, force elements, initial state."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.changes import JointChange
from antenna_pin.contact import (
    FRICTION_LAWS,
    CompiledNormalLaw,
    DampedContact,
    Hertz,
    LineLaw,
    Parameter,
    annular_punch_factor,
    effective_modulus,
    internal_hertz_stiffness,
    make_normal_law,
    normal_parameters,
)
from antenna_pin.dynamics import Hinge, System
from antenna_pin.errors import InvalidParameterError, MechanismError, ScenarioError, UnknownNameError
from antenna_pin.geometry import PlanarClearance, RevoluteClearance, SphericalClearance
from antenna_pin.joints import ClearanceJoint
from antenna_pin.mechanism import (
    JointSlot,
    JointVariant,
    Mechanism,
    Urdf,
    build_mechanism,
    frame_aligning_z,
)
from antenna_pin.scenario import AngleEvent, ForceEvent, GapEvent, RateEvent, Scenario
from antenna_pin.scenario import clearance as _clearance
from antenna_pin.scenario.laws import LawSpec

__all__ = ["build_system", "initial_angles", "initial_state", "urdf_variant"]

Array = NDArray[np.float64]

_VARIANTS: dict[str, JointVariant] = {
    "contact": "free",
    "constraint": "free",
    "planar": "planar",
    "spherical": "free",
    "ideal": "ideal",
}


def _where(scenario: Scenario, *keys: str) -> str:
    return f"{scenario.name or 'scenario'}: {'.'.join(keys)}"


def _known(
    scenario: Scenario, names: Collection[str], what: str, known: Collection[str], *place: str
) -> None:
    for name in names:
        if name not in known:
            raise UnknownNameError(_where(scenario, *place), what, name, known)


def urdf_variant(scenario: Scenario) -> Urdf:
    """Return the URDF of a scenario's case: joints freed, locked or made planar, and all overrides applied.

    Raises:
        MechanismError: The URDF is not a mechanism, or a change makes no sense.
        UnknownNameError: A link or joint that it does not have.
    """
    spec = scenario.mechanism
    urdf = Urdf.from_text(
        scenario.urdf_text,
        str(scenario.urdf_path),
        allow_impossible_inertia=spec.allow_impossible_inertia,
        folder=scenario.urdf_path.parent,
    )
    joints = {joint.name for joint in urdf.robot.joints}
    links = {link.name for link in urdf.robot.links}
    _known(scenario, spec.joints, "joint", joints, "mechanism.joints")
    _known(scenario, spec.links, "link", links, "mechanism.links")
    _known(scenario, scenario.clearance, "joint", joints, "clearance")
    if scenario.pointing is not None:
        _known(scenario, [scenario.pointing.body], "link", links, "pointing.body")
    variants: dict[str, JointVariant] = {
        name: change.kind for name, change in spec.joints.items() if change.kind is not None
    }
    for name, clearance in scenario.clearance.items():
        # A ball joint has no URDF type: a joint written as floating is taken as it is.
        if not (clearance.model == "spherical" and urdf.joint(name).type == "floating"):
            variants[name] = _VARIANTS[clearance.model]
    for name, clearance in scenario.clearance.items():
        kind = urdf.joint(name).type
        allowed = ("revolute", "continuous", *(("floating",) if clearance.model == "spherical" else ()))
        if kind not in allowed:
            raise MechanismError(
                f"{_where(scenario, 'clearance', name)}: a clearance joint must be revolute or "
                f"continuous in the URDF, got {kind} (model = {clearance.model!r}); "
                "name another joint or change the URDF"
            )
    return urdf.variant(
        joints=variants,
        links={name: change.build() for name, change in spec.links.items()},
        origins={
            name: change.build() for name, change in spec.joints.items() if change.build() != JointChange()
        },
    )


def build_system(scenario: Scenario) -> System:
    """Return the system of a scenario's case.

    Raises:
        AntennaPinError: Names, dimensions or laws that do not go together; one line that says where.
    """
    urdf = urdf_variant(scenario)
    mechanism = build_mechanism(urdf, scenario.mechanism.base, scenario.mechanism.gravity)
    for place, specs in (("drives", scenario.drives), ("springs", scenario.springs)):
        for name, spec in specs.items():
            _known(scenario, [spec.joint], "moving joint", mechanism.joints, place, name, "joint")
            _check_motion(scenario, mechanism.joint(spec.joint), spec.motion, place, name)
    system = System(
        mechanism,
        clearances=[
            clearance_joint(scenario, name, spec)
            for name, spec in scenario.clearance.items()
            if not isinstance(spec, _clearance.IdealClearance)
        ],
        drives={name: spec.build() for name, spec in scenario.drives.items()},
        springs={name: spec.build() for name, spec in scenario.springs.items()},
        hinges=[Hinge(joint=name) for name, spec in scenario.clearance.items() if spec.model == "constraint"],
    )
    _check_events(scenario, system)
    return system


def _check_events(scenario: Scenario, system: System) -> None:
    """Refuse events on joints and contacts that there are not, or in units of another motion."""
    for name, spec in scenario.events.items():
        place = ("events", name)
        if isinstance(spec, AngleEvent | RateEvent):
            _known(scenario, [spec.joint], "moving joint", system.mechanism.joints, *place, "joint")
            _check_motion(scenario, system.mechanism.joint(spec.joint), spec.motion, *place)
        elif isinstance(spec, GapEvent | ForceEvent):
            _known(scenario, [spec.contact], "contact", system.contact_names, *place, "contact")


def _check_motion(scenario: Scenario, slot: JointSlot, motion: str | None, *place: str) -> None:
    """Refuse units of a sliding joint at a turning one, and the other way round."""
    actual = "translation" if slot.kind == "prismatic" else "rotation"
    if motion not in (None, actual):
        raise ScenarioError(
            f"{_where(scenario, *place)}: units must be those of a {actual}, "
            f"for joint {slot.name!r} is {slot.kind}, got units of a {motion}"
        )


def clearance_joint(
    scenario: Scenario,
    name: str,
    spec: _clearance.PlanarClearance | _clearance.ContactClearance | _clearance.SphericalClearance,
) -> ClearanceJoint:
    """Return the clearance joint of one table of a scenario.

    A stiffness that is not given comes from materials and radii in the bore; at the flanges it is that of the
    bore (assumed: no source gives one for an edge on a plane), also where the bore has a law along a line.
    """
    journal = spec.bearing_radius - spec.radial_play
    radial = _normal_law(scenario, name, spec, spec.radial_law, None)
    geometry: PlanarClearance | RevoluteClearance | SphericalClearance
    axial = None
    if isinstance(spec, _clearance.PlanarClearance):
        geometry = PlanarClearance(bearing_radius=spec.bearing_radius, journal_radius=journal)
    elif isinstance(spec, _clearance.SphericalClearance):
        geometry = SphericalClearance(socket_radius=spec.bearing_radius, ball_radius=journal)
    else:
        geometry = RevoluteClearance(
            bearing_radius=spec.bearing_radius,
            journal_radius=journal,
            bearing_length=spec.bearing_length,
            flange_distance=spec.bearing_length + 2.0 * spec.axial_play,
            bearing_outer_radius=spec.bearing_outer_radius,
            flange_radius=spec.flange_radius,
        )
        axial = _normal_law(scenario, name, spec, spec.axial_law, radial)
    return ClearanceJoint(
        name=name,
        geometry=geometry,
        radial=radial,
        axial=axial,
        friction=FRICTION_LAWS[spec.friction.law](**spec.friction.parameters),
        backend=spec.geometry,
        offset=spec.offset,
        approach_speed_floor=spec.approach_speed_floor,
        maximum_depth=spec.maximum_depth,
        load=spec.load,
        strips=spec.strips,
        sectors=spec.sectors,
    )


def _normal_law(
    scenario: Scenario,
    name: str,
    spec: Any,
    law: LawSpec,
    radial: CompiledNormalLaw | None,
) -> CompiledNormalLaw:
    """Return the normal law of the bore or, with the bore's law given, that of the flanges.

    What it is not given it takes from the joint, but for an effective mass, which it then takes from each
    contact. A law along a line means nothing at a flange: the common law of both kinds of contact, if it is
    one, gives way there to another, with the same dissipation (``_flange_law``).
    """
    place = _where(scenario, "clearance", name, "normal" if radial is None else "axial")
    declared = normal_parameters(law.law, law.dissipation)
    parameters = dict(law.parameters)
    if "stiffness" in declared and "stiffness" not in parameters:
        parameters["stiffness"] = _stiffness(
            scenario, spec, declared, parameters, radial, f"{place}.stiffness"
        )
    for key in [key for key, p in declared.items() if p.required and p.from_joint and key not in parameters]:
        parameters[key] = _from_joint(scenario, spec, key, f"{place}.{key}")
    try:
        made = make_normal_law(law.law, parameters, law.dissipation)
    except InvalidParameterError as error:
        raise ScenarioError(f"{place}: {error}") from None
    elastic = made.parts.elastic
    if not isinstance(elastic, LineLaw):
        return made
    if isinstance(spec, _clearance.SphericalClearance):
        raise ScenarioError(
            f"{place}.law: must be a law of a point, such as hertz, for a ball in a socket, got {law.law!r}"
        )
    if radial is None:
        return made
    if spec.axial is not None and spec.axial.law is not None:
        raise ScenarioError(
            f"{place}.law: must be a law of a point, such as hertz, for a flange has no line of contact, "
            f"got {law.law!r}"
        )
    return DampedContact(elastic=_flange_law(spec, elastic), dissipation=made.parts.dissipation)


def _flange_law(spec: _clearance.ContactClearance, bore: LineLaw) -> Hertz:
    """Return the elastic law of one flange beside a law along a line in the bore.

    Under point load it is Hertz's with the stiffness of a point contact in the bore (assumed: no source gives
    one for an edge on a plane). Under distributed load it is that of an elastic foundation over the whole
    annulus, of which each sector has its share; the foundation's modulus, if not given, is that of the
    compression of a rigid annular punch (:func:`antenna_pin.contact.annular_punch_factor`) over its area.
    """
    if spec.load == "point":
        return Hertz(
            stiffness=internal_hertz_stiffness(bore.bearing_radius, bore.journal_radius, bore.modulus)
        )
    outer = min(spec.bearing_outer_radius, spec.flange_radius)
    punch = annular_punch_factor(spec.bearing_radius / outer) * 2.0 * bore.modulus * outer
    if spec.flange_modulus is not None:
        punch = spec.flange_modulus * math.pi * (outer**2 - spec.bearing_radius**2)
    return Hertz(stiffness=punch, exponent=1.0)


def _stiffness(
    scenario: Scenario,
    spec: Any,
    declared: Mapping[str, Parameter],
    given: Mapping[str, float],
    radial: CompiledNormalLaw | None,
    place: str,
) -> float:
    """Return the stiffness of a power law that is not given one: the bore's, or that of a Hertz contact."""
    default = declared["exponent"].default if "exponent" in declared else None
    exponent = given.get("exponent", 1.5 if default is None else default)
    bore = None if radial is None else radial.parts.elastic
    if isinstance(bore, Hertz):
        if bore.exponent != exponent:
            raise ScenarioError(
                f"{place}: must be given where the exponent ({exponent:g}) is not the bore's "
                f"({bore.exponent:g}), for the bore's stiffness has another unit"
            )
        return bore.stiffness
    if exponent != 1.5:
        raise ScenarioError(
            f"{place}: must be given for the exponent {exponent:g}; "
            "only for 1.5 does it follow from materials"
        )
    if isinstance(bore, LineLaw):
        return internal_hertz_stiffness(bore.bearing_radius, bore.journal_radius, bore.modulus)
    modulus = _from_joint(scenario, spec, "modulus", place)
    return internal_hertz_stiffness(spec.bearing_radius, spec.bearing_radius - spec.radial_play, modulus)


def _from_joint(scenario: Scenario, spec: Any, key: str, place: str) -> float:
    """Return what a law takes from the joint's dimensions and materials."""
    if key == "bearing_radius":
        return float(spec.bearing_radius)
    if key == "journal_radius":
        return float(spec.bearing_radius - spec.radial_play)
    if key == "length":
        if spec.bearing_length is None:
            raise ScenarioError(f"{place}: is missing; give it or the joint's bearing_length")
        # Of a line along the bearing each end has half, which under distributed load its strips share out; in
        # a planar joint the one contact has the whole.
        return float(spec.bearing_length / (1 if isinstance(spec, _clearance.PlanarClearance) else 2))
    for material in ("bearing_material", "journal_material"):
        if getattr(spec, material) is None:
            raise ScenarioError(f"{place}: is missing; give it or the joint's {material}")
    return effective_modulus(
        scenario.material(spec.bearing_material), scenario.material(spec.journal_material)
    )


def initial_state(scenario: Scenario, system: System) -> tuple[Array, Array]:
    """Return the initial configuration and velocity of a scenario, (nq,) and (nv,)."""
    return _initial_state(scenario, system.mechanism)


def initial_angles(scenario: Scenario, system: System) -> dict[str, float]:
    """Return the initial angles of the joints that turn without end, with their whole turns [rad]."""
    known = {name: _angle(spec) for name, spec in scenario.initial.joints.items()}
    return {name: known.get(name, 0.0) for name in system.turn_x}


def _angle(spec: Any) -> float:
    """Return the angle or position of a joint's initial state, by whichever of its names [rad] or [m]."""
    given = spec.angle if spec.angle is not None else spec.position
    return float(given or 0.0)


def _initial_state(scenario: Scenario, mechanism: Mechanism) -> tuple[Array, Array]:
    q, v = pin.neutral(mechanism.model), np.zeros(mechanism.model.nv)
    initial = scenario.initial
    if mechanism.base == "free":
        base = initial.base
        attitude = np.asarray(base.attitude, dtype=float)
        q[:3], q[3:7] = base.position, attitude / np.linalg.norm(attitude)
        v[:3], v[3:6] = base.velocity, base.angular_velocity
    _known(scenario, initial.joints, "moving joint", mechanism.joints, "initial.joints")
    for name, spec in initial.joints.items():
        slot = mechanism.joint(name)
        _check_motion(scenario, slot, spec.motion, "initial", "joints", name)
        if slot.kind in ("floating", "planar"):
            _place_journal(scenario, mechanism, slot, spec, q, v)
            continue
        for key in ("journal_position", "journal_tilt", "journal_velocity", "journal_angular_velocity"):
            given = getattr(spec, key)
            if given is not None and any(given):
                raise ScenarioError(
                    f"{_where(scenario, 'initial.joints', name, key)}: must be zero or left out at a joint "
                    f"without play, got {given}"
                )
        angle = _angle(spec)
        rate = spec.velocity if spec.velocity is not None else spec.rate or 0.0
        q[slot.q] = (np.cos(angle), np.sin(angle)) if slot.kind == "continuous" else angle
        v[slot.v] = rate
    return q, v


def _place_journal(
    scenario: Scenario, mechanism: Mechanism, slot: JointSlot, spec: Any, q: Array, v: Array
) -> None:
    """Write the pose and twist of a journal in its bearing, given in bearing axes, into q and v."""
    angle = _angle(spec)
    rate = spec.rate if spec.rate is not None else spec.velocity or 0.0
    position = np.array(spec.journal_position or (0.0, 0.0, 0.0))
    tilt = np.array(spec.journal_tilt or (0.0, 0.0, 0.0))
    velocity = np.array(spec.journal_velocity or (0.0, 0.0, 0.0))
    spin = np.array(spec.journal_angular_velocity or (0.0, 0.0, 0.0)) + [0.0, 0.0, rate]
    if slot.kind == "planar":
        if position[2] or tilt.any() or velocity[2] or spin[:2].any():
            raise ScenarioError(
                f"{_where(scenario, 'initial.joints', slot.name)}: a planar joint must stay in its plane; "
                "give no axial position or velocity, no tilt and no rate of tilt"
            )
        cosine, sine = np.cos(angle), np.sin(angle)
        q[slot.q] = (position[0], position[1], cosine, sine)
        v[slot.v] = (
            cosine * velocity[0] + sine * velocity[1],
            -sine * velocity[0] + cosine * velocity[1],
            spin[2],
        )
        return
    axes = frame_aligning_z(slot.axis)
    offset = scenario.clearance[slot.name].offset if slot.name in scenario.clearance else 0.0
    centre = offset * slot.axis
    turn = axes @ pin.exp3(tilt) @ pin.exp3(np.array([0.0, 0.0, angle])) @ axes.T
    omega = turn.T @ axes @ spin
    q[slot.q] = [*(axes @ position + centre - turn @ centre), *pin.Quaternion(turn).coeffs()]
    v[slot.v] = [*(turn.T @ axes @ velocity - np.cross(omega, centre)), *omega]
