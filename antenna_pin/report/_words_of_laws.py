"""Laws of contact and friction in words, with all parameters as they were used, and materials."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from antenna_pin.base.readable import GIVEN, number, readable
from antenna_pin.report._runs import ReportedRun
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assumed import words_of_assumed

__all__ = ["words_of_laws"]

# What contacts of a kind are called, of joints that have several.
_PLACES = {"radial": "bore", "axial": "flanges", "wall": "walls"}


def words_of_laws(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield the laws of each joint with clearance that a result carries, their limits, and the materials."""
    scenario = run.run.scenario
    joints: dict[str, dict[str, Any]] = json.loads(run.data.attrs.get("clearance_joints", "{}"))
    for name, joint in joints.items():
        contacts = joint["contacts"].values()
        said = {_PLACES.get(of["kind"], of["kind"]): _law(of["normal_law"]) for of in contacts}
        if len(set(said.values())) == 1:
            said = {"contact": next(iter(said.values()))}
        for place, text in said.items():
            yield f"{name}, {place}", text
        yield f"{name}, friction", _law(joint["friction_law"])
        floor = readable(joint["approach_speed_floor"], "m/s", GIVEN)
        yield (
            f"{name}, limits",
            (
                f"approach speeds count as {floor} at least; a run ends at a depth of "
                f"{readable(min(of['depth_limit'] for of in contacts), 'm', GIVEN)}"
            ),
        )
        if scenario is None:
            continue
        spec = scenario.clearance[name]
        if parts := words_of_assumed(spec):
            yield f"{name}, assumed", parts
        for part, material in zip(("bearing", "journal"), getattr(spec, "materials", ()), strict=False):
            if material is not None:
                yield f"{name}, {part}'s material", _material(scenario, material)


def _material(scenario: Scenario, name: str) -> str:
    found = scenario.material(name)
    young, poisson = readable(found.young, "Pa", 5), number(found.poisson, 5)
    return f"{name}: Young's modulus {young}, Poisson's ratio {poisson}"


def _law(law: dict[str, Any]) -> str:
    """Return a law that a result carries, with all its parameters."""
    given = ", ".join(
        f"{name.replace('_', ' ')} {readable(value, unit, 6)}"
        for name, (value, unit) in law["parameters"].items()
    )
    text = f"{law['law']}: {given}" if given else str(law["law"])
    return f"{text}; dissipation {_law(law['dissipation'])}" if "dissipation" in law else text
