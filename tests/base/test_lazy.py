"""Packages that load their names when they are used: none is missing, and the order does not count."""

import importlib
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import antenna_pin

ROOT = Path(antenna_pin.__file__).parent
STUBS = sorted(ROOT.rglob("*.pyi"))
PACKAGES = [
    ".".join(stub.with_suffix("").relative_to(ROOT.parent).parts).removesuffix(".__init__") for stub in STUBS
]


@pytest.mark.parametrize("name", PACKAGES)
def test_every_name_of_a_stub_is_there_and_is_not_a_file(name):
    package = importlib.import_module(name)
    homes = package.homes_of_names
    assert list(homes) == package.__all__ and sorted(homes) == dir(package)
    for each, home in homes.items():
        value = getattr(package, each)
        if home == name:  # a room of the package
            assert value is importlib.import_module(f"{name}.{each}")
            continue
        assert not isinstance(value, ModuleType), each
        held = getattr(importlib.import_module(home), each)
        assert value is held or each == "ELEMENTS" and value == held  # made where it is asked for
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
