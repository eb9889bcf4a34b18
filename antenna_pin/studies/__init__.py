"""Studies of many runs or states: linear, nonlinear, sensitivities, fits, sweeps, statics, margins."""

from antenna_pin.base.lazy import exported

exported(__name__)
