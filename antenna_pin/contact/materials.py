"""Bearing materials and pairs of them: elastic constants, strength, expansion, restitution, friction.

The tables are short on purpose, and every entry says where it comes from. Elastic constants of one alloy
differ by a few per cent between sources; restitution and friction are no constants of a pair at all (they
change with speed, finish, film and vacuum), so that their numbers are a place to start from. A scenario
brings its own materials under ``[materials.NAME]``. Strengths depend on the heat treatment, which each
source names; a material whose name says none (steel, bronze, brass) has none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Annotated

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.material import Material
from antenna_pin.base.rules import NumberRule, Positive
from antenna_pin.errors import InvalidParameterError

__all__ = [
    "annular_punch_factor",
    "effective_modulus",
    "hertz_stiffness",
    "internal_hertz_stiffness",
    "point_stiffness",
    "Material",
    "MATERIAL_PAIRS",
    "material_pairs",
    "MaterialPair",
    "MATERIALS",
]


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class MaterialPair:
    """Typical restitution and friction of two materials; NaN where unknown.

    Attributes:
        first: Name of a material.
        second: Name of a material.
        condition: Of the surfaces.
        source: Source of the numbers.
        restitution: Coefficient of restitution [-].
        static: Coefficient of static friction [-].
        dynamic: Coefficient of dynamic friction [-].
    """

    first: str
    second: str
    condition: str
    source: str
    restitution: float = math.nan
    static: float = math.nan
    dynamic: float = math.nan

    def __post_init__(self) -> None:
        """Check what is given."""
        if self.restitution < 0.0 or self.restitution > 1.0:
            raise InvalidParameterError(self, "restitution", "in [0, 1]")
        for name in ("static", "dynamic"):
            if getattr(self, name) < 0.0:
                raise InvalidParameterError(self, name, "zero or more")


_DELFT = "table of the course AEASM1x, Introduction to Aerospace Structures and Materials, TU Delft"
_CALLISTER = "Callister, Fundamentals of Materials Science and Engineering, appendix B"
_ROLLED = "Rolled Alloys, data sheet of 440C: hardened from 1900 degF, tempered at 600 degF"
# Pascals of a Brinell or Vickers number, a load in kilogram-force over an area in square millimetres.
_KGF_MM2 = 9.80665e6

MATERIALS: Mapping[str, Material] = MappingProxyType(
    {
        "steel": Material(
            young=207e9,
            poisson=0.3,
            density=7800.0,
            source="assumed: usual in the literature on clearance joints; Bai and Zhao 2020 give none",
            expansion=11.7e-6,
            expansion_source=f"{_CALLISTER}.6: AISI 1020",
        ),
        "steel-52100": Material(
            young=203e9,
            poisson=0.3,
            density=7830.0,
            source="data sheet of AISI 52100 bearing balls (29.5e6 psi, 0.283 lb/in^3); poisson assumed",
            expansion=11.9e-6,
            expansion_source="not verified: as often printed for AISI 52100",
        ),
        "steel-440c": Material(
            young=200e9,
            poisson=0.28,
            density=7700.0,
            source="makeitfrom.com, annealed AISI 440C; 7650 kg/m^3 elsewhere",
            yield_strength=1896e6,
            ultimate_strength=1965e6,
            strength_source=f"{_ROLLED} (275 and 285 ksi); 450 and 710 MPa annealed, makeitfrom.com",
            hardness=580.0 * _KGF_MM2,
            hardness_source=f"{_ROLLED} (580 HB)",
            expansion=10.2e-6,
            expansion_source=f"{_CALLISTER}.6: of 440A; 5.6e-6 per degF in the data sheet of Rolled Alloys",
        ),
        "steel-301": Material(young=193e9, poisson=0.3, density=8000.0, source=f"{_DELFT}, AISI 301"),
        "aluminium-2024-t3": Material(
            young=72e9,
            poisson=0.33,
            density=2780.0,
            source=f"{_DELFT}, AA 2024-T3",
            yield_strength=345e6,
            ultimate_strength=485e6,
            strength_source=f"{_CALLISTER}.4: alloy 2024, T3",
            hardness=120.0 * _KGF_MM2,
            hardness_source="Metals Handbook, desk edition: 2024-T3, 120 HB with 500 kgf",
            expansion=22.9e-6,
            expansion_source=f"{_CALLISTER}.6: alloy 2024",
        ),
        "aluminium-7075-t6": Material(
            young=71e9,
            poisson=0.33,
            density=2800.0,
            source=f"{_CALLISTER}.2: alloy 7075; 72 GPa elsewhere",
            yield_strength=505e6,
            ultimate_strength=572e6,
            strength_source=f"{_CALLISTER}.4: alloy 7075, T6; 503 MPa elsewhere",
            hardness=150.0 * _KGF_MM2,
            hardness_source="data sheets of 7075-T6: 150 HB with 500 kgf, typical",
            expansion=23.4e-6,
            expansion_source=f"{_CALLISTER}.6: alloy 7075; 23.6e-6 elsewhere",
        ),
        "titanium-6al-4v": Material(
            young=114e9,
            poisson=0.34,
            density=4430.0,
            source=f"{_DELFT}, Ti6Al-4V",
            yield_strength=827e6,
            ultimate_strength=896e6,
            strength_source=f"{_CALLISTER}.4: annealed, the least, 120 and 130 ksi",
            expansion=8.6e-6,
            expansion_source=f"{_CALLISTER}.6: Ti-6Al-4V",
        ),
        "brass": Material(
            young=101e9,
            poisson=0.35,
            density=8490.0,
            source="Dowling, Mechanical Behavior of Materials, table 5.2 (70Cu-30Zn); density: middle of the "
            "520 to 540 lb/ft^3 of Gere, Mechanics of Materials",
            expansion=19.9e-6,
            expansion_source=f"{_CALLISTER}.6: cartridge brass, C26000; from 20 to 300 degC",
        ),
        "bronze": Material(
            young=104e9,
            poisson=0.34,
            density=8490.0,
            source="Gere, Mechanics of Materials: 96 to 120 GPa, 510 to 550 lb/ft^3, a middle taken; 104 GPa "
            "in teaching tables",
            expansion=18.0e-6,
            expansion_source=f"{_CALLISTER}.6: bearing bronze C93200",
        ),
        "bronze-c93200": Material(
            young=100e9,
            poisson=0.34,
            density=8930.0,
            source="azom.com, article 6294: bearing bronze UNS C93200, SAE 660",
            yield_strength=125e6,
            ultimate_strength=240e6,
            strength_source=f"{_CALLISTER}.4: sand cast; yield at 0.5 % of strain",
            hardness=65.0 * _KGF_MM2,
            hardness_source="azom.com, article 6294 (65 HB)",
            expansion=18.0e-6,
            expansion_source=f"{_CALLISTER}.6: bearing bronze C93200",
        ),
        "silicon-nitride": Material(
            young=310e9,
            poisson=0.27,
            density=3290.0,
            source="Lily Bearing, ceramic materials and their properties, HP-Si3N4",
            expansion=2.7e-6,
            expansion_source=f"{_CALLISTER}.6: silicon nitride, hot pressed",
        ),
        "nylon-66": Material(
            young=2.7e9,
            poisson=0.41,
            density=1130.0,
            source="Dowling, Mechanical Behavior of Materials, table 5.2 (dry); density: middle of 1.10 to "
            "1.15 g/cm^3, finemech.com",
            expansion=144e-6,
            expansion_source=f"{_CALLISTER}.6: nylon 6,6",
        ),
    }
)

_TRIBONET = "tribonet.org, friction coefficient tables in air and vacuum"

MATERIAL_PAIRS: tuple[MaterialPair, ...] = (
    MaterialPair(
        first="steel",
        second="steel",
        condition="as simulated in the literature on clearance joints",
        restitution=0.9,
        static=0.15,
        dynamic=0.10,
        source="Bai and Zhao 2020, Int. J. Aerospace Eng. 8846177, table 2",
    ),
    MaterialPair(
        first="steel-52100",
        second="steel-52100",
        condition="dry, in air and in vacuum",
        dynamic=0.5,
        source=f"{_TRIBONET}: chromium steel",
    ),
    MaterialPair(
        first="steel-52100",
        second="steel-52100",
        condition="film of MoS2, in vacuum",
        dynamic=0.06,
        source=f"{_TRIBONET}: chromium steel on MoS2",
    ),
    MaterialPair(
        first="steel-301",
        second="steel-301",
        condition="dry, in air",
        dynamic=0.5,
        source=f"{_TRIBONET}: stainless steel",
    ),
    MaterialPair(
        first="steel-301",
        second="steel-301",
        condition="dry, in vacuum",
        dynamic=2.9,
        source=f"{_TRIBONET}: stainless steel; it seizes",
    ),
    MaterialPair(
        first="steel",
        second="bronze",
        condition="dry, in air",
        static=0.35,
        source=f"{_TRIBONET}: steel on phosphor bronze",
    ),
    MaterialPair(
        first="steel",
        second="brass",
        condition="dry, in air",
        static=0.35,
        source=f"{_TRIBONET}: steel on brass; 0.51 for mild steel",
    ),
    MaterialPair(
        first="steel",
        second="aluminium-2024-t3",
        condition="dry, in air",
        static=0.61,
        dynamic=0.47,
        source="A. J. DeMello, coefficient of friction tables, Lawrence Berkeley National Laboratory: mild "
        "steel on aluminium",
    ),
)


@takes()
def material_pairs(first: str, second: str) -> tuple[MaterialPair, ...]:
    """Return the pairs of two materials, by name in either order."""
    return tuple(pair for pair in MATERIAL_PAIRS if {pair.first, pair.second} == {first, second})


# --- stiffness of a pair of bodies --------------------------------------------------------------------------
#
# .. math:: \frac1{E^*} = \frac{1 - \nu_1^2}{E_1} + \frac{1 - \nu_2^2}{E_2}, \qquad
#           K = \tfrac43 E^* \sqrt R
#
# with :math:`R = R_i R_j / (R_i - R_j)` for a journal inside a bore (internal contact). Papers often print
# the external form :math:`R_i R_j / (R_i + R_j)`, which for a bearing of 10 mm with 0.2 mm of play is 9.95
# times softer.


@takes()
def effective_modulus(first: Material, second: Material) -> float:
    """Return the plane-strain contact modulus E* of two materials [Pa]."""
    return 1.0 / ((1.0 - first.poisson**2) / first.young + (1.0 - second.poisson**2) / second.young)


@takes(bearing_radius="m", journal_radius="m")
def hertz_stiffness(
    bearing_radius: float, journal_radius: float, bearing: Material, journal: Material
) -> float:
    """Return K of ``K depth^1.5`` for a journal inside a bore [N/m^1.5].

    Args:
        bearing_radius: R_i [m].
        journal_radius: R_j [m], below R_i.
        bearing: Material of the bearing.
        journal: Material of the journal.
    """
    return internal_hertz_stiffness(bearing_radius, journal_radius, effective_modulus(bearing, journal))


@takes(bearing_radius="m", journal_radius="m", modulus="Pa")
def internal_hertz_stiffness(bearing_radius: float, journal_radius: float, modulus: float) -> float:
    """Return K of ``K depth^1.5`` for a journal inside a bore [N/m^1.5].

    Args:
        bearing_radius: R_i [m].
        journal_radius: R_j [m], below R_i.
        modulus: E* of the pair [Pa].
    """
    if not 0.0 < journal_radius < bearing_radius:
        raise InvalidParameterError(
            "hertz_stiffness", "journal_radius", f"in (0, {bearing_radius}) [m]", journal_radius
        )
    return point_stiffness(bearing_radius * journal_radius / (bearing_radius - journal_radius), modulus)


@takes(radius="m", modulus="Pa")
def point_stiffness(radius: Positive, modulus: Positive) -> float:
    r"""Return K of ``K depth^1.5`` for an effective radius of curvature [N/m^1.5].

    Hertz's for spheres, :math:`K = \tfrac43 E^* \sqrt{R}`.

    Args:
        radius: R: of two convex spheres 1/R = 1/R_1 + 1/R_2, of one in a hollow 1/R = 1/R_j - 1/R_i [m].
        modulus: E* of the pair [Pa].
    """
    return 4.0 / 3.0 * modulus * math.sqrt(radius)


# --- flange pressed flat on an end face ---------------------------------------------------------------------
#
# A flat ring, :math:`R_i \le r \le R_o`, is pressed without friction and without tilt on an elastic
# half-space. By how much it sinks in, and the load, are proportional:
#
# .. math:: P = \kappa(\lambda)\, 2 E^* R_o\, \delta, \qquad \lambda = R_i / R_o
#
# with :math:`\kappa = 1` for the full disc (Boussinesq). The factor hardly falls as the disc is bored open,
# since the pressure is high along the edges: 0.98 for :math:`\lambda` = 0.5, 0.88 for 0.83, 0.75 for 0.95.

_NODES = 64


@takes()
def annular_punch_factor(ratio: Annotated[float, NumberRule("in [0, 1)")]) -> float:
    r"""Return :math:`\kappa` of :math:`P = \kappa\, 2 E^* R_o \delta`, of a flat ring [-].

    Boussinesq's potential of a pressure p, integrated around the axis, makes the condition of a flat punch

    .. math:: \delta = \frac{4}{\pi E^*} \int_{R_i}^{R_o} \frac{p(s)\, s}{r + s}\, K(m)\, ds, \qquad
              1 - m = m_1 = \left(\frac{r - s}{r + s}\right)^2

    with the complete elliptic integral K. The pressure is infinite as an inverse square root at both edges:
    with :math:`s = c + h \cos\varphi` over the ring, :math:`\sigma = p\, s\, h \sin\varphi` is smooth, even
    and periodic. The kernel's singularity is :math:`K(m) = A(m_1) - \tfrac1\pi K(m_1) \ln m_1` with a smooth
    A, and its logarithm

    .. math:: \ln|\cos\varphi - \cos\varphi'| = -\ln 2 - \sum_{k \ge 1} \tfrac2k \cos k\varphi \cos k\varphi'

    is integrated exactly against the interpolant of the rest in the Chebyshev points, where the equation is
    fulfilled (a product rule as Kress's). The error falls exponentially with the number of points; with the
    64 taken it is that of round-off, and 1e-12 still for a hole of a thousandth of the radius.

    Args:
        ratio: R_i / R_o, from 0 to below 1 [-].

    References:
        Derived here; the problem is that of Gubenko and Mossakovskii (1960), J. Appl. Math. Mech. 24, Collins
        (1963), Proc. Edinb. Math. Soc. 13, and Gladwell (1980), Contact Problems in the Classical Theory of
        Elasticity: recalled, not checked. The tests check both limits:
        :math:`1 - \tfrac{4}{3 \pi^2} \lambda^3 - \tfrac{8}{15 \pi^2} \lambda^5` for a small hole, and
        :math:`\pi^2 (1 + \lambda) / (4 \ln[16 (1 + \lambda) / (1 - \lambda)])` for a narrow ring.
    """
    return _factor(float(ratio), _NODES)


@lru_cache(maxsize=64)
def _factor(ratio: float, nodes: int) -> float:
    """Return the factor by collocation in a number of nodes."""
    from scipy.special import ellipk, ellipkm1

    if ratio == 0.0:
        return 1.0
    centre, half = 0.5 * (1.0 + ratio), 0.5 * (1.0 - ratio)
    angles = (np.arange(nodes) + 0.5) * math.pi / nodes
    s = centre + half * np.cos(angles)
    total = s[:, None] + s[None, :]
    difference = np.abs(half * (np.cos(angles)[:, None] - np.cos(angles)[None, :]))
    np.fill_diagonal(difference, 1.0)  # of no effect: there the limit stands
    m1 = (difference / total) ** 2
    smooth = ellipkm1(m1) + ellipk(m1) / math.pi * np.log(m1)
    np.fill_diagonal(m1, 0.0)
    np.fill_diagonal(smooth, math.log(4.0))
    over_pi = ellipk(m1) / math.pi
    # ln m_1 = 2 ln|cos - cos'| + 2 ln(h / (r + s)), its first part by the series.
    k = np.arange(1, nodes)
    cosines = np.cos(np.outer(angles, k))
    logarithm = -math.log(2.0) - (cosines * (2.0 / k)) @ cosines.T
    kernel = smooth - 2.0 * over_pi * (logarithm + np.log(half / total))
    weight = math.pi / nodes
    density = np.linalg.solve(4.0 / math.pi * weight * kernel / total, np.ones(nodes))
    return float(math.pi * weight * density.sum())  # 2 pi times the integral of p s, over 2 E* R_o delta
