"""Drives, controllers, springs, frictions, bearings and forces: what each exerted, took and was told."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from antenna_pin.analysis import blocks, drive_loads, drives_of, effort_unit
from antenna_pin.report._page import Picture, Row, Section, Table, counts, quantities, said_of_zeros
from antenna_pin.report._runs import ReportedRun, labels_of
from antenna_pin.report._turned import turned
from antenna_pin.trajectory import elements_of, names_along

__all__ = ["controllers", "drives", "forces", "springs"]

_Pick = Callable[[ReportedRun, str], float]


def drives(
    runs: Sequence[ReportedRun], scales: Mapping[str, float], pictures: Sequence[Picture] = ()
) -> Section:
    """Return what drives exerted and did: motors, prescribed motions and shake among them."""
    own = [run for run in runs if run.names("drive")]
    table = _table(own, tuple(_drives(own, scales)), "What the drives exert", "drives")
    return Section(
        key="drives",
        title="Drives",
        items=(*table, *pictures),
        meaning=(
            "What a drive with a prescribed motion, shake among them, exerts is the force or torque that "
            "holds the motion. Forces, torques and powers are the largest of samples; the error is what a "
            "controller follows less its joint's angle or way.",
            *said_of_zeros(table),
        ),
    )


def controllers(runs: Sequence[ReportedRun], pictures: Sequence[Picture] = ()) -> Section:
    """Return what controllers measured and commanded, and how often sampled ones were asked."""
    own = [run for run in runs if run.names("sampled")]
    rows: list[Row] = []
    for name in _every(own, "sampled"):
        rows.append(Row(name))
        for word, key in (("asked", "ticks"), ("of these held by limits", "saturated_ticks")):
            values = _column(own, "sampled", name, lambda run, one, key=key: _at(run, key, "sampled", one))  # type: ignore[misc]
            rows.append(counts(word, (None if value is None else int(value) for value in values)))
    table = _table(own, tuple(rows), "Instants of the sampled controllers", "controllers")
    return Section(key="controllers", title="Controllers", items=(*table, *pictures))


def springs(
    runs: Sequence[ReportedRun], scales: Mapping[str, float], pictures: Sequence[Picture] = ()
) -> Section:
    """Return what springs, dampers, frictions and bearings exerted and lost."""
    own = [run for run in runs if run.names("spring") or run.names("bearing") or any(_frictions(run))]
    rows = _telling((*_springs(own, scales), *_bearings(own, scales), *_friction_rows(own, scales)))
    table = _table(own, rows, "What springs, frictions and bearings exert and lose", "springs")
    return Section(
        key="springs",
        title="Springs, frictions and bearings",
        items=(*table, *pictures),
        meaning=("Forces, torques and lengths are those of samples.", *said_of_zeros(table)),
    )


def forces(
    runs: Sequence[ReportedRun], scales: Mapping[str, float], pictures: Sequence[Picture] = ()
) -> Section:
    """Return what forces on links brought in."""
    own = [run for run in runs if run.names("force")]
    rows: list[Row] = []
    for name in _every(own, "force"):
        rows.append(Row(name))
        for word, key, unit in (
            ("impulse", "total_impulse", "N s"),
            ("angular impulse, about the world's origin", "total_angular_impulse", "N m s"),
            ("work", "total_force_work", "J"),
            ("energy lost", "total_force_loss", "J"),
        ):
            values = _column(own, "force", name, lambda run, one, key=key: _at(run, key, "force", one))  # type: ignore[misc]
            rows.append(quantities(word, values, unit, 4, scales))
    for place in _every(own, "force_place"):
        peaks = _column(
            own, "force_place", place, lambda run, one: _at(run, "peak_applied_force", "force_place", one)
        )
        rows.append(quantities(f"largest at {place}", peaks, "N", 4, scales))
    table = _table(own, tuple(rows), "Forces on links", "forces")
    return Section(key="forces", title="Forces", items=(*table, *pictures), meaning=said_of_zeros(table))


def _drives(runs: Sequence[ReportedRun], scales: Mapping[str, float]) -> Iterator[Row]:
    loads = {run.label: drive_loads(run.data) for run in runs}
    for name in _every(runs, "drive"):
        first = next(run for run in runs if name in run.names("drive"))
        unit, about = effort_unit(first.data, name), drives_of(first.data).get(name, {})
        motion = f", motion of {about['joint']}" if about.get("motion") else ""
        what = "force" if unit == "N" else "torque"
        yield Row(f"drive {name}{motion}")
        for word, key, of in (
            (f"largest {what}", "peak_effort", unit),
            (f"root mean square of the {what}", "rms_effort", unit),
            ("largest power", "peak_power", "W"),
            ("work", "work", "J"),
            ("gross work", "gross_work", "J"),
        ):
            values = _column(
                runs,
                "drive",
                name,
                lambda run, one, key=key: float(loads[run.label][key].sel(drive=one)),  # type: ignore[misc]
            )
            yield quantities(word, values, of, 4, scales if of == unit else None)
        if name in _every(runs, "controller"):
            errors = _column(
                runs, "controller", name, lambda run, one: _largest(run, "control_error", "controller", one)
            )
            yield quantities("largest error", errors, "m" if unit == "N" else "rad", 4, scales)
        if name in _every(runs, "motor"):
            currents = _column(
                runs, "motor", name, lambda run, one: _largest(run, "motor_current", "motor", one)
            )
            yield quantities("largest current", currents, "A", 4)
            heats = _column(
                runs, "motor", name, lambda run, one: float(run.data["motor_heat"].sel(motor=one)[-1])
            )
            yield quantities("heat of the winding", heats, "J", 4)


def _springs(runs: Sequence[ReportedRun], scales: Mapping[str, float]) -> Iterator[Row]:
    for name in _every(runs, "spring"):
        yield Row(f"spring {name}")
        if name in _every(runs, "traced_spring"):
            first = next(run for run in runs if name in run.names("traced_spring"))
            at = names_along(first.data, "traced_joint")[first.names("traced_spring").index(name)]
            slides = at in first.names("sliding_joint")
            efforts = _column(
                runs,
                "traced_spring",
                name,
                lambda run, one: _largest(run, "spring_torque", "traced_spring", one),
            )
            word, unit = ("force", "N") if slides else ("torque", "N m")
            yield quantities(f"largest {word}", efforts, unit, 4, scales)
        if name in _every(runs, "point_spring"):
            tensions = _column(
                runs,
                "point_spring",
                name,
                lambda run, one: _largest(run, "spring_tension", "point_spring", one),
            )
            yield quantities("largest tension, by size", tensions, "N", 4, scales)
            lengths = _column(
                runs,
                "point_spring",
                name,
                lambda run, one: _largest(run, "spring_length", "point_spring", one),
            )
            yield quantities("greatest length", lengths, "m", 4)
        lost = _column(runs, "spring", name, lambda run, one: _at(run, "total_damper_loss", "spring", one))
        yield quantities("energy lost", lost, "J", 4)


def _bearings(runs: Sequence[ReportedRun], scales: Mapping[str, float]) -> Iterator[Row]:
    for name in _every(runs, "bearing"):
        yield Row(f"bearing {name}")
        for what, unit in (("force", "N"), ("moment", "N m")):
            peaks = _column(
                runs,
                "bearing",
                name,
                lambda run, one, what=what: _at(run, f"peak_bearing_{what}", "bearing", one),  # type: ignore[misc]
            )
            yield quantities(f"largest {what}", peaks, unit, 4, scales)


def _friction_rows(runs: Sequence[ReportedRun], scales: Mapping[str, float]) -> Iterator[Row]:
    for place in dict.fromkeys(place for run in runs for place in _frictions(run)):
        first = next(run for run in runs if place in elements_of(run.data))
        word, unit = ("force", "N") if elements_of(first.data)[place]["slides"] else ("torque", "N m")
        yield Row(f"friction {place.partition('.')[2]}")
        efforts = _column(
            runs, "element", place, lambda run, one: _largest(run, "element_effort", "element", one)
        )
        yield quantities(f"largest {word}", efforts, unit, 4, scales)
        lost = _column(
            runs, "element", place, lambda run, one: _at(run, "total_element_loss", "element", one)
        )
        yield quantities("energy lost", lost, "J", 4)


def _frictions(run: ReportedRun) -> Iterator[str]:
    return (place for place in elements_of(run.data) if place.startswith("frictions."))


def _telling(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Return rows without those that are nothing but zeros, and without headings of nothing."""
    kept: list[Row] = []
    for row in rows:
        if row.cells and not any(cell.value for cell in row.cells):
            continue
        if not row.cells and kept and not kept[-1].cells:
            kept.pop()
        kept.append(row)
    return tuple(kept if not kept or kept[-1].cells else kept[:-1])


def _table(runs: Sequence[ReportedRun], rows: tuple[Row, ...], caption: str, key: str) -> tuple[Table, ...]:
    if not any(row.cells for row in rows):
        return ()
    return (turned(Table(columns=("", *labels_of(runs)), rows=rows, caption=caption, key=key)),)


def _every(runs: Sequence[ReportedRun], dimension: str) -> list[str]:
    return list(dict.fromkeys(name for run in runs for name in run.names(dimension)))


def _column(runs: Sequence[ReportedRun], dimension: str, name: str, pick: _Pick) -> list[float | None]:
    """Return a number of each run; None for one that has no such thing, or does not know it."""
    values = (pick(run, name) if name in run.names(dimension) else None for run in runs)
    return [value if value is not None and np.isfinite(value) else None for value in values]


def _at(run: ReportedRun, variable: str, dimension: str, name: str) -> float:
    """Return the size of a number of the whole run; not a number where the result has none."""
    if variable not in run.data:
        return float("nan")
    values = np.asarray(run.data[variable].sel({dimension: name}).values, dtype=float)
    return float(np.linalg.norm(values)) if values.ndim else float(values)


def _largest(run: ReportedRun, variable: str, dimension: str, name: str) -> float:
    """Return the largest size of a series at a sample."""
    if variable not in run.data:
        return float("nan")
    parts = (part[variable].sel({dimension: name}).values for part in blocks(run.data))
    return max(float(np.nanmax(np.abs(part), initial=0.0)) for part in parts)
