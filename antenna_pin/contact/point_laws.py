r"""The laws of the literature as a whole: an elastic law with the dissipation of its authors, by their name.

Each is short for a :class:`antenna_pin.contact.DampedContact` of the two, which a row of ``ALIASES`` names;
its parameters are theirs. The docstring of the dissipation has the formula, where it holds, and the source.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from antenna_pin.contact import conformal, damping, hysteresis, proportional
from antenna_pin.contact.normal import CompiledNormalLaw, DampedContact, Dissipation, ElasticLaw, Hertz

__all__ = [
    "ALIASES",
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
    "Tsuji",
    "Ye",
    "ZhiyingQishao",
    "Alias",
    "WHOLE_LAWS",
    "WholeLaw",
]


@dataclass(frozen=True, slots=True)
class Alias:
    """A law as a whole, by name.

    Attributes:
        name: In a scenario.
        title: Name of its class.
        elastic: Its elastic law.
        dissipation: What it dissipates with.
        defaults: Of its parameters, where they are not those of the parts.
    """

    name: str
    title: str
    elastic: type[ElasticLaw]
    dissipation: type[Dissipation]
    defaults: Mapping[str, float] = field(default_factory=dict)


_LINEAR = {"exponent": 1.0}

ALIASES = (
    Alias("lankarani-nikravesh", "LankaraniNikravesh", Hertz, hysteresis.LankaraniNikraveshDamping),
    Alias("exact-restitution", "ExactRestitution", Hertz, hysteresis.ExactDamping),
    Alias("hunt-crossley", "HuntCrossley", Hertz, hysteresis.HuntCrossleyDamping),
    Alias("herbert-mcwhannell", "HerbertMcWhannell", Hertz, hysteresis.HerbertMcWhannellDamping),
    Alias("lee-wang", "LeeWang", Hertz, hysteresis.LeeWangDamping),
    Alias("marhefka-orin", "MarhefkaOrin", Hertz, proportional.MarhefkaOrinDamping),
    Alias("gonthier", "Gonthier", Hertz, hysteresis.GonthierDamping),
    Alias("zhiying-qishao", "ZhiyingQishao", Hertz, hysteresis.ZhiyingQishaoDamping),
    Alias("ye", "Ye", Hertz, hysteresis.YeDamping, _LINEAR),
    Alias("flores", "Flores", Hertz, hysteresis.FloresDamping),
    Alias("gharib-hurmuzlu", "GharibHurmuzlu", Hertz, hysteresis.GharibHurmuzluDamping),
    Alias(
        "pant-wijeyewickrema",
        "PantWijeyewickrema",
        Hertz,
        hysteresis.PantWijeyewickremaDamping,
        _LINEAR,
    ),
    Alias("hu-guo", "HuGuo", Hertz, hysteresis.HuGuoDamping),
    Alias("carvalho-martins", "CarvalhoMartins", Hertz, hysteresis.CarvalhoMartinsDamping),
    Alias("kelvin-voigt", "KelvinVoigt", Hertz, damping.KelvinVoigtDamping, _LINEAR),
    Alias("kuwabara-kono", "KuwabaraKono", Hertz, damping.KuwabaraKonoDamping),
    Alias("tsuji", "Tsuji", Hertz, damping.TsujiDamping),
    Alias("jankowski", "Jankowski", Hertz, damping.JankowskiDamping),
    Alias("adams-impact", "AdamsImpact", Hertz, damping.AdamsDamping),
    Alias("bai-zhao", "BaiZhao", conformal.BaiZhaoElastic, hysteresis.ZhiyingQishaoDamping),
)


@functools.lru_cache(maxsize=256)
def _parts_of(law: WholeLaw) -> DampedContact:
    """Return a law as its two parts, which are asked for at every turn and do not change."""

    def part(cls: Any) -> Any:
        return cls(**{item.name: getattr(law, item.name) for item in dataclasses.fields(cls)})

    return DampedContact(elastic=part(law.elastic), dissipation=part(law.dissipation))


class WholeLaw(CompiledNormalLaw):
    """Base: an elastic law with the dissipation that the class names, and the parameters of both."""

    __slots__ = ()

    elastic: ClassVar[type[ElasticLaw]]
    dissipation: ClassVar[type[Dissipation]]

    def __post_init__(self) -> None:
        """Check the parameters."""
        self.elastic.check(self)
        self.dissipation.check(self)

    @property
    def parts(self) -> DampedContact:
        """The law as its two parts."""
        return _parts_of(self)

    def code(self) -> NDArray[np.float64]:
        """Return the law as flat numbers, shape (16,)."""
        return self.parts.code()


class RestitutionLaw(WholeLaw):
    """Base: one whose hysteresis damping is set by the restitution."""

    __slots__ = ()

    @property
    def hysteresis(self) -> float:
        """Hysteresis damping factor chi of ``1 + chi rate / approach_speed`` [-]."""
        dissipation = self.parts.dissipation
        assert isinstance(dissipation, hysteresis.HysteresisDamping)
        return dissipation.hysteresis


def _class_of(alias: Alias) -> type[Any]:
    """Return the class of a law as a whole: what its parts require, then what has a default."""
    parts: tuple[Any, Any] = (alias.elastic, alias.dissipation)
    fields = []
    for item in (*dataclasses.fields(parts[0]), *dataclasses.fields(parts[1])):
        default = alias.defaults.get(item.name, item.default)
        fields.append((item.name, item.type, field(default=default, metadata=item.metadata)))
    fields.sort(key=lambda made: made[0] == "exponent")  # last, as it has a default
    of_restitution = issubclass(alias.dissipation, hysteresis.HysteresisDamping)
    spring = f":class:`antenna_pin.contact.{alias.elastic.__name__}`"
    if alias.elastic is Hertz:
        spring = "Linear spring" if "exponent" in alias.defaults else "Hertzian spring"
    return dataclasses.make_dataclass(
        alias.title,
        fields,
        bases=(RestitutionLaw if of_restitution else WholeLaw,),
        namespace={
            "__doc__": f"{spring} with :class:`antenna_pin.contact.{alias.dissipation.__name__}`.",
            "__module__": __name__,
            "elastic": alias.elastic,
            "dissipation": alias.dissipation,
        },
        frozen=True,
        slots=True,
        kw_only=True,
    )


WHOLE_LAWS: Mapping[str, type[Any]] = MappingProxyType({alias.name: _class_of(alias) for alias in ALIASES})

AdamsImpact = WHOLE_LAWS["adams-impact"]
BaiZhao = WHOLE_LAWS["bai-zhao"]
CarvalhoMartins = WHOLE_LAWS["carvalho-martins"]
ExactRestitution = WHOLE_LAWS["exact-restitution"]
Flores = WHOLE_LAWS["flores"]
GharibHurmuzlu = WHOLE_LAWS["gharib-hurmuzlu"]
Gonthier = WHOLE_LAWS["gonthier"]
HerbertMcWhannell = WHOLE_LAWS["herbert-mcwhannell"]
HuGuo = WHOLE_LAWS["hu-guo"]
HuntCrossley = WHOLE_LAWS["hunt-crossley"]
Jankowski = WHOLE_LAWS["jankowski"]
KelvinVoigt = WHOLE_LAWS["kelvin-voigt"]
KuwabaraKono = WHOLE_LAWS["kuwabara-kono"]
LankaraniNikravesh = WHOLE_LAWS["lankarani-nikravesh"]
LeeWang = WHOLE_LAWS["lee-wang"]
MarhefkaOrin = WHOLE_LAWS["marhefka-orin"]
PantWijeyewickrema = WHOLE_LAWS["pant-wijeyewickrema"]
Tsuji = WHOLE_LAWS["tsuji"]
Ye = WHOLE_LAWS["ye"]
ZhiyingQishao = WHOLE_LAWS["zhiying-qishao"]
