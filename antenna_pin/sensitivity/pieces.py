"""Derivatives over pieces of a run, each from the run's own state at its start.

Over a long run derivatives grow with what neighbours part by, until they say nothing. Over a piece they do
not: at the end of each it is told what its own start and the numbers make of it from there on, with the start
held. A fit by multiple shooting wants just that.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.state import State
from antenna_pin.errors import InvalidParameterError
from antenna_pin.nonlinear import Flow
from antenna_pin.sensitivity.found import Sensitivities
from antenna_pin.sensitivity.parameters import GrazeError

__all__ = ["borders_of", "over_pieces"]

Array = NDArray[np.float64]

# Shortest piece, over the whole; and two times that are one but for round-off, over either.
_SHORTEST, _ONE = 1e-6, 1e-12


def borders_of(length: float, begin: float, span: float) -> Array:
    """Return where pieces of a length [s] begin, and the last one ends.

    Raises:
        InvalidParameterError: There are none of such a length.
    """
    if not _SHORTEST * span <= length <= span:
        rule = f"at most the run's {span:g} s, and at least a millionth of it"
        raise InvalidParameterError("sensitivities", "pieces", rule, length)
    count = max(int(np.ceil(span / length * (1.0 - 1e-9))), 1)
    return np.append(begin + length * np.arange(count), begin + span)


def over_pieces(
    flow: Flow,
    first: State,
    borders: Array,
    times: Array,
    made: Callable[[State, Array, float], Sensitivities],
) -> Sensitivities:
    """Return derivatives at times and at the ends of pieces, each over its own piece.

    Args:
        flow: Whose run it is.
        first: Its first state.
        borders: Of pieces [s].
        times: Of samples, ascending [s].
        made: Makes those of a piece, ``(start, times, span)``.
    """
    parts: list[tuple[float, Sensitivities]] = []
    refused: list[dict[str, float | str]] = []
    start = first
    for begin, end in zip(borders[:-1].tolist(), borders[1:].tolist(), strict=True):
        at = np.append(times[(times > begin * (1.0 + _ONE)) & (times < end * (1.0 - _ONE))], end)
        try:
            parts.append((begin, made(start, at, end - begin)))
        except GrazeError as error:
            refused.append({"begin": begin, "end": end, "why": str(error)})
        start = flow.after(start, end - start.time)
    if not parts:
        raise GrazeError(f"sensitivities: no piece has derivatives; the first: {refused[0]['why']}")
    data = xr.concat(list(_series(parts)), dim="time", combine_attrs="override")
    data.attrs["refused"] = json.dumps(refused)
    return Sensitivities(parts[0][1].run, parts[0][1].parameters, data)


def _series(parts: list[tuple[float, Sensitivities]]) -> Iterator[xr.Dataset]:
    """Yield what each piece has over time, with when the piece began."""
    for begin, one in parts:
        names = [name for name, column in one.data.data_vars.items() if "time" in column.dims]
        part = one.data[names]
        yield part.assign_coords(piece_begin=("time", np.full(part.sizes["time"], begin)))
