"""Shared library of all stored kernels, linked for a wheel.

``shipped_code.py`` calls it. Numba stores compiled functions as object files for its own linker, with
optimised LLVM code. From that code object files for a shared library are generated here, without the parts
that only Numba calls. The instructions between numbers are the same, and so are all results.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import tempfile
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numba
from llvmlite import binding, ir
from numba import types
from numba.core.registry import cpu_target
from numba.np.arrayobj import populate_array
from numba.np.numpy_support import as_dtype

from antenna_pin.compiled.jit import stamp_of, stamped_files
from antenna_pin.compiled.kernel_cache import stored_code
from antenna_pin.compiled.machine_code import Kept
from antenna_pin.compiled.shipped_code import (
    DATA,
    FORMAT,
    INDEX,
    LIBRARY,
    RECORD,
    SHAPE,
    STRIDES,
    digest_of,
    dtype_text,
    key_of,
)
from antenna_pin.compiled.slots import FILL, symbols_of_call
from antenna_pin.compiled.stand_alone import symbol_of, symbols_of
from antenna_pin.compiled.target import BASELINE

#: Functions of Numba's runtime that code calls: here for arrays in C order, as all reshaped ones are.
_HELPERS = """
#include <stdint.h>
int numba_attempt_nocopy_reshape(intptr_t axes, const intptr_t *dims, const intptr_t *strides,
                                 intptr_t count, const intptr_t *newdims, intptr_t *newstrides,
                                 intptr_t itemsize, int fortran)
{
    intptr_t size = 1, step = itemsize;
    for (intptr_t k = 0; k < axes; k++) size *= dims[k];
    for (intptr_t k = axes - 1; size && k >= 0; step *= dims[k--])
        if (dims[k] != 1 && strides[k] != step) return 0;
    step = itemsize;
    for (intptr_t k = count - 1; k >= 0; step *= newdims[k--]) newstrides[k] = step;
    return !fortran;
}
"""

_WORD, _BYTE = ir.IntType(64), ir.IntType(8)
_ADDRESS = ir.PointerType(_BYTE)


class _UnsupportedError(Exception):
    """A type that does not come from Python, or does not go there."""


def write_library(package: Path, folder: Path, sources: Iterable[Path] | None = None) -> None:
    """Link the stored kernels of a package into a shared library with an index.

    Args:
        package: Folder of the package, with machine code beside its sources.
        folder: Folder for both, of a package with the same sources.
        sources: Files that the kernels depend on; all stamped ones by default.

    Raises:
        OSError: There is no linker.
        subprocess.CalledProcessError: The linker fails.
    """
    cpu_target.target_context.refresh()
    kernels = _all_kernels(package)
    machine = binding.Target.from_default_triple().create_target_machine(
        cpu=BASELINE, features="", opt=3, reloc="pic", codemodel="small"
    )
    entries = ir.Module("entries")
    entries.triple, entries.data_layout = binding.get_default_triple(), str(machine.target_data)
    index: dict[str, dict[str, Any]] = {}
    for symbol, (name, kernel) in kernels.items():
        try:
            types_ = [_text(one) for one in kernel.signature.args]
            entry = _write_entry(entries, symbol, kernel.signature, f"entry_{len(entries.functions)}")
        except _UnsupportedError:
            continue
        index.setdefault(name, {})[key_of(types_)] = entry
    _fill_slots(entries, kernels)
    with tempfile.TemporaryDirectory() as made:
        objects = [Path(made) / f"{number}.o" for number in range(len(kernels) + 1)]
        for path, (symbol, (_, kernel)) in zip(objects, kernels.items(), strict=False):
            path.write_bytes(_object(machine, kernel, symbol))
        objects[-1].write_bytes(machine.emit_object(binding.parse_assembly(str(entries))))
        helpers = Path(made) / "helpers.c"
        helpers.write_text(_HELPERS)
        visible = Path(made) / "visible"
        visible.write_text("{ global: entry_*; local: *; };")
        told = ["-Wl,-z,defs", "-Wl,--build-id=none", "-Wl,-s", f"-Wl,--version-script={visible}"]
        library = folder / LIBRARY
        listed = Path(made) / "objects"
        listed.write_text("\n".join(map(str, objects)))
        subprocess.run(
            ["cc", "-shared", "-fPIC", "-O2", *told, "-o", library, helpers, f"@{listed}", "-lm"], check=True
        )
    names = [path.relative_to(package).as_posix() for path in sources or stamped_files()]
    whole = {
        "format": FORMAT,
        "numba": numba.__version__,
        "of_library": hashlib.sha256(library.read_bytes()).hexdigest(),
        "of_sources": digest_of(package / name for name in names),
        "sources": names,
        "kernels": index,
    }
    (folder / INDEX).write_text(json.dumps(whole, separators=(",", ":")))


def _all_kernels(package: Path) -> dict[str, tuple[str, Kept]]:
    """Return name and code of each stored kernel whose callees are stored, by symbols."""
    found = {}
    for source in sorted(package.rglob("*.py")):
        for kernel in stored_code(source, stamp_of(source)):
            name = f"{kernel.description.modname}:{kernel.description.qualname}"
            found[symbol_of(name, kernel.signature.args)] = (name, kernel)
    while lacking := [one for one, (_, kernel) in found.items() if not found.keys() >= _called_by(kernel)]:
        for symbol in lacking:
            del found[symbol]
    return found


def _called_by(kernel: Kept) -> set[str]:
    """Return the symbols of kernels that a kernel calls, those through slots included."""
    return {*symbols_of(kernel), *(one for call in kernel.deferred for one in symbols_of_call(call)[1])}


def _fill_slots(module: Any, kernels: dict[str, tuple[str, Kept]]) -> None:
    """Define all slots, filled, and the function that would fill one."""
    calls = {call for _, kernel in kernels.values() for call in kernel.deferred}
    for name, symbols in dict(sorted(map(symbols_of_call, calls))).items():
        functions = [
            module.globals.get(one) or ir.Function(module, ir.FunctionType(_WORD, []), one) for one in symbols
        ]
        slots = ir.GlobalVariable(module, ir.ArrayType(_ADDRESS, len(symbols)), name)
        slots.initializer = slots.value_type([function.bitcast(_ADDRESS) for function in functions])
    fill = ir.Function(module, ir.FunctionType(_ADDRESS, [_ADDRESS, _WORD]), FILL)
    ir.IRBuilder(fill.append_basic_block()).ret(_ADDRESS(None))


def _object(machine: Any, kernel: Kept, symbol: str) -> bytes:
    """Return the object file of a kernel, under its symbol and without what Python calls."""
    module = binding.parse_bitcode(zlib.decompress(kernel.bitcode))
    for one in [*module.functions, *module.global_variables]:
        if not one.is_declaration:
            one.linkage = "internal"
    function = module.get_function(kernel.description.llvm_func_name)
    function.linkage, function.name = "external", symbol
    passes = binding.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, binding.create_pass_builder(machine, binding.create_pipeline_tuning_options()))
    return bytes(machine.emit_object(module))


# --- entries ---


def _text(kind: Any) -> str:
    """Return a type of Numba's as text, equal to that of a value in ``shipped_code.py``."""
    if isinstance(kind, types.Array) and not isinstance(kind, types.NestedArray):
        constant = "" if kind.mutable else " constant"
        return f"{dtype_text(as_dtype(kind.dtype))}:{kind.ndim}{kind.layout}{constant}"
    if isinstance(kind, types.BaseTuple):
        inner, cls = ",".join(map(_text, kind.types)), getattr(kind, "instance_class", None)
        return f"{cls.__module__}.{cls.__qualname__}({inner})" if cls else f"({inner})"
    if isinstance(kind, types.Record):
        return dtype_text(as_dtype(kind))
    return _code(kind)


def _code(kind: Any) -> str:
    """Return the code of a number; of a whole tuple they are in brackets."""
    for one, code in ((types.float64, "d"), (types.int64, "q"), (types.boolean, "?")):
        if types.unliteral(kind) == one:
            return code
    raise _UnsupportedError(kind)


def _result(kind: Any) -> str | list[Any]:
    """Return the codes of what a kernel returns."""
    if kind == types.none:
        return ""
    return [_result(one) for one in kind.types] if isinstance(kind, types.BaseTuple) else _code(kind)


def _write_entry(module: Any, symbol: str, signature: Any, name: str) -> tuple[str, str, str | list[Any]]:
    """Write a kernel's entry; return its name and the codes of row and result."""
    context, result = cpu_target.target_context, _result(signature.return_type)
    call = context.call_conv
    callee = ir.Function(module, call.get_function_type(signature.return_type, signature.args), symbol)
    entry = ir.Function(module, ir.FunctionType(ir.IntType(32), [_WORD.as_pointer()] * 2), name)
    builder = ir.IRBuilder(entry.append_basic_block())
    row = _RowIr(builder, entry.args[0])
    arguments = [_value(context, builder, kind, row) for kind in signature.args]
    status, value = call.call_function(builder, callee, signature.return_type, signature.args, arguments)
    for number, (code, part) in enumerate(_parts(builder, signature.return_type, value)):
        word = builder.bitcast(part, _WORD) if code == "d" else builder.zext(part, _WORD)
        builder.store(word, builder.gep(entry.args[1], [_WORD(number)]))
    builder.ret(builder.zext(status.is_error, ir.IntType(32)))
    return name, "".join(row.codes), result


class _RowIr:
    """Words of an entry's row, read one by one, and memory for tuples."""

    def __init__(self, builder: Any, start: Any, place: Any = None, room: int = 0) -> None:
        """Begin at the first word, with memory behind some words or on the stack."""
        self._builder, self.start, self._place, self.room = builder, start, place, room
        self.codes: list[str] = []

    def word(self, code: str) -> Any:
        """Return the next word, of a code."""
        self.codes.append(code)
        return self._builder.load(self._builder.gep(self.start, [_WORD(len(self.codes) - 1)]))

    def room_of(self, words: int) -> Any:
        """Return the address of room for so many words."""
        if self._place is None:
            return self._builder.alloca(_WORD, size=_WORD(words))
        self.room += words
        return self._builder.gep(self._place, [_WORD(self.room - words)])


def _value(context: Any, builder: Any, kind: Any, row: _RowIr) -> Any:
    """Return an argument as Numba has it, from the words of a row."""
    if isinstance(kind, types.Array):
        return _array(context, builder, kind, builder.inttoptr(row.word("Q"), _ADDRESS))
    if isinstance(kind, types.BaseTuple):
        if isinstance(context.get_value_type(kind), ir.PointerType):
            return _block(context, builder, kind, row)
        parts = [_value(context, builder, one, row) for one in kind.types]
        return context.make_tuple(builder, kind, parts)
    if isinstance(kind, types.Record):
        record = builder.inttoptr(row.word("Q"), _ADDRESS)
        return builder.bitcast(_field(builder, record, RECORD), context.get_value_type(kind))
    code = _code(kind)
    word = row.word("q" if code == "?" else code)
    if code == "d":
        return builder.bitcast(word, ir.DoubleType())
    return word if code == "q" else builder.trunc(word, context.get_value_type(kind))


def _field(builder: Any, item: Any, offset: int) -> Any:
    """Return an address that an object of NumPy's holds."""
    return builder.load(builder.bitcast(builder.gep(item, [_WORD(offset)]), _ADDRESS.as_pointer()))


def _array(context: Any, builder: Any, kind: Any, item: Any) -> Any:
    array = context.make_array(kind)(context, builder)
    data = builder.bitcast(_field(builder, item, DATA), array.data.type)
    sizes = []
    for offset in (SHAPE, STRIDES):
        numbers = builder.bitcast(_field(builder, item, offset), _WORD.as_pointer())
        sizes.append([builder.load(builder.gep(numbers, [_WORD(axis)])) for axis in range(kind.ndim)])
    itemsize = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    populate_array(array, data, *sizes, itemsize, meminfo=None)
    return array._getvalue()


def _block(context: Any, builder: Any, kind: Any, row: _RowIr) -> Any:
    """Lay out a tuple that is passed by its address; return the address."""
    module, block = builder.module, context.get_value_type(kind)
    name = f"lay_out_{hashlib.sha256(str(kind).encode()).hexdigest()}"
    if name not in module.globals:
        words = _WORD.as_pointer()
        function = ir.Function(module, ir.FunctionType(ir.VoidType(), [words, words]), name)
        function.linkage = "internal"
        inner = ir.IRBuilder(function.append_basic_block())
        own = _RowIr(inner, function.args[0], function.args[1], context.get_abi_sizeof(block.pointee) // 8)
        place = inner.bitcast(function.args[1], block)
        for number, one in enumerate(kind.types):
            value = _value(context, inner, one, own)
            data = context.data_model_manager[one].as_data(inner, value)
            inner.store(data, inner.gep(place, [ir.IntType(32)(0), ir.IntType(32)(number)]))
        inner.ret_void()
        function.codes, function.room = own.codes, own.room
    function = module.globals[name]
    start = builder.gep(row.start, [_WORD(len(row.codes))])
    row.codes += function.codes
    room = row.room_of(function.room)
    builder.call(function, [start, room])
    return builder.bitcast(room, block)


def _parts(builder: Any, kind: Any, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield the codes and values of the numbers that a kernel returns."""
    if isinstance(kind, types.BaseTuple):
        for number, one in enumerate(kind.types):
            yield from _parts(builder, one, builder.extract_value(value, number))
    elif kind != types.none:
        yield _code(kind), value
