"""antenna_pin: mechanisms with play in their joints, on a free-floating base.

Three lines run a shipped scenario::

    from antenna_pin import load_scenario, simulate
    run = simulate(load_scenario("bai2020", case="case3"), "0.2 s")
    run.save("case3.nc")

The names below are loaded when first used, so that importing the package is quick. Completion finds what is
there: ``antenna_pin.laws.<TAB>``, ``antenna_pin.elements.<TAB>``, ``antenna_pin.events.<TAB>``,
``run.plot.<TAB>``.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    __version__: str
    from antenna_pin.assemble import build_system, initial_state, urdf_variant
    from antenna_pin.constraints import Anchor, Closure, Coupling
    from antenna_pin.dynamics import System, assembled
    from antenna_pin.errors import AntennaPinError
    from antenna_pin.fit import Fit, FitPlan, load_fit, run_fit
    from antenna_pin.joints import ClearanceJoint
    from antenna_pin.linear import Modes, modes
    from antenna_pin.live import Exploration, explore
    from antenna_pin.mechanism import Mechanism, Urdf, build_mechanism
    from antenna_pin.scenario import Scenario, list_scenarios, load_scenario, models_path
    from antenna_pin.session import Session, start
    from antenna_pin.settings import ErrorScales, RunSettings
    from antenna_pin.simulation import Progress, simulate
    from antenna_pin.sweep import Study, load_study, open_study, run_study
    from antenna_pin.trajectory import Counts, Outcome, Trajectory, open_run

_HOMES = {
    "Anchor": "constraints",
    "AntennaPinError": "errors",
    "ClearanceJoint": "joints",
    "Closure": "constraints",
    "Coupling": "constraints",
    "Counts": "trajectory",
    "ErrorScales": "settings",
    "Exploration": "live",
    "Fit": "fit",
    "FitPlan": "fit",
    "Mechanism": "mechanism",
    "Modes": "linear",
    "Outcome": "trajectory",
    "Progress": "simulation",
    "RunSettings": "settings",
    "Scenario": "scenario",
    "Session": "session",
    "Study": "sweep",
    "System": "dynamics",
    "Trajectory": "trajectory",
    "Urdf": "mechanism",
    "assembled": "dynamics",
    "build_mechanism": "mechanism",
    "build_system": "assemble",
    "explore": "live",
    "initial_state": "assemble",
    "list_scenarios": "scenario",
    "load_fit": "fit",
    "load_scenario": "scenario",
    "load_study": "sweep",
    "models_path": "scenario",
    "modes": "linear",
    "open_run": "trajectory",
    "open_study": "sweep",
    "run_fit": "fit",
    "run_study": "sweep",
    "simulate": "simulation",
    "start": "session",
    "urdf_variant": "assemble",
}

# Rooms that a user finds by completion; the others are found by who builds on them.
_ROOMS = (
    "analysis",
    "constraints",
    "contact",
    "control",
    "elements",
    "errors",
    "events",
    "flexible",
    "geometry",
    "laws",
    "linear",
    "nonlinear",
    "plot",
    "record",
    "report",
)

__all__ = [
    "Anchor",
    "AntennaPinError",
    "ClearanceJoint",
    "Closure",
    "Counts",
    "Coupling",
    "ErrorScales",
    "Exploration",
    "Fit",
    "FitPlan",
    "Mechanism",
    "Modes",
    "Outcome",
    "Progress",
    "RunSettings",
    "Scenario",
    "Session",
    "Study",
    "System",
    "Trajectory",
    "Urdf",
    "analysis",
    "assembled",
    "build_mechanism",
    "build_system",
    "constraints",
    "contact",
    "control",
    "elements",
    "errors",
    "events",
    "explore",
    "flexible",
    "geometry",
    "initial_state",
    "laws",
    "linear",
    "list_scenarios",
    "load_fit",
    "load_scenario",
    "load_study",
    "models_path",
    "modes",
    "nonlinear",
    "open_run",
    "open_study",
    "plot",
    "record",
    "report",
    "run_fit",
    "run_study",
    "simulate",
    "start",
    "urdf_variant",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"antenna_pin.{_HOMES[name]}"), name)
    if name == "__version__":
        return importlib.import_module("antenna_pin.trajectory").library_versions()["antenna_pin"]
    if name in _ROOMS:
        return importlib.import_module(f"antenna_pin.{name}")
    raise AttributeError(f"module 'antenna_pin' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
