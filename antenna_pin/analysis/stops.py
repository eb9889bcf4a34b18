"""Tables of the touches of end stops and gears, and of the changes of latches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import xarray as xr

from antenna_pin.analysis._run import RunLike, data_of
from antenna_pin.base.arguments import takes
from antenna_pin.trajectory import Touch, elements_of, latch_changes, mesh_spans, mesh_touches, touches
from antenna_pin.trajectory.quantities import TABLES, table


@takes()
def stop_impacts(run: RunLike) -> xr.Dataset:
    """Return the touches of end stops of a run, in order of their onset.

    Beside :func:`antenna_pin.analysis.impacts`, which has those of contacts. A blow of a rigid stop lasts no
    time; a joint that comes to rest on one has a rebound rate once it leaves.

    Returns:
        Over ``touch``: ``onset`` and ``release`` [s], ``approach_rate`` and ``rebound_rate`` [rad/s],
        ``peak_effort`` [N m], ``impulse`` [N m s] and ``loss`` [J], in m/s, N and N s at a joint that slides;
        labelled by ``stop`` (its place) and ``side``. No rows if the run has no stop, or none was touched.
    """
    found = touches(data_of(run))
    labels = {"stop": [one.stop for one in found], "side": [one.side for one in found]}
    return touch_table(found, labels)


@takes()
def latch_events(run: RunLike) -> xr.Dataset:
    """Return captures, refusals and releases of latches, in order of time.

    Returns:
        Over ``latch_event``: ``time`` [s], ``angle`` [rad], ``rate`` [rad/s], ``loss`` [J], ``impulse``
        [N m s], ``energy`` [J], in m, m/s and N s at a joint that slides; labelled by ``latch`` (its place)
        and ``what``.
    """
    found = latch_changes(data_of(run))
    labels = {"latch": [one.element for one in found], "what": [one.what for one in found]}
    columns = {name: [getattr(one, name) for one in found] for name in TABLES["latch events"]}
    return table("latch events", columns, labels)


@takes()
def stops_and_latches(run: RunLike) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the places of the stops and of the latches of a run."""
    places = elements_of(data_of(run))
    stops, latches = (tuple(one for one in places if one.startswith(of)) for of in ("stops.", "latches."))
    return stops, latches


def touch_table(rows: Sequence[Touch], labels: Mapping[str, Sequence[str]]) -> xr.Dataset:
    """Return touches as a table, with labels beside them."""
    return table(
        "touches", {name: [getattr(one, name) for one in rows] for name in TABLES["touches"]}, labels
    )


# --- gears, belts and cables --------------------------------------------------------------------------------


@takes()
def gear_impacts(run: RunLike) -> xr.Dataset:
    """Return the touches of gears, belts and cables of a run, in order.

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
    """Return the sides in contact of a gear, belt or cable over the run.

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
