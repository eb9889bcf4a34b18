#!/usr/bin/env python3
"""Kernels that Python calls by name and that a shared library has no entry for.

    python scripts/check/called_kernels.py kernels.json    # exit code 1 if there are any

An installed package without Numba would fail there. What has entries is what ``scripts/compile_kernels.py
--all`` calls.
"""

from __future__ import annotations

import ast
import importlib
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import antenna_pin
from antenna_pin.compiled.decorators import _LazyKernel

PACKAGE = Path(antenna_pin.__path__[0])


def is_compiled(node: ast.stmt) -> bool:
    """Return whether a statement defines a compiled function."""
    return isinstance(node, ast.FunctionDef) and any(
        getattr(one, "id", "") in ("kernel", "inlined", "released", "deferred") for one in node.decorator_list
    )


def called_in(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield module and name of functions of kernel files that a file calls."""
    if isinstance(tree, ast.Module):  # kernels beside a kind's class are not Python's
        tree.body = [one for one in tree.body if not is_compiled(one)]
    names: dict[str, tuple[str, str]] = {}
    modules: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("antenna_pin"):
            for one in node.names:
                own = one.asname or one.name
                if str(node.module).endswith(("kernels", "records")):
                    names[own] = str(node.module), one.name
                elif one.name.endswith("kernels"):
                    modules[own] = f"{node.module}.{one.name}"
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            called = node.func
            if isinstance(called, ast.Name) and called.id in names:
                yield names[called.id]
            elif isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
                if called.value.id in modules:
                    yield modules[called.value.id], called.attr


def main() -> int:
    """Print the names."""
    entries = json.loads(Path(sys.argv[1]).read_text())["kernels"]
    files = [path for path in PACKAGE.rglob("*.py") if not path.name.endswith("kernels.py")]
    lacking = set()
    for path in files:
        for module, name in called_in(ast.parse(path.read_text())):
            function = getattr(importlib.import_module(module), name)
            if isinstance(function, _LazyKernel):
                if function.name not in entries:
                    lacking.add(function.name)
    print("\n".join(sorted(lacking)) or f"none of {len(files)} files")
    return int(bool(lacking))


if __name__ == "__main__":
    sys.exit(main())
