r"""Pressure of a ball in a socket of nearly its radius: the conformal point contact.

A ball of radius R is pressed without friction into a spherical hollow of an infinite body, by a force through
its centre. Pressure :math:`p = \sum p_n P_n(\cos\theta)` moves both surfaces along their normals by
:math:`w = \sum s_n p_n P_n`, and within the half-angle :math:`\varepsilon` of the contact

.. math:: w(\theta) = e \cos\theta - \Delta R, \qquad p(\varepsilon) = 0

with the play :math:`\Delta R` and the ball's eccentricity e. The compliances :math:`s_n` of ball and hollow
are those of Lur'e's solutions of the elastic sphere; the term n = 1 is a shift of the ball and so part of e.
For large n they are :math:`2 R / (E^* n)`, a half-space's: the kernel of that part is
:math:`1 / |x - x'|` over the chords of the sphere, which a stereographic projection makes that of the flat
disc, known in closed form for :math:`(1 - \rho^2 / a^2)^{j - 1/2}`. The rest is smooth and summed.

References:
    Lur'e (1964), Three-Dimensional Problems of the Theory of Elasticity, chapter 6; Goodman and Keer (1965),
    Int. J. Solids Struct. 1, 407-415, for the problem. Derived here.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.material import Material
from antenna_pin.base.rules import PositiveOrInfinite
from antenna_pin.contact.pressure import PointPressure, point_shear
from antenna_pin.errors import InvalidParameterError

Array = NDArray[np.float64]

# Terms of the smooth rest of the kernel, functions of the pressure, nodes of their integrals, and places at
# which the surfaces meet.
_TERMS, _FUNCTIONS, _NODES, _PLACES = 250, 10, 160, 40
#: Widest half-angle of a contact that is computed [rad]: 80 deg.
WIDEST_CAP = math.radians(80.0)
_ANGLES = 28  # of the table over the half-angle


class SocketContact(NamedTuple):
    """Contact of a ball in a socket over a cap, in scaled numbers."""

    load: float  # F / (E* R dR) [-]
    pressure: float  # p_0 R / (E* dR), in the middle [-]
    eccentricity: float  # e / dR [-]


@takes(half_angle="rad")
def socket_contact(
    half_angle: float, ball: tuple[float, float], socket: tuple[float, float]
) -> SocketContact:
    """Return load and pressure of a ball in a socket at a half-angle.

    Args:
        half_angle: epsilon, above 0 and up to 80 deg [rad].
        ball: Young's modulus [Pa] and Poisson's ratio of the ball [-].
        socket: Likewise of the socket.
    """
    if not 0.0 < half_angle <= WIDEST_CAP * (1.0 + 1e-12):
        rule = f"above 0 and up to {WIDEST_CAP:.4f} rad"
        raise InvalidParameterError("socket_contact", "half_angle", rule, half_angle)
    return _solved(half_angle, ball, socket)


def _solved(edge: float, ball: tuple[float, float], socket: tuple[float, float]) -> SocketContact:
    from scipy.special import eval_legendre

    a = math.tan(0.5 * edge)
    # Places within the cap, by rho = tan(theta / 2); x = (rho / a)^2.
    x = 0.5 * (1.0 - np.cos(math.pi * (np.arange(_PLACES) + 0.5) / _PLACES))
    rho2 = a * a * x
    cosine = (1.0 - rho2) / (1.0 + rho2)
    flat = np.stack([_disc(j, x) for j in range(1, _FUNCTIONS + 1)], axis=1)
    columns = (2.0 * a / math.pi) * np.sqrt(1.0 + rho2)[:, None] * flat  # in units of R / E*
    # Coefficients p_n of each function, by Gauss-Jacobi in t = x with the root at the edge as weight.
    nodes, weights = _gauss_jacobi()
    t, dt = 0.5 * (1.0 + nodes), weights * 0.5**1.5
    inner = a * a * t
    n = np.arange(_TERMS)
    legendre = eval_legendre(n[:, None], ((1.0 - inner) / (1.0 + inner))[None, :])
    # sin(theta) dtheta = 2 a^2 dt / (1 + rho^2)^2; p = q (1 + rho^2)^1.5.
    measure = 2.0 * a * a * dt / np.sqrt(1.0 + inner)
    powers = np.stack([(1.0 - t) ** (j - 1) for j in range(1, _FUNCTIONS + 1)], axis=1)
    moments = (n + 0.5)[:, None] * (legendre * measure) @ powers
    columns += eval_legendre(n[None, :], cosine[:, None]) @ (_rest(ball, socket)[:, None] * moments)
    system = np.hstack([columns, -cosine[:, None]])
    solution = np.linalg.lstsq(system, -np.ones(_PLACES), rcond=None)[0]
    shares = solution[:-1]
    load = 2.0 * math.pi * float(((1.0 - inner) / (1.0 + inner) * measure) @ powers @ shares)
    return SocketContact(load, float(shares.sum()), float(solution[-1]))


@lru_cache(maxsize=1)
def _gauss_jacobi() -> tuple[Array, Array]:
    from scipy.special import roots_jacobi

    nodes, weights = roots_jacobi(_NODES, 0.5, 0.0)
    return nodes, weights


def _disc(power: int, x: Array) -> Array:
    """Return the potential of a pressure on a flat disc, over its radius."""
    half = power + 0.5
    front = math.pi * math.sqrt(math.pi) * math.gamma(half) / math.gamma(half + 0.5)
    term, total = np.ones_like(x), np.ones_like(x)
    for k in range(power):  # of the hypergeometric series F(1/2, -power; 1; x), which ends
        term = term * (0.5 + k) * (k - power) / (1.0 + k) ** 2 * x
        total = total + term
    return front * total


def _rest(ball: tuple[float, float], socket: tuple[float, float]) -> Array:
    """Return s_n less the half-space's 4 / (2 n + 1), over R / E*."""
    n = np.arange(_TERMS, dtype=float)
    modulus = 1.0 / sum((1.0 - nu * nu) / young for young, nu in (ball, socket))
    total = np.zeros(_TERMS)
    for (young, nu), inside in ((ball, True), (socket, False)):
        twice = young / (1.0 + nu)  # 2 G
        own = _of_ball(n, nu) if inside else _of_hollow(n, nu)
        total += modulus / twice * own
    found = total - 4.0 / (2.0 * n + 1.0)
    found[1] = 0.0 - 4.0 / 3.0  # the shift of the ball is in its eccentricity
    return found


def _of_ball(n: Array, nu: float) -> Array:
    """Return the inward displacement of a ball's surface, scaled by 2 G / R."""
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = n * (n * n + 2.0 * n - 1.0 + 2.0 * nu) / (n - 1.0) - (n + 1.0) * (n - 2.0 + 4.0 * nu)
    found: Array = bend / (2.0 * (n * n + n + 1.0) + 2.0 * nu * (2.0 * n + 1.0))
    found[0], found[1] = (1.0 - 2.0 * nu) / (1.0 + nu), 0.0
    return found


def _of_hollow(n: Array, nu: float) -> Array:
    """Return the outward displacement of a hollow's surface, scaled by 2 G / R."""
    bend = n * (n + 3.0 - 4.0 * nu) - (n + 1.0) * (n * n - 2.0 + 2.0 * nu) / (n + 2.0)
    found: Array = bend / (2.0 * (n * n + n + 1.0) - 2.0 * nu * (2.0 * n + 1.0))
    found[0], found[1] = 0.5, 0.0
    return found


@takes(force="N", radius="m", clearance="m")
def ball_in_socket(
    force: ArrayLike,
    radius: PositiveOrInfinite,
    clearance: PositiveOrInfinite,
    ball: Material,
    socket: Material,
) -> PointPressure:
    """Return pressure and width of a ball in a socket with little play.

    For a small load it is Hertz's point contact. The greatest shear is that of Hertz's circle of the same
    pressure and half-width (approximate: the surface is curved). NaN beyond a half-angle of 80 deg.

    Args:
        force: F, zero or more [N].
        radius: R of socket or ball, or their geometric mean [m].
        clearance: Socket's radius less the ball's, positive [m].
        ball: Material of the ball.
        socket: Material of the socket.
    """
    f = np.asarray(force, dtype=float)
    if np.any(f < 0.0):
        raise InvalidParameterError("ball_in_socket", "force", "zero or more", float(np.nanmin(f)))
    both = (ball.young, ball.poisson), (socket.young, socket.poisson)
    modulus = 1.0 / sum((1.0 - nu * nu) / young for young, nu in both)
    loads, angles, pressures = _table(*both)
    scaled = f / (modulus * radius * clearance)
    from scipy.interpolate import CubicSpline

    with np.errstate(divide="ignore"):
        log = np.log(scaled)
    edge = np.exp(CubicSpline(loads, angles)(np.maximum(log, loads[0])))
    unit = np.exp(CubicSpline(loads, pressures)(np.maximum(log, loads[0])))
    # Below the table Hertz's powers hold.
    small = np.cbrt(np.exp(np.minimum(log - loads[0], 0.0)))
    edge, unit = edge * small, unit * small
    beyond = log > loads[-1]
    edge, unit = (np.where(beyond, math.nan, np.where(f > 0.0, one, 0.0)) for one in (edge, unit))
    pressure = unit * modulus * clearance / radius
    half = radius * edge
    share, depth = point_shear(1.0, ball.poisson)
    return PointPressure(pressure, half, half, share * pressure, depth * half)


@lru_cache(maxsize=16)
def _table(ball: tuple[float, float], socket: tuple[float, float]) -> tuple[Array, Array, Array]:
    """Return logarithms of load, half-angle and pressure."""
    angles = np.geomspace(0.01, WIDEST_CAP, _ANGLES)
    found = [_solved(float(one), ball, socket) for one in angles]
    return (
        np.log([one.load for one in found]),
        np.log(angles),
        np.log([one.pressure for one in found]),
    )
