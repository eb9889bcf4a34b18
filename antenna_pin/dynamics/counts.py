"""Counts of equations and freedoms of a system, and the joints that move."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.constraints import Mobility, mobility, redundancies
from antenna_pin.dynamics.system import System
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.elements import Motion

__all__ = ["constraint_counts", "mobility_of"]

Array = NDArray[np.float64]


def mobility_of(system: System, y: Array) -> Mobility:
    """Return how a system with constraints can move in a state [q, v, x]."""
    workspace = Workspace(system)
    assert workspace.constraints is not None
    workspace.prepare_motions(0.0, y)
    return mobility(workspace.constraints, 0.0, y, workspace.program)


def constraint_counts(system: System, y: Array) -> dict[str, Any]:
    """Return how many equations hold a system in a state [q, v, x], and what they leave free.

    ``closure_equations`` of closures and couplings, how many of these are ``couplings``, if any,
    ``closure_rank`` (independent ones), ``motions``, ``rank`` (of all), ``freedoms`` of the tree,
    ``mobility`` (what closures and couplings leave), ``freedoms_left`` (what all leave), ``moving``: of each
    joint (and the ``base``) that moves by no motion of its own its ``rate`` and the ``unit`` of that, and
    ``redundant``: of each closure or coupling with equations that others imply, how many ``equations`` that
    are, and ``among`` which.
    """
    if system.plan is None or system.plan.count == 0:  # elements that may hold close nothing
        nv = system.model.nv
        zero = dict.fromkeys(("closure_equations", "closure_rank", "motions", "rank"), 0)
        return {**zero, "freedoms": nv, "mobility": nv, "freedoms_left": nv, "moving": {}, "redundant": {}}
    count = mobility_of(system, y)
    found = {}
    if count.redundant:
        workspace = Workspace(system)
        assert workspace.constraints is not None
        workspace.prepare_motions(0.0, y)
        found = redundancies(workspace.constraints, 0.0, y, workspace.program)
    return {
        "closure_equations": count.closed,
        **({"couplings": len(system.couplings)} if system.couplings else {}),
        "closure_rank": count.closed_rank,
        "motions": count.driven,
        "rank": count.rank,
        "freedoms": count.freedoms,
        "mobility": count.free,
        "freedoms_left": count.left,
        "moving": _moving(system, y),
        "redundant": {
            name: {"equations": one.equations, "among": list(one.among)} for name, one in found.items()
        },
    }


def _moving(system: System, y: Array) -> dict[str, dict[str, Any]]:
    """Return the rates of moving joints without a prescribed motion, by name: of turns, or else of ways."""
    nq, mechanism, found = system.model.nq, system.mechanism, {}
    slots = {name: (slot.ways, slot.v) for name, slot in mechanism.joints.items()}
    if mechanism.base == "free":
        slots["base"] = slice(0, 3), mechanism.base_v
    moved = {one.joint for one in system.drives.values() if isinstance(one, Motion)}
    for name, (ways, own) in slots.items():
        rate = y[nq + own.start : nq + own.stop]
        turns = rate[ways.stop - ways.start :]
        if rate.any() and name not in moved:
            size = float(rate[0]) if len(rate) == 1 else float(np.linalg.norm(turns if turns.any() else rate))
            found[name] = {"rate": size, "unit": "rad/s" if turns.any() else "m/s"}
    return found
