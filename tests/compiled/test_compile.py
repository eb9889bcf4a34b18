"""What stands in for a kernel until it is needed is the kernel to whoever uses it."""

import copy
import pickle
import subprocess
import sys

import numba
import pytest

from antenna_pin.compiled.decorators import in_python
from antenna_pin.joints.layout_kernels import candidate_at, nodes_at

_LOADED = """\
import importlib, pathlib, sys
import antenna_pin
folder = pathlib.Path(antenna_pin.__file__).parent
for path in sorted(folder.glob("*/*kernels.py")):
    importlib.import_module(f"antenna_pin.{path.parent.name}.{path.stem}")
print("numba" in sys.modules)
from antenna_pin.joints.layout_kernels import nodes_at
nodes_at(0)
print("numba" in sys.modules)
"""


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_numba_is_loaded_with_the_first_call_and_not_with_the_kernels():
    done = subprocess.run([sys.executable, "-c", _LOADED], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "True"]


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")
def test_the_form_for_kernels_refuses_calls_from_python():
    """Numba makes no entry for them: the call would jump to a null address."""
    with pytest.raises(RuntimeError, match="^nodes_at: compiled for kernels only; call the kernel itself$"):
        nodes_at._made(3)


def test_a_kernel_goes_to_other_processes_by_its_name():
    """As a function does: who unpickles it has the one that is there."""
    assert pickle.loads(pickle.dumps(candidate_at)) is candidate_at
    assert copy.deepcopy(candidate_at) is candidate_at


def test_a_kernel_is_what_is_written_to_other_compiled_code_and_in_python():
    """Whole numbers: equal, not close."""
    of_user = numba.njit(lambda b: nodes_at(b) + candidate_at(b, 2))
    expected = in_python(nodes_at)(3) + in_python(candidate_at)(3, 2)
    assert of_user(3) == nodes_at(3) + candidate_at(3, 2) == expected
