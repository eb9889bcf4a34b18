r"""The point laws of the literature as a whole: a spring with a dissipation, by their authors' names.

Each is short for a :class:`antenna_pin.contact.DampedContact` of :class:`antenna_pin.contact.Hertz` and the
damping of the same name, whose docstring has the formula, where it holds, and the source.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from antenna_pin.contact import conformal as _conformal
from antenna_pin.contact import cylinder as _cylinder
from antenna_pin.contact import damping as _damping
from antenna_pin.contact import hysteresis as _hysteresis
from antenna_pin.contact.normal import (
    EXPONENT,
    RESTITUTION,
    STIFFNESS,
    CompiledNormalLaw,
    DampedContact,
    Dissipation,
    Hertz,
)

__all__ = [
    "AdamsImpact",
    "BaiZhao",
    "CarvalhoMartins",
    "ExactRestitution",
    "Flores",
    "GharibHurmuzlu",
    "Gonthier",
    "HerbertMcWhannell",
    "HuGuo",
    "HuntCrossley",
    "Jankowski",
    "KelvinVoigt",
    "KuwabaraKono",
    "LankaraniNikravesh",
    "LeeWang",
    "MarhefkaOrin",
    "PantWijeyewickrema",
    "PowerLaw",
    "RestitutionLaw",
    "Tsuji",
    "Ye",
    "ZhiyingQishao",
]


class PowerLaw(CompiledNormalLaw):
    """Base: a power of the depth, with the dissipation that the class names.

    Attributes:
        stiffness: K [N/m^n].
        exponent: n [-]; 3/2 for Hertz contact.
    """

    __slots__ = ()

    dissipation: ClassVar[type[Dissipation]]
    stiffness: float
    exponent: float

    def __post_init__(self) -> None:
        """Check the parameters."""
        Hertz.check(self)
        self.dissipation.check(self)

    @property
    def parts(self) -> DampedContact:
        """The law as its two parts."""
        names = [item.name for item in dataclasses.fields(self.dissipation)]  # type: ignore[arg-type]
        return DampedContact(
            elastic=Hertz(stiffness=self.stiffness, exponent=self.exponent),
            dissipation=self.dissipation(**{name: getattr(self, name) for name in names}),
        )

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        return self.parts.code()


@dataclass(frozen=True, slots=True, kw_only=True)
class RestitutionLaw(PowerLaw):
    """Base: a power of the depth, with a hysteresis damping set by the restitution.

    Attributes:
        stiffness: K [N/m^n].
        restitution: c_r, the coefficient of restitution asked for [-].
        exponent: n [-]; 3/2 for Hertz contact.
    """

    stiffness: float = field(metadata=STIFFNESS)
    restitution: float = field(metadata=RESTITUTION)
    exponent: float = field(default=1.5, metadata=EXPONENT)

    @property
    def hysteresis(self) -> float:
        """Hysteresis damping factor chi of ``1 + chi rate / approach_speed`` [-]."""
        dissipation = self.parts.dissipation
        assert isinstance(dissipation, _hysteresis.HysteresisDamping)
        return dissipation.hysteresis


@dataclass(frozen=True, slots=True, kw_only=True)
class LankaraniNikravesh(RestitutionLaw):
    r"""Hertzian spring with hysteresis damping set by the restitution.

    .. math:: f = K \delta^n \left[1 + \tfrac34 (1 - c_r^2)\,
              \dot\delta / \dot\delta_0\right], \quad f \ge 0

    Derived for restitution near 1: asked 0.9 it yields 0.913, asked 0.5, 0.73. A law of this form delivers
    the restitution :math:`c` that solves :math:`\chi (1 + c) = \ln[(1 + \chi) / (1 - \chi c)]`,
    :math:`\chi = \tfrac34 (1 - c_r^2)`, whatever the mass, the stiffness, the exponent and the speed.

    Attributes:
        stiffness: K [N/m^n].
        restitution: c_r, in [0, 1] [-].
        exponent: n [-]; 3/2 for Hertz contact.

    References:
        Lankarani and Nikravesh (1990), J. Mech. Des. 112(3), 369-376.
    """

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.LankaraniNikraveshDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class ExactRestitution(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.ExactDamping`: it delivers what is asked for."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.ExactDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class HuntCrossley(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.HuntCrossleyDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.HuntCrossleyDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class HerbertMcWhannell(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.HerbertMcWhannellDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.HerbertMcWhannellDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class LeeWang(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.LeeWangDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.LeeWangDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class Gonthier(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.GonthierDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.GonthierDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class ZhiyingQishao(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.ZhiyingQishaoDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.ZhiyingQishaoDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class Flores(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.FloresDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.FloresDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class GharibHurmuzlu(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.GharibHurmuzluDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.GharibHurmuzluDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class HuGuo(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.HuGuoDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.HuGuoDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class CarvalhoMartins(RestitutionLaw):
    """Hertzian spring with :class:`antenna_pin.contact.CarvalhoMartinsDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.CarvalhoMartinsDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class Ye(RestitutionLaw):
    """Linear spring with :class:`antenna_pin.contact.YeDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.YeDamping

    exponent: float = field(default=1.0, metadata=EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class PantWijeyewickrema(RestitutionLaw):
    """Linear spring with :class:`antenna_pin.contact.PantWijeyewickremaDamping`."""

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.PantWijeyewickremaDamping

    exponent: float = field(default=1.0, metadata=EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class MarhefkaOrin(PowerLaw):
    """Hertzian spring with :class:`antenna_pin.contact.MarhefkaOrinDamping`.

    Attributes:
        stiffness: K [N/m^n].
        exponent: n [-].
        slope: alpha, loss of restitution over impact speed [s/m].
    """

    dissipation: ClassVar[type[Dissipation]] = _hysteresis.MarhefkaOrinDamping

    stiffness: float = field(metadata=STIFFNESS)
    slope: float = field(metadata=_hysteresis.SLOPE)
    exponent: float = field(default=1.5, metadata=EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class KelvinVoigt(PowerLaw):
    """Linear spring with :class:`antenna_pin.contact.KelvinVoigtDamping`.

    Attributes:
        stiffness: K [N/m^n].
        exponent: n [-].
        damping: D [N s/m].
    """

    dissipation: ClassVar[type[Dissipation]] = _damping.KelvinVoigtDamping

    stiffness: float = field(metadata=STIFFNESS)
    damping: float = field(metadata=_damping.DAMPING)
    exponent: float = field(default=1.0, metadata=EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class KuwabaraKono(PowerLaw):
    """Hertzian spring with :class:`antenna_pin.contact.KuwabaraKonoDamping`.

    Attributes:
        stiffness: K [N/m^n].
        exponent: n [-].
        damping: c [N s/m^1.5].
    """

    dissipation: ClassVar[type[Dissipation]] = _damping.KuwabaraKonoDamping

    stiffness: float = field(metadata=STIFFNESS)
    damping: float = field(metadata=_damping.ROOT_DAMPING)
    exponent: float = field(default=1.5, metadata=EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tsuji(PowerLaw):
    """Hertzian spring with :class:`antenna_pin.contact.TsujiDamping`.

    Attributes:
        stiffness: K [N/m^n].
        exponent: n [-].
        restitution: c_r, the coefficient of restitution asked for [-].
        effective_mass: m [kg]; None for that of the contact, taken at its onset.
    """

    dissipation: ClassVar[type[Dissipation]] = _damping.TsujiDamping

    stiffness: float = field(metadata=STIFFNESS)
    restitution: float = field(metadata=RESTITUTION)
    effective_mass: float | None = field(default=None, metadata=_damping.EFFECTIVE_MASS)
    exponent: float = field(default=1.5, metadata=EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class Jankowski(PowerLaw):
    """Hertzian spring with :class:`antenna_pin.contact.JankowskiDamping`.

    Attributes:
        stiffness: K [N/m^n].
        exponent: n [-].
        restitution: c_r, the coefficient of restitution asked for [-].
        effective_mass: m [kg]; None for that of the contact, taken at its onset.
    """

    dissipation: ClassVar[type[Dissipation]] = _damping.JankowskiDamping

    stiffness: float = field(metadata=STIFFNESS)
    restitution: float = field(metadata=RESTITUTION)
    effective_mass: float | None = field(default=None, metadata=_damping.EFFECTIVE_MASS)
    exponent: float = field(default=1.5, metadata=EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class AdamsImpact(PowerLaw):
    """ADAMS' IMPACT function: a spring with :class:`antenna_pin.contact.AdamsDamping`.

    Attributes:
        stiffness: K [N/m^n].
        exponent: n [-].
        damping: D, of full damping [N s/m].
        full_damping_depth: d, depth from which on it acts in full [m].
    """

    dissipation: ClassVar[type[Dissipation]] = _damping.AdamsDamping

    stiffness: float = field(metadata=STIFFNESS)
    damping: float = field(metadata=_damping.DAMPING)
    full_damping_depth: float = field(metadata=_damping.FULL_DAMPING_DEPTH)
    exponent: float = field(default=1.5, metadata=EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class BaiZhao(CompiledNormalLaw):
    r"""Bai and Zhao's hybrid law: their depth-dependent stiffness with a damping set by the restitution.

    .. math:: F = L K_n \delta^n \left[1 + \tfrac34 (1 - c_r^2)\, e^{2 (1 - c_r)}\,
              \dot\delta / \dot\delta_0\right], \quad F \ge 0

    with the K_n of :class:`antenna_pin.contact.BaiZhaoElastic` and the factor of
    :class:`antenna_pin.contact.ZhiyingQishaoDamping`: asked 0.9 it delivers 0.896.

    Attributes:
        length: L, of the line along which they touch [m].
        journal_radius: R_j [m].
        bearing_radius: R_i, above R_j [m].
        modulus: E*, plane-strain contact modulus of the pair [Pa].
        restitution: c_r, in [0, 1] [-].
        exponent: n, 1 or 1.5 [-].

    References:
        Bai and Zhao (2012), Int. J. Mech. Sci. 54, 190-205, and (2013), Int. J. Non-Linear Mech. 48, 15-36.
        Recalled, not checked against the papers.
    """

    length: float = field(metadata=_cylinder.LENGTH)
    journal_radius: float = field(metadata=_cylinder.JOURNAL_RADIUS)
    bearing_radius: float = field(metadata=_cylinder.BEARING_RADIUS)
    modulus: float = field(metadata=_cylinder.MODULUS)
    restitution: float = field(metadata=RESTITUTION)
    exponent: float = field(default=1.0, metadata=_conformal.BAI_ZHAO_EXPONENT)

    def __post_init__(self) -> None:
        """Check the parameters."""
        _conformal.BaiZhaoElastic.check(self)
        _hysteresis.ZhiyingQishaoDamping.check(self)

    @property
    def parts(self) -> DampedContact:
        """The law as its two parts."""
        return DampedContact(
            elastic=_conformal.BaiZhaoElastic(
                length=self.length,
                journal_radius=self.journal_radius,
                bearing_radius=self.bearing_radius,
                modulus=self.modulus,
                exponent=self.exponent,
            ),
            dissipation=_hysteresis.ZhiyingQishaoDamping(restitution=self.restitution),
        )

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        return self.parts.code()
