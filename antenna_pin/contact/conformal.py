r"""Conformal contact of a journal in a bore: the patch is an arc of the bore.

The laws of :mod:`antenna_pin.contact.cylinder` need a patch that is narrow against the play. With little play
it is not: the journal, pressed in by :math:`\delta`, overlaps the bore over the arc of half-angle
:math:`\varepsilon`

.. math:: \cos\varepsilon = \frac{\Delta R}{\Delta R + \delta}, \qquad
          \tan^2\frac\varepsilon2 = \frac{\delta}{2 \Delta R + \delta}

and the load grows with the arc. All of these give the force over the depth explicitly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.contact.cylinder import LineLaw
from antenna_pin.contact.normal import elastic_code
from antenna_pin.contact.records import BAI_ZHAO, FOUNDATION, PERSSON, POWER
from antenna_pin.errors import InvalidParameterError

BAI_ZHAO_EXPONENT = {"unit": "1", "doc": "n of K_n depth^n, 1 or 1.5"}

__all__ = ["BaiZhaoElastic", "LiuFoundation", "Pereira", "Persson"]


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

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        factor = 0.5 * math.pi / math.sqrt(2.0) * self.modulus * self.length
        return elastic_code(FOUNDATION, factor=factor, clearance=self.clearance)


@dataclass(frozen=True, slots=True, kw_only=True)
class BaiZhaoElastic(LineLaw):
    r"""The elastic part of Bai and Zhao's hybrid law: a stiffness that depends on the depth.

    .. math:: F = L K_n \delta^n, \qquad K_n = \frac{\pi E^*}{8}
              \sqrt{\frac{2 \delta\, [3 \Delta R + 2 \delta]^2}{(\Delta R + \delta)^3}}

    K_n is the tangent stiffness dF/d delta per length of :class:`LiuFoundation`, used as a secant: with n =
    1, which the units ask for, the force is 1.5 times Liu's at small depth. With n = 3/2, as the paper
    suggests, the units do not agree; numbers are SI.

    Attributes:
        exponent: n, 1 or 1.5 [-].

    References:
        Bai and Zhao (2012), Int. J. Mech. Sci. 54, 190-205, and (2013), Int. J. Non-Linear Mech. 48, 15-36.
        Formula recalled, not checked against the papers; that K_n is Liu's tangent stiffness is checked in
        the tests.
    """

    exponent: float = field(default=1.0, metadata=BAI_ZHAO_EXPONENT)

    @classmethod
    def check(cls, law: Any) -> None:
        """Refuse what makes no such law."""
        LineLaw.check(law)
        if law.exponent not in (1.0, 1.5):
            raise InvalidParameterError(law, "exponent", "1 or 1.5")

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        factor = math.pi / 8.0 * math.sqrt(2.0) * self.modulus * self.length
        return elastic_code(BAI_ZHAO, factor=factor, clearance=self.clearance, exponent=self.exponent)


def _largest_square() -> float:
    """Return b^2 at which Persson's load is infinite: the root of 2 - ln(1 + b^2) - 2 b^4."""
    square = 0.8
    for _ in range(20):
        value = 2.0 - math.log1p(square) - 2.0 * square**2
        square -= value / (-1.0 / (1.0 + square) - 4.0 * square)
    return square


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

    @property
    def depth_limit(self) -> float:
        """Depth at which the arc is the largest that the law is evaluated at [m]."""
        square = 0.99 * _largest_square()
        return 2.0 * self.clearance * square / (1.0 - square)

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        factor = 2.0 * math.pi * self.modulus * self.length * self.clearance
        root = _largest_square()
        return elastic_code(PERSSON, factor=factor, clearance=self.clearance, largest=0.99 * root, root=root)


@dataclass(frozen=True, slots=True, kw_only=True)
class Pereira(LineLaw):
    r"""Pereira et al.'s fit of a power law to the laws with a logarithm, for a journal in a bore.

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

    @classmethod
    def check(cls, law: Any) -> None:
        """Refuse what makes no such law."""
        LineLaw.check(law)
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

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        return elastic_code(POWER, stiffness=self.stiffness, exponent=self.exponent)
