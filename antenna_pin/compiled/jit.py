"""Functions handed to Numba: what ``decorators.py`` declares is made here when it is first needed.

Numba caches a compiled function by the age of the file it stands in, and does not see that a function it
calls in another file has changed. The kernels call one another across rooms, so here every cache entry is
tied to the code of all kernel files: a change in any of them compiles all of them anew, other than of
docstrings, comments and annotations of functions.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba

import antenna_pin.compiled.address_intrinsics  # noqa: F401 - which tells Numba of them
import antenna_pin.compiled.intrinsics  # noqa: F401 - which tells Numba of them
from antenna_pin.compiled.kernel_cache import FORMAT, keep, remembered
from antenna_pin.compiled.stand_alone import stand_alone
from antenna_pin.compiled.target import aim_at_baseline

__all__ = ["code_of", "dispatcher", "stamped_files"]


aim_at_baseline()


def stamped_files() -> tuple[Path, ...]:
    """Return the files whose contents define the stamp of compiled code."""
    folder = Path(__file__).parents[1]
    names = (
        "**/*kernels.py",
        "contact/records.py",
        "base/records.py",
        "compiled/address_intrinsics.py",
        "compiled/by_address.py",
        "compiled/calls.py",
        "compiled/intrinsics.py",
        "compiled/lanes.py",
        "compiled/record.py",
        "elements/registry.py",
    )
    return tuple(sorted(path for name in names for path in folder.glob(name)))


@cache
def _stamp() -> str:
    """Return a digest of the code of all kernel files and of Numba's version."""
    texts = [path.read_bytes() for path in (Path(__file__), *stamped_files())]
    contents = hashlib.sha256(f"{numba.__version__} {FORMAT}".encode())
    for text in texts:
        contents.update(text)

    def of_code() -> str:
        digest = hashlib.sha256(f"{numba.__version__} {FORMAT}".encode())
        for text in texts:
            digest.update(code_of(text).encode())
        return digest.hexdigest()

    return remembered(dispatcher, contents.hexdigest(), of_code)


def code_of(text: bytes | str) -> str:
    """Return the syntax tree of a module, as text, without docstrings and annotations of functions."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.returns = None
            for argument in ast.walk(node.args):
                if isinstance(argument, ast.arg):
                    argument.annotation = None
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                del node.body[0]
    return ast.dump(tree)


def dispatcher(function: Callable[..., Any], cached: bool, alone: bool = False, **options: bool) -> Any:
    """Return a function as Numba compiles it; the function itself where nothing is compiled.

    Args:
        function: In Python.
        cached: Whether its machine code is kept, and a plain constant counts as the number it is.
        alone: Whether its callers call it by name (:func:`antenna_pin.compiled.stand_alone.stand_alone`).
        **options: Numba's.
    """
    compiled = _njit(function, **options)
    if cached:
        _take_constants_as_numbers(compiled)
        keep(compiled, _stamp())
    if alone:
        stand_alone(compiled)
    return compiled


def _take_constants_as_numbers(compiled: Any) -> None:
    """Let calls with a plain constant use the function compiled for numbers.

    Numba makes of a constant a type of its own: the function, and all that it calls, would be compiled once
    more for each.
    """
    if getattr(compiled, "py_func", None) is None:  # NUMBA_DISABLE_JIT=1
        return
    template = compiled.get_call_template

    def of_numbers(arguments: Any, keywords: Any) -> Any:
        plain = {name: numba.types.unliteral(one) for name, one in keywords.items()}
        return template(tuple(map(numba.types.unliteral, arguments)), plain)

    compiled.get_call_template = of_numbers


def _njit(function: Callable[..., Any], **options: bool) -> Any:
    try:
        # No entry for C: nothing here asks for an address.
        return numba.njit(error_model="numpy", _nrt=False, no_cfunc_wrapper=True, **options)(function)
    except KeyError:
        # These options are Numba's own, not promised ones; without that against counting kernels are slower.
        return numba.njit(error_model="numpy", **options)(function)
