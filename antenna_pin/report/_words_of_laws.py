"""Laws of contact and friction in words, with all parameters as they are used, and materials."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

from antenna_pin.assemble import build_system
from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, DampedContact
from antenna_pin.errors import AntennaPinError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.readable import number, readable
from antenna_pin.report._words_of_elements import GIVEN
from antenna_pin.scenario import Scenario

__all__ = ["words_of_laws"]


def words_of_laws(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield the laws of each joint with clearance, their limits, and the materials."""
    try:
        joints: Sequence[ClearanceJoint] = build_system(scenario).clearances
    except AntennaPinError as error:
        yield "laws", f"cannot be built any more: {error}"
        return
    for joint in joints:
        spec = scenario.clearance[joint.name]
        normals = {"bore": joint.radial, "flanges": joint.axial}
        said = {place: _law(law) for place, law in normals.items() if law is not None}
        if len(set(said.values())) == 1:
            said = {"contact": next(iter(said.values()))}
        for place, text in said.items():
            yield f"{joint.name}, {place}", text
        yield f"{joint.name}, friction", _law(joint.friction) if joint.friction is not None else "none"
        floor = readable(spec.approach_speed_floor, "m/s", GIVEN)
        yield (
            f"{joint.name}, limits",
            (
                f"approach speeds count as {floor} at least; a run ends at a depth of "
                f"{readable(min(joint.depth_limits), 'm', GIVEN)}"
            ),
        )
        for part in ("bearing", "journal"):
            material = getattr(spec, f"{part}_material")
            if material is not None:
                yield f"{joint.name}, {part}'s material", _material(scenario, material)


def _material(scenario: Scenario, name: str) -> str:
    found = scenario.material(name)
    young, poisson = readable(found.young, "Pa", 5), number(found.poisson, 5)
    return f"{name}: Young's modulus {young}, Poisson's ratio {poisson}"


def _law(law: Any) -> str:
    """Return a law, or an elastic law with its dissipation, with all parameters as they are used."""
    if isinstance(law, DampedContact):
        return f"{_law(law.elastic)}; dissipation {_law(law.dissipation)}"
    given = []
    for item in dataclasses.fields(law) if dataclasses.is_dataclass(law) else ():
        value = getattr(law, item.name)
        if isinstance(value, int | float):
            unit = str(item.metadata.get("unit", "1"))
            if "exponent" in unit:
                unit = unit.replace("exponent", number(law.exponent, 6))
            given.append(f"{item.name.replace('_', ' ')} {readable(float(value), unit, 6)}")
    known = {cls: name for names in (NORMAL_LAWS, DISSIPATIONS, FRICTION_LAWS) for name, cls in names.items()}
    name = known.get(type(law), type(law).__name__)
    return f"{name}: {', '.join(given)}" if given else name
