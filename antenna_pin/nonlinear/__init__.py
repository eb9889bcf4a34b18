"""What motions come to: periodic solutions, their stability, and how neighbours part."""

from antenna_pin.nonlinear.chart import Chart, NotAlikeError
from antenna_pin.nonlinear.flow import Flow, FlowError, Tangent, flow_of
from antenna_pin.nonlinear.lyapunov import Exponents, Verdict, largest_exponent, lyapunov_spectrum
from antenna_pin.nonlinear.orbits import NoOrbitError, Orbit, periodic_orbit

__all__ = [
    "Chart",
    "Exponents",
    "Flow",
    "FlowError",
    "NoOrbitError",
    "NotAlikeError",
    "Orbit",
    "Tangent",
    "Verdict",
    "flow_of",
    "largest_exponent",
    "lyapunov_spectrum",
    "periodic_orbit",
]
