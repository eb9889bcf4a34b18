r"""Line contact of a journal in a bore: the laws with a logarithm.

Two elastic cylinders that touch along a line approach by an amount that depends, through a logarithm, on how
far away one measures it. So these laws share one form and differ in what stands in the logarithm: with the
load per length :math:`f = F / L`, the play :math:`\Delta R = R_i - R_j` and
:math:`1/E^* = (1 - \nu_i^2)/E_i + (1 - \nu_j^2)/E_j`

.. math:: \delta = \alpha f \ln(\beta / f)

They give the depth over the force; the force over the depth is the branch that begins at zero. It ends
where the depth turns over, at :math:`\ln(\beta / f) = 1` and :math:`\delta = \alpha \beta / e`: that is
``depth_limit``. The stiffness grows without bound as the depth comes near it, and beyond it the law says
nothing: it refuses (the kernels hold the force, for the trial steps of an integrator). Well before, the
contact patch is no longer small against the radii.

Near zero depth the force is a little less than proportional to the depth: its slope falls to zero, but as
slowly as :math:`1 / \ln(1 / \delta)`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import packed
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.contact.normal import ElasticLaw, power, power_energy, power_force
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class LineLaw(ElasticLaw):
    """Parameters of the laws of a journal in a bore.

    A scenario may leave all of it out: the dimensions are the joint's (``length`` half the bearing's length,
    for each of its two ends; the whole for a planar joint), the modulus that of its materials.

    Attributes:
        length: L, of the line of contact [m].
        journal_radius: R_j [m].
        bearing_radius: R_i, above R_j [m].
        modulus: E*, plane-strain contact modulus of the pair [Pa].
    """

    line: ClassVar[bool] = True
    unpacked: ClassVar[tuple[str, ...]] = ("length", "journal_radius", "bearing_radius", "modulus")

    length: float = parameter("m", rule="positive", from_joint=True)
    journal_radius: float = parameter("m", rule="positive", from_joint=True)
    bearing_radius: float = parameter("m", rule="positive", from_joint=True)
    modulus: float = parameter("Pa", rule="positive", from_joint=True)

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse a bearing that is not larger than its journal."""
        if not law.journal_radius < law.bearing_radius:
            raise InvalidParameterError(
                law, "bearing_radius", f"above journal_radius = {law.journal_radius:g} m, and finite"
            )

    @packed
    def clearance(self) -> float:
        """Radial play dR = R_i - R_j [m]."""
        return self.bearing_radius - self.journal_radius


@kernel
def log_ratio(ratio: float) -> float:
    """Return the larger root w of ``w exp(-w) = ratio``.

    The ratio is in (0, 1/e]; beyond 1/e the root is that of 1/e: 1.

    By Newton's method on ``(w - 1) - ln w = u``, ``u = -1 - ln ratio``, between the bounds
    ``sqrt(2 u) + 2 u / 3`` and ``sqrt(2 u) + u`` of w - 1 (Chatzigeorgiou 2013). It is convex, so that from
    the lower bound the first step lands above the root and all others come down on it: four or five steps.
    """
    u = -1.0 - math.log(ratio)
    if not u > 0.0:
        return 1.0
    root = math.sqrt(2.0 * u)
    low = root + 2.0 / 3.0 * u
    high = root + u
    w = low
    for _ in range(12):
        step = (w - math.log1p(w) - u) * (1.0 + w) / w
        w = min(max(w - step, low), high)
        if abs(step) <= 1e-15 * w:
            break
    return 1.0 + w


@kernel
def logarithmic_force(law: LogarithmicLaw, depth: float) -> float:
    """Elastic force [N], odd in the depth.

    d = d_0 w exp(-w), F = F_0 exp(-w), on the branch below the turn-over at w = 1. Odd, as the law is nearly
    linear and an integrator may step across its end.
    """
    ratio = abs(depth) / law.depth_scale
    if ratio < 1e-300:
        return 0.0
    force = law.force_scale * math.exp(-log_ratio(ratio))
    return float(force if depth > 0.0 else -force)


@kernel
def logarithmic_energy(law: LogarithmicLaw, depth: float) -> float:
    """Energy stored [J].

    F d - integral of d dF, with d = d_0 s ln(1/s): F_0 d_0 s^2 (w/2 - 1/4), w = ln(1/s).
    """
    if depth < 1e-300 * law.depth_scale:
        return 0.0
    w = log_ratio(depth / law.depth_scale)
    s = math.exp(-w)
    # Beyond the turn-over the force stays as it is there.
    beyond = max(0.0, depth - law.depth_scale * w * s) * law.force_scale * s
    return float(law.force_scale * law.depth_scale * s * s * (0.5 * w - 0.25) + beyond)


class LogarithmicLaw(LineLaw):
    r"""Base of the laws :math:`\delta = \alpha f \ln(\beta / f)`."""

    __slots__ = ()

    kernel = staticmethod(logarithmic_force)
    energy = staticmethod(logarithmic_energy)

    def _logarithm(self) -> tuple[float, float]:
        """Return alpha [m^2/N] and beta [N/m]."""
        raise NotImplementedError

    @property
    def depth_limit(self) -> float:
        """Depth at which the law turns over [m]."""
        return self.depth_scale / math.e

    def depth(self, force: float) -> float:
        """Return the depth under a force, as the law is published [m].

        Args:
            force: Elastic force [N], zero or more.
        """
        if force == 0.0:
            return 0.0
        alpha, beta = self._logarithm()
        load = force / self.length
        return alpha * load * math.log(beta / load)

    @packed
    def force_scale(self) -> float:
        """F_0 of F = F_0 s [N]."""
        return self._logarithm()[1] * self.length

    @packed
    def depth_scale(self) -> float:
        """d_0 of the depth d_0 s ln(1/s) [m]."""
        alpha, beta = self._logarithm()
        return alpha * beta


@dataclass(frozen=True, slots=True, kw_only=True)
class HertzLine(LogarithmicLaw):
    r"""Hertz's contact of two cylinders.

    .. math:: \delta = \frac{2 f}{\pi E^*} \left[\ln\frac{\pi E^* \Delta R}{f} - 1\right]

    Holds for a patch narrow against the play and the radii.

    References:
        Hertz (1881); this form as a public multibody code (DyS) has it, after Machado et al. (2012), Mech.
        Mach. Theory 53, 99-121. Its prefactor is twice that of the others; not derived here.
    """

    def _logarithm(self) -> tuple[float, float]:
        return 2.0 / (math.pi * self.modulus), math.pi * self.modulus * self.clearance / math.e


@dataclass(frozen=True, slots=True, kw_only=True)
class Johnson(LogarithmicLaw):
    r"""Johnson's compression of two cylinders, for a journal in a bore.

    .. math:: \delta = \frac{f}{\pi E^*} \left[\ln\frac{4 \pi E^* \Delta R}{f} - 1\right]

    The sum of each body's compression between the contact and its own axis,
    :math:`f (1 - \nu^2) / (\pi E)\, [2 \ln(4 R / a) - 1]`, :math:`a^2 = 4 f R_i R_j / (\pi E^* \Delta R)`:
    for one material the radii drop out. Turns over at :math:`\delta = 4 e^{-2} \Delta R = 0.541\, \Delta R`.

    References:
        Johnson (1985), Contact Mechanics, sections 4.2 and 5.6.
    """

    def _logarithm(self) -> tuple[float, float]:
        return 1.0 / (math.pi * self.modulus), 4.0 * math.pi * self.modulus * self.clearance / math.e


@dataclass(frozen=True, slots=True, kw_only=True)
class Radzimovsky(LogarithmicLaw):
    r"""Radzimovsky's contact of two cylinders.

    .. math:: \delta = \frac{f}{\pi E^*} \left[\frac23 + \ln\frac{4 R_i}{b} + \ln\frac{4 R_j}{b}\right],
              \qquad b = k \sqrt{\frac{f R_i R_j}{E^* \Delta R}}

    with the full width b of the contact, for which Hertz has :math:`k = 4 / \sqrt\pi = 2.257`, the default.
    The literature on clearance joints prints 1.60, which belongs to diameters: in a bore of 10 mm radius with
    a play of 0.2 mm the depth comes out 5 to 11 % higher at 0.2 to 200 N/mm.

    Attributes:
        width_factor: k of the contact's full width; 1.60 as often printed [-].

    References:
        Radzimovsky (1953), University of Illinois Eng. Exp. Station Bull. 408; Roark's Formulas for Stress
        and Strain. The formula after Machado et al. (2012), not checked against the bulletin.
    """

    width_factor: float = parameter(rule="positive", default=4.0 / math.sqrt(math.pi))

    def _logarithm(self) -> tuple[float, float]:
        beta = 16.0 / self.width_factor**2 * self.modulus * self.clearance * math.exp(2.0 / 3.0)
        return 1.0 / (math.pi * self.modulus), beta


class _OverLength(LogarithmicLaw):
    """Base of the laws whose logarithm has the length of the contact."""

    __slots__ = ()

    def _logarithm(self) -> tuple[float, float]:
        softness = 1.0 / (math.pi * self.modulus)  # sigma_i + sigma_j
        radius = self.bearing_radius * self.journal_radius / self.clearance
        return softness, self.length**2 / (radius * softness) * math.e


@dataclass(frozen=True, slots=True, kw_only=True)
class Goldsmith(_OverLength):
    r"""Goldsmith's contact of two cylinders, for a journal in a bore.

    .. math:: \delta = \frac{F (\sigma_i + \sigma_j)}{L}
              \left[\ln\frac{L^3}{F R (\sigma_i + \sigma_j)} + 1\right], \qquad
              \sigma = \frac{1 - \nu^2}{\pi E}, \quad R = \frac{R_i R_j}{\Delta R}

    The power of L is printed as m; only m = 3 is consistent in its units. With the internal radius R it is
    Dubowsky and Freudenstein's law. The length takes the place of the distance over which the depth is
    measured, so that a long bearing is softer per length.

    References:
        Goldsmith (1960), Impact; the form after Machado et al. (2012), Mech. Mach. Theory 53, 99-121. Not
        checked against the book.
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class DubowskyFreudenstein(_OverLength):
    r"""Dubowsky and Freudenstein's contact of a pin in a hole.

    .. math:: \delta = \frac{F (\sigma_i + \sigma_j)}{L}
              \left[\ln\frac{L^3 \Delta R}{F R_i R_j (\sigma_i + \sigma_j)} + 1\right], \qquad
              \sigma = \frac{1 - \nu^2}{\pi E}

    :class:`Goldsmith`'s law with the internal radius. The power of L is printed as m; only m = 3 is
    consistent in its units.

    References:
        Dubowsky and Freudenstein (1971), J. Eng. Ind. 93, 305-309; the form after Machado et al. (2012). Not
        checked against the paper.
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class ESDU78035(LogarithmicLaw):
    r"""The law of ESDU item 78035 for a cylinder in a bore.

    .. math:: \delta = \frac{F (\sigma_i + \sigma_j)}{L}
              \left[\ln\frac{4 L \Delta R}{F (\sigma_i + \sigma_j)} + 1\right], \qquad
              \sigma = \frac{1 - \nu^2}{\pi E}

    Johnson's law except for the +1 where that has -1. A public multibody code (DyS) has another version,
    whose units do not agree.

    References:
        ESDU 78035 (1978), Contact phenomena I; the form after Pereira et al. (2011), Nonlinear Dyn. 63,
        681-697. Recalled, not checked.
    """

    def _logarithm(self) -> tuple[float, float]:
        return 1.0 / (math.pi * self.modulus), 4.0 * math.pi * self.modulus * self.clearance * math.e


# --- conformal contact --------------------------------------------------------------------------------------
#
# The laws of :mod:`antenna_pin.contact.cylinder` need a patch that is narrow against the play. With little
# play it is not: the journal, pressed in by :math:`\delta`, overlaps the bore over the arc of half-angle
# :math:`\varepsilon`
#
# .. math:: \cos\varepsilon = \frac{\Delta R}{\Delta R + \delta}, \qquad
#           \tan^2\frac\varepsilon2 = \frac{\delta}{2 \Delta R + \delta}
#
# and the load grows with the arc. All of these give the force over the depth explicitly.


@kernel
def arc_energy(factor: float, clearance: float, depth: float) -> float:
    """Integral of ``factor x sqrt(x / (clearance + x))`` from 0 to ``depth`` [J]."""
    r = depth / clearance
    if r > 0.3:
        root = math.sqrt(r * (1.0 + r))
        return 0.25 * factor * clearance**2 * ((2.0 * r - 3.0) * root + 3.0 * math.asinh(math.sqrt(r)))
    # The terms of that cancel at small depth: sum over k of binomial(-1/2, k) r^k / (k + 5/2).
    total = 0.0
    term = 1.0
    for k in range(40):
        total += term / (k + 2.5)
        term *= -r * (k + 0.5) / (k + 1.0)
        if abs(term) < 1e-17:
            break
    return factor * depth * depth * math.sqrt(r) * total


@inlined
def foundation_force(law: LiuFoundation, depth: float) -> float:
    """Elastic force [N]."""
    return float(law.factor * depth * math.sqrt(depth / (law.clearance + depth))) if depth > 0.0 else 0.0


@inlined
def foundation_energy(law: LiuFoundation, depth: float) -> float:
    """Energy stored [J]."""
    return arc_energy(law.factor, law.clearance, depth)


@dataclass(frozen=True, slots=True, kw_only=True)
class LiuFoundation(LineLaw):
    r"""Liu et al.'s elastic foundation for a journal in a bore (an improved Winkler model).

    .. math:: F = \frac\pi2 E^* L\, \delta \sqrt{\frac{\delta}{2 (\Delta R + \delta)}}

    Explicit, and without limit in depth short of the bearing's own thickness. For small depth
    :math:`\propto \delta^{3/2}`: force and slope leave zero together.

    References:
        Liu, Zhang and Yang (2005/2007), J. Comput. Nonlinear Dyn. 1, 60-67 and Mech. Mach. Theory 42,
        183-197. The formula as a public multibody code (DyS) has it.
    """

    kernel = staticmethod(foundation_force)
    energy = staticmethod(foundation_energy)
    frequent: ClassVar[bool] = True

    @packed
    def factor(self) -> float:
        """Pi E* L / sqrt(8) [N/m]."""
        return 0.5 * math.pi / math.sqrt(2.0) * self.modulus * self.length


@kernel
def bai_zhao_force(law: BaiZhaoElastic, depth: float) -> float:
    """Elastic force [N]."""
    if depth <= 0.0:
        return 0.0
    s = law.clearance + depth
    return float(
        law.factor
        * math.sqrt(depth / s)
        * (3.0 * law.clearance + 2.0 * depth)
        / s
        * power(depth, law.exponent)
    )  # K_n d^n


@kernel
def bai_zhao_energy(law: BaiZhaoElastic, depth: float) -> float:
    """Energy stored [J] with an exponent of 1; NaN with another.

    K_n L is the slope of Liu's force F, whose factor is twice K_n's: F d - integral of F.
    """
    if law.exponent != 1.0:
        return math.nan
    force = 2.0 * law.factor * depth * math.sqrt(depth / (law.clearance + depth))
    return float(force * depth - arc_energy(2.0 * law.factor, law.clearance, depth))


@dataclass(frozen=True, slots=True, kw_only=True)
class BaiZhaoElastic(LineLaw):
    r"""Elastic part of Bai and Zhao's hybrid law: a stiffness that depends on depth.

    .. math:: F = L K_n \delta^n, \qquad K_n = \frac{\pi E^*}{8}
              \sqrt{\frac{2 \delta\, [3 \Delta R + 2 \delta]^2}{(\Delta R + \delta)^3}}

    K_n is the tangent stiffness dF/d delta per length of :class:`LiuFoundation`, used as a secant: with n =
    1, which the units require, the force is 1.5 times Liu's at small depth. With n = 3/2, as the paper
    suggests, the units do not agree; numbers are SI.

    Attributes:
        exponent: n of K_n depth^n, 1 or 1.5 [-].

    References:
        Bai and Zhao (2012), Int. J. Mech. Sci. 54, 190-205, and (2013), Int. J. Non-Linear Mech. 48, 15-36.
        Formula recalled, not checked against the papers; that K_n is Liu's tangent stiffness is checked in
        the tests.
    """

    kernel = staticmethod(bai_zhao_force)
    energy = staticmethod(bai_zhao_energy)

    exponent: float = parameter(default=1.0)

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse another exponent than the two of the papers."""
        LineLaw.check_rules(law)
        if law.exponent not in (1.0, 1.5):
            raise InvalidParameterError(law, "exponent", "1 or 1.5")

    @packed
    def factor(self) -> float:
        """Pi E* L / sqrt(32) [N/m]."""
        return math.pi / 8.0 * math.sqrt(2.0) * self.modulus * self.length


def _largest_square() -> float:
    """Return the root b^2 of 2 - ln(1 + b^2) - 2 b^4."""
    square = 0.8
    for _ in range(20):
        capacity = 2.0 - math.log1p(square) - 2.0 * square * square
        square += capacity / (1.0 / (1.0 + square) + 4.0 * square)
    return square


#: b^2 of an infinite load [-].
LARGEST_SQUARE = _largest_square()
# b^2 that Persson's law is evaluated at, at most.
_LARGEST = 0.99 * LARGEST_SQUARE
# Gauss-Legendre on [-1, 1].
LOAD_NODES, LOAD_WEIGHTS = np.polynomial.legendre.leggauss(24)


@kernel
def persson_force(law: Persson, depth: float) -> float:
    """Elastic force [N], continued analytically below zero depth."""
    x = max(depth, -0.5 * law.clearance)
    square = min(x / (2.0 * law.clearance + x), _LARGEST)  # tan^2(eps/2)
    return float(law.factor * square * (1.0 + square) / (2.0 - math.log1p(square) - 2.0 * square * square))


@kernel
def persson_energy(law: Persson, depth: float) -> float:
    """Return the energy stored [J].

    The variable is s = tan^2(eps/2): depth = 2 dR s / (1 - s).

    The force has a pole at its root, just beyond the range: it is taken out, r / (s - root), and integrated
    in closed form. At small depth that would cancel, and the pole is far enough for the nodes alone.
    """
    root = LARGEST_SQUARE  # of the load: there it is infinite
    end = min(depth / (2.0 * law.clearance + depth), _LARGEST)
    residue = 0.0
    if end > 0.25:
        residue = -root * (1.0 + root) / ((1.0 - root) ** 2 * (1.0 / (1.0 + root) + 4.0 * root))
    total = residue * math.log1p(-end / root)
    for k in range(LOAD_NODES.shape[0]):
        s = 0.5 * end * (1.0 + LOAD_NODES[k])
        load = s * (1.0 + s) / (2.0 - math.log1p(s) - 2.0 * s * s)
        total += 0.5 * end * LOAD_WEIGHTS[k] * (load / (1.0 - s) ** 2 - residue / (s - root))
    # Beyond the range the force stays as it is there.
    beyond = depth - 2.0 * law.clearance * end / (1.0 - end) if end == _LARGEST else 0.0
    held = end * (1.0 + end) / (2.0 - math.log1p(end) - 2.0 * end * end)
    return float(law.factor * (2.0 * law.clearance * total + max(beyond, 0.0) * held))


@dataclass(frozen=True, slots=True, kw_only=True)
class Persson(LineLaw):
    r"""Persson's conformal contact of a disc in a hole of the same material.

    .. math:: \frac{2 E^* \Delta R}{f} = \frac{2 - \ln(1 + b^2) - 2 b^4}{\pi b^2 (1 + b^2)}, \qquad
              b = \tan\frac\varepsilon2 = \sqrt{\frac{\delta}{2 \Delta R + \delta}}

    The load over the arc is the exact plane solution for a frictionless disc in a hole of an infinite plate
    of the same material; for two materials it is an approximation, and the depth is the overlap, as in Liu's
    law. The arc cannot pass :math:`2\varepsilon = 169` degrees, at 10.1 times the play; ``depth_limit`` lies
    1 % of :math:`b^2` before it. Linear at small depth: :math:`f = \tfrac\pi2 E^* \delta`.

    References:
        Persson (1964), On the stress distribution of cylindrical elastic bodies in contact, dissertation,
        Chalmers; closed form after Ciavarella and Decuzzi (2001), Int. J. Solids Struct. 38. Recalled; the
        tests check the load over the arc against a series solution of the plane problem.
    """

    kernel = staticmethod(persson_force)
    energy = staticmethod(persson_energy)

    @property
    def depth_limit(self) -> float:
        """Depth at which the arc is the largest that the law is evaluated at [m]."""
        return 2.0 * self.clearance * _LARGEST / (1.0 - _LARGEST)

    @packed
    def factor(self) -> float:
        """2 pi E* L dR [N]."""
        return 2.0 * math.pi * self.modulus * self.length * self.clearance


@dataclass(frozen=True, slots=True, kw_only=True)
class Pereira(LineLaw):
    r"""Pereira et al.'s power law, fitted to the laws with a logarithm.

    In millimetres and newtons

    .. math:: F = \frac{(0.965\, \Delta R + 0.0965)\, L E^*}{\Delta R}\, \delta^n, \qquad
              n = Y \Delta R^{-0.005}

    .. math:: Y = \begin{cases} 1.51\, [\ln(1000\, \Delta R)]^{-0.151} & 0.005 \le \Delta R \le 0.34954 \\
              0.0151\, \Delta R + 1.151 & 0.34954 < \Delta R \le 10 \end{cases}

    Fitted for a play of 5 um to 10 mm: outside it is refused. Explicit, unlike the laws that it is fitted to.
    Their damping, Lankarani and Nikravesh's, is chosen apart here.

    References:
        Pereira, Ramalho and Ambrosio (2015), Multibody Syst. Dyn. 35, 277-298. Recalled, not checked against
        the paper; that the two branches of Y meet is checked in the tests.
    """

    kernel = staticmethod(power_force)
    energy = staticmethod(power_energy)
    frequent: ClassVar[bool] = True

    @classmethod
    def check_rules(cls, law: Any) -> None:
        """Refuse a play outside the range of the fit."""
        LineLaw.check_rules(law)
        # The play is a difference of two lengths: allow for its round-off.
        if not 5e-6 * (1.0 - 1e-9) <= law.bearing_radius - law.journal_radius <= 10e-3 * (1.0 + 1e-9):
            raise InvalidParameterError(
                law, "bearing_radius", "such that the play is 5 um to 10 mm, for which the law was fitted"
            )

    @property
    def exponent(self) -> float:
        """Exponent n [-]."""
        play = 1e3 * self.clearance
        y = 1.51 * math.log(1000.0 * play) ** -0.151 if play <= 0.34954 else 0.0151 * play + 1.151
        return float(y * play**-0.005)

    @property
    def stiffness(self) -> float:
        """K of K depth^n [N/m^n]."""
        play = 1e3 * self.clearance
        per_millimetre = (0.965 * play + 0.0965) * (1e3 * self.length) * (1e-6 * self.modulus) / play
        return float(per_millimetre * 1000.0**self.exponent)
