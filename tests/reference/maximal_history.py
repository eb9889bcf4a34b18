"""A motion in maximal coordinates, and what is read from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from maximal_vectors import cross
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class History:
    """A motion at its output times: states (k, n, 13), accelerations (k, n, 6), multipliers (k, rows)."""

    system: Any
    t: np.ndarray
    states: np.ndarray
    accelerations: np.ndarray
    multipliers: np.ndarray

    def rotation(self, body: str) -> np.ndarray:
        """Return the (k, 3, 3) rotations from the body to the world."""
        return Rotation.from_quat(self.states[:, self.system.index(body), 3:7]).as_matrix()

    def position(self, body: str, point: Sequence[float] = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return where a point of the body's frame is in the world, (k, 3) [m]."""
        return self.states[:, self.system.index(body), :3] + self._arm(body, point)

    def velocity(self, body: str, point: Sequence[float] = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return the velocity of a point of the body in world axes, (k, 3) [m/s]."""
        return self.states[:, self.system.index(body), 7:10] + cross(self.spin(body), self._arm(body, point))

    def spin(self, body: str) -> np.ndarray:
        """Return the body's angular velocity in world axes, (k, 3) [rad/s]."""
        return self.states[:, self.system.index(body), 10:13]

    def load(self, joint: str) -> tuple[np.ndarray, np.ndarray]:
        """Return force [N] and moment [N m] of the joint's first body on its second.

        Both (k, 3), about the second side's point, in the axes of frame A; a motion's share is not in them.
        """
        loads = [self.system.load_map(joint, t, y) @ m for t, y, m in self._each()]
        return np.array([w[:3] for w in loads]), np.array([w[3:] for w in loads])

    def ambiguous(self, joint: str) -> np.ndarray:
        """Return what redundant rows may add to a load without a change of the motion, (k, 6, redundant)."""
        return np.array([self.system.ambiguous(joint, t, y) for t, y, _ in self._each()])

    def drive(self, joint: str) -> np.ndarray:
        """Return the effort of a motion on the second body, along its own coordinate, (k,) [N] or [N m]."""
        return self.multipliers[:, self.system.driven_row(joint)]

    def energy(self) -> np.ndarray:
        """Return kinetic plus potential energy, of gravity and springs, (k,) [J]."""
        return np.array([self.system.energy(y) for y in self.states])

    def _arm(self, body: str, point: Sequence[float]) -> np.ndarray:
        return self.rotation(body) @ (np.array(point, dtype=float) - self.system.bodies[body].centre)

    def _each(self) -> zip[tuple[float, np.ndarray, np.ndarray]]:
        return zip(self.t, self.states, self.multipliers, strict=True)
