r"""A reading behind a low-pass filter: Butterworth's of any order, continuous, solved exactly by steps.

The filter's transfer function is a sum over its poles,

.. math:: H(s) = \sum_i \frac{r_i}{s - p_i}, \quad r_i = \prod_{j \neq i} (p_i - p_j)^{-1},

in units of the corner's angular frequency; each term is a linear equation of first order, of which a step of
time h has a closed solution, :math:`x' = e^{p h} x + \ldots`, for an input that is constant or straight over
it. Acceleration goes in as the change of velocity over a step, so that a blow is passed on with all of its
impulse however short it is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import signal

__all__ = ["PER_PERIOD", "filtered_means", "filtered_points"]

Array = NDArray[np.float64]

#: Instants at which what goes into a filter is asked for, in one period of its corner: what the filter makes
#: of a sine at its corner is then exact to (2 pi / 64)^2 / 12 = 8e-4.
PER_PERIOD = 64


def filtered_means(means: Array, step: float, corner: float, order: int) -> Array:
    """Return what comes out behind each of even steps, (n,), and before the first: (n + 1,).

    Args:
        means: Of the input over each step, (n,).
        step: Of time [s].
        corner: Where the filter is 3 dB down [Hz].
        order: Of it [-].
    """
    return _out(means, None, step, corner, order)


def filtered_points(points: Array, step: float, corner: float, order: int) -> Array:
    """Return what comes out at even instants, (n,), of an input that is straight between them, (n,)."""
    return _out(points[:-1], points[1:], step, corner, order)


def _out(first: Array, last: Array | None, step: float, corner: float, order: int) -> Array:
    poles = np.exp(0.5j * np.pi * (1.0 + (2.0 * np.arange(order) + 1.0) / order))
    h = 2.0 * np.pi * corner * step
    out = np.zeros(len(first) + 1)
    for i, pole in enumerate(poles):
        residue = 1.0 / np.prod(pole - np.delete(poles, i))
        decay = np.exp(pole * h)
        whole = (decay - 1.0) / pole  # of a constant input
        if last is None:
            driven = whole * first
        else:
            late = (decay - 1.0 - pole * h) / (pole**2 * h)
            driven = (whole - late) * first + late * last
        rest = -first[0] / pole  # as if the first input had always been there
        x = signal.lfilter([1.0], [1.0, -decay], np.concatenate([[rest], driven]))
        out += (residue * x).real
    return out
