"""End stops and latches: what struck, what was captured, what it took."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr

from antenna_pin.analysis import latch_events, stop_impacts
from antenna_pin.report._page import Picture, Row, Section, Table, counts, quantities
from antenna_pin.report._runs import ReportedRun, labels_of
from antenna_pin.report._turned import turned
from antenna_pin.trajectory import elements_of

__all__ = ["stops_and_latches"]

_TITLE = "End stops and latches"


def stops_and_latches(
    runs: Sequence[ReportedRun], scales: Mapping[str, float], pictures: Sequence[Picture] = ()
) -> Section:
    """Return what the stops and latches of the runs did."""
    own = [run for run in runs if any(_at(run, "stops.")) or any(_at(run, "latches."))]
    columns = ("", *labels_of(own))
    items, notes = [], []
    stops, latches = tuple(_stops(own, scales)), tuple(_latches(own, scales))
    if stops:
        table = Table(columns=columns, rows=stops, caption="Touches of the end stops", key="stops")
        items.append(turned(table))
        notes.append(
            "A torque in a touch is the largest of samples, of which there are some at its onset, where the "
            "joint turns back, and at its release; a blow of a rigid stop has an impulse and no torque."
        )
    if latches:
        table = Table(columns=columns, rows=latches, caption="What the latches did", key="latches")
        items.append(turned(table))
        notes.append(
            "Energy lost is all that a stop or a latch took in the run, its damper's share included."
        )
    return Section(key="stops", title=_TITLE, items=(*items, *pictures), meaning=tuple(notes))


def _at(run: ReportedRun, family: str) -> Iterator[str]:
    return (place for place in elements_of(run.data) if place.startswith(family))


def _every(runs: Sequence[ReportedRun], family: str) -> list[str]:
    return list(dict.fromkeys(place for run in runs for place in _at(run, family)))


def _units(runs: Sequence[ReportedRun], place: str) -> tuple[str, str, str, str]:
    """Return the units of an angle, a rate, a torque and its impulse at an element."""
    about = next(elements_of(run.data)[place] for run in runs if place in elements_of(run.data))
    return ("m", "m/s", "N", "N s") if about["slides"] else ("rad", "rad/s", "N m", "N m s")


def _stops(runs: Sequence[ReportedRun], scales: Mapping[str, float]) -> Iterator[Row]:
    tables = [stop_impacts(run.data) for run in runs]
    for place in _every(runs, "stops."):
        _, rate, effort, impulse = _units(runs, place)
        mine = [table.isel(touch=np.flatnonzero(table["stop"].values == place)) for table in tables]
        has = [place in elements_of(run.data) for run in runs]
        yield Row(place.partition(".")[2])
        yield counts("touches", (one.sizes["touch"] if own else None for one, own in _pairs(mine, has)))
        for name, key, unit in (
            ("fastest approach", "approach_rate", rate),
            ("fastest rebound", "rebound_rate", rate),
            ("largest torque" if effort == "N m" else "largest force", "peak_effort", effort),
            ("largest impulse", "impulse", impulse),
        ):
            yield quantities(name, [_largest(one[key].values) for one in mine], unit, 4, scales)
        yield quantities("energy lost", [_lost(run, place) for run in runs], "J", 4)


def _latches(runs: Sequence[ReportedRun], scales: Mapping[str, float]) -> Iterator[Row]:
    tables = [latch_events(run.data) for run in runs]
    for place in _every(runs, "latches."):
        angle, rate, _, impulse = _units(runs, place)
        mine = [table.isel(latch_event=np.flatnonzero(table["latch"].values == place)) for table in tables]
        has = [place in elements_of(run.data) for run in runs]
        yield Row(place.partition(".")[2])
        for name, what in (("captures", "latched"), ("refusals", "refused"), ("let go", "let go")):
            yield counts(
                name,
                (int((one["what"].values == what).sum()) if own else None for one, own in _pairs(mine, has)),
            )
        refused = [one.isel(latch_event=np.flatnonzero(one["what"].values == "refused")) for one in mine]
        yield quantities(
            "largest energy refused", [_largest(one["energy"].values) for one in refused], "J", 4
        )
        captures = [one.isel(latch_event=np.flatnonzero(one["what"].values == "latched")) for one in mine]
        for name, key, unit in (
            ("last capture", "time", "s"),
            ("at", "angle", angle),
            ("with a rate of", "rate", rate),
            ("with an energy of", "energy", "J"),
            ("impulse", "impulse", impulse),
        ):
            yield quantities(name, [_last(one[key].values) for one in captures], unit, 4, scales)
        yield quantities("energy lost", [_lost(run, place) for run in runs], "J", 4)


def _pairs(mine: Sequence[xr.Dataset], has: Sequence[bool]) -> Iterator[tuple[xr.Dataset, bool]]:
    return zip(mine, has, strict=True)


def _largest(values: np.ndarray) -> float | None:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if finite.size else None


def _last(values: np.ndarray) -> float | None:
    return float(values[-1]) if values.size else None


def _lost(run: ReportedRun, place: str) -> float | None:
    if place not in elements_of(run.data):
        return None
    return float(run.data["total_element_loss"].sel(element=place))
