"""Kernels as plain Python, compiled nowhere: for tests of one of them on numbers of a small example."""

from __future__ import annotations

import types
from collections.abc import Callable
from typing import Any

from antenna_pin.compiled.decorators import in_python


def plain(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """Return a kernel as plain Python, with all kernels that it calls."""
    return _copied(kernel, {})


def inner(module: types.ModuleType, name: str) -> Callable[..., Any]:
    """Return a private kernel of a module as plain Python."""
    return plain(getattr(module, name))


def _copied(kernel: Any, made: dict[Any, Any]) -> Any:
    function = in_python(kernel)
    if function is kernel or not isinstance(function, types.FunctionType):
        return kernel
    if function not in made:
        own = dict(function.__globals__)
        made[function] = types.FunctionType(
            function.__code__, own, function.__name__, function.__defaults__, function.__closure__
        )
        for name in function.__code__.co_names:
            if name in own:
                own[name] = _copied(own[name], made)
    return made[function]
