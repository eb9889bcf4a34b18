"""Quantities required of a lean result by its scenario, and samples for their record."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from antenna_pin.trajectory.quantities import CONTACTS, RUN, SUMMARIES
from antenna_pin.trajectory.read import json_in

if TYPE_CHECKING:
    import xarray as xr

#: Quantities of a record that need all its samples: peaks at samples, located efforts, the ledger.
OF_SAMPLES = frozenset(
    one.name
    for one in (*SUMMARIES, *RUN.values())
    if one.source == "conservation" or one.name.startswith(("peak_", "time_of_peak_"))
)
#: Names that ``output.keep`` may have.
KEEPABLE = frozenset({*OF_SAMPLES, "blows", *(one.name for one in (*CONTACTS, *SUMMARIES))})


def needs_samples(quantities: Collection[str] | None) -> bool:
    """Return whether a record with these quantities needs all samples; None stands for all.

    Episodes, and sums from start to end, do not.
    """
    return quantities is None or not OF_SAMPLES.isdisjoint(quantities)


def left_out_of(data: xr.Dataset) -> frozenset[str]:
    """Return the quantities left out of a result at the request of its scenario."""
    names = json_in(data.attrs.get("kept"))
    return OF_SAMPLES if isinstance(names, list) and not needs_samples(names) else frozenset()
