"""How results hang on the scenario's numbers: derivatives of all that a run gives, through its events."""

from antenna_pin._lazy import only_public
from antenna_pin.sensitivity.found import Sensitivities
from antenna_pin.sensitivity.growth import Growth
from antenna_pin.sensitivity.made import Method, sensitivities
from antenna_pin.sensitivity.parameters import GrazeError, Parameter, SensitivityError

__all__ = ["GrazeError", "Growth", "Method", "Parameter", "Sensitivities", "SensitivityError", "sensitivities"]

only_public(__name__)
