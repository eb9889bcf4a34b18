"""Hertz's point contact of a ball in a groove."""

from __future__ import annotations

import math

from antenna_pin.base.roots import root_between

__all__ = ["groove_contact", "in_series", "point_stiffness"]

# Axis ratio up to which the ellipse of contact is looked for: far beyond grooves as tight as balls.
_LONGEST = 1e8


def groove_contact(diameter: float, conformity: float, gamma: float, softness: float) -> float:
    """Return K of Q = K delta^1.5, of a ball on a raceway [N/m^1.5].

    Args:
        diameter: Of the ball [m].
        conformity: Radius of the groove over the ball's diameter, above 0.5 [-].
        gamma: D cos(contact angle) / d_m of an inner raceway, the opposite of an outer one [-].
        softness: Sum of (1 - nu^2) / E of both bodies [1/Pa].

    References:
        Harris and Kotzalas, Rolling Bearing Analysis, chapters 2 and 6: curvatures of raceways.
    """
    along = 2.0 / diameter * (1.0 + gamma / (1.0 - gamma))
    across = 2.0 / diameter - 1.0 / (conformity * diameter)
    return point_stiffness(along, across, softness)


def point_stiffness(first: float, second: float, softness: float) -> float:
    r"""Return K of Q = K delta^1.5 for two bodies with principal curvatures in the same planes [N/m^1.5].

    The axis ratio kappa = a / b of the ellipse of contact follows from

    .. math:: \frac{|\rho_1 - \rho_2|}{\rho_1 + \rho_2} =
              \frac{(\kappa^2 + 1) E - 2 K}{(\kappa^2 - 1) E}, \qquad m = 1 - \kappa^{-2}

    with complete elliptic integrals K(m) and E(m), and then

    .. math:: \delta = \frac{2 K}{\pi} \left(\frac{\pi}{2 \kappa^2 E}\right)^{1/3}
              \left(\frac{3 Q \eta}{2 \Sigma\rho}\right)^{2/3} \frac{\Sigma\rho}{2}.

    Args:
        first: Sum of both bodies' curvatures in one plane, positive [1/m].
        second: In the other, positive [1/m].
        softness: eta, sum of (1 - nu^2) / E of both [1/Pa].
    """
    from scipy.special import ellipe, ellipkm1

    total, uneven = first + second, abs(first - second) / (first + second)
    ratio = 1.0
    if uneven > 1e-9:

        def lack(log: float) -> float:
            square = math.exp(2.0 * log)
            whole = ellipe(1.0 - 1.0 / square)
            return (
                float(((square + 1.0) * whole - 2.0 * ellipkm1(1.0 / square)) / ((square - 1.0) * whole))
                - uneven
            )

        ratio = math.exp(root_between(lack, 1e-6, math.log(_LONGEST), absolute=1e-15))
    first_kind, second_kind = float(ellipkm1(ratio**-2)), float(ellipe(1.0 - ratio**-2))
    depth = 2.0 * first_kind / math.pi * (math.pi / (2.0 * ratio**2 * second_kind)) ** (1.0 / 3.0)
    depth *= (1.5 * softness / total) ** (2.0 / 3.0) * 0.5 * total
    return float(depth**-1.5)


def in_series(first: float, second: float) -> float:
    """Return K of two contacts under the same load [N/m^1.5]."""
    return float((first ** (-2.0 / 3.0) + second ** (-2.0 / 3.0)) ** -1.5)
