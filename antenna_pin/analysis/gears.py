"""What gears, belts and cables met: a row per touch of a flank, or per time that a strand was taut."""

from __future__ import annotations

import xarray as xr

from antenna_pin.analysis._run import RunLike, data_of
from antenna_pin.analysis.stops import touch_table
from antenna_pin.base.arguments import takes
from antenna_pin.trajectory import elements_of, mesh_spans, mesh_touches
from antenna_pin.trajectory.quantities import TABLES, table

__all__ = ["gear_contacts", "gear_impacts", "gears_of"]


@takes()
def gear_impacts(run: RunLike) -> xr.Dataset:
    """Return the touches of flanks of gears of a run, and what strands pulled, in order of their onset.

    Args:
        run: A run, or its data.

    Returns:
        Over ``touch``: ``onset`` and ``release`` [s], ``approach_rate`` and ``rebound_rate`` of the
        deflection [rad/s], ``peak_effort`` [N m], ``impulse`` [N m s] and ``loss`` [J], in m/s, N and N s of
        one whose deflection is a way; labelled by ``gear`` (its place) and ``side``: ``plus`` where the input
        is ahead, else ``minus``. No rows if there is no gear with play, or no side came into contact.
    """
    found = mesh_touches(data_of(run))
    labels = {"gear": [one.stop for one in found], "side": [one.side for one in found]}
    return touch_table(found, labels)


@takes()
def gear_contacts(run: RunLike, gear: str) -> xr.Dataset:
    """Return what of a gear, belt or cable was in contact, span by span over the whole run.

    Args:
        run: A run with samples, or its data.
        gear: Its place, as ``gears.drive``.

    Returns:
        Over ``span``: ``begin`` and ``end`` [s], labelled by ``sides``: apart, plus, minus or both.
    """
    found = mesh_spans(data_of(run), gear)
    words = ("apart", "plus", "minus", "both")
    labels = {"sides": [words[one.plus + 2 * one.minus] for one in found]}
    columns = {name: [float(getattr(one, name)) for one in found] for name in TABLES["spans"]}
    return table("spans", columns, labels)


@takes()
def gears_of(run: RunLike) -> tuple[str, ...]:
    """Return the places of the gears, belts and cables of a run."""
    return tuple(one for one in elements_of(data_of(run)) if one.startswith("gears."))
