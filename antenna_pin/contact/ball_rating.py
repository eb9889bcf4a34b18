r"""Static rating of ball bearings by the stress that ISO 76 permits.

ISO 76 calls a static load permissible that presses the most heavily loaded ball with 4200 MPa in the middle
of its contact, which leaves a dent of about a ten-thousandth of the ball's diameter. The radial rating of Z
balls is :math:`C_{0r} = i Z \cos\alpha\, Q / 5`, with the load Q of a ball at that stress, the axial one
:math:`C_{0a} = Z \sin\alpha\, Q`; the table of f_0 in the standard is this formula for grooves of 0.52 and
0.53 of the ball's diameter.
"""

from __future__ import annotations

import math
from typing import Annotated

from antenna_pin.base.arguments import takes
from antenna_pin.base.rules import NumberRule
from antenna_pin.contact.pressure import Ellipse, hertz_ellipse

__all__ = ["ISO76_PRESSURE", "ball_load_limit", "raceway_ellipse", "static_rating"]

#: Pressure in the middle of a ball's contact that ISO 76 permits, but for self-aligning bearings [Pa].
ISO76_PRESSURE = 4.2e9


@takes(diameter="m", modulus="Pa")
def raceway_ellipse(
    diameter: float,
    conformity: Annotated[float, NumberRule("above 0.5", finite=False)],
    gamma: float,
    modulus: float,
) -> Ellipse:
    """Return the ellipse of contact of a ball and a raceway under 1 N.

    Args:
        diameter: D, of the ball [m].
        conformity: Radius of the groove over D, above 0.5 [-].
        gamma: D cos(contact angle) / pitch diameter of an inner raceway, the opposite of an outer one [-].
        modulus: E* of ball and ring [Pa].

    References:
        Harris and Kotzalas, Rolling Bearing Analysis, chapter 2.
    """
    along = 2.0 / diameter * (1.0 + gamma / (1.0 - gamma))
    across = 2.0 / diameter - 1.0 / (conformity * diameter)
    return hertz_ellipse(along, across, modulus)


@takes(pressure="Pa")
def ball_load_limit(ellipse: Ellipse, pressure: float = ISO76_PRESSURE) -> float:
    """Return the load of a ball at a given peak pressure [N].

    Args:
        ellipse: Of the contact under 1 N.
        pressure: That pressure [Pa].
    """
    return (pressure * math.pi * ellipse.half_length * ellipse.half_width / 1.5) ** 3


@takes(contact_angle="rad", limit="N")
def static_rating(count: int, contact_angle: float, limit: float, rows: int = 1) -> tuple[float, float]:
    """Return the radial and axial static ratings C_0r and C_0a [N].

    Args:
        count: Balls in a row.
        contact_angle: Nominal [rad].
        limit: Load of a ball at the permitted pressure, the less of both raceways [N].
        rows: That share a radial load.

    References:
        ISO 76:2006, definition of the rating; factor 5 for the largest load of a ball under a radial load.
    """
    return (
        rows * count * math.cos(contact_angle) * limit / 5.0,
        count * math.sin(contact_angle) * limit,
    )
