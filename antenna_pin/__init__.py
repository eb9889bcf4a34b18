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
import sys
import warnings
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any

from antenna_pin.base.lazy import exported

exported(__name__)

#: Packages by their former places at the top, where they are imported from still.
_FORMER = {
    "assemble": "scenario",
    "cli": "apps",
    "constraints": "dynamics",
    "control": "elements",
    "engine": "run",
    "fit": "studies",
    "flexible": "mechanism",
    "fmu": "apps",
    "geometry": "joints",
    "law_studies": "analysis",
    "linear": "studies",
    "live": "apps",
    "nonlinear": "studies",
    "plot": "show",
    "record": "show",
    "report": "show",
    "sensitivity": "studies",
    "session": "run",
    "simulation": "run",
    "sweep": "studies",
    "views": "show",
}

#: Names that are in their packages now, where they are to be imported from.
_MOVED = {
    "Anchor": "dynamics.constraints",
    "Counts": "trajectory",
    "Exploration": "apps.live",
    "Fit": "studies.fit",
    "FitPlan": "studies.fit",
    "Modes": "studies.linear",
    "Progress": "run.simulation",
    "Session": "run.session",
    "Study": "studies.sweep",
    "assembled": "dynamics",
    "explore": "apps.live",
    "initial_state": "scenario.assemble",
    "modes": "studies.linear",
    "start": "run.session",
    "urdf_variant": "scenario.assemble",
}


class _FormerPlaces:
    """Import system's finder of packages by their former places: the same modules, under both names."""

    @staticmethod
    def find_spec(name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        package, *rest = name.split(".")
        if package != __name__ or not rest or rest[0] not in _FORMER:
            return None
        module = importlib.import_module(".".join((package, _FORMER[rest[0]], *rest)))
        return ModuleSpec(name, _Loaded(module))  # type: ignore[arg-type]


class _Loaded:
    """Loader of a module that has been loaded under its own name."""

    def __init__(self, module: ModuleType) -> None:
        self._module, self._spec = module, module.__spec__

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return self._module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self._spec


# First: by the path of a package Python would load its files once more, under the former names.
sys.meta_path.insert(0, _FormerPlaces)  # type: ignore[arg-type]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return importlib.import_module("antenna_pin.trajectory").library_versions()["antenna_pin"]
    if name in _MOVED:
        place = f"antenna_pin.{_MOVED[name]}"
        warnings.warn(f"antenna_pin.{name} is {place}.{name} now", DeprecationWarning, stacklevel=2)
        return getattr(importlib.import_module(place), name)
    path = Path(__file__).with_name(name)
    is_own = not name.startswith("_") and (path.is_dir() or path.with_suffix(".py").is_file())
    if is_own or name in _FORMER:
        return importlib.import_module(f"antenna_pin.{name}")
    raise AttributeError(f"module 'antenna_pin' has no attribute {name!r}")
