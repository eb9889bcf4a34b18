"""The angle of one joint, with its whole turns, and its rate: of a state, outside the equations of motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.element_block import element_block
from antenna_pin.dynamics.system import System
from antenna_pin.elements import ConstantDrive

__all__ = ["JointMotion", "motion_block"]

Array = NDArray[np.float64]


def motion_block(system: System, joint: str) -> Array:
    """Return what a kernel needs to know of a joint's motion, as a block of a program behind the system's.

    Raises:
        AntennaPinError: There is no such joint, or it has no axis.
    """
    return element_block(system, f"motion of {joint!r}", ConstantDrive(joint=joint, value=0.0), 0)


class JointMotion:
    """Angle and rate of a joint that has an axis: ideal, by constraint or with play.

    Args:
        system: The system.
        joint: Name of the joint.

    Raises:
        AntennaPinError: There is no such joint, or it has no axis.
    """

    def __init__(self, system: System, joint: str) -> None:
        """Lay out what the kernel needs to know of the joint."""
        self._program = np.concatenate([system.program, motion_block(system, joint)])
        self._block = system.program.size
        self._nq = system.model.nq

    def __call__(self, y: Array) -> tuple[float, float]:
        """Return angle [rad] (position [m] of a sliding joint) and rate of a state [q, v, x]."""
        angle, rate, _, _ = kernels.joint_motion(self._program, self._block, y, self._nq)
        return float(angle), float(rate)
