"""What motions come to: sections, diagrams, periodic solutions, their stability, and how neighbours part."""

from antenna_pin._lazy import only_public
from antenna_pin.nonlinear.carry import carried
from antenna_pin.nonlinear.chart import Chart, NotAlikeError, OutOfReachError
from antenna_pin.nonlinear.continuation import Bifurcation, Branch, Family, Point, check_steps, continued
from antenna_pin.nonlinear.diagram import Made, bifurcation
from antenna_pin.nonlinear.diagram_table import open_diagram, open_section
from antenna_pin.nonlinear.families import amplitudes, family_of
from antenna_pin.nonlinear.flow import Flow, FlowError, Tangent, flow_of
from antenna_pin.nonlinear.lyapunov import (
    Exponents,
    Verdict,
    exponents_table,
    largest_exponent,
    lyapunov_spectrum,
    open_exponents,
)
from antenna_pin.nonlinear.on_section import orbits_in_section
from antenna_pin.nonlinear.orbit_table import branch_table, open_branch, open_orbit, orbit_table
from antenna_pin.nonlinear.orbits import NoOrbitError, Orbit, periodic_orbit
from antenna_pin.nonlinear.plan import DiagramPlan, list_plans, load_plan, values_of
from antenna_pin.nonlinear.sections import poincare
from antenna_pin.nonlinear.surfaces import Crossing, Section, Stroboscope, drive_period, section_of
from antenna_pin.trajectory import save_table

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
    "amplitudes",
    "bifurcation",
    "branch_table",
    "carried",
    "check_steps",
    "continued",
    "drive_period",
    "exponents_table",
    "family_of",
    "flow_of",
    "largest_exponent",
    "lyapunov_spectrum",
    "list_plans",
    "load_plan",
    "open_diagram",
    "open_section",
    "open_branch",
    "open_exponents",
    "open_orbit",
    "orbit_table",
    "orbits_in_section",
    "periodic_orbit",
    "poincare",
    "save_table",
    "section_of",
    "values_of",
]

only_public(__name__)
