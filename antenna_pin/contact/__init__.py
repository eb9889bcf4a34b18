"""Materials, stiffness of a pair, normal laws and friction laws: numbers only."""

from antenna_pin.contact.friction import (
    Ambrosio,
    CompiledFrictionLaw,
    CustomFriction,
    FrictionLaw,
    NoFriction,
    Tanh,
    VelocityBased,
)
from antenna_pin.contact.materials import MATERIALS, Material
from antenna_pin.contact.normal import CompiledNormalLaw, CustomNormal, Hertz, LankaraniNikravesh, NormalLaw
from antenna_pin.contact.registry import FRICTION_LAWS, NORMAL_LAWS, Parameter, law_parameters
from antenna_pin.contact.stiffness import effective_modulus, hertz_stiffness

__all__ = [
    "FRICTION_LAWS",
    "MATERIALS",
    "NORMAL_LAWS",
    "Ambrosio",
    "CompiledFrictionLaw",
    "CompiledNormalLaw",
    "CustomFriction",
    "CustomNormal",
    "FrictionLaw",
    "Hertz",
    "LankaraniNikravesh",
    "Material",
    "NoFriction",
    "NormalLaw",
    "Parameter",
    "Tanh",
    "VelocityBased",
    "effective_modulus",
    "hertz_stiffness",
    "law_parameters",
]
