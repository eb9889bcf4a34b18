"""Dynamics of a tree by Pinocchio, as callbacks of compiled code (:mod:`outside_kernels`).

With the shim to Pinocchio's machine code (:mod:`antenna_pin.compiled.native`) compiled code calls it by
address; otherwise Pinocchio is called in Python. Results are the same to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.compiled.native import Evaluator, native_shim

Array = NDArray[np.float64]
Answer = Callable[[float], None]


def accelerations_of(model: Any, data: Any, y: Array, effort: Array) -> tuple[Answer, Array]:
    """Return a function for forward dynamics, and its array of accelerations, (nv,).

    The array is Pinocchio's own: the return value of ``pin.aba`` would be a copy, at a tenth more time. The
    function must be referenced as long as the array is read.
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


def machine_code_of(
    model: Any, y: Array, effort: Array, acceleration: Array, mass: Array, bias: Array
) -> tuple[Evaluator, int, int] | None:
    """Return the evaluator of a tree in machine code, and its functions' addresses.

    None without a shim, or if it does not give Pinocchio's acceleration of a first state to the last bit,
    for example with another library than that of the bindings.

    Args:
        model: Pinocchio's model.
        y: State [q, v, x] that is read.
        effort: Generalized force that is read, (nv,).
        acceleration: Written, (nv,).
        mass: Mass matrix, (nv, nv), written.
        bias: Bias forces, (nv,), written.
    """
    shim = native_shim()
    tree = None if shim is None else shim.tree(model, y, effort, acceleration, mass, bias)
    if shim is None or tree is None:
        return None
    nq, nv = model.nq, model.nv
    way = np.sin(np.arange(1.0, nv + 1.0))  # without zeros, so that all terms count
    y[:nq], y[nq : nq + nv], effort[:] = pin.integrate(model, pin.neutral(model), way), way[::-1], 1.0
    expected = pin.aba(model, model.createData(), y[:nq], y[nq : nq + nv], effort)
    failed = shim.evaluate(shim.acceleration, tree)
    y[:], effort[:] = 0.0, 0.0
    same = not failed and acceleration.tobytes() == expected.tobytes()
    return (tree, shim.acceleration, shim.terms) if same else None
