"""Contact and friction laws of a joint with play, completed by dimensions and materials."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

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
    point_stiffness,
)
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assemble.places import where
from antenna_pin.scenario.clearance import TouchingSpec
from antenna_pin.scenario.laws import LawSpec


def clearance_joint(
    scenario: Scenario,
    name: str,
    spec: TouchingSpec,
) -> ClearanceJoint:
    """Return the clearance joint of one table of a scenario.

    A stiffness that is not given comes from materials and radii in the bore; at the flanges it is that of the
    bore (assumed: no source gives one for an edge on a plane), also where the bore has a law along a line.
    """
    radial = _normal_law(scenario, name, spec, spec.radial_law, None)
    axial = _normal_law(scenario, name, spec, spec.axial_law, radial) if "axial" in spec.kinds else None
    return ClearanceJoint(
        name=name,
        geometry=spec.shape(),
        radial=radial,
        axial=axial,
        friction=FRICTION_LAWS[spec.friction.law](**spec.friction.parameters),
        backend=spec.geometry,
        offset=spec.offset,
        bearing_on=spec.bearing_on,
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
    """Return the normal law of the bore or, given the bore's law, of the flanges.

    What it is not given it takes from the joint, except for an effective mass, which it then takes from each
    contact. A law along a line means nothing at a flange: the common law of both kinds of contact, if it is
    one, is compliant there to another, with the same dissipation (``_flange_law``).
    """
    place = where(scenario, "clearance", name, "normal" if radial is None else "axial")
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
    if spec.shape_class.no_line:
        raise ScenarioError(
            f"{place}.law: must be a law of a point, such as hertz, for {spec.shape_class.no_line}, got "
            f"{law.law!r}"
        )
    if radial is None:
        return made
    if spec.axial is not None and spec.axial.law is not None:
        raise ScenarioError(
            f"{place}.law: must be a law of a point, such as hertz, for a flange has no line of contact, "
            f"got {law.law!r}"
        )
    return DampedContact(elastic=_flange_law(spec, elastic), dissipation=made.parts.dissipation)


def _flange_law(spec: Any, bore: LineLaw) -> Hertz:
    """Return the elastic law of a flange for a line law in the bore.

    Under point load it is Hertz's with the stiffness of a point contact in the bore (assumed: no source gives
    one for an edge on a plane). Under distributed load it is that of an elastic foundation over the whole
    annulus, of which each sector has its share; the foundation's modulus, if not given, is that of the
    compression of a rigid annular punch (:func:`antenna_pin.contact.annular_punch_factor`) over its area.
    """
    if spec.load == "point":
        return Hertz(
            stiffness=internal_hertz_stiffness(bore.bearing_radius, bore.journal_radius, bore.modulus)
        )
    sizes = spec.sizes()
    outer = min(sizes["bearing_outer_radius"], sizes["flange_radius"])
    punch = annular_punch_factor(spec.bearing_radius / outer) * 2.0 * bore.modulus * outer
    if spec.flange_modulus is not None:
        punch = spec.flange_modulus * math.pi * (outer**2 - spec.bearing_radius**2)
    return Hertz(stiffness=punch, exponent=1.0)


def _stiffness(
    scenario: Scenario,
    spec: Any,
    declared: Mapping[str, Parameter],
    parameters: Mapping[str, float],
    radial: CompiledNormalLaw | None,
    place: str,
) -> float:
    """Return the default stiffness of a power law: the bore's, or a Hertz contact's."""
    default = declared["exponent"].default if "exponent" in declared else None
    exponent = parameters.get("exponent", 1.5 if default is None else default)
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
    modulus, shape = _from_joint(scenario, spec, "modulus", place), spec.shape()
    if not shape.contact_radius:
        raise ScenarioError(f"{place}: is missing; give it, or the joint's {shape.sharp}")
    return point_stiffness(shape.contact_radius, modulus)


def _from_joint(scenario: Scenario, spec: Any, key: str, place: str) -> float:
    """Return what a law takes from the joint's dimensions and materials."""
    if key in ("bearing_radius", "journal_radius"):
        radius = getattr(spec.shape(), key, None)
        if radius is None:
            raise ScenarioError(f"{place}: must be given for {spec.shape_class.no_line}, which has no radius")
        return float(radius)
    if key == "length":
        if spec.bearing_length is None:
            raise ScenarioError(f"{place}: is missing; give it or the joint's bearing_length")
        # Of a line along the bearing each end has half, which under distributed load its strips share out; in
        # a planar joint the one contact has the whole.
        return float(spec.bearing_length / spec.shape_class.ends)
    for key, material in zip(("bearing_material", "journal_material"), spec.materials, strict=True):
        if material is None:
            raise ScenarioError(f"{place}: is missing; give it or the joint's {key}")
    bearing, journal = spec.materials
    return effective_modulus(scenario.material(bearing), scenario.material(journal))
