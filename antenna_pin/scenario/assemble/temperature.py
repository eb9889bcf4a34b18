r"""Scenarios at the temperatures of their parts: radii, lengths, preload, and numbers over temperature.

A part grows alike in all directions, a bore with it: :math:`R(T) = R [1 + \alpha (T - T_0)]`, with the mean
expansion from the reference temperature. The preload of a pair of ball bearings at the distance l changes by
:math:`\Delta = l (\alpha_h \Delta T_h - \alpha_s \Delta T_s)`, half of it in each row: back-to-back pairs are
pressed together where the housing grows more, face-to-face pairs where the shaft does. The expansion of the
rings across the axis is not in it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as ET

from antenna_pin.base.arguments import takes
from antenna_pin.base.parameters import parameters_of
from antenna_pin.base.readable import readable
from antenna_pin.base.tolerance_chain import Dimension, ToleranceChain
from antenna_pin.base.units import any_quantity
from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError
from antenna_pin.joints.geometry.dimension import dimensions_of
from antenna_pin.scenario import Scenario
from antenna_pin.scenario._clearance import law_tables
from antenna_pin.scenario._dimensions import FIT, by_key
from antenna_pin.scenario.assemble.places import check_known, where
from antenna_pin.scenario.clearance import TouchingSpec
from antenna_pin.scenario.merge import key_of
from antenna_pin.scenario.numbers import number_of, with_number
from antenna_pin.scenario.temperature import JointPlay, TemperatureSpec, ThermalBearing

if TYPE_CHECKING:
    from antenna_pin.elements import BallBearing


@takes()
def at_temperature(scenario: Scenario) -> Scenario:
    """Return a scenario with the dimensions and numbers that it has at its temperatures.

    The same scenario, if it has none. Results keep the scenario with its temperatures; their joints have the
    dimensions as used.

    Raises:
        ScenarioError: A part has no material with a known expansion, parts interfere (with the temperature
            from which on they do), a preload is lost, or a table does not reach so far.
        UnknownNameError: There is no such link, number, bearing or material.
    """
    spec = scenario.temperature
    if spec is None:
        return scenario
    check_known(scenario, spec.parts, "link", _links(scenario), "temperature", "parts")
    found = scenario.model_copy(update={"temperature": None})
    for name, value in _numbers(scenario, spec):
        found = with_number(found, name, value)
    joints = {}
    for joint, table in found.clearance.items():
        joints[joint] = table
        if isinstance(table, TouchingSpec):
            joints[joint] = _expanded(found, spec, joint, table)
    found = found.model_copy(update={"clearance": joints})
    for name, bearing in spec.bearings.items():
        preload = _preload(found, spec, name, bearing)
        found = with_number(found, key_of(("bearings", name, "preload")), preload)
    return found


def said_of_temperature(scenario: Scenario) -> Iterator[str]:
    """Yield a line for each joint with play at its temperatures."""
    spec = scenario.temperature
    if spec is None:
        return
    for joint, table in scenario.clearance.items():
        if isinstance(table, TouchingSpec):
            play = joint_play(scenario, joint)
            yield (
                f"{joint}: radial play {readable(play.reference, 'm')} at {celsius(spec.reference)} is "
                f"{readable(play.radial, 'm')} with the bearing at {celsius(play.bearing_temperature)} and "
                f"the journal at {celsius(play.journal_temperature)}"
            )


def celsius(temperature: float) -> str:
    """Return a temperature [K] in degrees Celsius, for people."""
    return f"{temperature - 273.15:.6g} degC"


# --- joints with play ---------------------------------------------------------------------------------------


@takes()
def joint_play(scenario: Scenario, joint: str) -> JointPlay:
    """Return the play of a joint at the scenario's temperatures, an interference too.

    Args:
        scenario: The scenario, with or without temperatures.
        joint: Name of a joint with play.

    Raises:
        UnknownNameError: There is no such joint with play.
        ScenarioError: The expansion of a material is not known.
    """
    known = [name for name, one in scenario.clearance.items() if isinstance(one, TouchingSpec)]
    if joint not in known:
        raise UnknownNameError(where(scenario, "clearance"), "joint with play", joint, known)
    table: Any = scenario.clearance[joint]
    spec = scenario.temperature or TemperatureSpec()
    sizes, grown = table.sizes(), _grown(scenario, spec, joint, table)
    before, after = _plays(table, sizes), _plays(table, grown)
    bearing, journal = _temperatures(scenario, spec, joint, table)
    least_before, least_after = min(before[0]), min(after[0])
    closing = least_before / (least_before - least_after) if least_after < least_before else math.nan
    return JointPlay(
        joint=joint,
        bearing_temperature=bearing,
        journal_temperature=journal,
        reference=least_before,
        radial=least_after,
        axial=after[1],
        fit=table.limits_of_fit,
        closing=closing,
    )


@takes()
def closing_temperature(scenario: Scenario, joint: str) -> float:
    """Return the temperature of all parts at which a joint's radial play is gone [K].

    NaN if it never closes above 0 K and below a rise of 1000 K, or an expansion is not known.
    """
    reference = (scenario.temperature or TemperatureSpec()).reference
    for rise in (1000.0, -reference):
        common = TemperatureSpec(all=max(reference + rise, 1e-3), reference=reference)
        try:
            share = joint_play(scenario.model_copy(update={"temperature": common}), joint).closing
        except ScenarioError:
            return math.nan
        if 0.0 <= share <= 1.0:
            return reference + share * rise
    return math.nan


@takes()
def play_over_temperature(scenario: Scenario, joint: str, temperatures: Sequence[float]) -> list[JointPlay]:
    """Return the play of a joint with all parts at each of some temperatures [K]."""
    reference = (scenario.temperature or TemperatureSpec()).reference
    found = []
    for one in temperatures:
        common = TemperatureSpec(all=float(one), reference=reference)
        found.append(joint_play(scenario.model_copy(update={"temperature": common}), joint))
    return found


def _plays(table: TouchingSpec, sizes: dict[str, float]) -> tuple[list[float], float]:
    """Return plays across the axis and the play at each flange [m]; NaN without flanges."""
    plays = [one for one in table.shape_class.plays if sizes[one.outer] and sizes[one.inner]]
    across = [one.of(sizes) for one in plays if not one.along]
    return across, next((one.of(sizes) for one in plays if one.along), math.nan)


def _grown(scenario: Scenario, spec: TemperatureSpec, joint: str, table: Any) -> dict[str, float]:
    """Return the dimensions of a joint at its temperatures, by the names of its shape."""
    rises = [one - spec.reference for one in _temperatures(scenario, spec, joint, table)]
    factors = {}
    for rise, name, part in zip(rises, table.materials, ("bearing", "journal"), strict=True):
        key = f"{part}_material"
        factors[part] = 1.0 + rise * _expansion(scenario, name, "clearance", joint, key) if rise else 1.0
    dimensions, units = dimensions_of(table.shape_class), parameters_of(table.shape_class)
    return {
        name: value * factors[dimensions[name].part] if units[name].unit == "m" else value
        for name, value in table.sizes().items()
    }


def _expansion(scenario: Scenario, name: str | None, *place: str) -> float:
    """Return a material's expansion, or refuse an unknown one."""
    if name is None:
        raise ScenarioError(f"{where(scenario, *place)}: is missing; the temperature requires its expansion")
    found = scenario.material(name).expansion
    if found is None:
        rule = "must have an expansion, which the temperature requires"
        raise ScenarioError(
            f"{where(scenario, *place)}: {rule}, got {name!r}; give materials.{name}.expansion"
        )
    return found


def _temperatures(scenario: Scenario, spec: TemperatureSpec, joint: str, table: Any) -> tuple[float, float]:
    """Return the temperatures of the parts with the bearing and the journal [K]."""
    if not spec.parts:
        return spec.of(None), spec.of(None)
    parent, child = _sides(scenario, joint)
    sides = (child, parent) if table.bearing_on == "child" else (parent, child)
    return spec.of(sides[0]), spec.of(sides[1])


def _expanded(scenario: Scenario, spec: TemperatureSpec, joint: str, table: Any) -> Any:
    """Return the table of a joint with play at its temperatures, or refuse an interference."""
    play = joint_play(scenario.model_copy(update={"temperature": spec}), joint)
    place = where(scenario, "clearance", joint)
    if not play.radial > 0.0:
        raise ScenarioError(
            f"{place}: must keep its play, got an interference of {readable(-play.radial, 'm')} in radius at "
            f"{_at(play)}; the play is gone from {_since(spec, play.closing, play)} on"
        )
    grown = _grown(scenario, spec, joint, table)
    data = table.model_dump(exclude_none=True) | law_tables(table)
    data = {key: value for key, value in data.items() if key not in (*FIT, *by_key(table.shape_class))}
    dimensions = dimensions_of(table.shape_class)
    lengths = {dimensions[name].key: value for name, value in grown.items() if value}
    if "bearing_length" in data and "bearing_length" not in lengths:  # of a planar joint its shape has none
        rise = play.bearing_temperature - spec.reference
        expansion = (
            _expansion(scenario, table.materials[0], "clearance", joint, "bearing_material") if rise else 0.0
        )
        lengths["bearing_length"] = data["bearing_length"] * (1.0 + rise * expansion)
    try:
        return type(table).model_validate(data | lengths)
    except AntennaPinError as error:
        reason = str(error).partition(": ")[2]
        raise ScenarioError(f"{place}: at {_at(play)} {reason}") from None


def _at(play: JointPlay) -> str:
    return _both(play.bearing_temperature, play.journal_temperature)


def _both(bearing: float, journal: float) -> str:
    if bearing == journal:
        return celsius(bearing)
    return f"{celsius(bearing)} of the bearing and {celsius(journal)} of the journal"


def _since(spec: TemperatureSpec, share: float, play: JointPlay) -> str:
    """Return the temperatures at a share of the way from the reference."""
    both = (play.bearing_temperature, play.journal_temperature)
    bearing, journal = (spec.reference + share * (one - spec.reference) for one in both)
    return _both(bearing, journal)


# --- numbers over temperature -------------------------------------------------------------------------------


def _numbers(scenario: Scenario, spec: TemperatureSpec) -> Iterator[tuple[str, float]]:
    """Yield key and value of the numbers that tables give."""
    for name, table in spec.tables.items():
        place = where(scenario, "temperature", "tables", name)
        if table.key.partition(".")[0] in ("temperature", "tolerances"):
            raise ScenarioError(f"{place}.key: must be a number of the mechanism, got {table.key!r}")
        if table.part is not None:
            check_known(
                scenario, [table.part], "link", _links(scenario), "temperature", "tables", name, "part"
            )
        number = number_of(scenario, table.key, f"{place}.key")
        units = {read[1] for one in table.value or () if (read := any_quantity(one)) is not None and read[1]}
        if units - {number.unit} and number.unit:
            raise ScenarioError(f"{place}.value: must be in {number.unit}, got {', '.join(sorted(units))}")
        temperature = spec.of(table.part)
        found = table.at(temperature)
        if found is None:
            ends = f"{celsius(table.temperature[0])} to {celsius(table.temperature[-1])}"
            raise ScenarioError(f"{place}: must reach {celsius(temperature)}, got {ends}; add points to it")
        yield table.key, found * (number.value if table.factor is not None else 1.0)


# --- preload of pairs of ball bearings ----------------------------------------------------------------------


def _preload(scenario: Scenario, spec: TemperatureSpec, name: str, thermal: ThermalBearing) -> float:
    """Return the preload of a pair at its temperatures [N], or refuse a lost one."""
    from antenna_pin.elements import BallBearing

    known = scenario.families.get("bearings", {})
    check_known(scenario, [name], "bearing", known, "temperature", "bearings")
    place = where(scenario, "temperature", "bearings", name)
    made = known[name].build()
    if not isinstance(made, BallBearing) or made.arrangement == "single":
        raise ScenarioError(
            f"{place}: must be of a pair of ball bearings; another's preload over temperature is a table of "
            f"bearings.{name}"
        )
    parent, child = _sides(scenario, str(known[name].joint))
    shaft, housing = (child, parent) if thermal.inner_on == "child" else (parent, child)
    grown = [
        made.spread
        * (spec.of(link) - spec.reference)
        * _expansion(scenario, material, "temperature", "bearings", name, key)
        for link, material, key in (
            (housing, thermal.housing_material, "housing_material"),
            (shaft, thermal.shaft_material, "shaft_material"),
        )
    ]
    pressed = 0.5 * (grown[0] - grown[1]) * (1.0 if made.arrangement == "back-to-back" else -1.0)
    free = _free_way(made)
    if not pressed > -free:
        rule = f"is lost from {100.0 * free / -pressed:.3g} % of the way from {celsius(spec.reference)} on"
        raise ScenarioError(
            f"{place}: the preload of {made.preload:g} N {rule}; take a larger one, or a spring"
        )
    return axial_load(made, pressed)


def axial_load(bearing: BallBearing, way: float) -> float:
    """Return the axial force of a row after a further displacement [N]."""
    off, along, rest, hertz = (abs(float(one)) for one in bearing.balls()[0, 4:8])
    moved = along + way
    length = math.hypot(off, moved)
    depth = max(length - rest, 0.0)
    return float(bearing.count * hertz * depth**1.5 * moved / length)


def _free_way(bearing: BallBearing) -> float:
    """Return by which way a row is pressed together under its preload [m]."""
    off, along, rest = (abs(float(one)) for one in bearing.balls()[0, 4:7])
    return along - math.sqrt(rest * rest - off * off)


# --- chains -------------------------------------------------------------------------------------------------


@takes()
def tolerance_chain(scenario: Scenario, name: str) -> ToleranceChain:
    """Return a chain of a scenario's ``[tolerances]`` at its temperatures.

    Raises:
        UnknownNameError: There is no such chain, material or link.
        ScenarioError: A material has no known expansion.
    """
    if name not in scenario.tolerances:
        raise UnknownNameError("tolerance_chain", "chain", name, scenario.tolerances)
    spec = scenario.temperature or TemperatureSpec()
    dimensions = []
    for key, one in scenario.tolerances[name].dimensions.items():
        nominal, minus, plus = one.limits
        place = ("tolerances", name, "dimensions", key)
        if one.part is not None:
            check_known(scenario, [one.part], "link", _links(scenario), *place, "part")
        rise, factor = spec.of(one.part) - spec.reference, 1.0
        if one.material is not None and rise:
            factor += rise * _expansion(scenario, one.material, *place, "material")
        dimensions.append(
            Dimension(
                name=key,
                nominal=nominal * factor,
                minus=minus * factor,
                plus=plus * factor,
                coefficient=one.coefficient,
                distribution=one.distribution,
                sigmas=one.sigmas,
            )
        )
    return ToleranceChain(name=name, dimensions=dimensions)


# --- links of the URDF --------------------------------------------------------------------------------------


def _links(scenario: Scenario) -> list[str]:
    return [str(one.get("name")) for one in _robot(scenario).findall("link")]


def _sides(scenario: Scenario, joint: str) -> tuple[str, str]:
    """Return parent and child link of a joint."""
    known = {}
    for one in _robot(scenario).findall("joint"):
        parent, child = one.find("parent"), one.find("child")
        if parent is not None and child is not None:
            known[str(one.get("name"))] = str(parent.get("link")), str(child.get("link"))
    check_known(scenario, [joint], "joint", known, "clearance")
    return known[joint]


def _robot(scenario: Scenario) -> ET.Element:
    if "<!DOCTYPE" in scenario.urdf_text:
        return ET.Element("robot")
    try:
        return ET.fromstring(scenario.urdf_text)  # noqa: S314 - entities need a DOCTYPE
    except ET.ParseError:
        return ET.Element("robot")
