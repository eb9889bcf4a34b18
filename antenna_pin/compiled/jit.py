"""Functions handed to Numba, prepared when first needed (``decorators.py`` declares them).

Numba caches a compiled function by the age of its file and does not detect a change of a function called in
another file. Kernels call each other across packages, so every cache entry is tied to the code of its kernel
file and of all kernel files that this one imports, directly or not. Changes other than of docstrings,
comments and annotations of functions recompile.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numba

import antenna_pin.compiled.intrinsics  # noqa: F401 - which tells Numba of them
import antenna_pin.compiled.slots  # noqa: F401 - likewise
from antenna_pin.compiled.kernel_cache import FORMAT, keep, remembered
from antenna_pin.compiled.numba_pipeline import KernelCompiler, compare_settings_fast
from antenna_pin.compiled.stand_alone import stand_alone
from antenna_pin.compiled.target import aim_at_baseline

aim_at_baseline()
compare_settings_fast()

_ROOMS_OF_KINDS = ("elements", "contact", "joints")  # kernels are in the modules of classes
# markers of files with kernels, or with fields of elements' records
_MARKS = (b"antenna_pin.compiled.decorators import", b"antenna_pin.elements.element import")
_REGISTRY = "contact/registry.py"  # names the files that are compiled into the chains of laws


def stamped_files() -> tuple[Path, ...]:
    """Return the files whose contents define the stamps of compiled code."""
    folder = Path(__file__).parents[1]
    names = (
        "**/*kernels.py",
        "contact/records.py",
        "base/records.py",
        "compiled/by_address.py",
        "compiled/calls.py",
        "compiled/deferred.py",
        "compiled/intrinsics.py",
        "compiled/lanes.py",
        "compiled/numba_pipeline.py",
        "compiled/record.py",
        "compiled/slots.py",
        _REGISTRY,
    )
    kinds = (path for room in _ROOMS_OF_KINDS for path in (folder / room).glob("*.py"))
    found = {path for name in names for path in folder.glob(name)}
    return tuple(
        sorted(found | {path for path in kinds if any(mark in path.read_bytes() for mark in _MARKS)})
    )


def stamp_of(path: str | Path) -> str:
    """Return the stamp of a file's kernels: a digest of its and imported code.

    A file outside the package is tied to all kernel files.
    """
    stamps = _stamps()
    return stamps.get(str(Path(path).resolve()), stamps[""])


@cache
def _stamps() -> dict[str, str]:
    """Return the stamps of kernel files by path; of all files by an empty path."""
    files = stamped_files()
    texts = [path.read_bytes() for path in (Path(__file__), *files)]
    contents = hashlib.sha256(f"{numba.__version__} {FORMAT}".encode())
    for text in texts:
        contents.update(text)

    def of_code() -> str:
        return " ".join(_digests(texts[0], dict(zip(files, texts[1:], strict=True))))

    *each, whole = remembered(dispatcher, contents.hexdigest(), of_code).split()
    return {"": whole} | {str(path.resolve()): one for path, one in zip(files, each, strict=True)}


def _digests(own: bytes, texts: Mapping[Path, bytes]) -> list[str]:
    """Return the stamps of files, then the stamp of all, from their texts."""
    room = Path(__file__).parent
    codes = {path: code_of(text, with_methods=path.parent == room) for path, text in texts.items()}
    imports = {path: _imports(path, text, codes) for path, text in texts.items()}
    base = f"{numba.__version__} {FORMAT} {code_of(own)}"

    def digest(paths: Iterable[Path]) -> str:
        return hashlib.sha256(
            "\0".join([base, *(codes[path] for path in sorted(paths))]).encode()
        ).hexdigest()

    everywhere = {path for path in codes if path.parent == room}
    stamps = []
    for path in codes:
        reached, left = set(everywhere), [path]
        while left:
            one = left.pop()
            reached.add(one)
            left += imports[one] - reached
        stamps.append(digest(reached))
    return [*stamps, digest(codes)]


def _imports(path: Path, text: bytes, stamped: Collection[Path]) -> set[Path]:
    """Return the stamped files imported by a file; by the registry, its whole room."""
    folder = Path(__file__).parents[1]
    if path == folder / _REGISTRY:
        return {one for one in stamped if one.parent == path.parent}
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(folder.name):
            source = folder.joinpath(*str(node.module).split(".")[1:])
            found |= {source.with_suffix(".py"), *(source / f"{name.name}.py" for name in node.names)}
    return found & set(stamped)


def code_of(text: bytes | str, with_methods: bool = False) -> str:
    """Return the syntax tree of a module, as text, without parts that cannot affect kernels.

    These are docstrings, annotations of functions, and in classes the methods and the declarations of fields
    except for names and types; properties that are ``packed`` remain.
    """
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
        if isinstance(node, ast.ClassDef) and not with_methods:
            node.body = [kept for one in node.body if (kept := _of_class(one)) is not None]
            for one in node.body:
                if isinstance(one, ast.AnnAssign) and isinstance(one.value, ast.Call):
                    one.value = None
    return ast.dump(tree)


def _of_class(node: ast.stmt) -> ast.stmt | None:
    """Return a statement of a class: no method, a packed property as a field."""
    if not isinstance(node, ast.FunctionDef):
        return node
    if node.returns is None or "packed" not in [getattr(one, "id", "") for one in node.decorator_list]:
        return None
    return ast.AnnAssign(ast.Name(node.name), node.returns, simple=1)


def dispatcher(
    function: Callable[..., Any], cached: bool, alone: bool = False, entry: bool = False, **options: bool
) -> Any:
    """Return a function as Numba compiles it; the function itself where nothing is compiled.

    Args:
        function: Function in Python.
        cached: Whether its machine code is stored, and a plain constant counts as a number.
        alone: Whether its callers call it by name (:func:`antenna_pin.compiled.stand_alone.stand_alone`).
        entry: Whether Python calls it, not kernels.
        **options: Options of Numba.
    """
    compiled = _njit(function, no_cpython_wrapper=not entry, **options)
    if cached:
        _take_constants_as_numbers(compiled)
        keep(compiled, stamp_of(function.__code__.co_filename), entry)
    if alone and not entry:
        stand_alone(compiled)
    return compiled


def _take_constants_as_numbers(compiled: Any) -> None:
    """Let calls with a plain constant use the function compiled for numbers.

    Numba gives a constant a type of its own: the function and all its callees would be compiled once more for
    each constant.
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
        return numba.njit(
            error_model="numpy",
            _nrt=False,
            no_cfunc_wrapper=True,
            pipeline_class=KernelCompiler,
            **options,
        )(function)
    except KeyError:
        # These options are internal to Numba; without the one against reference counts kernels are slower.
        return numba.njit(error_model="numpy", **options)(function)
