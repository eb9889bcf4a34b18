"""Flexible links: how far their elastic parts went, what they stored and lost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import xarray as xr

from antenna_pin.analysis import elastic_motion, elastic_parts_of
from antenna_pin.report._page import Picture, Row, Section, Table, quantities
from antenna_pin.report._runs import ReportedRun, labels_of
from antenna_pin.report._turned import turned

__all__ = ["elastic_parts"]

_TITLE = "Flexible links"


def elastic_parts(runs: Sequence[ReportedRun], pictures: Sequence[Picture] = ()) -> Section:
    """Return what the elastic parts of the runs did."""
    flexible = [run for run in runs if run.names("elastic_part")]
    if not flexible:
        return Section(key="elastic", title=_TITLE)
    rows = tuple(_rows(flexible))
    table = Table(
        columns=("", *labels_of(flexible)), rows=rows, caption="What the elastic parts did", key="elastic"
    )
    return Section(
        key="elastic",
        title=_TITLE,
        items=(turned(table), *pictures),
        meaning=(
            "Frequencies are those with the hub held. Energy is a part's against its hub, in its spring "
            "and of its motion; what its damper took is lost. Spin is the largest angular speed of the hub "
            "over the part's angular frequency: far below 1, or the part is not what it stands for.",
        ),
    )


def _rows(runs: Sequence[ReportedRun]) -> Iterator[Row]:
    found = [elastic_motion(run.data) for run in runs]
    parts = dict.fromkeys(name for run in runs for name in run.names("elastic_part"))
    for part in parts:
        own = next(run for run in runs if part in run.names("elastic_part"))
        unit = "m" if elastic_parts_of(own.data)[part]["slides"] else "rad"
        yield Row(part)
        for name, key, of in (
            ("frequency", "frequency", "Hz"),
            ("largest deflection", "peak_deflection", unit),
            ("root mean square", "rms_deflection", unit),
            ("largest energy", "peak_energy", "J"),
            ("energy lost", "lost", "J"),
            ("spin over frequency", "spin_ratio", "1"),
        ):
            yield quantities(name, [_value(one, part, key) for one in found], of, 3)


def _value(found: xr.Dataset, part: str, key: str) -> float | None:
    return float(found[key].sel(elastic_part=part)) if part in found["elastic_part"].values else None
