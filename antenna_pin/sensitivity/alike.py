"""Whether the contacts and events of a neighbour are those of a run, and in which order it has them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.sensitivity.parameters import GrazeError
from antenna_pin.sensitivity.unlike import first_unlike

__all__ = ["check_alike", "in_order_of"]

# Onsets of several contacts that are one instant, as where both rims of a bore are met at once: which of them
# is noted first is a matter of round-off [s].
_AT_ONCE = 1e-9


def in_order_of(ours: xr.Dataset, theirs: xr.Dataset, of: xr.Dataset | None = None) -> xr.Dataset:
    """Return numbers of a neighbour with contacts that begin at once in the order of a run's.

    Args:
        ours: The run.
        theirs: The neighbour's numbers.
        of: The neighbour, if these are not all of it.
    """
    whole = theirs if of is None else of
    if "episode" not in theirs.sizes or ours.sizes.get("episode") != theirs.sizes["episode"]:
        return theirs
    order = np.empty(theirs.sizes["episode"], dtype=int)
    order[_by_contact(ours)] = _by_contact(whole)
    return theirs if (np.diff(order) > 0).all() else theirs.isel(episode=order)


def _by_contact(data: xr.Dataset) -> NDArray[np.int_]:
    """Return contacts in the order in which they begin, of those at once the first in number first."""
    onsets = data["onset_time"].values
    later = np.diff(onsets, prepend=onsets[:1]) > _AT_ONCE
    return np.lexsort((data["episode_contact"].values, np.cumsum(later)))


def check_alike(ours: xr.Dataset, theirs: xr.Dataset, what: str) -> None:
    """Refuse a neighbour in which other contacts begin, or other things happen.

    Args:
        ours: The run.
        theirs: The neighbour, in its order.
        what: What is said of it.

    Raises:
        GrazeError: It is none that goes over into the run.
    """
    for name, here in ours.variables.items():
        there: Any = theirs.variables.get(name)
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
