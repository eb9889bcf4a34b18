"""Dynamics of a tree by Pinocchio, as callbacks of compiled code (:mod:`outside_kernels`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

__all__ = ["accelerations_of", "terms_of"]

Array = NDArray[np.float64]
Answer = Callable[[float], None]


def accelerations_of(model: Any, data: Any, y: Array, effort: Array) -> tuple[Answer, Array]:
    """Return a function for forward dynamics, and its array of accelerations, (nv,).

    That is Pinocchio's own array: what ``pin.aba`` returns would be a copy of it, and cost a tenth more. The
    answer has to be kept as long as the array is read.
    """
    q, v, aba = y[: model.nq], y[model.nq : model.nq + model.nv], pin.aba

    def answer(t: float) -> None:
        aba(model, data, q, v, effort)

    return answer, data.ddq


def terms_of(model: Any, data: Any, y: Array, mass: Array, bias: Array) -> Answer:
    """Return a function that writes mass matrix, (nv, nv), and bias, (nv,)."""
    q, v = y[: model.nq], y[model.nq : model.nq + model.nv]
    mass_of, bias_of = pin.crba, pin.nonLinearEffects

    def answer(t: float) -> None:
        mass[:] = mass_of(model, data, q)
        bias[:] = bias_of(model, data, q, v)

    return answer
