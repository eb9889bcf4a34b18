r"""Attitude between samples: cubic in the rotation vector, from attitudes and body rates at the samples.

Within an interval the attitude is :math:`R(t) = R_k \exp([\varphi(t)]_\times)`, with the cubic
:math:`\varphi` that has the right values and slopes at both ends:

.. math::
    \varphi(t_k) = 0, \quad \dot\varphi(t_k) = \omega_k, \quad
    \varphi(t_{k+1}) = \log(R_k^T R_{k+1}), \quad
    \dot\varphi(t_{k+1}) = J_r^{-1}(\varphi(t_{k+1}))\, \omega_{k+1}

:math:`\omega` is the angular velocity in body axes and :math:`J_r^{-1}` the inverse of the right Jacobian of
the exponential. The error falls with the fourth power of the spacing; slerp, without the rates, is of second
order. The interpolant passes through the samples exactly, and its rate is continuous.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError

__all__ = ["interpolate_attitude", "interpolation_error"]

Array = NDArray[np.float64]


@takes()
def interpolate_attitude(
    times: ArrayLike, knots: ArrayLike, attitude: Rotation, angular_velocity: ArrayLike
) -> Rotation:
    """Return the attitude at given times.

    Args:
        times: Where it is wanted, (m,) [s]; within the samples' span to a billionth of it.
        knots: Times of the samples, (n,), not decreasing [s]; of equal ones the first counts.
        attitude: At the samples, body in world, (n,).
        angular_velocity: At the samples, in body axes, (n, 3) [rad/s].

    Raises:
        InvalidParameterError: Times outside the samples' span.
    """
    wanted = np.atleast_1d(np.asarray(times, dtype=float))
    t, first = np.unique(np.asarray(knots, dtype=float), return_index=True)
    slack = 1e-9 * (t[-1] - t[0])
    outside = wanted[(wanted < t[0] - slack) | (wanted > t[-1] + slack)]
    if outside.size:
        raise InvalidParameterError(
            "interpolate_attitude", "times", f"from {t[0]:g} s to {t[-1]:g} s", float(outside[0])
        )
    at = attitude[first]
    if t.size == 1:
        return at[np.zeros(wanted.size, dtype=int)]
    omega = np.asarray(angular_velocity, dtype=float)[first]
    turn = (at[:-1].inv() * at[1:]).as_rotvec()
    h = np.diff(t)[:, None]
    start, end = h * omega[:-1], h * _chart_rate(turn, omega[1:])
    k = np.clip(np.searchsorted(t, wanted, side="right") - 1, 0, t.size - 2)
    s = np.clip((wanted - t[k]) / (t[k + 1] - t[k]), 0.0, 1.0)[:, None]
    phi = s * (1.0 - s) ** 2 * start[k] + s**2 * (3.0 - 2.0 * s) * turn[k] - s**2 * (1.0 - s) * end[k]
    return at[k] * Rotation.from_rotvec(phi)


@takes()
def interpolation_error(knots: ArrayLike, attitude: Rotation, angular_velocity: ArrayLike) -> float:
    """Return an estimate of the largest error of :func:`interpolate_attitude` [rad].

    Every other sample is left out and compared with what the rest gives there; at twice the spacing the error
    is 16 times as large. NaN for less than three samples.
    """
    t, first = np.unique(np.asarray(knots, dtype=float), return_index=True)
    if t.size < 3:
        return float("nan")
    at, omega = attitude[first], np.asarray(angular_velocity, dtype=float)[first]
    left_out = np.arange(1, t.size - 1, 2)
    found = interpolate_attitude(t[left_out], t[::2], at[::2], omega[::2])
    return float((found.inv() * at[left_out]).magnitude().max()) / 16.0


def _chart_rate(phi: Array, omega: Array) -> Array:
    r"""Return :math:`J_r^{-1}(\varphi)\, \omega`, (n, 3): the rotation vector's rate at a body rate."""
    half = 0.5 * np.linalg.norm(phi, axis=1)
    small = half < 1e-3
    safe = np.where(small, 1.0, half)
    # (1 - x cot x) / (4 x^2) with x half the angle, 1/12 + x^2/180 + ...
    factor = np.where(small, 1.0 / 12.0 + half**2 / 180.0, (1.0 - safe / np.tan(safe)) / (4.0 * safe**2))
    cross = np.cross(phi, omega)
    result: Array = omega + 0.5 * cross + factor[:, None] * np.cross(phi, cross)
    return result
