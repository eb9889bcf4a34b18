r"""Dampers beside the spring: dissipation by a force of its own.

.. math:: f = \max[0,\; f_e(\delta) + c(\delta)\, \dot\delta]

A damper pulls when the surfaces part fast enough. Here no law does: the force is cut off at zero, and what
the spring then gives back is lost too, so that less comes back than from the damper that pulls.

Three of them are linear in disguise. For :math:`f_e = K \delta^n` and :math:`c = \alpha \sqrt{m f_e /
\delta}` the substitution :math:`w = \delta^{(n+1)/2},\; d\tau = \delta^{(n-1)/2} dt` turns an impact into a
damped linear oscillator of damping ratio :math:`\zeta = \alpha / \sqrt{2 (n + 1)}`. So their restitution is
known in closed form and depends on neither speed nor stiffness
(:mod:`antenna_pin.analysis.law_studies.impacts`).

The mass m is that of the contact, which the law takes at each onset if it is given none: of two free bodies
:math:`1/m = 1/m_1 + 1/m_2`, of a mechanism :math:`m = (n^T M^{-1} n)^{-1}` along the contact's normal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import packed
from antenna_pin.compiled.decorators import inlined
from antenna_pin.contact.normal import STOPS_NOTHING, Dissipation, ElasticLaw


def damping_ratio(restitution: float) -> float:
    r"""Return the damping ratio of a linear oscillator that comes back with a restitution [-].

    :math:`\zeta = -\ln c / \sqrt{\pi^2 + \ln^2 c}`, where the damper may pull at the end.

    Args:
        restitution: c, in (0, 1] [-].
    """
    loss = -math.log(restitution)
    return loss / math.hypot(math.pi, loss)


@dataclass(frozen=True, slots=True, kw_only=True)
class _OfRestitution(Dissipation):
    """Base of the dampers set by the restitution of a mass.

    Attributes:
        restitution: c_r, required coefficient of restitution, in (0, 1] [-].
        effective_mass: m of the contact [kg]; left out: (n^T M^-1 n)^-1 at the onset of each contact, along
            its normal. With another mass the contact delivers another restitution.
    """

    adds_force: ClassVar[bool] = True
    unpacked: ClassVar[tuple[str, ...]] = ("restitution",)

    restitution: float = parameter(rule=STOPS_NOTHING)
    effective_mass: float | None = parameter("kg", rule="positive", default=None, from_joint=True)

    @property
    def takes_mass(self) -> bool:
        """Return whether the force depends on the effective mass of the contact."""
        return self.effective_mass is None

    @packed
    def mass(self) -> float:
        """Effective mass, 0 for that of the contact [kg]."""
        return self.effective_mass or 0.0

    @packed
    def damping(self) -> float:
        """Alpha or 2 xi, over the root of mass times secant stiffness [-]."""
        raise NotImplementedError


@inlined
def viscous(
    law: KelvinVoigtDamping, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force [N]."""
    return max(elastic + law.damping * rate, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class KelvinVoigtDamping(Dissipation):
    r"""A linear damper: :math:`f = \max(0, f_e + D \dot\delta)`.

    The force jumps to :math:`D v_0` at the onset, where there is no depth yet: the law's one discontinuity.
    With a linear spring, :math:`\zeta = D / (2 \sqrt{K m})` gives the restitution in closed form.

    Attributes:
        damping: D [N s/m].

    References:
        Voigt (1892), Ann. Phys. 283, 671-693. Codes exist that unload with c_r K depth instead, without a
        potential; that is not this law.
    """

    adds_force: ClassVar[bool] = True

    kernel = staticmethod(viscous)

    damping: float = parameter("N*s/m", rule="zero or more")


@inlined
def root_depth(
    law: KuwabaraKonoDamping, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force [N]."""
    damping = law.damping * math.sqrt(max(depth, 0.0))
    return max(elastic + damping * rate, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class KuwabaraKonoDamping(Dissipation):
    r"""Viscoelastic spheres: :math:`f = \max(0, f_e + c \sqrt\delta\, \dot\delta)`.

    Viscosity in the material makes :math:`c = \tfrac32 A K` for spheres with the elastic law
    :math:`K \delta^{3/2}` and a time A of the material [s]. The restitution rises to 1 as the speed tends to
    zero: :math:`1 - c_r \propto v_0^{1/5}`. Continuous at the onset, with infinite slope.

    Attributes:
        damping: c of c sqrt(depth) rate [N s/m^1.5].

    References:
        Kuwabara and Kono (1987), Jpn. J. Appl. Phys. 26, 1230-1233. Recalled, not checked against the paper;
        the scaling with the speed is checked in the tests.
    """

    adds_force: ClassVar[bool] = True

    kernel = staticmethod(root_depth)

    damping: float = parameter("N*s/m**1.5", rule="zero or more")


@inlined
def secant(
    law: _OfRestitution, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force [N]."""
    m = law.mass if law.mass > 0.0 else mass
    damping = law.damping * math.sqrt(m * max(elastic / depth, 0.0)) if depth != 0.0 else 0.0
    return max(elastic + damping * rate, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class TsujiDamping(_OfRestitution):
    r"""Damping that makes the restitution of a Hertz contact the same at every speed.

    .. math:: f = \max\left(0,\; K \delta^{3/2} + \alpha \sqrt{m K}\, \delta^{1/4} \dot\delta\right), \qquad
              \alpha = \sqrt5\, \zeta, \quad \zeta = \frac{-\ln c_r}{\sqrt{\pi^2 + \ln^2 c_r}}

    With other elastic laws :math:`K \delta^{1/2}` is the secant stiffness :math:`f_e / \delta`, and of a
    power law :math:`\alpha = \sqrt{2 (n + 1)}\, \zeta`. Cut off where it would pull it delivers
    :math:`\exp[-\zeta (\pi - 2 \arcsin\zeta) / \sqrt{1 - \zeta^2}]`: 0.902 for 0.9, 0.55 for 0.5.

    Beside an elastic law that is linear at small depth, or nearly, as the laws with a logarithm are, the
    force jumps at the onset as that of a Kelvin-Voigt contact does.

    References:
        Tsuji, Tanaka and Ishida (1992), Powder Technol. 71, 239-250, who give alpha as a graph; its closed
        form, Antypov and Elliott (2011), EPL 94, 50004, is derived here (see the module).
    """

    kernel = staticmethod(secant)

    def numbers(self, elastic: ElasticLaw) -> Any:
        """Return alpha, which depends on the elastic law, and the mass."""
        exponent = getattr(elastic, "exponent", 1.5)
        alpha = math.sqrt(2.0 * (exponent + 1.0)) * damping_ratio(self.restitution)
        return SimpleNamespace(damping=alpha, mass=self.mass)


@inlined
def secant_loading(
    law: _OfRestitution, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force [N]."""
    if rate > 0.0:
        return secant(law, elastic, depth, rate, approach_speed, mass)
    return max(elastic + 0.0 * rate, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class JankowskiDamping(_OfRestitution):
    r"""Damping in the approach only; the way back is elastic.

    .. math:: f = \begin{cases}
        K \delta^{3/2} + 2 \xi \sqrt{m K \sqrt\delta}\, \dot\delta & \dot\delta > 0 \\
        K \delta^{3/2} & \dot\delta \le 0 \end{cases} \qquad
        \xi = \frac{9 \sqrt5}{2}\, \frac{1 - c_r^2}{c_r [c_r (9 \pi - 16) + 16]}

    Continuous, with a kink where the approach ends. With other elastic laws :math:`K \sqrt\delta` is the
    secant stiffness. With a power law it delivers :math:`\exp(-\zeta \arccos\zeta / \sqrt{1 - \zeta^2})`,
    :math:`\zeta = 2 \xi / \sqrt{2 (n + 1)}`: with n = 3/2 0.900 for 0.9, 0.495 for 0.5.

    Beside an elastic law that is linear at small depth, or nearly, as the laws with a logarithm are, the
    force jumps at the onset as that of a Kelvin-Voigt contact does.

    References:
        Jankowski (2005), Earthq. Eng. Struct. Dyn. 34, 595-611, and (2006) 35, 517-524 for xi. Recalled, not
        checked against the papers; xi has the slope at c_r = 1 that the exact relation requires.
    """

    kernel = staticmethod(secant_loading)

    @property
    def damping_ratio(self) -> float:
        """Xi [-]."""
        c = self.restitution
        return 4.5 * math.sqrt(5.0) * (1.0 - c * c) / (c * (c * (9.0 * math.pi - 16.0) + 16.0))

    @packed
    def damping(self) -> float:
        """2 xi [-]."""
        return 2.0 * self.damping_ratio


@inlined
def step(
    law: AdamsDamping, elastic: float, depth: float, rate: float, approach_speed: float, mass: float
) -> float:
    """Normal force [N]."""
    x = min(max(depth / law.full_damping_depth, 0.0), 1.0)
    damping = law.damping * x * x * (3.0 - 2.0 * x)
    return max(elastic + damping * rate, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class AdamsDamping(Dissipation):
    r"""The damper of ADAMS' IMPACT function, which grows in with the depth.

    .. math:: f = \max[0,\; f_e + D\, \mathrm{STEP}(\delta; 0, 0, d, 1)\, \dot\delta], \qquad
              \mathrm{STEP} = x^2 (3 - 2 x), \quad x = \min(\delta / d, 1)

    Continuous with its slope at the onset. The restitution depends on mass, speed and stiffness.

    Attributes:
        damping: D, of full damping [N s/m].
        full_damping_depth: d, depth from which on the damping acts in full [m].

    References:
        MSC Adams, function IMPACT.
    """

    adds_force: ClassVar[bool] = True

    kernel = staticmethod(step)

    damping: float = parameter("N*s/m", rule="zero or more")
    full_damping_depth: float = parameter("m", rule="positive")
