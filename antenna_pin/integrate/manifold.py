"""The state space: a product of joint configuration spaces, their tangent spaces, and plain numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.errors import InvalidParameterError
from antenna_pin.integrate import _kernels

__all__ = ["KINDS", "Manifold"]

Array = NDArray[np.float64]

#: Configuration spaces of joints: kind -> (code, numbers in q, numbers in v).
KINDS = {
    "vector": (_kernels.VECTOR, 1, 1),
    "circle": (_kernels.CIRCLE, 2, 1),
    "plane": (_kernels.PLANE, 4, 3),
    "rotation": (_kernels.ROTATION, 4, 3),
    "rigid": (_kernels.RIGID, 7, 6),
}


@dataclass(frozen=True, slots=True, eq=False)
class Manifold:
    """A product of configuration spaces, in order, and ``nx`` plain numbers behind.

    Kinds: ``vector`` (one number), ``circle`` (cos, sin), ``plane`` (x, y, cos, sin), ``rotation`` (quaternion
    xyzw), ``rigid`` (position, quaternion). Velocities are in body axes: Pinocchio's conventions.

    Attributes:
        kinds: Kind of each factor.
        nx: How many plain numbers follow q and v in a state.
    """

    kinds: tuple[str, ...]
    nx: int = 0
    blocks: NDArray[np.int64] = field(init=False, repr=False)
    sizes: NDArray[np.int64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Lay the factors out."""
        rows, i, j = [], 0, 0
        for kind in self.kinds:
            if kind not in KINDS:
                raise InvalidParameterError("Manifold", "kinds", f"of {sorted(KINDS)}", kind)
            code, nq, nv = KINDS[kind]
            rows.append((code, i, j, nv))
            i += nq
            j += nv
        object.__setattr__(self, "blocks", np.array(rows, dtype=np.int64).reshape(-1, 4))
        object.__setattr__(self, "sizes", np.array([i, j, self.nx], dtype=np.int64))

    @property
    def nq(self) -> int:
        """Numbers in a configuration."""
        return int(self.sizes[0])

    @property
    def nv(self) -> int:
        """Numbers in a velocity."""
        return int(self.sizes[1])

    @property
    def size(self) -> int:
        """Numbers in a state [q, v, x]."""
        return int(self.sizes.sum())

    def compose(self, q: ArrayLike, u: ArrayLike) -> Array:
        """Return q o exp(u): the configuration reached from q by the chart coordinates u, (nq,).

        Args:
            q: Configuration, (nq,).
            u: Chart coordinates, (nv,): position [m] in the axes of the parent, rotation vector [rad] in body axes.
        """
        out = np.empty(self.nq)
        start = np.ascontiguousarray(q, dtype=float)
        _kernels.retract(self.blocks, start, np.ascontiguousarray(u, dtype=float), out)
        return out

    def chart_rate(self, q: ArrayLike, u: ArrayLike, v: ArrayLike) -> Array:
        """Return the rate of u for the velocity v at the configuration q o exp(u), (nv,)."""
        out = np.empty(self.nv)
        here = self.compose(q, u)
        coordinates = np.ascontiguousarray(u, dtype=float)
        _kernels.chart_rate(
            self.blocks, coordinates, here, np.ascontiguousarray(v, dtype=float), 0, out
        )
        return out

    def expand(self, per_kind: Sequence[ArrayLike]) -> Array:
        """Concatenate one tangent-space array per factor, checked for size, (nv,)."""
        parts = []
        for kind, values in zip(self.kinds, per_kind, strict=True):
            part = np.broadcast_to(np.asarray(values, dtype=float), (KINDS[kind][2],))
            parts.append(part)
        return np.concatenate(parts) if parts else np.zeros(0)
