"""A wheel's shared library: its kernels return what Python returns, and nothing unsafe or stale is called."""

import importlib.util
import json
import re
import shutil
import subprocess
import sys

import numba
import numpy as np
import pytest

from antenna_pin.compiled import shipped_code
from antenna_pin.compiled.decorators import kernel

pytestmark = [
    pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled"),
    pytest.mark.skipif(shutil.which("cc") is None, reason="there is no linker"),
]

_SOURCE = """\
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.compiled.by_address import by_address

PLACE = np.dtype((np.record, [("x", "f8"), ("count", "i8"), ("axes", "f8", (2, 2))]))


@by_address
class Inner(NamedTuple):
    weights: Any
    count: int


@by_address
class Outer(NamedTuple):
    rows: Any
    inner: Inner
    closed: bool
    places: Any
    factor: float


class Plain(NamedTuple):
    numbers: Any
    pair: tuple[float, int]


def weigh(outer, plain, k):
    total = outer.factor * outer.inner.count + plain.pair[0] * plain.pair[1] + outer.places[1].x
    for i in range(outer.inner.weights.shape[0]):
        outer.rows[k, i] = outer.inner.weights[i] * outer.factor
        total += outer.rows[k, i] + plain.numbers[i]
    return -total if outer.closed else total


def weigh_all(outer, plain, place, closed):
    place.count = outer.rows.shape[0]
    place.x = weigh(outer, plain, 0) + weigh(outer, plain, 1)
    return place.x > 1.0, (place.x, (place.count, closed)), place.axes[1, 0]


def strides(numbers, fixed):
    total = 0.0
    for i in range(numbers.shape[0]):
        for j in range(numbers.shape[1]):
            total = 3.0 * total + numbers[i, j] + fixed[j]
    return total


def write(numbers, value):
    numbers[0] = value


def count(k):
    return k + 1


def both(x, k):
    return x * k, x + k
"""


@pytest.fixture(scope="module")
def module(tmp_path_factory):
    """Kernels of a module, compiled, and linked into a library in the folder ``compiled`` beside it."""
    from antenna_pin.compiled.shared_library import write_library

    package = tmp_path_factory.mktemp("package")
    path = package / "kernels_of_test.py"
    path.write_text(_SOURCE)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    module.plain = {
        name: getattr(module, name) for name in ("weigh", "weigh_all", "strides", "write", "count", "both")
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numba.config, "CACHE_DIR", "")
        patch.delenv("NUMBA_CPU_NAME", raising=False)
        compiled = {}
        for name, function in module.plain.items():
            # What calls another finds it, compiled, among its own module's names.
            compiled[name] = kernel(function)
            setattr(module, name, compiled[name])
        for name, given in arguments(module).items():
            for one in given:
                compiled[name](*one)
        (package / "compiled").mkdir()
        write_library(package, package / "compiled", [path])
    for name, function in module.plain.items():
        setattr(module, name, function)
    module.package = package
    return module


@pytest.fixture
def installed(module, tmp_path, monkeypatch):
    """A copy of the library in the place of that of an installed package."""
    monkeypatch.delenv("NUMBA_CPU_NAME", raising=False)
    package = shutil.copytree(module.package, tmp_path / "package")
    monkeypatch.setattr(shipped_code, "_FOLDER", package / "compiled")
    shipped_code._opened.cache_clear()
    yield package
    shipped_code._opened.cache_clear()


def arguments(module):
    """Return arguments of each function, made anew; of all types that kernels are called with."""
    places = np.zeros(3, module.PLACE)
    places["x"] = 0.1, 0.7, 0.3
    places["axes"][2] = [[1.0, 2.0], [1e-3, 4.0]]
    inner = module.Inner(np.array([0.1, 0.2, 0.4]), 5)
    outer = module.Outer(np.zeros((2, 3)), inner, False, places, 0.3)
    plain = module.Plain(np.linspace(0.0, 1.0, 9)[::3], (0.7, 3))
    square, fixed = np.arange(12.0).reshape(3, 4) / 7.0, np.arange(4.0)
    fixed.flags.writeable = False
    return {
        "weigh": [(outer, plain, 1), (outer._replace(closed=True), plain, np.int64(0))],
        "weigh_all": [(outer, plain, places[2], True)],
        "strides": [
            (square, fixed),
            (np.asfortranarray(square), fixed),
            (square[::2, ::-1], fixed),
            (square[:0], fixed),
        ],
        "write": [(np.zeros(2), np.float64(0.1)), (np.zeros(2, dtype=np.int64), 3)],
        "count": [(4,)],
        "both": [(0.1, 3)],
    }


def called(name):
    """Return a kernel of the library; other types of arguments raise."""

    def otherwise():
        raise LookupError(name)

    return shipped_code.shipped(f"kernels_of_test:{name}", False, otherwise)


@pytest.mark.parametrize("name", ["weigh", "weigh_all", "strides", "write", "count", "both"])
def test_a_kernel_returns_and_writes_what_python_does(module, installed, name):
    """Equal, not close: sums in one order; the second call goes by the types that the first has found."""
    kernel, plain = called(name), module.plain[name]
    assert shipped_code.misfit() == ""
    for own, other in zip(arguments(module)[name], arguments(module)[name], strict=True):
        for _ in range(2):
            assert kernel(*own) == plain(*other)
        np.testing.assert_equal(own, other)


def test_the_row_of_a_record_is_the_one_in_its_array(module, installed):
    """A record is passed by where it stands, as Numba passes it."""
    outer, plain, place, closed = arguments(module)["weigh_all"][0]
    called("weigh_all")(outer, plain, place, closed)
    assert outer.places[2].count == 2 and outer.places[2].x == place.x != 0.3


def test_other_types_are_left_to_numba(module, installed):
    """Also of a constant array for one that is written, of another shape and of another class of tuple."""
    constant = np.zeros(2)
    constant.flags.writeable = False
    outer, plain, k = arguments(module)["weigh"][0]
    for name, given in (
        ("write", (constant, 1.0)),
        ("write", (np.zeros((2, 2)), 1.0)),
        ("write", (np.zeros(2, dtype=np.float32), 1.0)),
        ("weigh", (tuple(outer), plain, k)),
        ("weigh", (outer._replace(rows=outer.rows[:, ::-1]), plain, k)),
        ("count", ("4",)),
    ):
        with pytest.raises(LookupError, match=name):
            called(name)(*given)
    assert shipped_code.shipped("kernels_of_test:unknown", False, dict) is None


def test_an_integer_stands_for_a_float(module, installed):
    """As a value of a law's argument; Numba would compile a kernel for it."""
    assert called("both")(2, 3) == (6.0, 5.0)


def damage(path, at):
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda package, patch: damage(package / "compiled" / "kernels.so", -20), "does not hold what was"),
        (lambda package, patch: damage(package / "kernels_of_test.py", 40), "kernels have been changed"),
        (lambda package, patch: (package / "compiled").chmod(0o777), "is not safe, for .* by everybody"),
        (lambda package, patch: (package / "compiled" / "kernels.so").chmod(0o666), "is not safe, for"),
        (lambda package, patch: (package / "compiled" / "kernels.json").unlink(), "none is installed"),
        (lambda package, patch: (package / "compiled" / "kernels.json").write_text("{"), "cannot be read"),
        (lambda package, patch: patch.setenv("NUMBA_CPU_NAME", "generic"), "NUMBA_CPU_NAME requires generic"),
        (lambda package, patch: patch.setattr(shipped_code, "baseline_runs", lambda: False), "x86-64-v3"),
        (lambda package, patch: patch.setattr(shipped_code, "STRIDES", 32), "of another Python or NumPy"),
    ],
    ids=["library", "sources", "folder", "file", "index", "cut", "asked", "processor", "objects"],
)
def test_what_does_not_fit_is_not_called(installed, monkeypatch, change, reason):
    change(installed, monkeypatch)
    assert called("count") is None
    assert re.search(reason, shipped_code.misfit())


def test_the_index_is_plain_data(module):
    """Reading it runs nothing."""
    index = json.loads((module.package / "compiled" / "kernels.json").read_text())
    assert {name.partition(":")[2] for name in index["kernels"]} == module.plain.keys()


_WITHOUT_NUMBA = """\
import importlib.abc, sys

class Refused(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in ("numba", "llvmlite"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name.partition(".")[0])

sys.meta_path.insert(0, Refused())
from antenna_pin.compiled import shipped_code
from antenna_pin.errors import MissingToolError
from antenna_pin.joints.layout_kernels import nodes_at
shipped_code._opened = lambda: "none is installed"
try:
    nodes_at(0)
except MissingToolError as error:
    print(error)
"""


def test_what_must_be_compiled_without_numba_says_what_to_install():
    done = subprocess.run([sys.executable, "-c", _WITHOUT_NUMBA], capture_output=True, text=True, check=True)
    assert done.stdout == (
        "kernel 'antenna_pin.joints.layout_kernels:nodes_at' needs machine code, and none is installed; "
        "install what compiles it with pip install 'antenna-pin[compile]'\n"
    )
