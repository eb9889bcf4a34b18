"""When two runs begin to be unlike: the first contact, event or change of mode that only one of them has."""

from __future__ import annotations

import math
from collections.abc import Mapping

from antenna_pin.trajectory import Column

__all__ = ["first_unlike"]

_INSTANTS = ("onset_time", "change_time", "event_time")


def first_unlike(ours: Mapping[str, Column], theirs: Mapping[str, Column]) -> float:
    """Return when contacts, changes or events of two runs begin to differ [s]; NaN if all begin alike.

    Args:
        ours: Variables of a run.
        theirs: Those of another.
    """
    found = [_first(*(_course(one, name) for one in (ours, theirs))) for name in _INSTANTS]
    earliest = min(found)
    return earliest if earliest < math.inf else math.nan


def _course(run: Mapping[str, Column], name: str) -> list[tuple[float, tuple[str, ...]]]:
    """Return instants of a kind in order, each with what it is of: all that is no measured number."""
    if name not in run:
        return []
    dim = run[name].dims[0]
    said = [one.values for one in run.values() if one.dims == (dim,) and one.dtype.kind != "f"]
    return [(float(time), tuple(str(each[k]) for each in said)) for k, time in enumerate(run[name].values)]


def _first(mine: list[tuple[float, tuple[str, ...]]], other: list[tuple[float, tuple[str, ...]]]) -> float:
    """Return when two courses begin to differ [s]; infinite where they do not."""
    for (here, what), (there, instead) in zip(mine, other, strict=False):
        if what != instead:
            return min(here, there)
    rest = (mine if len(mine) > len(other) else other)[min(len(mine), len(other)) :]
    return rest[0][0] if rest else math.inf
