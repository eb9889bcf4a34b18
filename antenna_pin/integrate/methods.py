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
from antenna_pin.integrate import newton_kernels as _newton

# --- Dormand-Prince 8(5,3) ----------------------------------------------------------------------------------
#
# Rows are sparse: {column: value}. The values are those of Hairer, Norsett and Wanner (1993), Solving
# Ordinary Differential Equations I, 2nd ed., section II.5 and their program DOP853.

# fmt: off
# ruff: noqa: E501
NODES = (0.0, 0.05260015195876773, 0.0789002279381516, 0.1183503419072274, 0.2816496580927726, 0.3333333333333333, 0.25, 0.3076923076923077, 0.6512820512820513, 0.6, 0.8571428571428571, 1.0, 1.0, 0.1, 0.2, 0.7777777777777778)

# Stage weights: stages 0-11, row 12 the step itself, rows 13-15 what the dense output adds.
WEIGHTS: tuple[dict[int, float], ...] = (
    {},
    {0: 0.05260015195876773},
    {0: 0.0197250569845379, 1: 0.0591751709536137},
    {0: 0.02958758547680685, 2: 0.08876275643042054},
    {0: 0.2413651341592667, 2: -0.8845494793282861, 3: 0.924834003261792},
    {0: 0.037037037037037035, 3: 0.17082860872947386, 4: 0.12546768756682242},
    {0: 0.037109375, 3: 0.17025221101954405, 4: 0.06021653898045596, 5: -0.017578125},
    {0: 0.03709200011850479, 3: 0.17038392571223998, 4: 0.10726203044637328, 5: -0.015319437748624402, 6:
    0.008273789163814023}, {0: 0.6241109587160757, 3: -3.3608926294469414, 4: -0.868219346841726, 5:
    27.59209969944671, 6: 20.154067550477894, 7: -43.48988418106996}, {0: 0.47766253643826434, 3:
    -2.4881146199716677, 4: -0.590290826836843, 5: 21.230051448181193, 6: 15.279233632882423, 7:
    -33.28821096898486, 8: -0.020331201708508627}, {0: -0.9371424300859873, 3: 5.186372428844064, 4:
    1.0914373489967295, 5: -8.149787010746927, 6: -18.52006565999696, 7: 22.739487099350505, 8:
    2.4936055526796523, 9: -3.0467644718982196}, {0: 2.273310147516538, 3: -10.53449546673725, 4:
    -2.0008720582248625, 5: -17.9589318631188, 6: 27.94888452941996, 7: -2.8589982771350235, 8:
    -8.87285693353063, 9: 12.360567175794303, 10: 0.6433927460157636}, {0: 0.054293734116568765, 5:
    4.450312892752409, 6: 1.8915178993145003, 7: -5.801203960010585, 8: 0.3111643669578199, 9:
    -0.1521609496625161, 10: 0.20136540080403034, 11: 0.04471061572777259}, {0: 0.056167502283047954, 6:
    0.25350021021662483, 7: -0.2462390374708025, 8: -0.12419142326381637, 9: 0.15329179827876568, 10:
    0.00820105229563469, 11: 0.007567897660545699, 12: -0.008298}, {0: 0.03183464816350214, 5:
    0.028300909672366776, 6: 0.053541988307438566, 7: -0.05492374857139099, 10: -0.00010834732869724932, 11:
    0.0003825710908356584, 12: -0.00034046500868740456, 13: 0.1413124436746325}, {0: -0.42889630158379194, 5:
    -4.697621415361164, 6: 7.683421196062599, 7: 4.06898981839711, 8: 0.3567271874552811, 12:
    -0.0013990241651590145, 13: 2.9475147891527724, 14: -9.15095847217987},
)

# Error estimates of order 5 and 3, over stages 0-12.
ERRORS: tuple[dict[int, float], ...] = (
    {0: 0.01312004499419488, 5: -1.2251564463762044, 6: -0.4957589496572502, 7: 1.6643771824549864, 8:
    -0.35032884874997366, 9: 0.3341791187130175, 10: 0.08192320648511571, 11: -0.022355307863886294}, {0:
    -0.18980075407240762, 5: 4.450312892752409, 6: 1.8915178993145003, 7: -5.801203960010585, 8:
    -0.4226823213237919, 9: -0.1521609496625161, 10: 0.20136540080403034, 11: 0.02265179219836082},
)

# Dense output: Hairer's coefficients of the fourth to seventh term, over stages 0-15.
DENSE: tuple[dict[int, float], ...] = (
    {0: -8.428938276109013, 5: 0.5667149535193777, 6: -3.0689499459498917, 7: 2.38466765651207, 8:
    2.117034582445028, 9: -0.871391583777973, 10: 2.2404374302607883, 11: 0.6315787787694688, 12:
    -0.08899033645133331, 13: 18.148505520854727, 14: -9.194632392478356, 15: -4.436036387594894}, {0:
    10.427508642579134, 5: 242.28349177525817, 6: 165.20045171727028, 7: -374.5467547226902, 8:
    -22.113666853125306, 9: 7.733432668472264, 10: -30.674084731089398, 11: -9.332130526430229, 12:
    15.697238121770845, 13: -31.139403219565178, 14: -9.35292435884448, 15: 35.81684148639408}, {0:
    19.985053242002433, 5: -387.0373087493518, 6: -189.17813819516758, 7: 527.8081592054236, 8:
    -11.57390253995963, 9: 6.8812326946963, 10: -1.0006050966910838, 11: 0.7777137798053443, 12:
    -2.778205752353508, 13: -60.19669523126412, 14: 84.32040550667716, 15: 11.99229113618279}, {0:
    -25.69393346270375, 5: -154.18974869023643, 6: -231.5293791760455, 7: 357.6391179106141, 8:
    93.40532418362432, 9: -37.45832313645163, 10: 104.0996495089623, 11: 29.8402934266605, 12:
    -43.53345659001114, 13: 96.32455395918828, 14: -39.17726167561544, 15: -149.72683625798564},
)
# fmt: on


# --- tables -------------------------------------------------------------------------------------------------

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
        """Return whether the stages depend on one another, by equations to be solved."""
        return bool(np.triu(self.weights).any())

    @property
    def adaptive(self) -> bool:
        """Return whether the method estimates its error."""
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
    weights = _dense_of(WEIGHTS, stages)
    # Hairer's nested form: F0 t + F1 t(1-t) + F2 t^2(1-t) + F3 t^2(1-t)^2 + ...; each F linear in the stages.
    step = weights[last]
    first = np.zeros(stages)
    first[0] = 1.0
    final = np.zeros(stages)
    final[last] = 1.0
    terms = [step, first - step, 2.0 * step - first - final, *_dense_of(DENSE, stages)]
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
        nodes=np.array(NODES),
        last=last,
        errors=_dense_of(ERRORS, stages),
        polynomials=polynomials,
    )


def _radau5() -> Method:
    """Radau IIA: start derivative, three stages, and the step's end again.

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


# --- implicit steps -----------------------------------------------------------------------------------------

# From the coordinates in which A^-1 parts into a number and a pair to the stages' (Hairer and Wanner 1996,
# IV.8, and their program RADAU5).
_BACK = (
    (9.1232394870892942792e-02, -0.14125529502095420843, -3.0029194105147424492e-02),
    (0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779),
    (0.96604818261509293619, 1.0, 0.0),
)


def newton_of(method: Method, size: int, columns: NDArray[np.int64]) -> _newton.Radau:
    """Return what the kernels solve the equations of a step with.

    Args:
        method: Radau IIA.
        size: Components of z.
        columns: Those that the derivative depends on, increasing.
    """
    root, third = math.sqrt(6.0), np.cbrt(3.0)
    m = len(columns)
    return _newton.Radau(
        progress=np.zeros(1, _newton.PROGRESS),
        nodes=np.ascontiguousarray(method.nodes[1:4]),
        inverse=np.asarray(np.linalg.inv(method.weights[1:4, 1:4]), dtype=np.float64),
        back=np.array(_BACK),
        forth=np.linalg.inv(np.array(_BACK)),
        values=np.array(
            [
                3.0 + third**2 - third,
                3.0 + 0.5 * (third - third**2),
                0.5 * math.sqrt(3.0) * (third + third**2),
            ]
        ),
        error=np.array([-13.0 - 7.0 * root, -13.0 + 7.0 * root, -1.0]) / 3.0,
        columns=np.ascontiguousarray(columns, dtype=np.int64),
        z=np.zeros((3, size)),
        w=np.zeros((3, size)),
        f=np.zeros((3, size)),
        jacobian=np.zeros((size, m)),
        real=np.zeros((m, m)),
        complex=np.zeros((m, m), dtype=complex),
        pivots=np.zeros((2, m), dtype=np.int64),
        solved=np.zeros(m),
        paired=np.zeros(m, dtype=complex),
    )
