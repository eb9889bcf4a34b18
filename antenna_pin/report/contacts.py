"""What the analyses find in the joints with play: impacts, loads, settling into lasting contact."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
import xarray as xr

from antenna_pin.analysis import Settling, impacts, load_statistics, settling
from antenna_pin.base.readable import number, readable
from antenna_pin.report._page import Details, Row, Table, counts, quantities, said_of_zeros, shares_row, words
from antenna_pin.report._runs import ReportedRun, labels_of

__all__ = ["contact_details", "every_impact"]

#: Rows of the tables of largest impacts.
LARGEST = 8
#: Rows of a whole table of impacts; the file holds the rest.
MOST = 2000


# --- impacts ---

_COLUMNS = (
    ("onset", "from", "s", 6),
    ("peak_time", "peak at", "s", 6),
    ("approach_speed", "approach", "m/s", 3),
    ("peak_force", "peak force", "N", 4),
    ("peak_depth", "depth", "m", 3),
    ("impulse", "impulse", "N s", 3),
    ("duration", "duration", "s", 3),
    ("restitution", "restitution", "1", 3),
    ("dissipated", "energy lost", "J", 3),
)


def contact_details(runs: Sequence[ReportedRun], joint: str, scales: Mapping[str, float]) -> Details:
    """Return statistics of the impacts in a joint, the hardest, its loads, and when it settled."""
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


def _impact_summary(runs: Sequence[ReportedRun], tables: Sequence[xr.Dataset], joint: str) -> Table:
    def column(name: str, of: Callable[[np.ndarray], float]) -> list[float | None]:
        found: list[float | None] = []
        for table in tables:
            values = table[name].values
            values = values[np.isfinite(values)]
            found.append(float(of(values)) if values.size else None)
        return found

    rows = [
        counts("impacts", (table.sizes["impact"] for table in tables)),
        counts("blows of joints", (len(set(table["blow"].values.tolist())) for table in tables)),
        counts("not ended", (int(np.count_nonzero(~table["ended"].values)) for table in tables)),
        counts(
            "slower than the law's floor",
            (int(np.count_nonzero(table["floored"].values)) for table in tables),
        ),
    ]
    for name, word, unit, _ in _COLUMNS[2:]:
        for said, of in (("median", np.median), ("largest", np.max)):
            if name != "restitution" or said == "median":
                rows.append(quantities(f"{word}, {said}", column(name, of), unit))
    return Table(
        columns=("", *labels_of(runs)),
        rows=tuple(rows),
        caption="Impacts in numbers",
        key=f"impact-summary-{joint}",
    )


def _impact_table(table: xr.Dataset, caption: str, key: str, dense: bool = False) -> Table:
    columns = [
        quantities(word, _floats(table[name].values), unit, digits) for name, word, unit, digits in _COLUMNS
    ]
    heads = (f"{c.name} [{c.unit}]" if c.unit else c.name for c in columns)
    cells = zip(*(c.cells for c in columns), strict=True)
    rows = tuple(Row(str(name), line) for name, line in zip(table["contact"].values, cells, strict=True))
    return Table(columns=("contact", *heads), rows=rows, caption=caption, key=key, dense=dense)


def _floats(values: np.ndarray) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


# --- loads ---


def _loads(
    runs: Sequence[ReportedRun], joint: str, scales: Mapping[str, float]
) -> tuple[tuple[Table, ...], tuple[str, ...]]:
    """Return statistics of the forces in a joint with play: of the whole, and of each contact."""
    found = [load_statistics(run.data, joint) for run in runs]
    columns = ("", *labels_of(runs))
    contacts = list(dict.fromkeys(str(name) for one in found for name in one["contact"].values))
    whole = Table(
        columns=columns,
        rows=tuple(_load_rows(found, "clearance_joint", joint, scales)),
        caption="Size of the whole contact force on the journal",
        key=f"loads-{joint}",
    )
    each = Table(
        columns=columns,
        rows=tuple(row for name in contacts for row in _load_rows(found, "contact", name, scales)),
        caption="Normal force of each contact",
        key=f"loads-contacts-{joint}",
    )
    notes = (
        "Percentiles of the time: a force that is not exceeded for so much of it. The force on the "
        "journal may be far below those of its contacts, which press from opposite sides when the "
        "journal is tilted.",
        *said_of_zeros((whole, each)),
    )
    return (whole, each), notes


def _load_rows(
    found: Sequence[xr.Dataset], dimension: str, name: str, scales: Mapping[str, float]
) -> Iterator[Row]:
    prefix = "joint_" if dimension == "clearance_joint" else ""
    mine = [one.sel({dimension: name}) if name in one[dimension].values else None for one in found]

    def column(key: str) -> list[float | None]:
        values = (None if one is None else float(one[prefix + key]) for one in mine)
        return [value if value is not None and np.isfinite(value) else None for value in values]

    yield Row(name)
    yield quantities("largest", column("peak_force"), "N", 4, scales)
    yield quantities("mean", column("mean_force"), "N", 4, scales)
    if not prefix:
        yield quantities("mean while in contact", column("mean_force_in_contact"), "N", 4, scales)
    yield quantities("root mean square", column("rms_force"), "N", 3, scales)
    percents = next(one for one in mine if one is not None)["percent"].values
    for k, percent in enumerate(percents):
        values = [None if one is None else float(one[f"{prefix}force_percentile"][k]) for one in mine]
        yield quantities(f"{number(float(percent))} % of the time", values, "N", 3, scales)
    yield shares_row("share of time in contact", column("contact_share"))


# --- settling ---


def _settlings(runs: Sequence[ReportedRun], joint: str) -> tuple[tuple[Table, ...], tuple[str, ...]]:
    """Return when impacts in a joint turned into lasting contact."""
    found = [next((one for one in settling(run.data, joint)), None) for run in runs]
    known = [one for one in found if one is not None]
    if not known:
        return (), ()
    table = Table(
        columns=("", *labels_of(runs)),
        rows=tuple(_settling_rows(joint, found)),
        caption="When impacts turn into lasting contact",
        key=f"settling-{joint}",
    )
    note = (
        "Settled: from this time on its contacts are never all apart for longer than "
        f"{readable(known[0].longest_gap, 's')}. Rate of decay: of the straight line through the logarithm "
        "of the approach speeds over time, where that explains half of what they do."
    )
    if any(one.driven and not one.note for one in known):
        note += " Driven, so that they may part again as its load turns."
    return (table,), (note,)


def _settling_rows(joint: str, found: Sequence[Settling | None]) -> Iterator[Row]:
    def row(name: str, of: Callable[[Settling], float | None], unit: str) -> Row:
        values = [None if one is None else of(one) for one in found]
        return quantities(name, [v if v is not None and np.isfinite(v) else None for v in values], unit, 3)

    yield Row(joint)
    yield row("settled at", lambda one: one.time, "s")
    if any(one is not None and one.note for one in found):
        yield words("why it has not settled", ("" if one is None else one.note for one in found))
    for word in ("before", "after"):
        shares = [None if one is None else getattr(one, f"share_{word}") for one in found]
        shares = [s if s is not None and np.isfinite(s) else None for s in shares]
        yield shares_row(f"share of time in contact {word}", shares)
    yield row("last time apart ends at", lambda one: one.last_gap, "s")
    yield row("rate of decay of approach speeds", lambda one: one.decay_rate if one.decays else None, "1/s")
    if any(one is not None and one.decays is False for one in found):
        said = ("no decay" if one is not None and one.decays is False else "" for one in found)
        yield words("approach speeds over time", said)
    yield row("how well it fits, R²", lambda one: one.decay_r2, "1")
