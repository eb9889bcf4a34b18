"""Sections of joints, with and without play: motion, impacts, loads, settling."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from antenna_pin.analysis import Settling, blocks, impacts, load_statistics, settling
from antenna_pin.base.readable import number, readable
from antenna_pin.show.report._page import (
    Details,
    Embedded,
    PageTable,
    Picture,
    PicturedTable,
    Row,
    Section,
    counts,
    quantities,
    said_of_zeros,
    words,
)
from antenna_pin.show.report._runs import ReportedRun, every, ideal_of, row_of, rows_along, run_table
from antenna_pin.trajectory import contact_joints
from antenna_pin.trajectory.columns import Variable
from antenna_pin.trajectory.quantities import CONTACTS, SUMMARIES, TABLES, reduced

#: Rows of the tables of largest impacts.
LARGEST = 8
#: Rows of a whole table of impacts; the file holds the rest.
MOST = 2000


# --- impacts ---

_HIDDEN = ("separation_speed", "ended", "floored", "blow")
_IMPACTS = [one for name, one in TABLES["impacts"].items() if name not in _HIDDEN]


def contact_details(runs: Sequence[ReportedRun], joint: str, scales: Mapping[str, float]) -> Details:
    """Return statistics, hardest impacts, loads and settling of a joint."""
    found = [impacts(run.data, joint) for run in runs]
    tables = [_impact_summary(runs, found, joint)]
    for run, table in zip(runs, found, strict=True):
        if table.sizes["impact"]:
            order = np.argsort(-table["peak_force"].values, kind="stable")[:LARGEST]
            hardest = table.isel(impact=order)
            key = f"largest-impacts-{joint}-{run.label}"
            tables.append(_impact_table(hardest, f"Hardest impacts of {run.label}", key))
    loads, of_loads = _loads(runs, joint, scales)
    settled, of_settling = _settlings(runs, joint)
    return Details(
        title=f"Impacts, loads and settling of {joint}",
        tables=(*tables, *loads, *settled),
        notes=(_ROWS, *of_loads, *of_settling),
    )


def every_impact(runs: Sequence[ReportedRun], joint: str) -> Iterator[Details]:
    """Yield all impacts in a joint of each run."""
    for run in runs:
        table = impacts(run.data, joint)
        count = table.sizes["impact"]
        if count:
            shown = _impact_table(
                table.isel(impact=slice(0, MOST)), "", f"impacts-{joint}-{run.label}", dense=True
            )
            rest = f", the first {MOST}" if count > MOST else ""
            yield Details(title=f"All {count} impacts in {joint} of {run.label}{rest}", tables=(shown,))


_ROWS = (
    "One row per contact, from first touch to release. Contacts of the same surfaces that overlap, "
    "as at both ends of a bore that are met at once, are one blow of the joint. Restitution is the "
    "speed of separation over that of approach, at these very instants; a dash where the contact had "
    "not ended, or closed slower than the law's floor of speed. Values above 1 occur where two "
    "contacts push each other."
)


def _impact_summary(runs: Sequence[ReportedRun], tables: Sequence[xr.Dataset], joint: str) -> PageTable:
    def column(name: str, of: Callable[[np.ndarray], float]) -> list[float | None]:
        known = (table[name].values[np.isfinite(table[name].values)] for table in tables)
        return [float(of(values)) if values.size else None for values in known]

    statistics = TABLES["impact statistics"]
    rows = [
        row_of(statistics["impacts"], [table.sizes["impact"] for table in tables]),
        counts("blows", (len(set(table["blow"].values.tolist())) for table in tables)),
        row_of(statistics["touching"], [int(np.count_nonzero(~table["ended"].values)) for table in tables]),
        row_of(statistics["floored"], [int(np.count_nonzero(table["floored"].values)) for table in tables]),
    ]
    for one in _IMPACTS:
        if one.units != "s" or one.name == "duration":
            for word, of in (("median", np.median), ("largest", np.max)):
                if one.name != "restitution" or word == "median":
                    values = column(one.name, of)
                    rows.append(quantities(f"{one.words()}, {word}", values, one.unit(), one.digits))
    return run_table(runs, rows, "Impacts in numbers", f"impact-summary-{joint}")


def _impact_table(table: xr.Dataset, caption: str, key: str, dense: bool = False) -> PageTable:
    columns = [row_of(one, table[one.name].values.tolist()) for one in _IMPACTS]
    heads = (f"{c.name} [{c.unit}]" if c.unit else c.name for c in columns)
    cells = zip(*(c.cells for c in columns), strict=True)
    rows = tuple(Row(str(name), line) for name, line in zip(table["contact"].values, cells, strict=True))
    return PageTable(columns=("contact", *heads), rows=rows, caption=caption, key=key, dense=dense)


# --- loads ---


def _loads(
    runs: Sequence[ReportedRun], joint: str, scales: Mapping[str, float]
) -> tuple[tuple[PageTable, ...], tuple[str, ...]]:
    """Return statistics of a joint's forces: of the whole, and of each contact."""
    found = [load_statistics(run.data, joint) for run in runs]
    contacts = dict.fromkeys(str(name) for one in found for name in one["contact"].values)
    rows = _load_rows(found, "clearance_joint", joint, scales)
    whole = run_table(runs, rows, "Size of the whole contact force on the journal", f"loads-{joint}")
    rows = (row for name in contacts for row in _load_rows(found, "contact", name, scales))
    each = run_table(runs, rows, "Normal force of each contact", f"loads-contacts-{joint}")
    notes = (
        "Percentiles of the time: a force that is not exceeded for so much of it. The force on the "
        "journal may be far below those of its contacts, which press from opposite sides when the "
        "journal is tilted.",
        *said_of_zeros((whole, each)),
    )
    return (whole, each), notes


def _load_rows(
    statistics: Sequence[xr.Dataset], dimension: str, name: str, scales: Mapping[str, float]
) -> Iterator[Row]:
    prefix = "joint_" if dimension == "clearance_joint" else ""
    mine = [one.sel({dimension: name}) if name in one[dimension].values else None for one in statistics]

    def column(key: str) -> list[float | None]:
        values = (None if one is None else float(one[prefix + key]) for one in mine)
        return [value if value is not None and np.isfinite(value) else None for value in values]

    known = {
        key: of for key, of in TABLES["loads"].items() if prefix + key in TABLES["joint loads"] or not prefix
    }
    yield Row(name)
    for key, of in known.items():
        if key.endswith(("force", "contact")):
            yield row_of(of, column(key), scales=scales)
    percents = next(one for one in mine if one is not None)["percent"].values
    for k, percent in enumerate(percents):
        values = [None if one is None else float(one[f"{prefix}force_percentile"][k]) for one in mine]
        yield quantities(f"{number(float(percent))} % of the time", values, "N", 3, scales)
    yield row_of(known["contact_share"], column("contact_share"))


# --- settling ---


def _settlings(runs: Sequence[ReportedRun], joint: str) -> tuple[tuple[PageTable, ...], tuple[str, ...]]:
    """Return when impacts in a joint turned into lasting contact."""
    found = [next(iter(settling(run.data, joint)), None) for run in runs]
    known = [one for one in found if one is not None]
    if not known:
        return (), ()
    rows = _settling_rows(joint, found)
    table = run_table(runs, rows, "When impacts turn into lasting contact", f"settling-{joint}")
    note = (
        "Settled: from this time on its contacts are never all apart for longer than "
        f"{readable(known[0].longest_gap, 's')}. Rate of decay: of the straight line through the logarithm "
        "of the approach speeds over time, where that explains half of what they do."
    )
    if any(one.driven and not one.note for one in known):
        note += " Driven, so that they may part again as its load turns."
    return (table,), (note,)


def _settling_rows(joint: str, settlings: Sequence[Settling | None]) -> Iterator[Row]:
    yield Row(joint)
    for name, of in TABLES["settling"].items():
        if name == "decay_rate":
            values = [one.decay_rate if one is not None and one.decays else None for one in settlings]
        else:
            values = [None if one is None else getattr(one, name) for one in settlings]
        yield row_of(of, values)
        if name == "time" and any(one is not None and one.note for one in settlings):
            yield words("why not settled", ("" if one is None else one.note for one in settlings))
        if name == "decay_rate" and any(one is not None and one.decays is False for one in settlings):
            said = ("no decay" if one is not None and one.decays is False else "" for one in settlings)
            yield words("approach speeds over time", said)


# --- joints ---


def joint_key(joint: str) -> str:
    """Return the address of a joint's section in the page."""
    return f"joint-{joint}"


def hardness(runs: Sequence[ReportedRun], joint: str) -> float:
    """Return the largest contact force in a joint over all runs [N]."""
    tables = (impacts(run.data, joint) for run in runs if joint in run.names("clearance_joint"))
    return max((float(one["peak_force"].max()) for one in tables if one.sizes["impact"]), default=0.0)


def hardest_joint(runs: Sequence[ReportedRun]) -> str | None:
    """Return the joint of the page's head: the hardest hit, else the first moving."""
    hit = {name: hardness(runs, name) for name in every(runs, "clearance_joint")}
    if hit:
        return max(hit, key=lambda name: hit[name])
    return next(iter((*every(runs, "joint"), *every(runs, "sliding_joint"))), None)


def with_play(
    runs: Sequence[ReportedRun],
    joint: str,
    scales: Mapping[str, float],
    pictures: Sequence[Picture] = (),
    folded: bool = False,
) -> Section:
    """Return the section of a joint with play."""
    touched = [run for run in runs if joint in run.names("clearance_joint")]
    rows = (*_motion(runs, joint, scales), *_contact(runs, joint), *_settled(runs, joint))
    table = run_table(runs, rows, "Motion and contact in numbers", joint_key(joint))
    return Section(
        key=joint_key(joint),
        title=f"Joint {joint}",
        items=(
            PicturedTable(table=table),
            *pictures,
            contact_details(touched, joint, scales),
            *every_impact(touched, joint),
        ),
        folded=folded,
        meaning=(
            "Forces, depths and speeds of contacts are the largest of the integrator's dense output, not of "
            "samples. Impulse is the integral of the normal forces over time; energy lost is that of "
            "contacts, normal and friction.",
            *said_of_zeros([table]),
        ),
    )


def with_recordings(section: Section, close: Mapping[str, Sequence[Embedded]]) -> Section:
    """Return a section with close-ups of its joint beside its table."""
    seen = next((tuple(made) for joint, made in close.items() if joint_key(joint) == section.key), ())
    items = [replace(one, seen=seen) if isinstance(one, PicturedTable) else one for one in section.items]
    return replace(section, items=tuple(items)) if seen else section


def without_play(
    runs: Sequence[ReportedRun], scales: Mapping[str, float], pictures: Sequence[Picture] = ()
) -> Section:
    """Return the section of the joints that have no play in any of the runs."""
    played = every(runs, "clearance_joint")
    rows: list[Row] = []
    for dimension in ("joint", "sliding_joint"):
        for joint in every(runs, dimension):
            if joint not in played:
                rows += [Row(f"joint {joint}"), *_motion(runs, joint, scales)]
    table = run_table(runs, rows, "Their motion in numbers", "joints")
    return Section(
        key="joints",
        title="Joints without play" if played else "Joints",
        items=(*([table] if rows else []), *pictures),
        meaning=said_of_zeros([table]),
    )


def _motion(runs: Sequence[ReportedRun], joint: str, scales: Mapping[str, float]) -> Iterator[Row]:
    dim = "sliding_joint" if joint in every(runs, "sliding_joint") else "joint"
    if joint not in every(runs, dim):
        return
    known = [one for one in SUMMARIES if one.dims == (dim,)]
    rows = list(rows_along(runs, dim, joint, [run.data for run in runs], known, scales))
    yield from rows
    ideal = ideal_of(runs)
    if ideal is not None and joint in ideal.names(dim):
        top = next(row for row, one in zip(rows, known, strict=True) if one.name.startswith("peak"))
        peaks = [cell.value for cell in top.cells]
        own = peaks[list(runs).index(ideal)]
        ratios = [peak / own if peak is not None and own else None for peak in peaks]
        yield quantities("the same over the ideal joint's", ratios, "1", 3)


def _contact(runs: Sequence[ReportedRun], joint: str) -> Iterator[Row]:
    touched = [run if joint in run.names("clearance_joint") else None for run in runs]
    tables = [None if run is None else impacts(run.data, joint) for run in touched]
    loads = [None if run is None else load_statistics(run.data, joint) for run in touched]

    def number(run: ReportedRun | None, of: Variable) -> float | None:
        if run is None:
            return None
        owners = list(contact_joints(run.data).values())
        mine = np.isin(
            run.data["episode_contact"].values, [k for k, one in enumerate(owners) if one == joint]
        )
        return reduced(of, run.data, mine, float(run.data.attrs["end_time"]))

    blows = (None if t is None else len(set(t["blow"].values.tolist())) for t in tables)
    shares = [None if one is None else float(one["joint_contact_share"].values[0]) for one in loads]
    for of in CONTACTS:
        if of.key():
            yield row_of(of, [number(run, of) for run in touched])
        if of.form == "count":
            yield counts("blows", blows)
    yield row_of(TABLES["loads"]["contact_share"], shares)


def _settled(runs: Sequence[ReportedRun], joint: str) -> Iterator[Row]:
    found = [
        next(iter(settling(run.data, joint)), None) if joint in run.names("clearance_joint") else None
        for run in runs
    ]
    times = [None if one is None else one.time for one in found]
    if any(time is not None for time in times):
        yield quantities("lasting contact from", times, "s", 3)


# --- base ---


def base(
    runs: Sequence[ReportedRun], scales: Mapping[str, float], pictures: Sequence[Picture] = ()
) -> Section:
    """Return how far a free base went and turned."""
    free = [run if "base_position" in run.data else None for run in runs]
    farthest, largest = ([None if run is None else of(run) for run in free] for of in (_displacement, _turn))
    rows = (
        quantities("farthest from its start", farthest, "m", 4, scales),
        quantities("largest turn from its start", largest, "rad", 4, scales),
    )
    table = run_table(runs, rows, "Motion of the base", "base")
    return Section(key="base", title="Base", items=(*([table] if any(free) else ()), *pictures))


def _displacement(run: ReportedRun) -> float:
    start = run.data["base_position"][0].values
    parts = (part["base_position"].values - start for part in blocks(run.data))
    return max(float(np.linalg.norm(part, axis=1).max()) for part in parts)


def _turn(run: ReportedRun) -> float:
    x0 = run.data["base_attitude"][0].values
    return max(_largest_turn(x0, part["base_attitude"].values) for part in blocks(run.data))


def _largest_turn(x0: np.ndarray, q: np.ndarray) -> float:
    # Of q0* q the vector part is sin of half the angle; small angles keep their digits that way.
    scalar = q @ x0
    vector = (
        x0[3] * q[:, :3] - q[:, 3:] * x0[:3] - np.cross(np.broadcast_to(x0[:3], q[:, :3].shape), q[:, :3])
    )
    return float((2.0 * np.arctan2(np.linalg.norm(vector, axis=1), np.abs(scalar))).max())
