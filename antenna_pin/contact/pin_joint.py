r"""Laws of Liu et al. 2013 for a deployable pin joint, and a correction.

The paper measures the load of a pin in a clevis over the displacement, and compares its own law (28) with
Hertz's (6) and with the simplest conformal one (14). Equation numbers are the paper's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.records import packed
from antenna_pin.compiled.decorators import kernel
from antenna_pin.contact.cylinder import LineLaw
from antenna_pin.contact.normal import check_depth, power_energy, power_force


@dataclass(frozen=True, slots=True, kw_only=True)
class LiuHertz(LineLaw):
    r"""Equation (6), "Hertz theory": :math:`F = \tfrac\pi4 E^* L \delta`.

    Linear, without radii. It rests on :math:`a^2 = \delta R` (5), which has no basis for a line contact:
    there the depth depends on a logarithm, as in :class:`antenna_pin.contact.Johnson`.

    References:
        Liu, Zhang, Guo and Deng (2013), J. Aerosp. Technol. Manag. 5(3), 341-348, equation (6).
    """

    kernel = staticmethod(power_force)
    energy = staticmethod(power_energy)
    frequent: ClassVar[bool] = True

    @property
    def stiffness(self) -> float:
        """K of K depth [N/m]."""
        return 0.25 * math.pi * self.modulus * self.length

    @property
    def exponent(self) -> float:
        """Exponent 1 [-]."""
        return 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LiuConformal(LineLaw):
    r"""Equation (14), "conformal model".

    .. math:: F = \tfrac43 E^* \delta^{3/2} \left(\frac{1}{R_j} - \frac{1}{R_i}\right)^{-1/2}

    Steuermann's formulas for bodies of revolution with n = 1, that is Hertz's law for *spheres*, with the
    internal radius. It does not depend on the length, which is checked only; the paper compares it with (6)
    per millimetre. Its column in Table 1 has radii of 0.9 mm, or a slip in the units.

    References:
        Liu, Zhang, Guo and Deng (2013), J. Aerosp. Technol. Manag. 5(3), 341-348, equation (14).
    """

    kernel = staticmethod(power_force)
    energy = staticmethod(power_energy)
    frequent: ClassVar[bool] = True

    @property
    def stiffness(self) -> float:
        """K of K depth^1.5 [N/m^1.5]."""
        radius = self.bearing_radius * self.journal_radius / self.clearance
        return 4.0 / 3.0 * self.modulus * math.sqrt(radius)

    @property
    def exponent(self) -> float:
        """Exponent 3/2 [-]."""
        return 1.5


@kernel
def pin_joint_force(law: _PinJoint, depth: float) -> float:
    """Elastic force [N]; odd in the depth.

    Liu et al. 2013 (24) and (28); a^2 is written so that nothing cancels at small depth.
    """
    journal, bearing, clearance = law.journal_radius, law.bearing_radius, law.clearance
    size = abs(depth)
    d = min(size * law.share, math.sqrt((bearing + journal) * clearance) - clearance)
    s = clearance + d
    inner = 4.0 * bearing * clearance + 2.0 * (bearing + clearance) * d + d * d
    square = d * (2.0 * journal - d) * inner / (4.0 * s * s)
    if square < 1e-300:
        return 0.0
    force = law.factor * size / (math.log(16.0 * journal * journal / square) - 1.0)
    return float(force if depth > 0.0 else -force)


class _PinJoint(LineLaw):
    """Base of (28) and (28'), with different shares of depth in the width."""

    __slots__ = ()

    kernel = staticmethod(pin_joint_force)
    unpacked: ClassVar[tuple[str, ...]] = ("length", "modulus")

    @packed
    def share(self) -> float:
        """Share of the depth that shapes the contact [-]."""
        return 1.0

    @packed
    def factor(self) -> float:
        """Half of pi E* L [N/m]."""
        return 0.5 * math.pi * self.modulus * self.length

    @property
    def depth_limit(self) -> float:
        """Depth of a contact as wide as the pin [m]."""
        sum_of_radii = self.bearing_radius + self.journal_radius
        return (math.sqrt(sum_of_radii * self.clearance) - self.clearance) / self.share

    def half_width(self, depth: float) -> float:
        """Return the half-width a of the contact, (24), at a depth up to ``depth_limit`` [m]."""
        check_depth(self, depth)
        s = self.clearance + self.share * depth
        sum_of_radii = self.bearing_radius + self.journal_radius
        x = 0.5 * (sum_of_radii * self.clearance / s + s)
        return math.sqrt(max(self.bearing_radius**2 - x * x, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class LiuPinJoint(_PinJoint):
    r"""Equation (28), the paper's new law.

    .. math:: F = \frac{\pi E L \delta}{4 (1 - \nu^2)}\, \frac{1}{2 \ln(4 R_j / a) - 1}, \qquad
              a^2 = R_i^2 - \frac14 \left(\frac{R_i^2 - R_j^2}{\delta + \Delta R} + \delta + \Delta R\right)^2

    With :math:`E / (1 - \nu^2) = 2 E^*`, for a pair of one material. The text mixes a prefactor (26), (27) of
    two contacts in series with a width (24) of one; here the depth given is put into both
    (:class:`LiuPinJointCorrected` mends it).

    References:
        Liu, Zhang, Guo and Deng (2013), J. Aerosp. Technol. Manag. 5(3), 341-348, equations (24), (28).
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class LiuPinJointCorrected(_PinJoint):
    r"""Equation (28) with half the depth in the width of the contact: (28').

    .. math:: F = \frac{\pi E^* L \delta}{2}\, \frac{1}{2 \ln(4 R_j / a) - 1}, \qquad
              a^2 = R_i^2 - \frac14 \left(\frac{R_i^2 - R_j^2}{s} + s\right)^2, \quad
              s = \Delta R + \frac\delta2

    The depth is that of two equal contacts in series, each pressed in by half of it, which is what (24) makes
    the width from. It fits the paper's measurements better than (28).

    References:
        Liu, Zhang, Guo and Deng (2013), J. Aerosp. Technol. Manag. 5(3), 341-348; the correction is this
        project's.
    """

    @packed
    def share(self) -> float:
        """Half of the depth, that of each of both contacts [-]."""
        return 0.5
