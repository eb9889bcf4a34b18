"""Kernels that only some runs need are compiled when one needs them, also under callers compiled before."""

import subprocess
import sys

import numba
import pytest

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

_KERNELS = """\
from antenna_pin.compiled.decorators import deferred, inlined, kernel

@kernel
def square(x: float) -> float:
    return x * x

@deferred("pairs")
def pair(x: float, n: int) -> float:
    return square(x) + n

@inlined
def inner(x, n, is_paired):
    return pair(x, n) if is_paired else x

@kernel
def outer(x, n, is_paired):
    return 2.0 * inner(x, n, is_paired)
"""

_ASKED = """\
import sys
sys.path.insert(0, sys.argv[1])
from antenna_pin.compiled.compile_time import told_of_compiling
from antenna_pin.compiled.deferred import require
import kernels_of_pairs as kernels

made = []
with told_of_compiling(lambda: made.append(1)):
    for word in sys.argv[2].split():
        if word == "require":
            require("pairs")
        elif word == "direct":
            print(kernels.pair(3.0, 1), end=" ")
        else:
            try:
                print(kernels.outer(3.0, 1, word == "paired"), end=" ")
            except SystemError:
                print("error", end=" ")
print(len(made))
"""


@pytest.fixture
def answer(tmp_path, monkeypatch):
    """Return what a process prints that asks in an order."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    (tmp_path / "kernels_of_pairs.py").write_text(_KERNELS)

    def ask(order):
        command = [sys.executable, "-c", _ASKED, str(tmp_path), order]
        return subprocess.run(command, capture_output=True, text=True, timeout=300, check=True).stdout.strip()

    return ask


def test_what_is_not_required_is_not_compiled_and_is_found_when_it_is(answer):
    """Outer, with what is inlined; then pair and square. Later processes find them stored."""
    assert answer("alone alone") == "6.0 6.0 2"
    assert answer("alone require paired") == "6.0 20.0 2"
    assert answer("require paired") == "20.0 0"
    assert answer("alone require paired alone") == "6.0 20.0 6.0 0"


def test_what_is_required_first_is_compiled_with_its_caller(answer):
    assert answer("require paired alone") == "20.0 6.0 4"
    assert answer("alone") == "6.0 0"


def test_a_call_that_nothing_has_required_is_an_error_and_no_crash(answer):
    assert answer("paired alone") == "error 6.0 2"
    assert answer("paired require paired") == "error 20.0 2"


def test_python_calls_it_as_any_kernel(answer):
    """Which requires its group."""
    assert answer("direct paired").startswith("10.0 20.0")
