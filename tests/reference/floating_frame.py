"""A cantilever that turns with its hub, by the floating frame of reference with assumed modes: written anew.

In the frame of the hub, at whose axis the beam is clamped, the transverse deflection in the plane of the turn
is w(x, t) = sum phi_i(x) eta_i(t), with the beam's own modes, of unit modal mass, along x from 0 to L. With
the spin Omega and its rate alpha, to first order in the deflection (Kane, Ryan and Banerjee 1987, J. Guidance
10(2), 139-151)

    eta'' + [diag(omega^2) + Omega^2 (G - 1)] eta = -delta alpha,
    delta_i = int rho x phi_i dx,    G_ij = int rho/2 (L^2 - x^2) phi_i' phi_j' dx,

G by the tension that holds the outer parts of the beam on their circle. Without it the beam softens with spin
as a mass on a spring does; no code of the package is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cantilever:
    """A uniform beam by its first modes.

    Attributes:
        omega: Of each mode with the root held [rad/s].
        translation: Participation of the root's acceleration across, int rho phi dx [sqrt(kg)].
        rotation: Of its angular acceleration, int rho x phi dx [sqrt(kg) m].
        stiffening: G, (n, n) [-].
    """

    omega: Array
    translation: Array
    rotation: Array
    stiffening: Array


def cantilever(mass: float, length: float, first: float, modes: int) -> Cantilever:
    """Return a beam of a mass [kg] and length [m] whose first mode has a frequency [rad/s]."""
    roots = np.array(
        [brentq(_characteristic, (k + 0.5) * np.pi - 0.5, (k + 0.5) * np.pi + 0.5) for k in range(modes)]
    )
    # Gauss-Legendre over the length: exact to round-off for these shapes.
    nodes, weights = np.polynomial.legendre.leggauss(80)
    s, ds = 0.5 * (nodes + 1.0), 0.5 * weights
    shape, slope = np.array([_shape(b, s) for b in roots]).transpose(1, 0, 2)
    norm = np.sqrt((shape**2 * ds).sum(axis=1) * mass)
    shape, slope = shape / norm[:, None], slope / norm[:, None]
    return Cantilever(
        omega=first * (roots / roots[0]) ** 2,
        translation=mass * (shape * ds).sum(axis=1),
        rotation=mass * length * (shape * s * ds).sum(axis=1),
        stiffening=mass * 0.5 * np.einsum("is,js,s->ij", slope, slope, (1.0 - s**2) * ds),
    )


def _characteristic(b: float) -> float:
    return float(np.cos(b) + 1.0 / np.cosh(b))


def _shape(b: float, s: Array) -> tuple[Array, Array]:
    """Return a mode of beta L = b over x / L, and its derivative."""
    ratio = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    value = np.cosh(b * s) - np.cos(b * s) - ratio * (np.sinh(b * s) - np.sin(b * s))
    return value, b * (np.sinh(b * s) + np.sin(b * s) - ratio * (np.cosh(b * s) - np.cos(b * s)))


def deflections(
    beam: Cantilever,
    spin: Callable[[float], float],
    rate: Callable[[float], float],
    times: Array,
    stiffened: bool,
) -> Array:
    """Return the modal coordinates over time, from rest, (times, n) [sqrt(kg) m]."""
    n = len(beam.omega)
    g = beam.stiffening if stiffened else np.zeros((n, n))

    def motion(t: float, y: Array) -> Array:
        stiffness = np.diag(beam.omega**2) + spin(t) ** 2 * (g - np.eye(n))
        return np.concatenate([y[n:], -stiffness @ y[:n] - beam.rotation * rate(t)])

    found = solve_ivp(
        motion, (times[0], times[-1]), np.zeros(2 * n), "DOP853", t_eval=times, rtol=1e-12, atol=1e-14
    )
    return np.asarray(found.y[:n].T)


def frequencies(beam: Cantilever, spin: float, stiffened: bool) -> Array:
    """Return the squares of the frequencies at a steady spin, in rising order [rad^2/s^2]."""
    n = len(beam.omega)
    g = beam.stiffening if stiffened else np.zeros((n, n))
    return np.linalg.eigvalsh(np.diag(beam.omega**2) + spin**2 * (g - np.eye(n)))
