"""The kernels are plain Python too: the same numbers without the compiler, for every kind of part."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import every_kind
import numpy as np
import pytest

from antenna_pin.base.records import Floats, Record, Vector3, layout
from antenna_pin.dynamics.constraints import CLOSURES
from antenna_pin.elements import PointSpring
from antenna_pin.elements.registry import ELEMENTS
from antenna_pin.scenario.clearance import CLEARANCES

SCRIPT = "import json, every_kind; print(json.dumps(every_kind.told()))"


@pytest.fixture(scope="module")
def without():
    """How the runs end without the compiler."""
    path = os.pathsep.join([str(Path(every_kind.__file__).parent), *sys.path])
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": path}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


def test_runs_without_the_compiler_give_the_same_numbers(without):
    """No fastmath: what differs is the round-off of some tens of evaluations."""
    compiled = every_kind.told()
    assert set(compiled) == set(without)
    for name, (evaluations, end) in compiled.items():
        plainly, other = without[name]
        assert plainly == evaluations, name
        assert other == pytest.approx(end, rel=1e-9, abs=1e-11), name


def test_every_kind_runs_without_the_compiler():
    """A new element, joint with play or closure takes its place among them."""
    parts = [*every_kind.DRIVES.values(), *every_kind.IN_PYTHON.values(), *every_kind.SPRINGS.values()]
    parts += [*every_kind.GEARS.values(), *every_kind.FORCES.values(), *every_kind.FORCES_IN_PYTHON.values()]
    parts += every_kind.SHAKES.values()
    parts += [part for family in every_kind.WITH_MODES.values() for part in family.values()]
    assert {type(part) for part in parts} == {*ELEMENTS, PointSpring}
    assert {*CLEARANCES} - {"ideal", "constraint"} == {*every_kind.PLAY, every_kind.ROUND} - {"coal"}
    runs = {name for name, _ in every_kind.systems()}
    assert {f"{kind} closure" for kind in CLOSURES} <= runs


_COLUMNS = 4


class _Placed(Record):
    inverses: int
    centre: Vector3


class _Turned(_Placed):
    sine: float
    numbers: Annotated[Floats, (2, _COLUMNS)]


def test_a_record_has_the_fields_of_its_class_in_order():
    assert layout(_Placed).descr == [("inverses", "<i8"), ("centre", "<f8", (3,))]
    assert layout(_Turned).names == ("inverses", "centre", "sine", "numbers")
    assert np.zeros(1, layout(_Turned))[0].numbers.shape == (2, _COLUMNS)


def test_a_record_refuses_names_that_numpy_has():
    """Without the compiler ``record.diagonal`` would be NumPy's method, whatever stands in the field."""
    for name in ("base", "diagonal", "size", "T"):
        kind = type("Kind", (Record,), {"__annotations__": {"rate": float, name: float}})
        with pytest.raises(ValueError, match=re.escape(f"an attribute of numpy.void, got {name}:")):
            layout(kind)
        assert hasattr(np.void, name)
