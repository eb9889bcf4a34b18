"""Gears, belts and cables: touches of flanks, what they exerted, how long nothing was in contact."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from antenna_pin.report._page import Picture, Row, Section, Table, counts, quantities
from antenna_pin.report._runs import ReportedRun, labels_of
from antenna_pin.report._turned import turned
from antenna_pin.trajectory import elements_of, met_by_meshes

__all__ = ["gears"]


def gears(runs: Sequence[ReportedRun], pictures: Sequence[Picture] = ()) -> Section:
    """Return what the gears, belts and cables of the runs did."""
    own = [run for run in runs if any(place.startswith("gears.") for place in elements_of(run.data))]
    met = [met_by_meshes(run.data) for run in own]
    names = list(dict.fromkeys(name for one in met for name in one))
    rows = [row for name in names for row in _rows(name, own, [one.get(name, {}) for one in met])]
    if not rows:
        return Section(key="gears", title="Gears, belts and cables")
    table = Table(columns=("", *labels_of(own)), rows=tuple(rows), caption="What they met", key="gears")
    note = (
        "A torque is the largest of samples, of which there are some where flanks meet, turn back and part; "
        "impulses are those of touches of one side alone."
    )
    return Section(
        key="gears", title="Gears, belts and cables", items=(turned(table), *pictures), meaning=(note,)
    )


def _rows(name: str, runs: Sequence[ReportedRun], met: Sequence[Mapping[str, Any]]) -> Iterator[Row]:
    """Yield the rows of one of them, by what each run met."""
    place = f"gears.{name}"
    slides = next(elements_of(run.data)[place]["slides"] for run in runs if place in elements_of(run.data))
    rate, effort, impulse = ("m/s", "N", "N s") if slides else ("rad/s", "N m", "N m s")
    yield Row(name)
    if any("touches" in one for one in met):
        yield counts("touches", [one.get("touches") for one in met])
        yield quantities("fastest touch", [one.get("fastest_touch") for one in met], rate, 4)
        yield quantities("largest impulse", [one.get("largest_blow") for one in met], impulse, 4)
        yield quantities("time without contact", [one.get("time_apart") for one in met], "s", 4)
    if any("time_slack" in one for one in met):
        yield quantities("time with a slack strand", [one.get("time_slack") for one in met], "s", 4)
    word, key = ("force", "peak_force") if slides else ("torque", "peak_torque")
    yield quantities(f"largest {word}", [one.get(key) for one in met], effort, 4)
    yield quantities("energy lost", [one.get("element_loss") for one in met], "J", 4)
