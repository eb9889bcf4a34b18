r"""Pressure, width and shear of elastic contacts: Hertz's lines and points, Persson's conformal line.

Numbers in, numbers out, for scalars and arrays of forces alike. A contact law of a joint says how force
follows from depth; here pressure follows from force and geometry, so a fitted stiffness plays no part.

With :math:`1/E^* = (1 - \nu_1^2)/E_1 + (1 - \nu_2^2)/E_2` and, of a journal in a bore,
:math:`1/R^* = 1/R_j - 1/R_i`:

- line: :math:`p_0 = \sqrt{f E^* / (\pi R^*)}`, :math:`a = 2 f / (\pi p_0)`, f the force per length;
- point: :math:`p_0 = 3 F / (2 \pi a b)` over the ellipse of half-axes a and b;
- conformal line (Persson): :math:`f` and :math:`p_0` over the half-angle of the arc.

The greatest shear stress lies below the middle of the contact, on the axis: its size and depth are exact for
Hertz's contacts, at :math:`0.300\, p_0` and :math:`0.786\, a` below a line.

References:
    Johnson (1985), Contact Mechanics, chapters 3 to 5; Persson (1964), dissertation, Chalmers; Ciavarella and
    Decuzzi (2001), Int. J. Solids Struct. 38, 4507-4523 and 4525-4533.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.rules import NumberRule, PositiveOrInfinite
from antenna_pin.contact.cylinder import LARGEST_SQUARE
from antenna_pin.errors import InvalidParameterError

Array = NDArray[np.float64]


class LinePressure(NamedTuple):
    """Stress of a contact along a line."""

    pressure: Array  # p_0, in the middle [Pa]
    half_width: Array  # of the contact, along the arc [m]
    half_angle: Array  # of the arc, seen from the bore's centre [rad]
    shear: Array  # greatest shear stress [Pa]
    shear_depth: Array  # of the greatest shear below the surface [m]


class PointPressure(NamedTuple):
    """Stress of a contact at a point, over an ellipse."""

    pressure: Array  # p_0, in the middle [Pa]
    half_length: Array  # longer half-axis [m]
    half_width: Array  # shorter half-axis [m]
    shear: Array  # greatest shear stress on the axis below the middle [Pa]
    shear_depth: Array  # of the greatest shear below the surface [m]


# --- Hertz's line -------------------------------------------------------------------------------------------

# Below the middle of a line contact tau / p0 = z (1 - z / sqrt(1 + z^2)) over the depth z / a: greatest where
# z^2 = (sqrt 5 - 1) / 2.
_LINE_DEPTH = math.sqrt(0.5 * (math.sqrt(5.0) - 1.0))
_LINE_SHEAR = _LINE_DEPTH * (1.0 - _LINE_DEPTH / math.sqrt(1.0 + _LINE_DEPTH**2))


@takes()
def line_shear() -> tuple[float, float]:
    """Return greatest shear over the pressure, and its depth over the half-width [-]: 0.300, 0.786."""
    return _LINE_SHEAR, _LINE_DEPTH


@takes(load="N/m", curvature="1/m", modulus="Pa")
def hertz_line(load: ArrayLike, curvature: PositiveOrInfinite, modulus: PositiveOrInfinite) -> LinePressure:
    """Return pressure and width of Hertz's contact along a line.

    Args:
        load: f, force per length, zero or more [N/m].
        curvature: 1/R*, sum of both bodies' curvatures, a bore's negative [1/m].
        modulus: E* [Pa].

    Returns:
        With ``half_angle`` zero: a line has no arc.
    """
    f = _loads("hertz_line", load)
    pressure = np.sqrt(f * modulus * curvature / math.pi)
    half = 2.0 * np.sqrt(f / (math.pi * modulus * curvature))
    return LinePressure(pressure, half, np.zeros_like(f), _LINE_SHEAR * pressure, _LINE_DEPTH * half)


# --- Persson's conformal line -------------------------------------------------------------------------------
#
# A disc of radius R_j in a hole of radius R_i of an infinite plate, without friction, of one material. With
# b = tan(half_angle / 2) and y = tan(phi / 2)
#
#   2 E* dR / f = [2 - ln(1 + b^2) - 2 b^4] / [pi b^2 (1 + b^2)]
#   p(phi) R / f = 2 sqrt(b^2 - y^2) / (pi sqrt(1 + b^2) (1 + y^2))
#                  + ln[(sqrt(1 + b^2) + sqrt(b^2 - y^2)) / (sqrt(1 + b^2) - sqrt(b^2 - y^2))]
#                    / (2 pi b^2 (1 + b^2))
#
# R is the radius of the hole or of the disc, which differ by the play that the theory takes as small.


#: Half-angle of the arc of contact under an infinite load, or without play [rad]: 84.5 deg.
LARGEST_HALF_ANGLE = 2.0 * math.atan(math.sqrt(LARGEST_SQUARE))


@takes(half_angle="rad")
def persson_load(half_angle: ArrayLike) -> Array:
    r"""Return the scaled load f / (E* dR) of a conformal contact [-].

    .. math:: \frac{2 E^* \Delta R}{f} = \frac{2 - \ln(1 + b^2) - 2 b^4}{\pi b^2 (1 + b^2)}, \qquad
              b = \tan\frac{\varepsilon}{2}

    Args:
        half_angle: epsilon, from zero to below 84.5 deg [rad].
    """
    angle = np.asarray(half_angle, dtype=float)
    if not np.all((angle >= 0.0) & (angle < LARGEST_HALF_ANGLE)):
        rule = f"in [0, {LARGEST_HALF_ANGLE:.4f}) rad, where the load is infinite"
        raise InvalidParameterError("persson_load", "half_angle", rule, half_angle)
    square = np.tan(0.5 * angle) ** 2
    found: Array = 2.0 * math.pi * square * (1.0 + square) / (2.0 - np.log1p(square) - 2.0 * square**2)
    return found


@takes(half_angle="rad", angle="rad")
def persson_pressure(half_angle: ArrayLike, angle: ArrayLike = 0.0) -> Array:
    r"""Return the scaled pressure p R / f of a conformal contact [-].

    .. math:: \frac{p R}{f} = \frac{2}{\pi} \frac{\sqrt{b^2 - y^2}}{\sqrt{1 + b^2}\, (1 + y^2)} +
              \frac{1}{2 \pi b^2 (1 + b^2)}
              \ln\frac{\sqrt{1 + b^2} + \sqrt{b^2 - y^2}}{\sqrt{1 + b^2} - \sqrt{b^2 - y^2}}

    with :math:`b = \tan(\varepsilon / 2)` and :math:`y = \tan(\varphi / 2)`. For a small arc it is Hertz's
    ellipse, :math:`2 / (\pi \varepsilon)` in the middle; of a rigid pin it would be :math:`p \propto
    \cos\varphi`.

    Args:
        half_angle: epsilon, above zero and up to 84.5 deg [rad].
        angle: phi, from the middle of the arc, at most epsilon in size [rad].
    """
    edge, place = np.broadcast_arrays(np.asarray(half_angle, dtype=float), np.asarray(angle, dtype=float))
    if not np.all((edge > 0.0) & (edge <= LARGEST_HALF_ANGLE * (1.0 + 1e-12))):
        rule = f"above 0 and up to {LARGEST_HALF_ANGLE:.4f} rad"
        raise InvalidParameterError("persson_pressure", "half_angle", rule, half_angle)
    if not np.all(np.abs(place) <= edge):
        raise InvalidParameterError("persson_pressure", "angle", "within the arc of contact", angle)
    b2, y2 = np.tan(0.5 * edge) ** 2, np.tan(0.5 * place) ** 2
    root = np.sqrt(np.maximum(b2 - y2, 0.0) / (1.0 + b2))
    found: Array = 2.0 / math.pi * root / (1.0 + y2) + np.arctanh(root) / (math.pi * b2 * (1.0 + b2))
    return found


@takes(load="N/m", radius="m", clearance="m", modulus="Pa")
def persson_line(
    load: ArrayLike, radius: PositiveOrInfinite, clearance: PositiveOrInfinite, modulus: PositiveOrInfinite
) -> LinePressure:
    """Return pressure and arc of a journal in a bore with little play.

    The arc follows from the load by a bracketed root of :func:`persson_load`. For a small load it is Hertz's
    line, with R = sqrt(R_i R_j) exactly; as the arc widens the pressure is above Hertz's, by a third at a
    half-angle of 46 deg, and under an ever larger load the arc tends to 169 deg and the pressure to 0.60 f /
    R. Exact for one material, without friction, in a bearing that is thick against its radius and with play
    that is small; for two materials an approximation.

    The greatest shear is that of Hertz's line of the same pressure and half-width (approximate: the surface
    is curved).

    Args:
        load: f, force per length, zero or more [N/m].
        radius: R of bearing or journal, or their geometric mean [m].
        clearance: R_i - R_j, positive [m].
        modulus: E* [Pa].
    """
    f = _loads("persson_line", load)
    scaled = f / (modulus * clearance)
    square = _persson_square(scaled)
    edge = 2.0 * np.arctan(np.sqrt(square))
    with np.errstate(invalid="ignore", divide="ignore"):
        pressure = np.where(f > 0.0, f / radius * persson_pressure(np.maximum(edge, 1e-12)), 0.0)
    half = radius * edge
    return LinePressure(pressure, half, edge, _LINE_SHEAR * pressure, _LINE_DEPTH * half)


def _persson_square(load: Array) -> Array:
    """Return b^2 under loads f / (E* dR), by safeguarded Newton steps."""
    # g(s) = load * (2 - ln(1 + s) - 2 s^2) - 2 pi s (1 + s) falls from 2 load to below zero at the largest s.
    low, high = np.zeros_like(load), np.full_like(load, LARGEST_SQUARE)
    s = np.minimum(load / math.pi, 0.5 * LARGEST_SQUARE)
    for _ in range(80):
        value = load * (2.0 - np.log1p(s) - 2.0 * s * s) - 2.0 * math.pi * s * (1.0 + s)
        slope = -load * (1.0 / (1.0 + s) + 4.0 * s) - 2.0 * math.pi * (1.0 + 2.0 * s)
        low, high = np.where(value >= 0.0, s, low), np.where(value < 0.0, s, high)
        step = s - value / slope
        after = np.where((step > low) & (step < high), step, 0.5 * (low + high))
        done = bool(np.all(np.abs(after - s) <= 1e-16 + 4e-16 * s))
        s = after
        if done:
            break
    found: Array = np.where(load > 0.0, s, 0.0)
    return found


# --- Hertz's point ------------------------------------------------------------------------------------------


class Ellipse(NamedTuple):
    """Ellipse of contact of two bodies under a load of 1 N."""

    half_length: float  # longer half-axis [m/N^(1/3)]
    half_width: float  # shorter half-axis [m/N^(1/3)]


@takes(along="1/m", across="1/m", modulus="Pa")
def hertz_ellipse(
    along: PositiveOrInfinite, across: PositiveOrInfinite, modulus: PositiveOrInfinite
) -> Ellipse:
    r"""Return the ellipse of contact under a force of 1 N.

    With the sum of curvatures :math:`\Sigma = A + B` in the two planes and the axis ratio kappa from
    :math:`|A - B| / \Sigma = [(\kappa^2 + 1) E - 2 K] / [(\kappa^2 - 1) E]`,
    :math:`a^3 = 3 \kappa^2 E F / (\pi E^* \Sigma)`, :math:`b = a / \kappa`, E and K the complete elliptic
    integrals of :math:`m = 1 - \kappa^{-2}`.

    Args:
        along: Sum of both bodies' curvatures in one principal plane, positive [1/m].
        across: In the other, positive [1/m].
        modulus: E* [Pa].
    """
    kappa, second_kind = _axis_ratio(abs(along - across) / (along + across))
    long = (3.0 * kappa**2 * second_kind / (math.pi * modulus * (along + across))) ** (1.0 / 3.0)
    return Ellipse(long, long / kappa)


@lru_cache(maxsize=256)
def _axis_ratio(uneven: float) -> tuple[float, float]:
    """Return the axis ratio of an ellipse of contact, and the elliptic integral E."""
    from scipy.special import ellipe, ellipkm1

    from antenna_pin.base.calculus import root_between

    if uneven < 1e-9:
        return 1.0, 0.5 * math.pi

    def lack(log: float) -> float:
        square = math.exp(2.0 * log)
        whole = float(ellipe(1.0 - 1.0 / square))
        return ((square + 1.0) * whole - 2.0 * float(ellipkm1(1.0 / square))) / (
            (square - 1.0) * whole
        ) - uneven

    farthest = math.log(1e8)
    if lack(farthest) < 0.0:
        raise InvalidParameterError(
            "hertz_ellipse", "along", "no flatter than a hundred millionth of a line", said="a line"
        )
    ratio = math.exp(root_between(lack, 1e-6, farthest, absolute=1e-15))
    return ratio, float(ellipe(1.0 - ratio**-2))


@takes(force="N", along="1/m", across="1/m", modulus="Pa")
def hertz_point(
    force: ArrayLike, along: float, across: float, modulus: float, poisson: float = 0.3
) -> PointPressure:
    """Return pressure and axes of Hertz's contact at a point.

    Args:
        force: F, zero or more [N].
        along: Sum of both bodies' curvatures in one principal plane, positive; a hollow's negative [1/m].
        across: In the other, positive [1/m].
        modulus: E* [Pa].
        poisson: Poisson's ratio of the body in which the shear is taken [-].
    """
    ellipse = hertz_ellipse(along, across, modulus)
    f = _loads("hertz_point", force)
    cube = np.cbrt(f)
    pressure = 1.5 * cube / (math.pi * ellipse.half_length * ellipse.half_width)
    share, depth = point_shear(ellipse.half_width / ellipse.half_length, poisson)
    long, short = ellipse.half_length * cube, ellipse.half_width * cube
    return PointPressure(pressure, long, short, share * pressure, depth * short)


@takes()
def point_shear(
    ratio: Annotated[float, NumberRule("above 0 and at most 1")],
    poisson: Annotated[float, NumberRule("above -1 and at most 0.5")] = 0.3,
) -> tuple[float, float]:
    """Return greatest shear over the pressure, and its depth over the shorter half-axis [-].

    On the axis below the middle of the contact: 0.310 and 0.48 under a circle for a Poisson's ratio of 0.3,
    0.300 and 0.786 under a line.

    Args:
        ratio: Shorter over longer half-axis, in (0, 1] [-].
        poisson: Poisson's ratio [-].

    References:
        Johnson (1985), Contact Mechanics, equations (3.45) and (3.64) to (3.70), table 4.1.
    """
    return _point_shear(float(ratio), float(poisson))


@lru_cache(maxsize=256)
def _point_shear(ratio: float, poisson: float) -> tuple[float, float]:
    """Return the greatest shear on the axis by a bounded search over the depth."""
    from scipy.optimize import minimize_scalar

    def less(depth: float) -> float:
        stresses = sorted(_axis_stresses(depth, ratio, poisson))
        return -0.5 * (stresses[2] - stresses[0])

    found = minimize_scalar(less, bounds=(1e-3, 3.0), method="bounded", options={"xatol": 1e-9})
    return float(-found.fun), float(found.x)


def _axis_stresses(depth: float, ratio: float, poisson: float) -> tuple[float, float, float]:
    """Return the principal stresses over p0 on the axis at a depth."""
    from scipy.special import ellipeinc, ellipkinc

    if ratio > 1.0 - 1e-6:  # a circle, (3.45)
        along = -1.0 / (1.0 + depth**2)
        around = -(1.0 + poisson) * (1.0 - depth * math.atan2(1.0, depth)) - 0.5 * along
        return around, around, along
    zeta = depth * ratio  # z / a
    square = 1.0 - ratio**2  # e^2
    t = math.sqrt((ratio**2 + zeta**2) / (1.0 + zeta**2))
    phi = math.atan2(1.0, zeta)  # cot phi = z / a
    first, second = float(ellipkinc(phi, square)), float(ellipeinc(phi, square))
    x = -0.5 * (1.0 - t) + zeta * (first - second)
    x_poisson = 1.0 - t / ratio**2 + zeta * (second / ratio**2 - first)
    y = 0.5 + 0.5 / t - t / ratio**2 + zeta * (second / ratio**2 - first)
    y_poisson = -1.0 + t + zeta * (first - second)
    scale = 2.0 * ratio / square
    z = -0.5 * scale * (1.0 - t * t) / t
    return scale * (x + poisson * x_poisson), scale * (y + poisson * y_poisson), z


# --- checks -------------------------------------------------------------------------------------------------


def _loads(place: str, load: ArrayLike) -> Array:
    """Return loads as an array, or refuse a negative one; NaN stays."""
    found = np.asarray(load, dtype=float)
    if np.any(found < 0.0):
        raise InvalidParameterError(place, "load", "zero or more", float(np.nanmin(found)))
    return found


# --- balls in raceways --------------------------------------------------------------------------------------


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
