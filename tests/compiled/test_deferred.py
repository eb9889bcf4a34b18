"""Deferred kernels are compiled at their first call, also under callers compiled before."""

import subprocess
import sys

import numba
import pytest

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

_KERNELS = """\
from antenna_pin.compiled.decorators import ByKind, deferred, inlined, kernel

@kernel
def square(x: float) -> float:
    return x * x

@deferred
def pair(x: float, n: int) -> tuple[float, int]:
    return square(x) + n, n

@deferred
def declared(x: float) -> int:
    return x

def of_kind(number):
    @kernel
    def member(x):
        return x + offset
    offset = float(number)
    member.__wrapped__.__qualname__ = f"member.{number}"
    return member

members = ByKind("kernels_of_pairs:members", square.__wrapped__, of_kind)

@inlined
def inner(x, n, is_paired):
    return pair(x, n)[0] if is_paired else x

@kernel
def outer(x, n, is_paired):
    return 2.0 * inner(x, n, is_paired)

@kernel
def of_members(x, kind):
    return members(kind, x)

@kernel
def wrong(x):
    return declared(x)
"""

_ASKED = """\
import sys
sys.path.insert(0, sys.argv[1])
from antenna_pin.compiled import compile_time
import kernels_of_pairs as kernels

def interrupt():
    raise KeyboardInterrupt

made = []
with compile_time.told_of_compiling(lambda: made.append(1)):
    for word in sys.argv[2].split():
        if word == "direct":
            print(kernels.pair(3.0, 1)[0], end=" ")
        elif word.startswith("kind"):
            print(kernels.of_members(0.5, int(word[4:])), end=" ")
        elif word == "wrong":
            try:
                kernels.wrong(1.0)
            except TypeError as error:
                print(error, end=" ")
        elif word == "interrupted":
            kernels.outer(3.0, 1, False)
            with compile_time.told_of_compiling(interrupt):
                try:
                    kernels.outer(3.0, 1, True)
                except KeyboardInterrupt:
                    print("interrupted", end=" ")
        else:
            print(kernels.outer(3.0, 1, word == "paired"), end=" ")
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


def test_it_is_compiled_when_it_is_called_and_found_stored(answer):
    """Outer, with what is inlined; then pair and square. Later processes find them stored."""
    assert answer("alone alone") == "6.0 6.0 2"
    assert answer("alone paired kind3 kind5 kind3") == "6.0 20.0 3.5 5.5 3.5 5"
    # Of kinds the caller and two of them; numbers outside 0 to 127 are the last's.
    assert answer("paired alone kind5 kind127 kind-1 kind1000") == "20.0 6.0 5.5 127.5 127.5 127.5 1"


def test_an_interrupted_compilation_is_raised_and_done_again(answer):
    assert answer("interrupted paired") == "interrupted 20.0 5"


def test_python_calls_it_as_any_kernel_and_another_type_than_declared_is_no_crash(answer):
    said = answer("direct paired wrong")
    assert said.startswith("10.0 20.0")
    assert "kernels_of_pairs:declared is declared to return int64, not float64" in said
