"""What a result has of friction with bristles: how they are bent, and for how long they have rested."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from antenna_pin.dynamics import kernels, records_at
from antenna_pin.elements import BristleFriction
from antenna_pin.simulation.seen import Seen

__all__ = ["bristles_of", "of_bristles"]


def bristles_of(seen: Seen, state: str) -> list[str]:
    """Return the frictions with a state of this name, by family and name."""
    return [place for place, _, _ in _with(seen, state)]


def of_bristles(seen: Seen) -> Mapping[str, Any]:
    """Return the series of bristles."""
    layout = BristleFriction.compiled().LAYOUT
    bends = [
        records_at(seen.programs, words, layout)["start"] + seen.states[:, at]
        for _, at, words in _with(seen, "bend")
    ]
    dwells = [seen.states[:, at] for _, at, _ in _with(seen, "dwell")]
    shape = len(seen.times), 0
    return {
        "bristle_bend": np.column_stack(bends) if bends else np.zeros(shape),
        "bristle_dwell": np.column_stack(dwells) if dwells else np.zeros(shape),
    }


def _with(seen: Seen, state: str) -> list[tuple[str, int, int]]:
    """Return place, where in a state the number of this name is, and in a program its record, of all."""
    system, found = seen.system, []
    for name, friction in system.families.get("frictions", {}).items():
        own = [one.name for one in friction.integrals]
        if isinstance(friction, BristleFriction) and state in own:
            block = system.element_blocks["frictions"][name]
            head = system.program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)[0]
            at = system.model.nq + system.model.nv + int(head["x"]) + own.index(state)
            found.append((f"frictions.{name}", at, block + int(kernels.PARAMETERS)))
    return found
