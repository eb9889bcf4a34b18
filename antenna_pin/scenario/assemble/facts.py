"""Facts of a scenario as a mechanism, from its system and initial state."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.dynamics import System, Workspace, constraint_counts, facts_of_couplings
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assemble.build import build_system
from antenna_pin.scenario.assemble.closures import reversed_axes
from antenna_pin.scenario.assemble.initial import guess_of, initial_angles, initial_state
from antenna_pin.scenario.assemble.places import as_written
from antenna_pin.scenario.clearance import TouchingSpec

# What an assembly may move a joint by before it is told [rad, or of ways the mechanism's length]: 10 deg. A
# drawn pose is seldom as far off, and to that the first guess of Newton's method is good to 2 %.
_TOLD = np.radians(10.0)


@takes()
def scenario_facts(scenario: Scenario) -> dict[str, Any]:
    """Return what a case is: ``base``, ``joints``, ``closures``, ``couplings``, ``drives``, ``constraints``.

    Joints and drives are text; a closure has its ``kind``, its ``links`` and how many ``equations``
    it is, a coupling what a result tells of it; ``constraints`` is what
    :func:`antenna_pin.dynamics.constraint_counts` finds at the start, and ``residuals`` is how well loops and
    couplings are closed there [m], [rad]. Where a start is found, ``start`` has the angles or positions of
    hinges and slides in it [rad], [m], and ``moved`` by how much joints (and ``base``) are away from where
    the search began, if that is more than 10 deg or as much of the mechanism's length: turns [rad] and ways
    [m]. A closure is ``turned`` if its second side's axis is taken the other way round than it is written.
    ``passed_over`` has lines of the URDF, by what stands there that means nothing to the mechanics,
    ``unbounded`` the joints without bounds, ``points`` the links without moments of inertia, ``unlimited``
    the continuous joints that state bounds, ``impossible`` impossible moments of inertia, as text.

    Raises:
        AntennaPinError: The scenario cannot be built, or its loops cannot be closed; one line that gives the
            reason.
    """
    system = build_system(scenario)
    q, v = initial_state(scenario, system)
    # Where nothing is held nobody asks for turns, and no compiled code is needed.
    state = system.state_as_given if system.plan is None else system.state
    y = state(q, v, initial_angles(scenario, system))
    turned = reversed_axes(scenario, system.mechanism, system.closures)
    return {
        "base": system.mechanism.base,
        "joints": _joints(scenario, system),
        "closures": {
            name: {
                "kind": one.kind,
                "links": [one.first.link, one.second.link],
                "equations": one.holds.rows,
                "turned": name in turned,
            }
            for name, one in system.closures.items()
        },
        "couplings": facts_of_couplings(system.mechanism, system.couplings),
        "drives": {name: _drive(system, name) for name in system.drives},
        "constraints": constraint_counts(system, y),
        "residuals": _residuals(system, y),
        "passed_over": {kind.what: list(kind.lines) for kind in as_written(scenario).passed_over},
        "unbounded": list(system.mechanism.urdf.unbounded),
        "points": list(system.mechanism.urdf.points),
        "unlimited": [f"{name} ({bounds})" for name, bounds in system.mechanism.urdf.unlimited],
        "impossible": list(system.mechanism.impossible),
        **({} if system.plan is None or system.plan.count == 0 else _start(scenario, system, q)),
    }


def _start(scenario: Scenario, system: System, q: NDArray[np.float64]) -> dict[str, dict[str, Any]]:
    """Return the joint positions of a computed initial state, and its distance from the guess."""
    assert system.plan is not None
    mechanism, model, far = system.mechanism, system.model, {}
    way = pin.difference(model, guess_of(scenario, system)[0], q)
    slots = {name: (slot.ways, slot.v) for name, slot in mechanism.joints.items()}
    if mechanism.base == "free":
        slots["base"] = (slice(0, 3), mechanism.base_v)
    for name, (ways, own) in slots.items():
        shift = float(np.linalg.norm(way[ways]))
        turn = float(np.linalg.norm(way[ways.stop : own.stop]))
        if turn > _TOLD or shift > _TOLD * system.plan.length:
            far[name] = {"turn": turn, "shift": shift}
    start = {}
    for name, slot in mechanism.joints.items():
        if slot.has_one_axis:
            own_q = q[slot.q]
            start[name] = float(own_q[0] if len(own_q) == 1 else np.arctan2(own_q[1], own_q[0]))
    return {"start": start, "moved": far}


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
    return f"{drive.words(system.slides(drive.joint))}, at {drive.joint}"


def _residuals(system: System, y: Any) -> tuple[float, float]:
    if system.plan is None or system.plan.count == 0:
        return 0.0, 0.0
    workspace = Workspace(system)
    assert workspace.constraints is not None
    workspace.prepare_motions(0.0, y)
    found = workspace.constraints.residuals(0.0, y, workspace.program)
    return found.gap, found.turn
