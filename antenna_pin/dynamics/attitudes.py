"""Attitudes of journals in their bearings at the samples of a run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics.program_parts import records_at
from antenna_pin.dynamics.system import System
from antenna_pin.joints.layout_kernels import JOINT

__all__ = ["journal_attitudes"]

Array = NDArray[np.float64]


def journal_attitudes(
    system: System,
    states: Array,
    programs: Sequence[Array],
    before: tuple[Array, Array] | None = None,
) -> Array:
    """Return the attitudes of the journals' frames in their bearings', as quaternions without jumps in sign.

    Args:
        system: The system.
        states: (n, nq + nv + nx).
        programs: Force elements at each: the same array from one to the next where nothing was changed.
        before: The state before the first of these, and its attitudes, (joints, 4), whose signs go on.

    Returns:
        (n, joints, 4), xyzw.
    """
    if before is not None:
        states, programs = np.concatenate([before[0][np.newaxis], states]), [programs[0], *programs]
    result = np.zeros((len(states), len(system.clearances), 4))
    for k, joint in enumerate(system.clearances):
        slot = system.mechanism.joint(joint.name)
        q, found = states[:, slot.q], result[:, k]
        if slot.kind == "planar":
            half = 0.5 * np.arctan2(q[:, 3], q[:, 2])
            found[:, 2], found[:, 3] = np.sin(half), np.cos(half)
        else:
            axes = records_at(programs, system.clearance_blocks[joint.name], JOINT)["axes"]
            # Number by number, so that a sample's are the same among whatever others it is.
            found[:, :3] = sum(q[:, 3 + i, np.newaxis] * axes[:, i] for i in range(3))
            found[:, 3] = q[:, 6]
        if joint.bearing_on == "child":
            found[:, :3] *= -1.0
        largest = found[0, np.argmax(np.abs(found[0]))]
        sign = np.sign(largest) if before is None else np.sign(found[0] @ before[1][k])
        jumps = np.cumsum(np.sum(found[1:] * found[:-1], axis=1) < 0.0) % 2 == 1
        found[0] *= sign
        found[1:] *= np.where(jumps, -sign, sign)[:, None]
    return result if before is None else result[1:]
