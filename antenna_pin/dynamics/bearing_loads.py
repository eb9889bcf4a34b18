"""What the bearings of a system carry at the samples of a run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import POSE
from antenna_pin.dynamics.bearing_load_kernels import BEARING_LOAD, look_at_bearings
from antenna_pin.dynamics.mounted import bearings_in
from antenna_pin.dynamics.program_parts import program_parts
from antenna_pin.dynamics.system import System

__all__ = ["bearing_loads", "bearing_names"]

Array = NDArray[np.float64]


def bearing_names(system: System) -> list[str]:
    """Return the names of a system's bearings and preloads."""
    return [name for _, name, _ in bearings_in(system.families)]


def bearing_loads(system: System, states: Array, programs: Sequence[Array]) -> NDArray[Any]:
    """Return place, tilt, force and moment of each bearing, ``BEARING_LOAD``, (n, bearings).

    Args:
        system: The system.
        states: [q, v, x] of each sample, (n, nq + nv + nx).
        programs: Force elements at each: the same array from one to the next where nothing was changed.
    """
    blocks = [system.element_blocks[table][name] for table, name, _ in bearings_in(system.families)]
    found = np.zeros((len(states), len(blocks)), BEARING_LOAD)
    if not blocks:
        return found
    pose = np.zeros(1, POSE)
    for first, last in program_parts(programs):
        look_at_bearings(programs[first], states[first:last], np.array(blocks), pose, found[first:last])
    return found
