"""Packages that load their names when they are used: none is missing, and the order does not count."""

import importlib
import subprocess
import sys
from types import ModuleType

import pytest

PACKAGES = (
    "analysis",
    "assemble",
    "constraints",
    "contact",
    "control",
    "dynamics",
    "elements",
    "engine",
    "flexible",
    "geometry",
    "integrate",
    "joints",
    "mechanism",
    "plot",
    "simulation",
    "trajectory",
)


@pytest.mark.parametrize("name", PACKAGES)
def test_every_name_is_there_and_is_not_a_file(name):
    package = importlib.import_module(f"antenna_pin.{name}")
    homes = package.homes_of_names
    assert set(homes) <= set(package.__all__)
    for each, home in homes.items():
        value = getattr(package, each)
        assert not isinstance(value, ModuleType), each
        held = getattr(sys.modules[home if "." in home else f"antenna_pin.{name}.{home}"], each)
        assert value is held or each == "ELEMENTS" and value == held  # made where it is asked for
    assert set(package.__all__) <= set(dir(package))
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = package.nothing


def test_a_function_goes_before_the_file_of_its_name_whoever_loads_it_first():
    code = (
        "import antenna_pin.analysis.deviation\n"  # makes the file an attribute of the package
        "from antenna_pin.analysis import deviation, impacts\n"
        "assert callable(deviation) and callable(impacts), (deviation, impacts)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
