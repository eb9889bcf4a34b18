"""Whether the contacts and events of a neighbour are those of a run, and in which order it has them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from antenna_pin.sensitivity.parameters import GrazeError
from antenna_pin.sensitivity.unlike import first_unlike
from antenna_pin.trajectory import Column

__all__ = ["check_alike", "in_order_of"]

# Onsets of several contacts that are one instant, as where both rims of a bore are met at once: which of them
# is noted first is a matter of round-off [s].
_AT_ONCE = 1e-9


def in_order_of(ours: Mapping[str, Column], theirs: Mapping[str, Column]) -> Mapping[str, Column]:
    """Return a neighbour's variables with contacts that begin at once in the order of a run's.

    Args:
        ours: The run's.
        theirs: The neighbour's.
    """
    count = len(theirs["onset_time"].values) if "onset_time" in theirs else -1
    if count < 0 or "onset_time" not in ours or len(ours["onset_time"].values) != count:
        return theirs
    order = np.empty(count, dtype=int)
    order[_by_contact(ours)] = _by_contact(theirs)
    if (np.diff(order) > 0).all():
        return theirs
    return {
        name: Column(one.dims, one.values.take(order, one.dims.index("episode")), one.attrs)
        if "episode" in one.dims
        else one
        for name, one in theirs.items()
    }


def _by_contact(run: Mapping[str, Column]) -> NDArray[np.int_]:
    """Return contacts in the order in which they begin, of those at once the first in number first."""
    onsets = run["onset_time"].values
    later = np.diff(onsets, prepend=onsets[:1]) > _AT_ONCE
    return np.lexsort((run["episode_contact"].values, np.cumsum(later)))


def check_alike(ours: Mapping[str, Column], theirs: Mapping[str, Column], what: str) -> None:
    """Refuse a neighbour in which other contacts begin, or other things happen.

    Args:
        ours: The variables of the run.
        theirs: Those of the neighbour, in its order.
        what: What is said of it.

    Raises:
        GrazeError: It is none that goes over into the run.
    """
    for name, here in ours.items():
        there = theirs.get(name)
        if "time" in here.dims or here.dtype.kind == "f" and there is not None and here.shape == there.shape:
            continue
        if there is None or here.shape != there.shape or not np.array_equal(here.values, there.values):
            time = first_unlike(ours, theirs)
            at = "" if np.isnan(time) else f", first at {time:.9g} s"
            raise GrazeError(
                f"sensitivities: {what}, other contacts begin or other events happen{at}: it has no "
                f"derivative there; take another value, or a span that ends before",
                time,
            )
