"""Packed parameters of laws, and dispatch to the kernels of their kinds.

A normal law travels as ``NORMAL_SIZE`` floats, the kinds of its elastic part and of its dissipation before
the parameters of both; a friction law as ``FRICTION_SIZE``, its kind first. The kind is the number of the
kernel that the law's class names (``kernel``). The class that the kernel's first argument is annotated with
is the record: its fields that are numbers, without ``unpacked``, and its ``packed`` properties. Another
class with the same kernel has attributes of the same names.
"""

from __future__ import annotations

import functools
import zlib
from collections.abc import Callable, Iterable
from typing import Any, get_type_hints

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import Record, fields_of, numbers_of
from antenna_pin.compiled.decorators import composed, composed_later
from antenna_pin.compiled.record import Layout, record

_ELASTIC_ROOM = 8
_DISSIPATION_ROOM = 6
_KINDS = 2  # of elastic part and dissipation, before the parameters of both

NORMAL_SIZE = _KINDS + _ELASTIC_ROOM + _DISSIPATION_ROOM
FRICTION_SIZE = 12


def _record(size: int, start: int, room: int, kind: type[Any]) -> Layout[Any]:
    """Return a record of ``size`` floats with at most ``room`` names from float ``start`` on."""
    names = tuple(fields_of(kind))
    if len(names) > room:
        raise ValueError(f"{', '.join(names)}: there is room for {room}")
    layout = {
        "names": names,
        "formats": ["f8"] * len(names),
        "offsets": [8 * (start + i) for i in range(len(names))],
        "itemsize": 8 * size,
    }
    return Layout((kind, layout))


def _of_kernel(size: int, start: int, room: int) -> Callable[[Any], Layout[Any]]:
    """Return a function that returns the record of a law's kernel."""

    @functools.cache
    def layout(kernel: Any) -> Layout[Any]:
        law = next(iter(get_type_hints(kernel).values()))
        kind = type(law.__name__, (Record,), {"__annotations__": numbers_of(law)})
        return _record(size, start, room, kind)

    return layout


#: Record of a normal law with names for its elastic parameters, by kernel.
elastic_record = _of_kernel(NORMAL_SIZE, _KINDS, _ELASTIC_ROOM)
#: Record of a normal law with names for the parameters of its dissipation, by kernel.
dissipation_record = _of_kernel(NORMAL_SIZE, _KINDS + _ELASTIC_ROOM, _DISSIPATION_ROOM)
#: Record of a friction law with names for its parameters, by kernel.
friction_record = _of_kernel(FRICTION_SIZE, 1, FRICTION_SIZE - 1)


class NormalLawRecord(Record):
    """The kinds of a normal law, before its parameters."""

    elastic: float
    dissipation: float


class FrictionLawRecord(Record):
    """The kind of a friction law, before its parameters."""

    kind: float


NORMAL_LAW = _record(NORMAL_SIZE, 0, _KINDS, NormalLawRecord)
FRICTION_LAW = _record(FRICTION_SIZE, 0, 1, FrictionLawRecord)


def number_of(kernel: Any) -> float:
    """Return the kind of the laws of a kernel, a digest of its name."""
    return float(zlib.crc32(f"{kernel.__module__}.{kernel.__qualname__}".encode()))


def chain(
    laws: Callable[[], Iterable[Any]],
    hook: str,
    record_of: Callable[[Any], Layout[Any]],
    last: Callable[..., Any],
) -> Any:
    """Return a function of packed parameters, kind and arguments: the kind's own ``hook``.

    It is composed when a caller is compiled.

    Args:
        laws: Returns the classes; those without a kernel of their own, and repeated kinds, are skipped.
        hook: Attribute of a class with a kernel of record and arguments; without it ``kernel``.
        record_of: Record of a kernel.
        last: Compiled function of the same arguments, for other kinds.
    """

    def compose() -> Any:
        hooks = {law.kernel: getattr(law, hook, law.kernel) for law in laws() if hasattr(law, "kernel")}
        names: dict[str, Any] = {"__name__": __name__, "record": record, "last": last}
        lines = [f"def {hook}(law, kind, *arguments):"]
        for k, (kernel, own) in enumerate(hooks.items()):
            layout = record_of(kernel)
            names |= {f"own_{k}": own, f"layout_{k}": layout}
            first = f"record(law, layout_{k})" if layout.names else "law"
            lines += [
                f"    if kind == {number_of(kernel)!r}:",
                f"        return own_{k}({first}, *arguments)",
            ]
        lines.append("    return last(law, kind, *arguments)")
        exec("\n".join(lines), names)  # noqa: S102 - as of elements
        return composed(names[hook])

    return composed_later(compose)


def friction_code(law: Any) -> NDArray[np.float64]:
    """Return a friction law in packed parameters, (FRICTION_SIZE,)."""
    code = np.zeros(FRICTION_SIZE)
    record(code, FRICTION_LAW).kind = number_of(law.kernel)
    _write(code, friction_record(law.kernel), law)
    return code


def normal_code(elastic: Any, law: Any, dissipation: Any, numbers: Any) -> NDArray[np.float64]:
    """Return a normal law in packed parameters, (NORMAL_SIZE,).

    Args:
        elastic: Kernel of the elastic part.
        law: Numbers of its record, as attributes.
        dissipation: Kernel of the dissipation.
        numbers: Likewise of its record.
    """
    code = np.zeros(NORMAL_SIZE)
    kinds = record(code, NORMAL_LAW)
    kinds.elastic, kinds.dissipation = number_of(elastic), number_of(dissipation)
    _write(code, elastic_record(elastic), law)
    _write(code, dissipation_record(dissipation), numbers)
    return code


def _write(code: NDArray[np.float64], layout: Layout[Any], law: Any) -> None:
    """Write the attributes of a law that its record has."""
    row = record(code, layout)
    for name in layout.names or ():
        row[name] = getattr(law, name)
