r"""Hysteresis damping: dissipation as a multiple of the elastic force.

All laws of this module have the form

.. math:: f = f_e(\delta)\left(1 + \chi\, \dot\delta / \dot\delta_0\right), \quad f \ge 0

and differ in the factor :math:`\chi` that they take for a coefficient of restitution :math:`c_r`. What they
deliver follows from the form alone: a free impact separates with the restitution :math:`c` that solves

.. math:: \chi (1 + c) = \ln\frac{1 + \chi}{1 - \chi c}

whatever the elastic law, the masses and the speed
(:func:`antenna_pin.contact.delivered_restitution`); for
:math:`m v\, dv / (1 + \chi v / v_0) = -f_e\, d\delta`, and the integral from :math:`v_0` to :math:`-c v_0` is
zero. :class:`ExactDamping` is that equation solved for :math:`\chi`; the others approximate it, each as well
as its docstring says. One, :class:`PantWijeyewickremaDamping`, damps in the approach only and leaves with
:math:`f_e`: what the spring has stored at the largest depth all comes back, so that

.. math:: \tfrac12 c^2 = \frac{U(\delta_{max})}{m v_0^2} = \frac1\chi - \frac{\ln(1 + \chi)}{\chi^2}

The force leaves zero with the elastic force and comes back to zero with it; it is cut off where it would
pull, which in a free impact it never does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from antenna_pin.base.arguments import takes
from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import packed
from antenna_pin.base.rules import NotNegative, NumberRule
from antenna_pin.compiled.decorators import inlined
from antenna_pin.contact.normal import STOPS_NOTHING, Dissipation


@inlined
def hysteretic(
    law: HysteresisDamping, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force before it is cut off [N]."""
    return elastic * (1.0 + float(law.hysteresis * rate / approach_speed))


@dataclass(frozen=True, slots=True, kw_only=True)
class HysteresisDamping(Dissipation):
    """Base of the laws of the form; each has its ``factor`` chi over c_r.

    Attributes:
        restitution: c_r, required coefficient of restitution, in [0, 1] [-].
    """

    kernel = staticmethod(hysteretic)
    frequent: ClassVar[bool] = True
    unpacked: ClassVar[tuple[str, ...]] = ("restitution",)
    factor: ClassVar[Any]  # c_r -> chi

    # It damps while the bodies approach; the way back is elastic.
    approach_only: ClassVar[bool] = False

    restitution: float = parameter(rule="in [0, 1]")

    @packed
    def hysteresis(self) -> float:
        """Hysteresis damping factor chi of ``1 + chi rate / approach_speed`` [-]."""
        return float(type(self).factor(self.restitution))


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactDamping(HysteresisDamping):
    r"""The damping that delivers the restitution asked for, exactly, with any elastic law.

    :math:`\chi` is the root of :math:`\chi (1 + c_r) = \ln[(1 + \chi) / (1 - \chi c_r)]` in (0+, 1/c_r).
    Zero restitution has no finite one and is refused.

    References:
        The relation is Hunt and Crossley's energy balance, integrated without approximation; Gonthier et al.
        (2004) give it implicitly. Derived here; the tests check it against integrated impacts.
    """

    restitution: float = parameter(rule=STOPS_NOTHING)

    @packed
    def hysteresis(self) -> float:
        """Chi [-]."""
        return exact_hysteresis(self.restitution)


@dataclass(frozen=True, slots=True, kw_only=True)
class HuntCrossleyDamping(HysteresisDamping):
    r""":math:`\chi = \tfrac32 (1 - c_r)`.

    For restitution near 1: delivers 0.909 for 0.9, 0.66 for 0.5; at least 0.488.

    References:
        Hunt and Crossley (1975), J. Appl. Mech. 42(2), 440-445.
    """

    factor = staticmethod(lambda c: 1.5 * (1.0 - c))


@dataclass(frozen=True, slots=True, kw_only=True)
class HerbertMcWhannellDamping(HysteresisDamping):
    r""":math:`\chi = 6 (1 - c_r) / [(2 c_r - 1)^2 + 3]`.

    Delivers 0.901 for 0.9, 0.59 for 0.5; at least 0.488.

    References:
        Herbert and McWhannell (1977), J. Eng. Ind. 99(3), 795-798; the formula as a public multibody code
        (DyS) has it, not checked against the paper.
    """

    factor = staticmethod(lambda c: 6.0 * (1.0 - c) / ((2.0 * c - 1.0) ** 2 + 3.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class LeeWangDamping(HysteresisDamping):
    r""":math:`\chi = \tfrac34 (1 - c_r)`.

    Half of Hunt and Crossley's: delivers 0.952 for 0.9, 0.80 for 0.5; at least 0.663.

    References:
        Lee and Wang (1983), J. Mech. Transm. Autom. Des. 105(3), 534-543; the formula as a public multibody
        code (DyS) has it, not checked against the paper.
    """

    factor = staticmethod(lambda c: 0.75 * (1.0 - c))


@dataclass(frozen=True, slots=True, kw_only=True)
class LankaraniNikraveshDamping(HysteresisDamping):
    r""":math:`\chi = \tfrac34 (1 - c_r^2)`.

    Derived for restitution near 1: delivers 0.913 for 0.9, 0.73 for 0.5; at least 0.663.

    References:
        Lankarani and Nikravesh (1990), J. Mech. Des. 112(3), 369-376.
    """

    factor = staticmethod(lambda c: 0.75 * (1.0 - c**2))


@dataclass(frozen=True, slots=True, kw_only=True)
class GonthierDamping(HysteresisDamping):
    r""":math:`\chi = (1 - c_r^2) / c_r`.

    An explicit approximation of the exact relation, good at low restitution: delivers 0.876
    for 0.9, 0.304 for 0.3.

    References:
        Gonthier, McPhee, Lange and Piedboeuf (2004), Multibody Syst. Dyn. 11, 209-233.
    """

    restitution: float = parameter(rule=STOPS_NOTHING)

    factor = staticmethod(lambda c: (1.0 - c**2) / c)


@dataclass(frozen=True, slots=True, kw_only=True)
class ZhiyingQishaoDamping(HysteresisDamping):
    r""":math:`\chi = \tfrac34 (1 - c_r^2) \exp[2 (1 - c_r)]`.

    Delivers 0.896 for 0.9, 0.48 for 0.5; at least 0.179.

    References:
        Qin and Lu (2006), also cited as Zhiying and Qishao, J. Dyn. Control 4(4), 294-298; the formula as a
        public multibody code (DyS) has it, not checked against the paper.
    """

    factor = staticmethod(lambda c: 0.75 * (1.0 - c * c) * math.exp(2.0 * (1.0 - c)))


@dataclass(frozen=True, slots=True, kw_only=True)
class YeDamping(HysteresisDamping):
    r""":math:`\chi = 3 (1 - c_r) / (2 c_r)`, given for a linear spring.

    As the restitution does not depend on the elastic law it holds with others as well; Hu and Guo's is the
    same factor. Delivers 0.900 for 0.9, 0.49 for 0.5, 0.17 for 0.2.

    References:
        Ye, Li and Zhu (2009), on the pounding of structures.
    """

    restitution: float = parameter(rule=STOPS_NOTHING)

    factor = staticmethod(lambda c: 1.5 * (1.0 - c) / c)


@dataclass(frozen=True, slots=True, kw_only=True)
class FloresDamping(HysteresisDamping):
    r""":math:`\chi = 8 (1 - c_r) / (5 c_r)`.

    Delivers 0.894 for 0.9, 0.47 for 0.5.

    References:
        Flores, Machado, Silva and Martins (2011), Multibody Syst. Dyn. 25, 357-375.
    """

    restitution: float = parameter(rule=STOPS_NOTHING)

    factor = staticmethod(lambda c: 8.0 * (1.0 - c) / (5.0 * c))


@dataclass(frozen=True, slots=True, kw_only=True)
class GharibHurmuzluDamping(HysteresisDamping):
    r""":math:`\chi = 1 / c_r`, for low restitution only.

    It delivers 0.594 where 1 is requested, 0.282 where 0.3; at 0.2 and below it is within 0.003.

    References:
        Gharib and Hurmuzlu (2012), J. Appl. Mech. 79(6), 064506. Recalled, not checked against the paper; it
        is the limit of the exact relation for c_r -> 0.
    """

    restitution: float = parameter(rule=STOPS_NOTHING)

    factor = staticmethod(lambda c: 1.0 / c)


@dataclass(frozen=True, slots=True, kw_only=True)
class HuGuoDamping(HysteresisDamping):
    r""":math:`\chi = 3 (1 - c_r) / (2 c_r)`.

    Delivers 0.900 for 0.9, 0.49 for 0.5, 0.17 for 0.2. A public multibody code (DyS) has half of
    it.

    References:
        Hu and Guo (2015), Multibody Syst. Dyn. 35, 131-151. Recalled, not checked against the paper; it has
        the slope of the exact relation at c_r = 1.
    """

    restitution: float = parameter(rule=STOPS_NOTHING)

    factor = staticmethod(lambda c: 1.5 * (1.0 - c) / c)


@dataclass(frozen=True, slots=True, kw_only=True)
class CarvalhoMartinsDamping(HysteresisDamping):
    r""":math:`\chi = 3 (1 - c_r)(11 - c_r) / [2 (1 + 9 c_r)]`.

    Delivers 0.900 for 0.9, 0.500 for 0.5, 0.212 for 0.2. It is finite at zero restitution, where
    it delivers 0.061.

    References:
        Carvalho and Martins (2019), Mech. Mach. Theory 139, 174-194; the formula as a public multibody code
        (Exudyn) has it.
    """

    factor = staticmethod(lambda c: 1.5 * (1.0 - c) * (11.0 - c) / (1.0 + 9.0 * c))


@inlined
def hysteretic_loading(
    law: HysteresisDamping, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force before it is cut off [N]."""
    return elastic * (1.0 + float(law.hysteresis * max(rate, 0.0) / approach_speed))


@dataclass(frozen=True, slots=True, kw_only=True)
class PantWijeyewickremaDamping(HysteresisDamping):
    r""":math:`\chi = 3 (1 - c_r^2) / (2 c_r^2)`, in the approach only.

    .. math:: f = \begin{cases} f_e\, (1 + \chi\, \dot\delta / \dot\delta_0) & \dot\delta > 0 \\
              f_e & \dot\delta \le 0 \end{cases}

    Given for a linear spring. Continuous, with a kink where the approach ends. Delivers 0.902 for 0.9,
    0.525 for 0.5, 0.328 for 0.3. Codes exist that damp in both phases, which at 0.5 would deliver 0.22:
    not this law.

    References:
        Pant and Wijeyewickrema (2012), Earthq. Eng. Struct. Dyn. 41(12).
    """

    kernel = staticmethod(hysteretic_loading)
    restitution: float = parameter(rule=STOPS_NOTHING)
    approach_only: ClassVar[bool] = True

    factor = staticmethod(lambda c: 1.5 * (1.0 - c * c) / (c * c))


# --- restitution delivered ----------------------------------------------------------------------------------


def _excess(chi: float, restitution: float) -> float:
    """Return the excess of the relation over chi^2, by its series.

    It is ``[ln((1 + chi) / (1 - chi c)) - chi (1 + c)] / chi^2``, whose terms cancel for chi up to 0.1.

    For chi up to 0.1, where the terms cancel.
    """
    total, size = 0.0, 1.0
    for k in range(2, 22):
        total += size * ((-1.0) ** (k + 1) + restitution**k) / k
        size *= chi
    return total


def stored_share(hysteresis: float) -> float:
    r"""Return the spring's largest energy over :math:`m v_0^2` [-], one half without damping.

    .. math:: \frac1\chi - \frac{\ln(1 + \chi)}{\chi^2}

    Args:
        hysteresis: chi, zero or more [-].
    """
    chi = hysteresis
    if chi < 0.05:  # the terms cancel
        return sum((-chi) ** k / (k + 2.0) for k in range(14))
    return 1.0 / chi - math.log1p(chi) / chi**2


@takes()
def delivered_restitution(hysteresis: NotNegative, *, approach_only: bool = False) -> float:
    r"""Return the restitution that a free impact delivers, from the factor :math:`\chi` [-].

    The root :math:`c` in (0, 1] of :math:`\chi (1 + c) = \ln[(1 + \chi) / (1 - \chi c)]`, to round-off; of a
    law that damps in the approach only, :math:`\sqrt{2 / \chi - 2 \ln(1 + \chi) / \chi^2}`.

    Args:
        hysteresis: chi, zero or more [-].
        approach_only: Whether the way back is elastic.
    """
    from scipy.optimize import brentq

    chi = hysteresis
    if approach_only:
        return math.sqrt(2.0 * stored_share(chi))
    if chi == 0.0:
        return 1.0
    if chi < 0.1:
        return float(brentq(lambda c: _excess(chi, c), 0.0, 1.0, xtol=1e-16, rtol=1e-15))

    # In s = -ln(1 - chi c), which stays well conditioned as c tends to 1 / chi.
    def excess(s: float) -> float:
        return math.log1p(chi) + s - chi + math.expm1(-s)

    s = float(brentq(excess, 0.0, chi + 1.0, xtol=1e-16, rtol=1e-15))
    return -math.expm1(-s) / chi


@takes()
def exact_hysteresis(restitution: Annotated[float, NumberRule("in (0, 1]")]) -> float:
    r"""Return the factor :math:`\chi` that delivers a restitution exactly [-].

    The root of :math:`\chi (1 + c) = \ln[(1 + \chi) / (1 - \chi c)]` in (0+, 1/c); zero is always another.

    Args:
        restitution: c, in (0, 1] [-].
    """
    from scipy.optimize import brentq

    c = restitution
    if c == 1.0:
        return 0.0
    if _excess(0.1, c) > 0.0:
        return float(brentq(lambda chi: _excess(chi, c), 0.0, 0.1, xtol=1e-18, rtol=1e-15))

    # In s = -ln(1 - chi c): chi comes within exp(-1 / c) of 1 / c.
    def excess(s: float) -> float:
        chi = -math.expm1(-s) / c
        return math.log1p(chi) + s - chi * (1.0 + c)

    low = -math.log1p(-0.1 * c)
    s = float(brentq(excess, low, (1.0 + c) / c + 1.0, xtol=1e-16, rtol=1e-15))
    return -math.expm1(-s) / c


# --- damping without an approach speed ----------------------------------------------------------------------


@inlined
def proportional(
    law: MarhefkaOrinDamping, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force before it is cut off [N]."""
    return elastic * (1.0 + law.hysteresis_over_speed * rate)


@dataclass(frozen=True, slots=True, kw_only=True)
class MarhefkaOrinDamping(Dissipation):
    r"""Hunt and Crossley's damping with a restitution that falls with the speed.

    .. math:: f = f_e(\delta) \left(1 + \tfrac32 \alpha\, \dot\delta\right)

    which requires :math:`c_r = 1 - \alpha v_0`, as metals have it at moderate speeds. The damping does not
    depend on the approach speed, so the law has no memory; :math:`\chi` is :math:`\tfrac32 \alpha v_0`.

    Attributes:
        slope: alpha, loss of restitution over impact speed [s/m].

    References:
        Marhefka and Orin (1999), IEEE Trans. Syst. Man Cybern. A 29(6), 566-572.
    """

    kernel = staticmethod(proportional)
    frequent: ClassVar[bool] = True

    slope: float = parameter("s/m", rule="zero or more")

    @packed
    def hysteresis_over_speed(self) -> float:
        """Chi over the approach speed [s/m]."""
        return 1.5 * self.slope
