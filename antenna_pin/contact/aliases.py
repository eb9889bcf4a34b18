"""The laws of the literature as a whole, by the name of their authors: which elastic law, which dissipation.

A row here is one; its class is made when it is asked for (:mod:`antenna_pin.contact.point_laws`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

__all__ = ["ALIASES", "Alias"]


@dataclass(frozen=True, slots=True)
class Alias:
    """A law as a whole, by name.

    Attributes:
        name: In a scenario.
        title: Name of its class.
        elastic: Its elastic law: the file of this room that holds the class, and the class.
        dissipation: What it dissipates with, likewise.
        defaults: Of its parameters, where they are not those of the parts.
    """

    name: str
    title: str
    elastic: str
    dissipation: str
    defaults: Mapping[str, float] = field(default_factory=dict)


_LINEAR = {"exponent": 1.0}

ALIASES = (
    Alias(
        "lankarani-nikravesh", "LankaraniNikravesh", "normal.Hertz", "hysteresis.LankaraniNikraveshDamping"
    ),
    Alias("exact-restitution", "ExactRestitution", "normal.Hertz", "hysteresis.ExactDamping"),
    Alias("hunt-crossley", "HuntCrossley", "normal.Hertz", "hysteresis.HuntCrossleyDamping"),
    Alias("herbert-mcwhannell", "HerbertMcWhannell", "normal.Hertz", "hysteresis.HerbertMcWhannellDamping"),
    Alias("lee-wang", "LeeWang", "normal.Hertz", "hysteresis.LeeWangDamping"),
    Alias("marhefka-orin", "MarhefkaOrin", "normal.Hertz", "proportional.MarhefkaOrinDamping"),
    Alias("gonthier", "Gonthier", "normal.Hertz", "hysteresis.GonthierDamping"),
    Alias("zhiying-qishao", "ZhiyingQishao", "normal.Hertz", "hysteresis.ZhiyingQishaoDamping"),
    Alias("ye", "Ye", "normal.Hertz", "hysteresis.YeDamping", _LINEAR),
    Alias("flores", "Flores", "normal.Hertz", "hysteresis.FloresDamping"),
    Alias("gharib-hurmuzlu", "GharibHurmuzlu", "normal.Hertz", "hysteresis.GharibHurmuzluDamping"),
    Alias(
        "pant-wijeyewickrema",
        "PantWijeyewickrema",
        "normal.Hertz",
        "hysteresis.PantWijeyewickremaDamping",
        _LINEAR,
    ),
    Alias("hu-guo", "HuGuo", "normal.Hertz", "hysteresis.HuGuoDamping"),
    Alias("carvalho-martins", "CarvalhoMartins", "normal.Hertz", "hysteresis.CarvalhoMartinsDamping"),
    Alias("kelvin-voigt", "KelvinVoigt", "normal.Hertz", "damping.KelvinVoigtDamping", _LINEAR),
    Alias("kuwabara-kono", "KuwabaraKono", "normal.Hertz", "damping.KuwabaraKonoDamping"),
    Alias("tsuji", "Tsuji", "normal.Hertz", "damping.TsujiDamping"),
    Alias("jankowski", "Jankowski", "normal.Hertz", "damping.JankowskiDamping"),
    Alias("adams-impact", "AdamsImpact", "normal.Hertz", "damping.AdamsDamping"),
    Alias("bai-zhao", "BaiZhao", "conformal.BaiZhaoElastic", "hysteresis.ZhiyingQishaoDamping"),
)
