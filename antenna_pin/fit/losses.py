"""How much a residual counts: by its square, or less where it is large, as in SciPy's ``least_squares``."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.fit.plan import FitPlan

__all__ = ["cost_of", "weights_of"]

Array = NDArray[np.float64]


def cost_of(plan: FitPlan, residuals: Array) -> float:
    """Return half the sum of the losses of residuals, (m,) [-]."""
    z = (residuals / plan.loss_scale) ** 2
    losses: dict[str, Callable[[], Array]] = {
        "linear": lambda: z,
        "soft_l1": lambda: 2.0 * (np.sqrt(1.0 + z) - 1.0),
        "huber": lambda: np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0),
        "cauchy": lambda: np.log1p(z),
        "arctan": lambda: np.arctan(z),
    }
    return 0.5 * plan.loss_scale**2 * float(np.sum(losses[plan.loss]()))


def weights_of(plan: FitPlan, residuals: Array) -> Array:
    """Return the weight of each residual, (m,) [-]: the derivative of its loss by its square."""
    z = (residuals / plan.loss_scale) ** 2
    weights: dict[str, Callable[[], Array]] = {
        "linear": lambda: np.ones_like(z),
        "soft_l1": lambda: 1.0 / np.sqrt(1.0 + z),
        "huber": lambda: 1.0 / np.sqrt(np.maximum(z, 1.0)),
        "cauchy": lambda: 1.0 / (1.0 + z),
        "arctan": lambda: 1.0 / (1.0 + z**2),
    }
    return np.asarray(weights[plan.loss]())
