"""The dynamics of a tree by Pinocchio, as functions that compiled code asks (:mod:`outside_kernels`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

__all__ = ["accelerations_of", "terms_of"]

Array = NDArray[np.float64]
Answer = Callable[[float], None]


def accelerations_of(model: Any, data: Any, y: Array, effort: Array, out: Array) -> Answer:
    """Return what writes the acceleration at a state under a generalized force, all in arrays, (nv,)."""
    q, v, aba = y[: model.nq], y[model.nq : model.nq + model.nv], pin.aba

    def answer(t: float) -> None:
        out[:] = aba(model, data, q, v, effort)

    return answer


def terms_of(model: Any, data: Any, y: Array, mass: Array, bias: Array) -> Answer:
    """Return what writes mass matrix, (nv, nv), and bias, (nv,), at a state in an array."""
    q, v = y[: model.nq], y[model.nq : model.nq + model.nv]
    mass_of, bias_of = pin.crba, pin.nonLinearEffects

    def answer(t: float) -> None:
        mass[:] = mass_of(model, data, q)
        bias[:] = bias_of(model, data, q, v)

    return answer
