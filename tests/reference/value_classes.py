"""Dataclasses of a subpackage: frozen, keyword-only, documented with their units, checked by their rules."""

import dataclasses
import importlib
import inspect
import math
import pkgutil
import re
from typing import get_args, get_type_hints

import pytest

import antenna_pin
from antenna_pin.base.parameters import attribute_docs, parameters_of
from antenna_pin.base.rules import finite_too, obeys
from antenna_pin.errors import InvalidParameterError

_UNIT = re.compile(r"\[([^\],]+)\]")  # [0, 1] is a range


def dataclasses_of(room):
    """Return all dataclasses of a subpackage, private ones too."""
    package = importlib.import_module(f"{antenna_pin.__name__}.{room}")
    modules = [
        importlib.import_module(one.name)
        for one in pkgutil.iter_modules(package.__path__, f"{package.__name__}.")
        if not one.ispkg
    ]
    return [
        cls
        for module in (package, *modules)
        for cls in vars(module).values()
        if inspect.isclass(cls) and cls.__module__ == module.__name__ and "__dataclass_params__" in vars(cls)
    ]


def changeable(room):
    """Return the names of dataclasses that are not frozen, or that take attributes they do not declare."""
    return {
        cls.__name__
        for cls in dataclasses_of(room)
        if not (cls.__dataclass_params__.frozen and "__slots__" in vars(cls))
    }


def by_position(room):
    """Return the names of dataclasses some fields of which may be given without their names."""
    return {
        cls.__name__
        for cls in dataclasses_of(room)
        if not all(one.kw_only for one in dataclasses.fields(cls))
    }


def documented_units(cls):
    """Return the units in brackets of each attribute's description, as the package writes units."""
    return {
        name: [_plain(unit) for unit in _UNIT.findall(text)] for name, text in attribute_docs(cls).items()
    }


def undocumented_units(room):
    """Return the described parameters whose docstring begins with another unit: (class, name, declared unit).

    The unit at a sliding joint comes second. A pure number needs none.
    """
    found = set()
    for cls in dataclasses_of(room):
        documented = documented_units(cls)
        for name, one in parameters_of(cls).items():
            units = [_plain(unit) for unit in (one.unit, one.sliding) if unit]
            if name in documented and (documented[name][: len(units)] or ["1"]) != units:
                found.add((cls.__name__, name, one.unit))
    return found


def _plain(unit):
    """Return a unit with powers and products written one way."""
    return {"-": "1"}.get(unit, unit).replace("**", "^").replace(" ", "*")


def check_refusals(one):
    """Check that each declared number of an object is refused, in one line, where it breaks its rule."""
    cls = type(one)
    hints = get_type_hints(cls)
    for name, declared in parameters_of(cls).items():
        whole = int in (hints[name], *get_args(hints[name]))
        for bad in (-1, 0) if whole else (-1.0, 0.0, 0.5, 1.3, math.nan, math.inf):
            if declared.sizes or (math.isfinite(bad) and obeys(bad, declared.rule)):
                continue
            message = f"{cls.__name__}: {name} must be {finite_too(declared.rule)}, got {bad!r}"
            with pytest.raises(InvalidParameterError, match=f"^{re.escape(message)}$"):
                dataclasses.replace(one, **{name: bad})
