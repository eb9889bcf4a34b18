"""After ``scripts/compile_kernels.py`` nothing is compiled any more: no next mechanism, element or law."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.compiled import kernel_cache as _kernel_cache
from antenna_pin.compiled.kernel_cache import Turn
from antenna_pin.scenario import list_scenarios

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

SCRIPTS = Path(__file__).parents[2] / "scripts"
SEED = 2024
FEW = range(12)  # free and fixed bases, all kinds of joint, half of the laws, drives, springs, both loads


@pytest.fixture(scope="module", autouse=True)
def kernels():
    """What the script makes; a second where it is there."""
    subprocess.run([sys.executable, SCRIPTS / "compile_kernels.py"], check=True, capture_output=True)


@pytest.fixture
def compiled(monkeypatch):
    """The names of kernels that are compiled from here on."""
    found = []
    cache = _kernel_cache._KernelCache
    load = cache.load_overload

    def loaded(self, signature, context):
        result = load(self, signature, context)
        if result is None:
            found.append(f"{self._py_func.__module__}.{self._py_func.__name__}")
        return result

    monkeypatch.setattr(cache, "load_overload", loaded)
    return found


def both_engines(scenario):
    """Yield a scenario as it is, and with the compiled engine and gaps in closed form."""
    yield scenario
    closed = [
        f"clearance.{name}.geometry=closed-form"
        for name, joint in scenario.clearance.items()
        if hasattr(joint, "geometry")
    ]
    yield scenario.with_overrides(["integrator.engine=compiled", *closed])


def run(scenario, duration):
    simulate(scenario, duration=min(duration, scenario.duration))


@pytest.mark.parametrize("name", [one.name for one in list_scenarios()])
def test_no_shipped_scenario_compiles_anything(compiled, name):
    cases = next(one.cases for one in list_scenarios() if one.name == name)
    for case, _ in cases:
        for scenario in both_engines(load_scenario(name, case=case)):
            run(scenario, 1e-4)
    assert compiled == []


@pytest.mark.parametrize("method", ["rk4", "bogacki-shampine-32", "dormand-prince-54", "radau5"])
def test_no_method_compiles_anything(compiled, method):
    for scenario in both_engines(load_scenario("bai2020", case="case3")):
        more = {"integrator.step": 1e-6} if method == "rk4" else {}
        run(scenario.with_overrides({"integrator.method": method, **more}), 1e-4)
    assert compiled == []


@pytest.mark.parametrize("number", FEW)
def test_no_random_mechanism_compiles_anything(compiled, monkeypatch, number):
    """Random trees with laws, elements, loads and geometries dealt from all that there are."""
    monkeypatch.syspath_prepend(str(SCRIPTS / "check"))
    draw = importlib.import_module("scenario_generator").draw_scenario
    for scenario in both_engines(draw(SEED, number)):
        run(scenario, 2e-3)
    assert compiled == []


@pytest.mark.parametrize("kernel", range(20))
def test_a_turn_is_taken_whatever_the_kernel_is_called(tmp_path, kernel):
    """No byte is too far out to be held, in a file of any system's."""
    turn = Turn(f"antenna_pin.kernels:{kernel}")
    turn.begin(str(tmp_path))
    assert turn.is_held
    turn.end()
    assert not turn.is_held


_TAKES = """\
import sys, time
from antenna_pin.compiled.kernel_cache import Turn
turn = Turn("kernel")
turn.begin(sys.argv[1])
print("has it", flush=True)
sys.stdin.readline()
"""


def test_who_comes_second_waits_for_the_first_and_not_for_the_dead(tmp_path):
    """Else processes that start together would compile everything once each, or wait for ever."""
    command = [sys.executable, "-c", _TAKES, str(tmp_path)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    first = subprocess.Popen(command, **pipes)
    assert first.stdout.readline() == b"has it\n"
    second = subprocess.Popen(command, **pipes)
    os.set_blocking(second.stdout.fileno(), False)
    other = Turn("another kernel")
    other.begin(str(tmp_path))  # at once
    other.end()
    assert second.stdout.read() is None
    first.kill()
    first.communicate()
    os.set_blocking(second.stdout.fileno(), True)
    assert second.stdout.readline() == b"has it\n"
    second.communicate(b"\n")
    assert second.returncode == 0
