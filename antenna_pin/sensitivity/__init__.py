"""How results hang on the scenario's numbers: derivatives of all that a run gives, through its events."""

from antenna_pin._lazy import only_public
from antenna_pin.sensitivity.found import Sensitivities
from antenna_pin.sensitivity.growth import Growth
from antenna_pin.sensitivity.made import Method, sensitivities
from antenna_pin.sensitivity.parameters import GrazeError, Parameter, SensitivityError
from antenna_pin.sensitivity.told import (
    Changed,
    growth_said,
    open_sensitivities,
    refused_in,
    results_of,
    sensitivity_table,
)

__all__ = [
    "Changed",
    "GrazeError",
    "Growth",
    "Method",
    "Parameter",
    "Sensitivities",
    "SensitivityError",
    "growth_said",
    "open_sensitivities",
    "refused_in",
    "results_of",
    "sensitivities",
    "sensitivity_table",
]

only_public(__name__)
