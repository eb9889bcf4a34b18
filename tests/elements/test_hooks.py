"""The hooks of elements are declared once, with units, and every kind has them with these arguments."""

import inspect

import pytest

from antenna_pin.compiled.decorators import in_python
from antenna_pin.elements import ELEMENTS, PointSpring, kernels
from antenna_pin.elements.hook_kernels import Hooks

HOOKS = {name: one for name, one in vars(Hooks).items() if inspect.isfunction(one) and name[0] != "_"}
MODULES = {element.kernels: element.compiled() for element in (*ELEMENTS, PointSpring)}

NAMED = {"length": "angle"}
"""Arguments that a kind has under a name of its own: between points the distance is the deflection."""


def arguments(function):
    """Return names and types of what a hook takes, without what it is bound to."""
    found = inspect.signature(in_python(function)).parameters.values()
    return [(NAMED.get(one.name, one.name), one.annotation) for one in found if one.name != "self"]


@pytest.mark.parametrize("module", MODULES)
def test_a_kind_has_its_hooks_as_they_are_declared(module):
    own = {name: getattr(MODULES[module], name) for name in HOOKS if hasattr(MODULES[module], name)}
    assert own
    for name, function in own.items():
        assert arguments(function) == arguments(HOOKS[name]), name
        assert inspect.signature(in_python(function)).return_annotation == (
            inspect.signature(HOOKS[name]).return_annotation
        ), name


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
