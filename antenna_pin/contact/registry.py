"""Contact laws by name; a law enters by one line.

A scenario file, the command line, the documentation and the kernels all read the laws from here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from antenna_pin.base.lazy import Classes

# --- laws of the literature as a whole ----------------------------------------------------------------------
#
# A row here is one; its class is made when it is asked for (:mod:`antenna_pin.contact.point_laws`).


@dataclass(frozen=True, slots=True)
class Alias:
    """A law as a whole, by name.

    Beside a Hertzian spring its dissipation bears the same name alone.

    Attributes:
        name: In a scenario.
        title: Name of its class.
        dissipation: What it dissipates with: the file of this room that holds the class, and the class.
        defaults: Of its parameters, where they are not those of the parts.
        elastic: Its elastic law, likewise.
    """

    name: str
    title: str
    dissipation: str
    defaults: Mapping[str, float] = field(default_factory=dict)
    elastic: str = "normal.Hertz"


_LINEAR = {"exponent": 1.0}

ALIASES = (
    Alias("lankarani-nikravesh", "LankaraniNikravesh", "hysteresis.LankaraniNikraveshDamping"),
    Alias("exact-restitution", "ExactRestitution", "hysteresis.ExactDamping"),
    Alias("hunt-crossley", "HuntCrossley", "hysteresis.HuntCrossleyDamping"),
    Alias("herbert-mcwhannell", "HerbertMcWhannell", "hysteresis.HerbertMcWhannellDamping"),
    Alias("lee-wang", "LeeWang", "hysteresis.LeeWangDamping"),
    Alias("marhefka-orin", "MarhefkaOrin", "hysteresis.MarhefkaOrinDamping"),
    Alias("gonthier", "Gonthier", "hysteresis.GonthierDamping"),
    Alias("zhiying-qishao", "ZhiyingQishao", "hysteresis.ZhiyingQishaoDamping"),
    Alias("ye", "Ye", "hysteresis.YeDamping", _LINEAR),
    Alias("flores", "Flores", "hysteresis.FloresDamping"),
    Alias("gharib-hurmuzlu", "GharibHurmuzlu", "hysteresis.GharibHurmuzluDamping"),
    Alias("pant-wijeyewickrema", "PantWijeyewickrema", "hysteresis.PantWijeyewickremaDamping", _LINEAR),
    Alias("hu-guo", "HuGuo", "hysteresis.HuGuoDamping"),
    Alias("carvalho-martins", "CarvalhoMartins", "hysteresis.CarvalhoMartinsDamping"),
    Alias("kelvin-voigt", "KelvinVoigt", "damping.KelvinVoigtDamping", _LINEAR),
    Alias("kuwabara-kono", "KuwabaraKono", "damping.KuwabaraKonoDamping"),
    Alias("tsuji", "Tsuji", "damping.TsujiDamping"),
    Alias("jankowski", "Jankowski", "damping.JankowskiDamping"),
    Alias("adams-impact", "AdamsImpact", "damping.AdamsDamping"),
    Alias("bai-zhao", "BaiZhao", "hysteresis.ZhiyingQishaoDamping", elastic="cylinder.BaiZhaoElastic"),
)

# Beside a Hertzian spring.
_HERTZIAN = [alias for alias in ALIASES if alias.elastic == "normal.Hertz"]

SHAPELESS_LAWS = tuple(alias.name for alias in _HERTZIAN if alias.name != "kuwabara-kono")
"""Laws that hold for bodies of any shape, by name: that of Kuwabara and Kono is of spheres."""


# --- laws by name -------------------------------------------------------------------------------------------

_ROOM = "antenna_pin.contact"

NORMAL_LAWS: Classes = Classes(
    _ROOM,
    {
        # Elastic laws, which can be given any of the DISSIPATIONS: point contact ...
        "hertz": "normal.Hertz",
        # ... lines ...
        "hertz-line": "cylinder.HertzLine",
        "johnson": "cylinder.Johnson",
        "radzimovsky": "cylinder.Radzimovsky",
        "goldsmith": "cylinder.Goldsmith",
        "dubowsky-freudenstein": "cylinder.DubowskyFreudenstein",
        "esdu-78035": "cylinder.ESDU78035",
        "pereira": "cylinder.Pereira",
        # ... arcs of the bore ...
        "liu-foundation": "cylinder.LiuFoundation",
        "persson": "cylinder.Persson",
        "bai-zhao-elastic": "cylinder.BaiZhaoElastic",
        # ... and the pin joint of Liu et al. 2013.
        "liu-2013-hertz": "pin_joint.LiuHertz",
        "liu-2013-conformal": "pin_joint.LiuConformal",
        "liu-2013": "pin_joint.LiuPinJoint",
        "liu-2013-corrected": "pin_joint.LiuPinJointCorrected",
        # Laws as a whole, with the dissipation of their authors.
        **{alias.name: f"point_laws.{alias.title}" for alias in ALIASES},
    },
)

DISSIPATIONS: Classes = Classes(
    _ROOM, {"none": "normal.NoDissipation", **{alias.name: alias.dissipation for alias in _HERTZIAN}}
)

FRICTION_LAWS: Classes = Classes(
    _ROOM,
    {
        # Laws of the slip speed.
        "none": "friction.NoFriction",
        "velocity-based": "friction.VelocityBased",
        "ambrosio": "friction.Ambrosio",
        "tanh": "friction.Tanh",
        "coulomb": "friction.Coulomb",
        "linear": "friction.LinearFriction",
        "stribeck": "friction.Stribeck",
        "threlfall": "friction.Threlfall",
        "bengisu-akay": "friction.BengisuAkay",
        "brown-mcphee": "friction.BrownMcPhee",
        # Laws with bristles.
        "dahl": "bristle.Dahl",
        "lugre": "bristle.LuGre",
        "gonthier-bristle": "bristle.GonthierBristle",
    },
)

CUSTOM_FRICTION = Classes(_ROOM, {"custom": "friction.CustomFriction"})
"""Friction of a user's function, which no scenario names."""
