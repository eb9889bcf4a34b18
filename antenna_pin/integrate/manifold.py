"""The state space: a product of joint configuration spaces, their tangent spaces, and plain numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.records import CIRCLE, PLANE, RIGID, ROTATION, VECTOR
from antenna_pin.errors import InvalidParameterError
from antenna_pin.integrate import manifold_kernels as kernels

__all__ = ["KINDS", "Manifold"]

Array = NDArray[np.float64]

#: Configuration spaces of joints: kind -> (code, numbers in q, numbers in v).
KINDS = {
    "vector": (VECTOR, 1, 1),
    "circle": (CIRCLE, 2, 1),
    "plane": (PLANE, 4, 3),
    "rotation": (ROTATION, 4, 3),
    "rigid": (RIGID, 7, 6),
}


def _laid_out(nq: int, nv: int, nx: int, factors: NDArray[Any]) -> NDArray[np.int64]:
    """Return a space as flat numbers."""
    head = np.array([(nq, nv, nx, len(factors))], dtype=kernels.SPACE)
    return np.concatenate([head.view(np.int64), factors.view(np.int64)])


@dataclass(frozen=True, slots=True, eq=False)
class Manifold:
    """A product of configuration spaces, in order, and ``nx`` plain numbers behind.

    Kinds: ``vector`` (one number), ``circle`` (cos, sin), ``plane`` (x, y, cos, sin), ``rotation``
    (quaternion xyzw), ``rigid`` (position, quaternion). Velocities are in body axes: Pinocchio's conventions.

    Attributes:
        kinds: Kind of each factor.
        nx: How many plain numbers follow q and v in a state.
        nq: Numbers in a configuration.
        nv: Numbers in a velocity.
        size: Numbers in a state [q, v, x].
        layout: The space as the kernels take it: ``SPACE``, and a ``FACTOR`` for each joint.
    """

    kinds: tuple[str, ...]
    nx: int = 0
    nq: int = field(init=False, repr=False)
    nv: int = field(init=False, repr=False)
    size: int = field(init=False, repr=False)
    layout: NDArray[np.int64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Lay the factors out."""
        factors, i, j = [], 0, 0
        for kind in self.kinds:
            if kind not in KINDS:
                raise InvalidParameterError("Manifold", "kinds", f"of {sorted(KINDS)}", kind)
            code, nq, nv = KINDS[kind]
            factors.append((code, i, j, nv))
            i += nq
            j += nv
        layout = _laid_out(i, j, self.nx, np.array(factors, dtype=kernels.FACTOR))
        for name, value in (("nq", i), ("nv", j), ("size", i + j + self.nx), ("layout", layout)):
            object.__setattr__(self, name, value)

    def part(self, factors: Sequence[int]) -> NDArray[np.int64]:
        """Return the layout of some factors only, without the plain numbers."""
        every = self.layout[kernels.SPACE_WORDS :].view(kernels.FACTOR)
        return _laid_out(self.nq, self.nv, 0, every[list(factors)])

    def compose(self, q: ArrayLike, u: ArrayLike) -> Array:
        """Return q o exp(u): the configuration reached from q by the chart coordinates u, (nq,).

        Args:
            q: Configuration, (nq,).
            u: Chart coordinates, (nv,): position [m] in the axes of the parent, rotation vector [rad] in body
                axes.
        """
        rows = np.zeros((3, self.size))
        rows[0, : self.nq], rows[1, : self.nv] = q, u
        kernels.retract(self.layout, rows, 0, rows, 1, rows, 2)
        return rows[2, : self.nq].copy()

    def chart_rate(self, q: ArrayLike, u: ArrayLike, v: ArrayLike) -> Array:
        """Return the rate of u for the velocity v at the configuration q o exp(u), (nv,)."""
        rows = np.zeros((3, self.size))
        rows[0, : self.nq], rows[0, self.nq : self.nq + self.nv] = self.compose(q, u), v
        rows[1, : self.nv] = u
        kernels.chart_rate(self.layout, rows, 1, rows, 0, rows, 2)
        return rows[2, : self.nv].copy()

    def bracket(self, v: ArrayLike, ways: ArrayLike) -> Array:
        """Return the bracket [v, w] of a velocity with ways w from a configuration, (nv, k).

        Neighbours q o exp(w) of a motion q' = q v move by w' = dv - [v, w] beside it, dv the difference of
        velocities.

        Args:
            v: Velocity, (nv,).
            ways: In the coordinates of velocities, by columns, (nv, k).
        """
        velocity, columns = np.array(v, dtype=float), np.array(ways, dtype=float).T.copy()
        out = np.zeros_like(columns)
        for way, found in zip(columns, out, strict=True):
            kernels.write_bracket(self.layout, velocity, way, found)
        return np.asarray(out.T)
