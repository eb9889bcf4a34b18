"""How far the elastic parts of flexible links are out of rest, and what their springs store."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.program_parts import records_at
from antenna_pin.dynamics.system import System
from antenna_pin.elements import JointSpring
from antenna_pin.mechanism import link_twists

__all__ = ["Deflections", "deflections"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Deflections:
    """The elastic parts of a system at n samples.

    Attributes:
        motion: Deflection from rest [rad] or [m], its rate and its acceleration, (n, parts, 3).
        energy: Stored in their springs, (n, parts) [J].
        spin: Angular speed of their hubs, (n, parts) [rad/s].
    """

    motion: Array
    energy: Array
    spin: Array


def deflections(
    system: System, states: Array, accelerations: Array, programs: Sequence[Array]
) -> Deflections:
    """Evaluate the elastic parts of a system at samples.

    Args:
        system: The system.
        states: [q, v, x] of each, (n, nq + nv + nx).
        accelerations: Generalized, (n, nv).
        programs: Force elements at each: the same array from one to the next where nothing was changed.
    """
    n, parts = len(states), len(system.elastic)
    motion, energy, spin = np.zeros((n, parts, 3)), np.zeros((n, parts)), np.zeros((n, parts))
    if not parts:
        return Deflections(motion, energy, spin)
    nq, nv = system.model.nq, system.model.nv
    q, v = states[:, :nq], states[:, nq : nq + nv]
    urdf = system.mechanism.urdf
    hubs = list(dict.fromkeys(urdf.joint(name).parent for name in system.elastic))
    turning = np.linalg.norm(link_twists(system.mechanism, q, v, hubs)[..., 3:], axis=2)
    for k, name in enumerate(system.elastic):
        slot = system.mechanism.joint(name)
        motion[:, k, 0] = q[:, slot.q.start]
        motion[:, k, 1] = v[:, slot.v.start]
        motion[:, k, 2] = accelerations[:, slot.v.start]
        spin[:, k] = turning[:, hubs.index(urdf.joint(name).parent)]
        at = system.spring_blocks[name]
        on = records_at(programs, at, kernels.ELEMENT)["on"]
        spring = records_at(programs, at + int(kernels.PARAMETERS), JointSpring.compiled().LAYOUT)
        energy[:, k] = 0.5 * on * spring["stiffness"] * (motion[:, k, 0] - spring["rest_angle"]) ** 2
    return Deflections(motion, energy, spin)
