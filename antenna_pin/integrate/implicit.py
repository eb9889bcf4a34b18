"""What the equations of an implicit step are solved with: Radau IIA of order 5, for stiff contact."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate import newton_kernels as _newton
from antenna_pin.integrate.methods import Method

__all__ = ["newton_of"]

# From the coordinates in which A^-1 parts into a number and a pair to the stages' (Hairer and Wanner 1996,
# IV.8, and their program RADAU5).
_BACK = (
    (9.1232394870892942792e-02, -0.14125529502095420843, -3.0029194105147424492e-02),
    (0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779),
    (0.96604818261509293619, 1.0, 0.0),
)


def newton_of(method: Method, size: int, columns: NDArray[np.int64]) -> _newton.Radau:
    """Return what the kernels solve the equations of a step with.

    Args:
        method: Radau IIA.
        size: Components of z.
        columns: Those that the derivative depends on, increasing.
    """
    root, third = math.sqrt(6.0), np.cbrt(3.0)
    m = len(columns)
    return _newton.Radau(
        progress=np.zeros(1, _newton.PROGRESS),
        nodes=np.ascontiguousarray(method.nodes[1:4]),
        inverse=np.asarray(np.linalg.inv(method.weights[1:4, 1:4]), dtype=np.float64),
        back=np.array(_BACK),
        forth=np.linalg.inv(np.array(_BACK)),
        values=np.array(
            [
                3.0 + third**2 - third,
                3.0 + 0.5 * (third - third**2),
                0.5 * math.sqrt(3.0) * (third + third**2),
            ]
        ),
        error=np.array([-13.0 - 7.0 * root, -13.0 + 7.0 * root, -1.0]) / 3.0,
        columns=np.ascontiguousarray(columns, dtype=np.int64),
        z=np.zeros((3, size)),
        w=np.zeros((3, size)),
        f=np.zeros((3, size)),
        jacobian=np.zeros((size, m)),
        real=np.zeros((m, m)),
        complex=np.zeros((m, m), dtype=complex),
        pivots=np.zeros((2, m), dtype=np.int64),
        solved=np.zeros(m),
        paired=np.zeros(m, dtype=complex),
    )
