"""Contact laws by name, their parameters, and their construction.

A scenario file, the command line and the documentation all read the laws from here; a law enters by one line.
A normal law is a name and its parameters; where the name is that of an elastic law, a dissipation can be
named beside it, whose parameters then stand with the elastic law's::

    make_normal_law("johnson", {"length": "0.025", ..., "restitution": 0.9}, dissipation="flores")
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.base.lazy import Classes
from antenna_pin.base.parameters import Parameter, parameters_of
from antenna_pin.contact.normal import CompiledNormalLaw, DampedContact, ElasticLaw
from antenna_pin.errors import InvalidParameterError, UnknownNameError

__all__ = [
    "Alias",
    "ALIASES",
    "DISSIPATIONS",
    "FRICTION_LAWS",
    "is_elastic",
    "law_parameters",
    "make_normal_law",
    "NORMAL_LAWS",
    "normal_parameters",
    "Parameter",
    "SHAPELESS_LAWS",
]

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


@takes()
def law_parameters(law: type[Any]) -> dict[str, Parameter]:
    """Return the parameters of a law or dissipation by name."""
    return parameters_of(law)


@takes()
def is_elastic(law: str) -> bool:
    """Return whether a normal law, by name, takes a separate dissipation."""
    return issubclass(NORMAL_LAWS[law], ElasticLaw)


@takes()
def normal_parameters(law: str, dissipation: str | None = None) -> dict[str, Parameter]:
    """Return the parameters of a normal law by name, with those of its dissipation.

    Args:
        law: Name in ``NORMAL_LAWS``.
        dissipation: Name in ``DISSIPATIONS``, only beside an elastic law.
    """
    own = law_parameters(NORMAL_LAWS[law])
    return own if dissipation is None else own | law_parameters(DISSIPATIONS[dissipation])


@takes()
def make_normal_law(
    law: str, parameters: Mapping[str, float], dissipation: str | None = None
) -> CompiledNormalLaw:
    """Return a normal law from names and numbers.

    Args:
        law: Name in ``NORMAL_LAWS``.
        parameters: Parameters in SI units, of the law and of the dissipation together.
        dissipation: Name in ``DISSIPATIONS``; only beside an elastic law, which without one is conservative.

    Raises:
        UnknownNameError: No such law or dissipation.
        InvalidParameterError: A parameter breaks a rule, is missing, or is not the law's.
    """
    if law not in NORMAL_LAWS:
        raise UnknownNameError("make_normal_law", "law", law, NORMAL_LAWS)
    if dissipation is not None and dissipation not in DISSIPATIONS:
        raise UnknownNameError("make_normal_law", "dissipation", dissipation, DISSIPATIONS)
    if dissipation is not None and not is_elastic(law):
        raise InvalidParameterError(
            "make_normal_law", "dissipation", f"left out, for law {law} brings its own", dissipation
        )
    declared = normal_parameters(law, dissipation)
    for name in parameters:
        if name not in declared:
            takes = ", ".join(declared) or "no parameters"
            raise InvalidParameterError("make_normal_law", "parameters", f"of {takes} (law {law})", name)
    for name, parameter in declared.items():
        if parameter.required and name not in parameters:
            raise InvalidParameterError("make_normal_law", name, f"given (law {law})")
    own = law_parameters(NORMAL_LAWS[law])
    elastic: CompiledNormalLaw = NORMAL_LAWS[law](**{k: v for k, v in parameters.items() if k in own})
    if dissipation is None:
        return elastic
    assert isinstance(elastic, ElasticLaw)
    rest = {name: value for name, value in parameters.items() if name not in own}
    return DampedContact(elastic=elastic, dissipation=DISSIPATIONS[dissipation](**rest))
