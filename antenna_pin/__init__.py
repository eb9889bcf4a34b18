"""antenna_pin: mechanisms with play in their joints, on a free-floating base.

Three lines run a shipped scenario::

    from antenna_pin import load_scenario, simulate
    run = simulate(load_scenario("bai2020", case="case3"), "0.2 s")
    run.save("case3.nc")

The names below are loaded when first used, so that importing the package is quick. Completion finds what is
there: ``antenna_pin.laws.<TAB>``, ``antenna_pin.elements.<TAB>``, ``antenna_pin.events.<TAB>``,
``run.plot.<TAB>``.
"""

import importlib
import warnings
from pathlib import Path
from typing import Any

from antenna_pin.base.lazy import exported

exported(__name__)

#: Names that are in their packages now, where they are to be imported from.
_MOVED = {
    "Anchor": "constraints",
    "Counts": "trajectory",
    "Exploration": "live",
    "Fit": "fit",
    "FitPlan": "fit",
    "Modes": "linear",
    "Progress": "simulation",
    "Session": "session",
    "Study": "sweep",
    "assembled": "dynamics",
    "explore": "live",
    "initial_state": "assemble",
    "modes": "linear",
    "start": "session",
    "urdf_variant": "assemble",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return importlib.import_module("antenna_pin.trajectory").library_versions()["antenna_pin"]
    if name in _MOVED:
        place = f"antenna_pin.{_MOVED[name]}"
        warnings.warn(f"antenna_pin.{name} is {place}.{name} now", DeprecationWarning, stacklevel=2)
        return getattr(importlib.import_module(place), name)
    path = Path(__file__).with_name(name)
    if not name.startswith("_") and (path.is_dir() or path.with_suffix(".py").is_file()):
        return importlib.import_module(f"antenna_pin.{name}")
    raise AttributeError(f"module 'antenna_pin' has no attribute {name!r}")
