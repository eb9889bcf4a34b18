"""Small motions about a state: linearisation, modes, frequency responses."""

from antenna_pin._lazy import only_public
from antenna_pin.linear.eigen import Eigen, Kind, solve
from antenna_pin.linear.forces import ForceDerivatives
from antenna_pin.linear.linearisation import Linearisation, linearise
from antenna_pin.linear.of_model import modes
from antenna_pin.linear.play import At, Play, prepared
from antenna_pin.linear.response import BORESIGHT, first_source, frequency_response, sources_of, targets_of
from antenna_pin.linear.result import COMPONENTS, Modes, modes_at
from antenna_pin.linear.swings import swing

__all__ = [
    "BORESIGHT",
    "COMPONENTS",
    "At",
    "Eigen",
    "ForceDerivatives",
    "Kind",
    "Linearisation",
    "Modes",
    "Play",
    "first_source",
    "frequency_response",
    "linearise",
    "modes",
    "modes_at",
    "prepared",
    "solve",
    "sources_of",
    "swing",
    "targets_of",
]

only_public(__name__)
