r"""Losses of weighted residuals, and what a few of them far out do to how sure a fit is.

A fit makes :math:`\tfrac12 \sum_i s^2 \rho(r_i^2 / s^2)` small, with the scale s at which a residual begins
to count less. Its slope in a residual is :math:`\psi(r) = \rho'(z)\, r` with :math:`z = r^2 / s^2`, and its
curvature :math:`\psi'(r) = \rho'(z) + 2 z \rho''(z)`.

References:
    Huber (1981), Robust Statistics, sections 7.5 and 7.6.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import InvalidParameterError, UnknownNameError

__all__ = ["LOSSES", "Loss", "cost", "curvature", "influence"]

Array = NDArray[np.float64]

Loss = Literal["linear", "soft_l1", "huber", "cauchy", "arctan"]
"""What scipy.optimize.least_squares calls them."""

LOSSES: tuple[Loss, ...] = get_args(Loss)


def _terms(residuals: Array, loss: Loss, scale: float) -> tuple[Array, Array, Array, Array]:
    """Return z, and rho with its two derivatives there, (m,) each."""
    if loss not in LOSSES:
        raise UnknownNameError("fit", "loss", loss, LOSSES)
    if not scale > 0.0:
        raise InvalidParameterError("fit", "loss_scale", "positive [-]", scale)
    z = (residuals / scale) ** 2
    one = np.ones_like(z)
    if loss == "linear":
        return z, z, one, 0.0 * z
    if loss == "soft_l1":
        root = np.sqrt(1.0 + z)
        return z, 2.0 * (root - 1.0), 1.0 / root, -0.5 / root**3
    if loss == "huber":
        far = z > 1.0
        size = np.sqrt(np.where(far, z, 1.0))
        return z, np.where(far, 2.0 * size - 1.0, z), 1.0 / size, np.where(far, -0.5 / size**3, 0.0)
    if loss == "cauchy":
        return z, np.log1p(z), 1.0 / (1.0 + z), -1.0 / (1.0 + z) ** 2
    return z, np.arctan(z), 1.0 / (1.0 + z**2), -2.0 * z / (1.0 + z**2) ** 2


def cost(residuals: Array, loss: Loss = "linear", scale: float = 1.0) -> float:
    """Return twice what the fit makes small: of the linear loss the sum of squares [-]."""
    _, rho, _, _ = _terms(residuals, loss, scale)
    return float(scale**2 * rho.sum())


def influence(residuals: Array, loss: Loss = "linear", scale: float = 1.0) -> Array:
    """Return the slope psi of the loss in each residual, (m,) [-]; the residual itself of the linear one."""
    _, _, slope, _ = _terms(residuals, loss, scale)
    return np.asarray(slope * residuals)


def curvature(residuals: Array, loss: Loss = "linear", scale: float = 1.0) -> Array:
    """Return the curvature psi' of the loss in each residual, (m,) [-]; 1 of the linear one.

    That of ``cauchy`` and ``arctan`` is negative far out.
    """
    z, _, slope, bend = _terms(residuals, loss, scale)
    return np.asarray(slope + 2.0 * z * bend)
