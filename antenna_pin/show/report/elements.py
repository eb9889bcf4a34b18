"""Sections of loops, drives, springs, stops, latches, gears, flexible links, forces: loads and losses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from antenna_pin.analysis import (
    closure_loads,
    closures_of,
    coupling_loads,
    couplings_of,
    drive_loads,
    drives_of,
    elastic_motion,
    latch_events,
    said_of_constraints,
    stop_impacts,
)
from antenna_pin.show.report._page import (
    Details,
    PageTable,
    Picture,
    Row,
    Section,
    Statement,
    said_of_zeros,
    turned,
)
from antenna_pin.show.report._runs import ReportedRun, along, every, row_of, rows_along, run_table, slides_in
from antenna_pin.trajectory import elements_of
from antenna_pin.trajectory.quantities import RUN, SUMMARIES, TABLES

_Scales = Mapping[str, float]


# --- closed loops and motions ---


def loops(runs: Sequence[ReportedRun], scales: _Scales, pictures: Sequence[Picture] = ()) -> Section:
    """Return what closures and motions of the runs are, their residuals, and their loads."""
    held = [run for run in runs if run.run.constraints]
    if not held:
        return Section(key="loops", title="Closed loops and motions")
    texts: dict[str, list[str]] = {}
    for run in held:
        texts.setdefault(said_of_constraints(run.run.constraints), []).append(run.label)
    everywhere = len(texts) == 1 and len(held) == len(runs)
    said = tuple((() if everywhere else tuple(labels), text) for text, labels in texts.items())
    (how,) = _table(held, tuple(_constraints(held)), "How loops and motions were held", "loops", turn=False)
    about = {name: one for run in reversed(held) for name, one in closures_of(run.data).items()}
    joined = {name: one for run in reversed(held) for name, one in couplings_of(run.data).items()}
    closures = along(
        held,
        "closure",
        [closure_loads(run.data) for run in held],
        TABLES["closure loads"].values(),
        scales,
        lambda name: (
            f"{name}, {about[name]['kind']}: {about[name]['first_body']} - {about[name]['second_body']}"
        ),
    )
    couplings = along(
        held,
        "coupling",
        [coupling_loads(run.data) for run in held],
        TABLES["coupling loads"].values(),
        scales,
        lambda name: "{}: {follower} follows {leader}".format(name, **joined[name]),
    )
    items = [
        *_table(held, _without_moments(closures), "Loads of the closures", "closures"),
        *_table(held, tuple(couplings), "Loads of the couplings, on the followers", "couplings"),
    ]
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
        items=(*items, *pictures, Details(title=how.caption, tables=(how,))),
        meaning=(*notes, *said_of_zeros(items)),
    )


def _constraints(runs: Sequence[ReportedRun]) -> Iterator[Row]:
    for heading, keys in (
        ("counts", ("freedoms", "closure_equations", "closure_rank", "motions", "mobility", "freedoms_left")),
        ("residuals", ("position_residual", "angle_residual", "velocity_residual", "rate_residual")),
        ("corrections after each step", ("projection_energy",)),
    ):
        yield Row(heading)
        for key in keys:
            yield row_of(RUN[key], [run.run.constraints[key] for run in runs])


def _without_moments(rows: Iterator[Row]) -> tuple[Row, ...]:
    """Return rows without those of moments that no closure has."""
    return tuple(row for row in rows if "moment" not in row.name or any(cell.value for cell in row.cells))


# --- drives and controllers ---


def drives(runs: Sequence[ReportedRun], scales: _Scales, pictures: Sequence[Picture] = ()) -> Section:
    """Return what drives exerted and did: motors, prescribed motions and shake among them."""
    own = [run for run in runs if run.names("drive")]
    about = {name: one for run in reversed(own) for name, one in drives_of(run.data).items()}
    loads = [drive_loads(run.data) for run in own]
    rows: list[Row] = []
    for name in every(own, "drive"):
        one = about.get(name, {})
        rows.append(Row(f"drive {name}" + (f", motion of {one['joint']}" if one.get("motion") else "")))
        rows += rows_along(own, "drive", name, loads, TABLES["drive loads"].values(), scales)
        for of in ("controllers", "motors"):
            rows += _of_series(own, of, name, scales)
    table = _table(own, tuple(rows), "What the drives exert", "drives")
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
    """Return what controllers measured and commanded, and how often sampled ones were evaluated."""
    own = [run for run in runs if run.names("sampled")]
    rows = tuple(_recorded(own, "sampled", {}))
    table = _table(own, rows, "Instants of the sampled controllers", "controllers")
    return Section(key="controllers", title="Controllers", items=(*table, *pictures))


# --- springs, frictions, bearings, flexible links, forces ---


def springs(runs: Sequence[ReportedRun], scales: _Scales, pictures: Sequence[Picture] = ()) -> Section:
    """Return what springs, dampers, frictions and bearings exerted and lost."""
    own = [run for run in runs if run.names("spring") or run.names("bearing") or _places(run, "frictions.")]
    data = [run.data for run in own]
    rows: list[Row] = []
    for name in every(own, "spring"):
        rows.append(Row(f"spring {name}"))
        for of in ("traced springs", "point springs"):
            rows += _of_series(own, of, name, scales)
        rows += rows_along(own, "spring", name, data, _summed("spring"), None)
    rows += _recorded(own, "bearing", scales, "bearing ")
    for place in dict.fromkeys(place for run in own for place in _places(run, "frictions.")):
        rows.append(Row(f"friction {place.partition('.')[2]}"))
        rows += _of_series(own, "frictions", place, scales)
        rows += rows_along(own, "element", place, data, _summed("element"), None)
    table = _table(own, _telling(rows), "What springs, frictions and bearings exert and lose", "springs")
    return Section(
        key="springs",
        title="Springs, frictions and bearings",
        items=(*table, *pictures),
        meaning=("Forces, torques and lengths are those of samples.", *said_of_zeros(table)),
    )


def forces(runs: Sequence[ReportedRun], scales: _Scales, pictures: Sequence[Picture] = ()) -> Section:
    """Return what forces on links brought in."""
    own = [run for run in runs if run.names("force")]
    rows = (*_recorded(own, "force", scales), *_recorded(own, "force_place", scales, "at "))
    table = _table(own, rows, "Forces on links", "forces")
    return Section(key="forces", title="Forces", items=(*table, *pictures), meaning=said_of_zeros(table))


def elastic_parts(runs: Sequence[ReportedRun], pictures: Sequence[Picture] = ()) -> Section:
    """Return what the elastic parts of the runs did."""
    own = [run for run in runs if run.names("elastic_part")]
    found = [elastic_motion(run.data) for run in own]
    rows = tuple(along(own, "elastic_part", found, TABLES["elastic motion"].values(), None, str))
    table = _table(own, rows, "What the elastic parts did", "elastic")
    return Section(
        key="elastic",
        title="Flexible links",
        items=(*table, *(pictures if own else ())),
        meaning=(
            "Frequencies are those with the hub held. Energy is a part's against its hub, in its spring "
            "and of its motion; what its damper took is lost. Spin is the largest angular speed of the hub "
            "over the part's angular frequency: far below 1, otherwise the spring does not model the part.",
        )
        if own
        else (),
    )


# --- stops, latches, gears: entries of summaries ---


def stops_and_latches(
    runs: Sequence[ReportedRun], scales: _Scales, pictures: Sequence[Picture] = ()
) -> Section:
    """Return what the stops and latches of the runs did."""
    own = [run for run in runs if _places(run, "stops.", "latches.")]
    rebounds = TABLES["elements"]["fastest_rebound"]
    touched = [stop_impacts(run.data) for run in own]
    events = [latch_events(run.data) for run in own]

    def rebound(place: str, slides: bool) -> Iterator[Row]:
        mine = [table["rebound_rate"].values[table["stop"].values == place] for table in touched]
        yield row_of(rebounds, [values.max(initial=float("-inf")) for values in mine], slides, scales)

    def capture(place: str, slides: bool) -> Iterator[Row]:
        for key in ("angle", "rate", "energy", "impulse"):
            values: list[float | None] = []
            for table in events:
                caught = (table["latch"].values == place) & (table["what"].values == "latched")
                values.append(float(table[key].values[caught][-1]) if caught.any() else None)
            yield row_of(TABLES["latch events"][key], values, slides, scales)

    stops = _table(own, _summarized(own, "stops", scales, rebound), "Touches of the end stops", "stops")
    latches = _table(own, _summarized(own, "latches", scales, capture), "What the latches did", "latches")
    of_stops = (
        "A torque in a touch is the largest of samples, of which there are some at its onset, where the "
        "joint turns back, and at its release; a blow of a rigid stop has an impulse and no torque."
    )
    of_latches = "Energy lost is all that a stop or a latch took in the run, its damper's share included."
    return Section(
        key="stops",
        title="End stops and latches",
        items=(*stops, *latches, *pictures),
        meaning=((of_stops,) if stops else ()) + ((of_latches,) if latches else ()),
    )


def gears(runs: Sequence[ReportedRun], pictures: Sequence[Picture] = ()) -> Section:
    """Return what the gears, belts and cables of the runs did."""
    own = [run for run in runs if _places(run, "gears.")]
    table = _table(own, _summarized(own, "gears", {}), "What they met", "gears")
    note = (
        "A torque is the largest of samples, of which there are some where flanks meet, turn back and part; "
        "impulses are those of touches of one side alone."
    )
    return Section(
        key="gears",
        title="Gears, belts and cables",
        items=(*table, *(pictures if table else ())),
        meaning=(note,) if table else (),
    )


# --- rows ---


def _summarized(
    runs: Sequence[ReportedRun],
    family: str,
    scales: _Scales,
    more: Callable[[str, bool], Iterator[Row]] = lambda place, slides: iter(()),
) -> tuple[Row, ...]:
    """Return rows of a family's elements by the summaries, and further rows."""
    found: list[dict[str, dict[str, Any]]] = [run.run.summary().get(family, {}) for run in runs]
    rows: list[Row] = []
    for name in dict.fromkeys(name for one in found for name in one):
        place = f"{family}.{name}"
        slides = slides_in(runs, "element", place)
        rows.append(Row(name))
        for one in TABLES["elements"].values():
            values = [each.get(name, {}).get(one.key(slides)) for each in found]
            if any(one.key(slides) in each.get(name, {}) for each in found) and one.name != "held_at_end":
                rows.append(row_of(one, values, slides, scales))
        rows[-1:-1] = more(place, slides)
    return tuple(rows)


def _summed(dim: str) -> list[Any]:
    return [one for one in SUMMARIES if one.dims[:1] == (dim,)]


def _recorded(runs: Sequence[ReportedRun], dim: str, scales: _Scales, word: str = "") -> Iterator[Row]:
    """Yield rows of all that results have recorded along a dimension."""
    return along(runs, dim, [run.data for run in runs], _summed(dim), scales, lambda name: f"{word}{name}")


def _of_series(runs: Sequence[ReportedRun], table: str, name: str, scales: _Scales) -> Iterator[Row]:
    """Yield rows of a table reduced from series, if a run has the name."""
    variables = list(TABLES[table].values())
    (dim,) = variables[0].dims
    if name in every(runs, dim):
        yield from rows_along(runs, dim, name, [run.data for run in runs], variables, scales)


def _places(run: ReportedRun, *families: str) -> list[str]:
    return [place for place in elements_of(run.data) if place.startswith(families)]


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


def _table(
    runs: Sequence[ReportedRun], rows: tuple[Row, ...], caption: str, key: str, turn: bool = True
) -> tuple[PageTable, ...]:
    if not any(row.cells for row in rows):
        return ()
    table = run_table(runs, rows, caption, key)
    return (turned(table) if turn else table,)
