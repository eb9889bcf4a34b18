"""The hooks of elements are declared once, with units, and every kind has them with these arguments."""

import inspect
import math
from dataclasses import dataclass
from typing import ClassVar, Literal

import pytest

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import words_of
from antenna_pin.compiled.decorators import ByKind, in_python, inlined, record
from antenna_pin.elements import ELEMENTS, PointSpring, kernels
from antenna_pin.elements.element import Element, packed
from antenna_pin.elements.hook_kernels import Hooks

HOOKS = {name: one for name, one in vars(Hooks).items() if inspect.isfunction(one) and name[0] != "_"}
MODULES = {element.kernels: element for element in (*ELEMENTS, PointSpring)}

NAMED = {"length": "angle"}
"""Arguments that a kind has under a name of its own: between points the distance is the deflection."""


def arguments(function):
    """Return names and types of what a hook takes behind the element, and the numbers behind its record."""
    _, *found = inspect.signature(in_python(function)).parameters.values()
    found = [one for one in found if one.name not in ("element", "tail")]
    return [(NAMED.get(one.name, one.name), one.annotation) for one in found]


@pytest.mark.parametrize("module", MODULES)
def test_a_kind_has_its_hooks_as_they_are_declared(module):
    element = MODULES[module]
    own = {name: element.hook(name) for name in HOOKS if element.hook(name) is not None}
    assert own
    for name, function in own.items():
        assert arguments(function) == arguments(HOOKS[name]), name
        signature = inspect.signature(in_python(function))
        assert signature.return_annotation == inspect.signature(HOOKS[name]).return_annotation, name
        records = next(iter(signature.parameters.values())).annotation.split(" | ")
        assert {base.__name__ for base in element.__mro__} & {*records}, "its first argument is the element"


def test_every_hook_is_called_by_the_number_of_a_kind():
    rows = {name for name, one in vars(kernels).items() if isinstance(one, ByKind)}
    assert rows - {"mode"} <= set(HOOKS)  # a kind's mode is a number of its record
    assert set(HOOKS) - rows == {"write_rates", "kink"}  # of kinds without states, called as those with them


def test_every_hook_says_what_it_returns_or_writes():
    assert all(
        one.__doc__ and one.__doc__.split()[0] in ("Return", "Write", "Store") for one in HOOKS.values()
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Example(Element):
    """Fields of all sorts."""

    kernels: ClassVar[str] = __name__
    unpacked: ClassVar[tuple[str, ...]] = ("on", "behind")

    stiffness: float = 3.0
    count: int = 2
    way: Literal["up", "down"] = "down"
    limit: float | None = parameter(default=None)
    axis: tuple[float, float, float] = (0.0, 0.6, 0.8)
    table: tuple[float, ...] = (1.0, 2.0)
    behind: float = 5.0
    stays: bool = True
    on: bool = True

    @packed
    def largest(self) -> float:
        """No limit."""
        return math.inf if self.limit is None else self.limit

    def tail(self):
        """Return the table."""
        return self.table


class Further(Example):
    """Another of the kind."""

    more: float = 4.0


def test_a_record_has_the_numbers_of_the_class_that_names_the_kernels():
    """Not what may be None, is text, of any size, or said to stand elsewhere; and the same for its heirs."""
    assert Example.layout().names == ("stiffness", "count", "axis", "stays", "largest")
    assert Further.layout() is Example.layout()
    words = Example(joint="hinge").words_of_kernel()
    size = words_of(Example.layout())
    own = record(words[:size], Example.layout())
    assert (own.stiffness, own.count, own.stays, own.largest) == (3.0, 2, 1, math.inf)
    assert own.axis.tolist() == [0.0, 0.6, 0.8] and words[size:].tolist() == [1.0, 2.0]


@inlined
def effort(example, t, angle, rate):
    """Return a whole number, without annotations."""
    return 2


def test_a_hook_needs_no_annotations(monkeypatch):
    """What it returns follows from the declaration of the hook, also for compiled callers."""
    monkeypatch.setattr(kernels.registry, "element_of", lambda number: Example)
    words = Example(joint="hinge").words_of_kernel()
    found = in_python(kernels.effort.at.__wrapped__(0))(words, 0, 0.0, 0.5, 0.0)
    assert (found, type(found)) == (2.0, float)
