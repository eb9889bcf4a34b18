"""The hooks of elements are declared once, with units, and every kind has them with these arguments."""

import inspect

import pytest

from antenna_pin.compiled.decorators import in_python
from antenna_pin.elements import ELEMENTS, PointSpring, kernels
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
    chains = {
        name for name, one in vars(kernels).items() if name[0] != "_" and type(one).__name__ == "_Composed"
    }
    assert chains <= set(HOOKS)
    assert all(hasattr(kernels, name) for name in HOOKS)


def test_every_hook_says_what_it_returns_or_writes():
    assert all(
        one.__doc__ and one.__doc__.split()[0] in ("Return", "Write", "Store") for one in HOOKS.values()
    )
