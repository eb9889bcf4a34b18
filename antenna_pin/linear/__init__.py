"""Small motions about a state: linearisation, modes, frequency responses."""

from antenna_pin.linear.eigen import Eigen, Kind, solve
from antenna_pin.linear.forces import ForceDerivatives
from antenna_pin.linear.linearisation import Linearisation, linearise
from antenna_pin.linear.of_model import modes
from antenna_pin.linear.play import At, Play, prepared
from antenna_pin.linear.result import COMPONENTS, Modes, modes_at

__all__ = [
    "COMPONENTS",
    "At",
    "Eigen",
    "ForceDerivatives",
    "Kind",
    "Linearisation",
    "Modes",
    "Play",
    "linearise",
    "modes",
    "modes_at",
    "prepared",
    "solve",
]
