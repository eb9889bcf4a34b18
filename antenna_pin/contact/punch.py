r"""Compression under a rigid annular punch: the stiffness of a flange pressed flat on an end face.

A flat ring, :math:`R_i \le r \le R_o`, is pressed without friction and without tilt on an elastic half-space.
By how much it sinks in, and the load, are proportional:

.. math:: P = \kappa(\lambda)\, 2 E^* R_o\, \delta, \qquad \lambda = R_i / R_o

with :math:`\kappa = 1` for the full disc (Boussinesq). The factor hardly falls as the disc is bored open,
since the pressure is high along the edges: 0.98 for :math:`\lambda` = 0.5, 0.88 for 0.83, 0.75 for 0.95.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError

__all__ = ["annular_punch_factor"]

_NODES = 64


@takes()
def annular_punch_factor(ratio: float) -> float:
    r"""Return :math:`\kappa` of :math:`P = \kappa\, 2 E^* R_o \delta`, for a rigid flat ring [-].

    Boussinesq's potential of a pressure p, integrated around the axis, makes the condition of a flat punch

    .. math:: \delta = \frac{4}{\pi E^*} \int_{R_i}^{R_o} \frac{p(s)\, s}{r + s}\, K(m)\, ds, \qquad
              1 - m = m_1 = \left(\frac{r - s}{r + s}\right)^2

    with the complete elliptic integral K. The pressure is infinite as an inverse square root at both edges:
    with :math:`s = c + h \cos\varphi` over the ring, :math:`\sigma = p\, s\, h \sin\varphi` is smooth, even
    and periodic. The kernel's singularity is :math:`K(m) = A(m_1) - \tfrac1\pi K(m_1) \ln m_1` with a smooth
    A, and its logarithm

    .. math:: \ln|\cos\varphi - \cos\varphi'| = -\ln 2 - \sum_{k \ge 1} \tfrac2k \cos k\varphi \cos k\varphi'

    is integrated exactly against the interpolant of the rest in the Chebyshev points, where the equation is
    fulfilled (a product rule as Kress's). The error falls exponentially with the number of points; with the
    64 taken it is that of round-off, and 1e-12 still for a hole of a thousandth of the radius.

    Args:
        ratio: R_i / R_o, from 0 to below 1 [-].

    References:
        Derived here; the problem is that of Gubenko and Mossakovskii (1960), J. Appl. Math. Mech. 24, Collins
        (1963), Proc. Edinb. Math. Soc. 13, and Gladwell (1980), Contact Problems in the Classical Theory of
        Elasticity: recalled, not checked. The tests check both limits:
        :math:`1 - \tfrac{4}{3 \pi^2} \lambda^3 - \tfrac{8}{15 \pi^2} \lambda^5` for a small hole, and
        :math:`\pi^2 (1 + \lambda) / (4 \ln[16 (1 + \lambda) / (1 - \lambda)])` for a narrow ring.
    """
    if not 0.0 <= ratio < 1.0:
        raise InvalidParameterError("annular_punch_factor", "ratio", "in [0, 1)", ratio)
    return _factor(float(ratio), _NODES)


@lru_cache(maxsize=64)
def _factor(ratio: float, nodes: int) -> float:
    """Return the factor by collocation in a number of nodes."""
    from scipy.special import ellipk, ellipkm1

    if ratio == 0.0:
        return 1.0
    centre, half = 0.5 * (1.0 + ratio), 0.5 * (1.0 - ratio)
    angles = (np.arange(nodes) + 0.5) * math.pi / nodes
    s = centre + half * np.cos(angles)
    total = s[:, None] + s[None, :]
    difference = np.abs(half * (np.cos(angles)[:, None] - np.cos(angles)[None, :]))
    np.fill_diagonal(difference, 1.0)  # of no effect: there the limit stands
    m1 = (difference / total) ** 2
    smooth = ellipkm1(m1) + ellipk(m1) / math.pi * np.log(m1)
    np.fill_diagonal(m1, 0.0)
    np.fill_diagonal(smooth, math.log(4.0))
    over_pi = ellipk(m1) / math.pi
    # ln m_1 = 2 ln|cos - cos'| + 2 ln(h / (r + s)), its first part by the series.
    k = np.arange(1, nodes)
    cosines = np.cos(np.outer(angles, k))
    logarithm = -math.log(2.0) - (cosines * (2.0 / k)) @ cosines.T
    kernel = smooth - 2.0 * over_pi * (logarithm + np.log(half / total))
    weight = math.pi / nodes
    density = np.linalg.solve(4.0 / math.pi * weight * kernel / total, np.ones(nodes))
    return float(math.pi * weight * density.sum())  # 2 pi times the integral of p s, over 2 E* R_o delta
