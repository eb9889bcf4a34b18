r"""Response of a low-pass filter: Butterworth's of any order, continuous, in closed form between samples.

The filter's transfer function is a sum over its poles,

.. math:: H(s) = \sum_i \frac{r_i}{s - p_i}, \quad r_i = \prod_{j \neq i} (p_i - p_j)^{-1},

in units of the corner's angular frequency. Each term obeys a linear equation of first order, whose solution
over an interval of length h is :math:`x' = e^{p h} x + \int_0^h e^{p (h - \tau)} f(\tau)\,d\tau`. Between two
samples of a run the input f is a polynomial and impulses at known times; an impulse J at time s contributes
:math:`J e^{p (h - s)}`. So the response follows the time of a blow smoothly, however short the blow.

An acceleration is sampled with the velocity and position that belong to it. Over an interval from a to b
these fix its zeroth and first moments exactly,

.. math:: \int_a^b \dot{v}\,dt = v_b - v_a, \quad \int_a^b (b - t)\,\dot{v}\,dt = x_b - x_a - (b - a)\,v_a,

whatever the acceleration does in between. A straight line from one sampled acceleration to the next accounts
for a part of both moments; the rest is an impulse, whose size is the rest of the zeroth moment and whose time
is the ratio of the rests. If that time is outside the interval, two opposite impulses at its ends supply what
the first moment lacks.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

__all__ = ["FilterInput", "filter_response", "input_of_acceleration", "input_of_values"]

Array = NDArray[np.float64]

# Gauss-Legendre nodes and weights on [0, 1]: exact to the fifth degree, where |p h| is 0.3 at most.
_NODES, _WEIGHTS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)]), np.array([5.0, 8.0, 5.0]) / 18.0


class FilterInput(NamedTuple):
    """Input of a filter over the n - 1 intervals between n sample times.

    Attributes:
        time: Sample times, rising, (n,) [s].
        smooth: Coefficients of the smooth part, a polynomial in the share of the interval, (n - 1, 3).
        impulses: Sizes of impulses in each interval, (n - 1, k), in the input's unit times s.
        places: Their times after the interval's start, (n - 1, k) [s].
    """

    time: Array
    smooth: Array
    impulses: Array
    places: Array

    def at(self, intervals: NDArray[np.intp], share: Array) -> Array:
        """Return the smooth part of the input at shares of some intervals, (m,)."""
        first, second, third = self.smooth[intervals].T
        return np.asarray(first + share * (second + share * third))


def input_of_values(time: Array, values: Array) -> FilterInput:
    """Return the input that is straight between its values at sample times, (n,) each."""
    smooth = np.column_stack([values[:-1], np.diff(values), np.zeros(len(time) - 1)])
    none = np.zeros((len(time) - 1, 0))
    return FilterInput(time, smooth, none, none)


def input_of_acceleration(
    time: Array, axes: Array, position: Array, velocity: Array, acceleration: Array, gravity: Array
) -> FilterInput:
    """Return the specific force along a moving axis as a filter's input.

    Args:
        time: Sample times, rising, (n,) [s].
        axes: Unit vectors along which the sensor reads, (n, 3).
        position: Of the sensor, (n, 3) [m].
        velocity: Likewise [m/s].
        acceleration: Likewise, where it jumps the value afterwards [m/s^2].
        gravity: (3,) [m/s^2].
    """
    h = np.diff(time)[:, None]
    turn, bend = np.diff(axes, axis=0), np.diff(acceleration, axis=0)
    force = acceleration[:-1] - gravity
    smooth = np.column_stack(
        [_dot(axes[:-1], force), _dot(axes[:-1], bend) + _dot(turn, force), _dot(turn, bend)]
    )
    impulse = np.diff(velocity, axis=0) - h * (acceleration[:-1] + 0.5 * bend)
    moment = np.diff(position, axis=0) - h * velocity[:-1] - h**2 * (acceleration[:-1] / 2.0 + bend / 6.0)
    size = _dot(impulse, impulse)
    left = np.divide(_dot(impulse, moment), size, out=np.zeros(len(size)), where=size > 0.0)  # to the end
    place = h[:, 0] - np.clip(left, 0.0, h[:, 0])
    share = np.divide(place, h[:, 0], out=np.zeros(len(size)), where=h[:, 0] > 0.0)
    axis = axes[:-1] + share[:, None] * turn
    along = _dot(axis, impulse)
    lack = _dot(axis, moment) - along * (h[:, 0] - place)
    pair = np.divide(lack, h[:, 0], out=np.zeros(len(size)), where=h[:, 0] > 0.0)
    return FilterInput(
        time,
        smooth,
        np.column_stack([pair, along, -pair]),
        np.column_stack([np.zeros(len(size)), place, h[:, 0]]),
    )


def filter_response(given: FilterInput, rows: Array, corner: float, order: int) -> Array:
    """Return the filter's output at some times, (m,).

    Before the first sample the input is taken to have been constant for ever.

    Args:
        given: The input.
        rows: Times of the output [s], from the first to the last sample time.
        corner: Frequency at which the filter is 3 dB down [Hz].
        order: Order of the filter [-].
    """
    omega = 2.0 * np.pi * corner
    poles = np.exp(0.5j * np.pi * (1.0 + (2.0 * np.arange(order) + 1.0) / order))
    every = np.arange(len(given.time) - 1)
    inside = np.clip(np.searchsorted(given.time, rows, side="right") - 1, 0, len(every) - 1)
    lengths, out = np.diff(given.time), np.zeros(len(rows))
    for i, pole in enumerate(poles):
        if pole.imag < -1e-9:  # the conjugate of one that counts twice
            continue
        times = 2.0 if pole.imag > 1e-9 else 1.0
        residue = 1.0 / np.prod(pole - np.delete(poles, i))
        p = omega * pole
        driven = omega * _driven(given, p, every, lengths)
        first = -given.smooth[0, 0] / pole
        bands = np.ones((2, len(given.time)), dtype=complex)
        bands[1, :-1] = -np.exp(p * lengths)
        states = solve_banded((1, 0), bands, np.concatenate([[first], driven]), check_finite=False)
        into = rows - given.time[inside]
        found = np.exp(p * into) * states[inside] + omega * _driven(given, p, inside, into)
        out += times * (residue * found).real
    return out


def _driven(
    given: FilterInput, p: complex, intervals: NDArray[np.intp], into: Array
) -> NDArray[np.complex128]:
    """Return what intervals' inputs have added to a pole's state some time after their starts, (m,)."""
    lengths = np.diff(given.time)[intervals]
    total = np.zeros(len(intervals), dtype=complex)
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        share = np.divide(node * into, lengths, out=np.zeros(len(into)), where=lengths > 0.0)
        total += weight * into * np.exp(p * into * (1.0 - node)) * given.at(intervals, share)
    for size, place in zip(given.impulses[intervals].T, given.places[intervals].T, strict=True):
        after = into - place
        total += np.where(after >= 0.0, size * np.exp(p * np.maximum(after, 0.0)), 0.0)
    return total


def _dot(one: Array, other: Array) -> Array:
    return np.asarray(np.einsum("ni,ni->n", one, other))
