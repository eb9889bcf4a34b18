r"""What a hysteresis damping delivers, and the one that delivers a restitution exactly.

The relation :math:`\chi (1 + c) = \ln[(1 + \chi) / (1 - \chi c)]` of :mod:`antenna_pin.contact.hysteresis`,
solved to round-off in both directions.
"""

from __future__ import annotations

import math

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError

__all__ = ["delivered_restitution", "exact_hysteresis", "stored_share"]


def _excess(chi: float, restitution: float) -> float:
    """``[ln((1 + chi) / (1 - chi c)) - chi (1 + c)] / chi^2`` for chi up to 0.1, where its terms cancel."""
    total, size = 0.0, 1.0
    for k in range(2, 22):
        total += size * ((-1.0) ** (k + 1) + restitution**k) / k
        size *= chi
    return total


def stored_share(hysteresis: float) -> float:
    r"""Return what the spring stores at the largest depth over :math:`m v_0^2` [-], one half without damping.

    .. math:: \frac1\chi - \frac{\ln(1 + \chi)}{\chi^2}

    Args:
        hysteresis: chi, zero or more [-].
    """
    chi = hysteresis
    if chi < 0.05:  # the terms cancel
        return sum((-chi) ** k / (k + 2.0) for k in range(14))
    return 1.0 / chi - math.log1p(chi) / chi**2


@takes()
def delivered_restitution(hysteresis: float, *, approach_only: bool = False) -> float:
    r"""Return the restitution that a free impact delivers, from the factor :math:`\chi` [-].

    The root :math:`c` in (0, 1] of :math:`\chi (1 + c) = \ln[(1 + \chi) / (1 - \chi c)]`, to round-off; of a
    law that damps in the approach only, :math:`\sqrt{2 / \chi - 2 \ln(1 + \chi) / \chi^2}`.

    Args:
        hysteresis: chi, zero or more [-].
        approach_only: Whether the way back is elastic.
    """
    from scipy.optimize import brentq

    chi = hysteresis
    if not 0.0 <= chi < math.inf:
        raise InvalidParameterError("delivered_restitution", "hysteresis", "zero or more, and finite", chi)
    if approach_only:
        return math.sqrt(2.0 * stored_share(chi))
    if chi == 0.0:
        return 1.0
    if chi < 0.1:
        return float(brentq(lambda c: _excess(chi, c), 0.0, 1.0, xtol=1e-16, rtol=1e-15))

    # In s = -ln(1 - chi c), which stays well conditioned as c tends to 1 / chi.
    def excess(s: float) -> float:
        return math.log1p(chi) + s - chi + math.expm1(-s)

    s = float(brentq(excess, 0.0, chi + 1.0, xtol=1e-16, rtol=1e-15))
    return -math.expm1(-s) / chi


@takes()
def exact_hysteresis(restitution: float) -> float:
    r"""Return the factor :math:`\chi` that delivers a restitution exactly [-].

    The root of :math:`\chi (1 + c) = \ln[(1 + \chi) / (1 - \chi c)]` in (0+, 1/c); zero is always another.

    Args:
        restitution: c, in (0, 1] [-].
    """
    from scipy.optimize import brentq

    c = restitution
    if not 0.0 < c <= 1.0:
        raise InvalidParameterError("exact_hysteresis", "restitution", "in (0, 1]", c)
    if c == 1.0:
        return 0.0
    if _excess(0.1, c) > 0.0:
        return float(brentq(lambda chi: _excess(chi, c), 0.0, 0.1, xtol=1e-18, rtol=1e-15))

    # In s = -ln(1 - chi c): chi comes within exp(-1 / c) of 1 / c.
    def excess(s: float) -> float:
        chi = -math.expm1(-s) / c
        return math.log1p(chi) + s - chi * (1.0 + c)

    low = -math.log1p(-0.1 * c)
    s = float(brentq(excess, low, (1.0 + c) / c + 1.0, xtol=1e-16, rtol=1e-15))
    return -math.expm1(-s) / c
