"""What motions come to: sections, diagrams, periodic solutions, their stability, and how neighbours part."""

from antenna_pin.nonlinear.carry import carried
from antenna_pin.nonlinear.chart import Chart, NotAlikeError, OutOfReachError
from antenna_pin.nonlinear.continuation import Bifurcation, Branch, Family, Point, continued
from antenna_pin.nonlinear.diagram import Made, bifurcation
from antenna_pin.nonlinear.flow import Flow, FlowError, Tangent, flow_of
from antenna_pin.nonlinear.lyapunov import Exponents, Verdict, largest_exponent, lyapunov_spectrum
from antenna_pin.nonlinear.orbits import NoOrbitError, Orbit, periodic_orbit
from antenna_pin.nonlinear.plan import DiagramPlan, list_plans, load_plan, values_of
from antenna_pin.nonlinear.sections import poincare
from antenna_pin.nonlinear.surfaces import Crossing, Section, Stroboscope, drive_period, section_of
from antenna_pin.nonlinear.table import open_diagram, open_section, save_table

__all__ = [
    "Bifurcation",
    "Branch",
    "Chart",
    "Crossing",
    "DiagramPlan",
    "Exponents",
    "Family",
    "Flow",
    "FlowError",
    "Made",
    "NoOrbitError",
    "NotAlikeError",
    "Orbit",
    "OutOfReachError",
    "Point",
    "Section",
    "Stroboscope",
    "Tangent",
    "Verdict",
    "bifurcation",
    "carried",
    "continued",
    "drive_period",
    "flow_of",
    "largest_exponent",
    "lyapunov_spectrum",
    "list_plans",
    "load_plan",
    "open_diagram",
    "open_section",
    "periodic_orbit",
    "poincare",
    "save_table",
    "section_of",
    "values_of",
]
