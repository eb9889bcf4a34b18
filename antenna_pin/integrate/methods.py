"""Runge-Kutta methods as tables: stages, error estimate and dense output.

All are used with their last main stage at the end of the step (its derivative is the first stage of the
next step), so every method has a derivative at both ends and a dense output.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import UnknownNameError
from antenna_pin.integrate import _dop853

__all__ = ["METHODS", "Method", "method_named"]

Array = NDArray[np.float64]

# In a lasting contact a step of low order is as long as stability lets it. The error then grows by leaps: a
# control that answers each in full makes steps too long and too short by turns, every sixth of which is
# rejected. Named PI4.2 (Söderlind 2003; docs/performance.md, work and precision).
_STEADY = (0.4, 0.2)


@dataclass(frozen=True, slots=True, eq=False)
class Method:
    """A Runge-Kutta method with dense output.

    Attributes:
        name: As scenario files write it.
        order: p, of the solution carried on [-].
        error_order: Order of the solution that the error is estimated against; None for a fixed step.
        dense_order: Order of the dense output [-].
        weights: a_ij, (stages, stages); row ``last`` gives the end of the step.
        nodes: c_i, (stages,).
        last: Index of the main stages' last one, at the end of the step.
        errors: Weights of the error estimate, (1 or 2, stages); an implicit method has another, and zeros.
        polynomials: Dense output, (stages, degree): z(theta) - z(0) = h sum_jp b_jp theta^(p+1) k_j.
        control: Integral and proportional gain of the control of steps by their errors: a step follows its
            own error to the power -(sum of both), and the error before to the power of the second, over the
            order of the error. (1, 0) answers each error in full.
    """

    name: str
    order: int
    error_order: int | None
    dense_order: int
    weights: Array
    nodes: Array
    last: int
    errors: Array
    polynomials: Array
    control: tuple[float, float] = (1.0, 0.0)

    @property
    def implicit(self) -> bool:
        """Whether its stages depend on one another, so that equations are to be solved for them."""
        return bool(np.triu(self.weights).any())

    @property
    def adaptive(self) -> bool:
        """Whether the method estimates its error."""
        return self.error_order is not None

    @property
    def stages(self) -> int:
        """Number of stages, those that only the dense output needs included."""
        return int(self.weights.shape[0])


def _table(rows: list[list[float]]) -> Array:
    size = len(rows)
    table = np.zeros((size, size))
    for i, row in enumerate(rows):
        table[i, : len(row)] = row
    return table


def _hermite(weights: Array, last: int, stages: int) -> Array:
    """Cubic Hermite dense output from the derivatives at both ends, as weights of the stages."""
    change = np.array([0.0, 3.0, -2.0])
    out: Array = weights[last][:, None] * change
    out[0] += [1.0, -2.0, 1.0]
    out[last] += [0.0, -1.0, 1.0]
    assert out.shape == (stages, 3)
    return out


def _rk4() -> Method:
    weights = _table([[], [1 / 2], [0, 1 / 2], [0, 0, 1], [1 / 6, 1 / 3, 1 / 3, 1 / 6]])
    return Method(
        name="rk4",
        order=4,
        error_order=None,
        dense_order=3,
        weights=weights,
        nodes=np.array([0, 1 / 2, 1 / 2, 1, 1]),
        last=4,
        errors=np.zeros((1, 5)),
        polynomials=_hermite(weights, 4, 5),
    )


def _bogacki_shampine() -> Method:
    weights = _table([[], [1 / 2], [0, 3 / 4], [2 / 9, 1 / 3, 4 / 9]])
    return Method(
        name="bogacki-shampine-32",
        order=3,
        error_order=2,
        dense_order=3,
        weights=weights,
        nodes=np.array([0, 1 / 2, 3 / 4, 1]),
        last=3,
        errors=np.array([[5 / 72, -1 / 12, -1 / 9, 1 / 8]]),
        polynomials=_hermite(weights, 3, 4),
        control=_STEADY,
    )


def _dormand_prince_54() -> Method:
    weights = _table(
        [
            [],
            [1 / 5],
            [3 / 40, 9 / 40],
            [44 / 45, -56 / 15, 32 / 9],
            [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
            [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
            [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
        ]
    )
    fourth = np.array([5179 / 57600, 0, 7571 / 16695, 393 / 640, -92097 / 339200, 187 / 2100, 1 / 40])
    # Dense output of order 4 (Hairer, Norsett, Wanner 1993, II.6): theta^2 (3 - 2 theta) times the step,
    # Hermite parts, and a fourth-degree correction that vanishes with its slope at both ends.
    polynomials = np.zeros((7, 4))
    polynomials[:, :3] = _hermite(weights, 6, 7)
    correction = np.array(
        [
            -12715105075 / 11282082432,
            0,
            87487479700 / 32700410799,
            -10690763975 / 1880347072,
            701980252875 / 199316789632,
            -1453857185 / 822651844,
            69997945 / 29380423,
        ]
    )
    polynomials += correction[:, None] * np.array([0.0, 1.0, -2.0, 1.0])
    return Method(
        name="dormand-prince-54",
        order=5,
        error_order=4,
        dense_order=4,
        weights=weights,
        nodes=np.array([0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1]),
        last=6,
        errors=(weights[6] - fourth)[None, :],
        polynomials=polynomials,
        control=_STEADY,
    )


def _dense_of(rows: tuple[dict[int, float], ...], columns: int) -> Array:
    table = np.zeros((len(rows), columns))
    for i, row in enumerate(rows):
        for j, value in row.items():
            table[i, j] = value
    return table


def _dormand_prince_853() -> Method:
    stages, last = 16, 12
    weights = _dense_of(_dop853.WEIGHTS, stages)
    # Hairer's nested form: F0 t + F1 t(1-t) + F2 t^2(1-t) + F3 t^2(1-t)^2 + ...; each F linear in the stages.
    step = weights[last]
    first = np.zeros(stages)
    first[0] = 1.0
    final = np.zeros(stages)
    final[last] = 1.0
    terms = [step, first - step, 2.0 * step - first - final, *_dense_of(_dop853.DENSE, stages)]
    polynomials = np.zeros((stages, 7))
    shape = np.polynomial.Polynomial([0.0, 1.0])
    other = np.polynomial.Polynomial([1.0, -1.0])
    base = shape
    for index, term in enumerate(terms):
        coefficients = base.coef[1:]
        polynomials[:, : len(coefficients)] += term[:, None] * coefficients
        base = base * (other if index % 2 == 0 else shape)
    return Method(
        name="dormand-prince-853",
        order=8,
        error_order=7,
        dense_order=7,
        weights=weights,
        nodes=np.array(_dop853.NODES),
        last=last,
        errors=_dense_of(_dop853.ERRORS, stages),
        polynomials=polynomials,
    )


def _radau5() -> Method:
    """Radau IIA: the derivative at the start, the three stages, and the step's end once more.

    Hairer and Wanner, Solving Ordinary Differential Equations II, 2nd ed., IV.5 and IV.8. The dense output is
    the collocation polynomial: its slopes at the stages are the derivatives there.
    """
    root = math.sqrt(6.0)
    nodes = np.array([(4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0])
    weights, polynomials = np.zeros((5, 5)), np.zeros((5, 3))
    for j, node in enumerate(nodes):
        a, b = np.delete(nodes, j)
        # The integral of Lagrange's polynomial that is one at this node and zero at a and b.
        polynomials[1 + j] = np.array([a * b, -(a + b) / 2.0, 1.0 / 3.0]) / ((node - a) * (node - b))
    powers = nodes[:, None] ** np.array([1, 2, 3])
    weights[1:4, 1:4] = powers @ polynomials[1:4].T
    weights[4] = weights[3]
    return Method(
        name="radau5",
        order=5,
        error_order=3,
        dense_order=3,
        weights=weights,
        nodes=np.array([0.0, *nodes, 1.0]),
        last=4,
        errors=np.zeros((1, 5)),
        polynomials=polynomials,
    )


#: The methods by name: fixed-step RK4, Bogacki-Shampine 3(2), Dormand-Prince 5(4) and 8(5,3); implicit, for
#: stiff contact, Radau IIA of order 5(3).
METHODS: Mapping[str, Method] = MappingProxyType(
    {m.name: m for m in (_rk4(), _bogacki_shampine(), _dormand_prince_54(), _dormand_prince_853(), _radau5())}
)


def method_named(name: str) -> Method:
    """Return a method by name; the error for an unknown one lists the names."""
    if name not in METHODS:
        raise UnknownNameError("integrator.method", "method", name, METHODS)
    return METHODS[name]
