"""How a mechanism on a shaken base begins: with its base."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics.system import System
from antenna_pin.elements import Shake

__all__ = ["start_with_base"]


def start_with_base(system: System, y: NDArray[np.float64]) -> None:
    """Put the joints that carry a shaken base where their motions begin, and as fast, in place.

    All else is given relative to the base and so begins with it: no blow sets it moving.

    Args:
        system: The system.
        y: State [q, v, x], at time zero.
    """
    for drive in system.drives.values():
        if isinstance(drive, Shake):
            slot = system.mechanism.joint(drive.joint)
            y[slot.q], y[system.model.nq + slot.v.start], _ = drive.at(0.0)
