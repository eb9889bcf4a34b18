"""Closed loops and couplings: how many equations, how well they were held, what they carried."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr

from antenna_pin.analysis import (
    closure_loads,
    closures_of,
    coupling_loads,
    couplings_of,
    round_off_scales,
    said_of_constraints,
)
from antenna_pin.report._page import (
    Details,
    Picture,
    Row,
    Section,
    Statement,
    Table,
    counts,
    quantities,
    said_of_zeros,
)
from antenna_pin.report._runs import ReportedRun, labels_of
from antenna_pin.report._turned import turned

__all__ = ["loops"]


def loops(runs: Sequence[ReportedRun], pictures: Sequence[Picture] = ()) -> Section:
    """Return what closures and motions of the runs are, their residuals, and their loads."""
    held = [run for run in runs if run.run.constraints]
    if not held:
        return Section(key="loops", title="Closed loops and motions")
    texts: dict[str, list[str]] = {}
    for run in held:
        texts.setdefault(said_of_constraints(run.run.constraints), []).append(run.label)
    everywhere = len(texts) == 1 and len(held) == len(runs)
    said = tuple((() if everywhere else tuple(labels), text) for text, labels in texts.items())
    columns = ("", *labels_of(held))
    how = Table(
        columns=columns, rows=tuple(_held(held)), caption="How loops and motions were held", key="loops"
    )
    items: list[Table] = []
    closures = tuple(_closures(held))
    if closures:
        items.append(Table(columns=columns, rows=closures, caption="Loads of the closures", key="closures"))
    couplings = tuple(_couplings(held))
    if couplings:
        items.append(
            Table(columns=columns, rows=couplings, caption="Loads of the couplings", key="couplings")
        )
    notes = [
        "Residuals are the largest of all samples. After each step the state is brought back onto closures "
        "and motions by the least correction in kinetic energy; what all of these put in is a part of the "
        "error of the energy balance.",
    ]
    if any(one.run.constraints["closure_equations"] > one.run.constraints["closure_rank"] for one in held):
        notes.append(
            "Equations that others imply are redundant: they do not change the motion, and of all loads that "
            "hold it the least are given."
        )
    return Section(
        key="loops",
        title="Closed loops and motions",
        statements=(Statement(label="counted at the start", texts=said),),
        items=(*map(turned, items), *pictures, Details(title=how.caption, tables=(how,))),
        meaning=(*notes, *said_of_zeros(items)),
    )


def _held(runs: Sequence[ReportedRun]) -> Iterator[Row]:
    found = [run.run.constraints for run in runs]
    yield Row("counts")
    for name, key in (
        ("freedoms of the tree", "freedoms"),
        ("equations of closures", "closure_equations"),
        ("independent ones", "closure_rank"),
        ("motions", "motions"),
        ("mobility: freedoms that closures leave", "mobility"),
        ("freedoms left by closures and motions", "freedoms_left"),
    ):
        yield counts(name, (one[key] for one in found))
    yield Row("largest residual")
    for name, key, unit in (
        ("position", "position_residual", "m"),
        ("attitude", "angle_residual", "rad"),
        ("velocity", "velocity_residual", "m/s"),
        ("angular velocity", "rate_residual", "rad/s"),
    ):
        yield quantities(name, [one[key] for one in found], unit, 3)
    yield Row("corrections after each step")
    yield quantities("energy that they put in", [one["projection_energy"] for one in found], "J", 3)


def _closures(runs: Sequence[ReportedRun]) -> Iterator[Row]:
    loads = [closure_loads(run.data) for run in runs]
    scales = round_off_scales(*(run.data for run in runs))
    for name in _every(runs, "closure"):
        about = next(closures_of(run.data)[name] for run in runs if name in run.names("closure"))
        yield Row(f"{name}, {about['kind']}: {about['first_body']} - {about['second_body']}")
        yield quantities("largest force", _column(loads, "closure", name, "peak_force"), "N", 4, scales)
        yield quantities("at", _column(loads, "closure", name, "time_of_peak_force"), "s")
        yield quantities(
            "root mean square of the force", _column(loads, "closure", name, "rms_force"), "N", 4, scales
        )
        moments = _column(loads, "closure", name, "peak_moment")
        if any(moments):
            yield quantities("largest moment", moments, "N m", 4, scales)


def _couplings(runs: Sequence[ReportedRun]) -> Iterator[Row]:
    loads = [coupling_loads(run.data) for run in runs]
    for name in _every(runs, "coupling"):
        about = next(couplings_of(run.data)[name] for run in runs if name in run.names("coupling"))
        what, unit = ("force", "N") if about["slides"] else ("torque", "N m")
        yield Row(f"{name}: {about['follower']} follows {about['leader']}; {what} on the follower")
        yield quantities(f"largest {what}", _column(loads, "coupling", name, "peak_torque"), unit)
        yield quantities("at", _column(loads, "coupling", name, "time_of_peak_torque"), "s")
        yield quantities(
            f"root mean square of the {what}", _column(loads, "coupling", name, "rms_torque"), unit
        )


def _every(runs: Sequence[ReportedRun], dimension: str) -> list[str]:
    return list(dict.fromkeys(name for run in runs for name in run.names(dimension)))


def _column(loads: Sequence[xr.Dataset], dimension: str, name: str, key: str) -> list[float | None]:
    values = (
        float(one[key].sel({dimension: name})) if name in one[dimension].values else None for one in loads
    )
    return [value if value is not None and np.isfinite(value) else None for value in values]
