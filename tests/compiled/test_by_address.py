"""What stands at an address is what Python has handed in, at each call anew."""

from typing import Any, NamedTuple

import numba
import numpy as np

import antenna_pin.compiled.intrinsics  # noqa: F401 - which tells Numba of such tuples
from antenna_pin.compiled.by_address import by_address


@by_address
class Inner(NamedTuple):
    """Numbers to weigh with."""

    weights: Any
    count: int


@by_address
class Outer(NamedTuple):
    """What is weighed, in a tuple that holds another."""

    rows: Any
    inner: Any
    factor: float


class Plain(NamedTuple):
    """A tuple that is handed on word by word."""

    rows: Any
    factor: float


def weigh(outer, r):
    """Write a row and return its sum, by all parts of a tuple and of the one in it."""
    total = 0.0
    for k in range(outer.inner.weights.shape[0]):
        outer.rows[r, k] = outer.factor * outer.inner.weights[k] + outer.inner.count
        total += outer.rows[r, k]
    return total


_weigh = numba.njit(weigh)


@numba.njit
def weigh_all(outer):
    """Hand a tuple on."""
    total = 0.0
    for r in range(outer.rows.shape[0]):
        total += _weigh(outer, r)
    return total


def test_parts_are_those_of_the_tuple():
    outer = Outer(np.zeros((2, 3)), Inner(np.array([1.0, 2.0, 4.0]), 5), 0.5)
    again = outer._replace(rows=np.zeros((2, 3)))
    assert weigh_all(outer) == weigh(again, 0) + weigh(again, 1) == 37.0
    assert np.array_equal(outer.rows, again.rows)


def test_each_call_sees_its_own():
    """Nothing is kept from one call to the next: compiled code may read a part once, but of this call's."""
    for factor, count in ((0.5, 5), (2.0, -1), (0.5, 7)):
        outer = Outer(np.zeros((1, 3)), Inner(np.arange(3.0), count), factor)
        assert weigh_all(outer) == 3.0 * factor + 3.0 * count
        weights = np.arange(3.0)[::-1].copy()
        assert weigh_all(outer._replace(inner=Inner(weights, 0))) == 3.0 * factor


def test_is_one_word_to_compiled_code():
    """However many arrays it holds: that is what it is for. Others stay as they were."""
    outer = Outer(np.zeros((1, 3)), Inner(np.arange(3.0), 1), 0.5)
    described = numba.core.registry.cpu_target.target_context.data_model_manager
    assert not isinstance(described[numba.typeof(outer)].get_argument_type(), tuple)
    assert isinstance(described[numba.typeof(Plain(np.zeros(3), 0.5))].get_argument_type(), tuple)


def test_references_are_given_back():
    """An array that is handed in is held by nobody after the call."""
    import sys

    rows = np.zeros((1, 3))
    outer = Outer(rows, Inner(np.arange(3.0), 1), 0.5)
    weigh_all(outer)
    before = sys.getrefcount(rows)
    for _ in range(100):
        weigh_all(outer)
    assert sys.getrefcount(rows) == before
