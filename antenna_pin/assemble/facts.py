"""What a scenario is as a mechanism: found by building its system and its initial state."""

from __future__ import annotations

from typing import Any

from antenna_pin.assemble.build import build_system
from antenna_pin.assemble.initial import initial_angles, initial_state
from antenna_pin.assemble.variant import as_written
from antenna_pin.dynamics import System, Workspace, constraint_counts, facts_of_couplings
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.clearance import TouchingSpec

__all__ = ["scenario_facts"]


def scenario_facts(scenario: Scenario) -> dict[str, Any]:
    """Return what a case is: ``base``, ``joints``, ``closures``, ``couplings``, ``drives``, ``constraints``.

    Joints and drives are said in words; a closure has its ``kind``, its ``links`` and how many ``equations``
    it is, a coupling what a result tells of it; ``constraints`` is what
    :func:`antenna_pin.dynamics.constraint_counts` finds at the start, and ``residuals`` is how well loops and
    couplings are closed there [m], [rad]. ``passed_over`` has lines of the URDF, by what stands there that
    means nothing to the mechanics, ``unbounded`` the joints without bounds.

    Raises:
        AntennaPinError: The scenario cannot be built, or its loops cannot be closed; one line that says why.
    """
    system = build_system(scenario)
    y = system.state(*initial_state(scenario, system), initial_angles(scenario, system))
    return {
        "base": system.mechanism.base,
        "joints": _joints(scenario, system),
        "closures": {
            name: {
                "kind": one.kind,
                "links": [one.first.link, one.second.link],
                "equations": one.holds.rows,
            }
            for name, one in system.closures.items()
        },
        "couplings": facts_of_couplings(system.mechanism, system.couplings),
        "drives": {name: _drive(system, name) for name in system.drives},
        "constraints": constraint_counts(system, y),
        "residuals": _residuals(system, y),
        "passed_over": {kind.what: list(kind.lines) for kind in as_written(scenario).passed_over},
        "unbounded": list(system.mechanism.urdf.unbounded),
    }


def _joints(scenario: Scenario, system: System) -> dict[str, str]:
    found = {}
    for name, slot in system.mechanism.joints.items():
        play = scenario.clearance.get(name)
        if isinstance(play, TouchingSpec):
            found[name] = f"with play ({play.model})"
        elif name in system.elastic:
            part, hub = system.elastic[name], system.mechanism.urdf.joint(name).parent
            found[name] = f"elastic part of {hub}, {part.frequency:g} Hz with the hub held"
        elif name in system.closures:
            found[name] = f"{system.closures[name].kind}, held by constraint"
        else:
            found[name] = str(slot.kind)
    return found


def _drive(system: System, name: str) -> str:
    drive = system.drives[name]
    slides = system.mechanism.joint(drive.joint).kind == "prismatic"
    return f"{drive.words(slides)}, at {drive.joint}"


def _residuals(system: System, y: Any) -> tuple[float, float]:
    workspace = Workspace(system)
    if workspace.constraints is None:
        return 0.0, 0.0
    workspace.prepare_motions(0.0, y)
    found = workspace.constraints.residuals(0.0, y, workspace.program)
    return found.gap, found.turn
