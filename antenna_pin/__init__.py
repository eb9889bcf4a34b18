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
from typing import Any

from antenna_pin.base.lazy import exported

exported(__name__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return importlib.import_module("antenna_pin.trajectory").library_versions()["antenna_pin"]
    raise AttributeError(f"module 'antenna_pin' has no attribute {name!r}")
