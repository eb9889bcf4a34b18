"""Tables for people, and numbers as they stand in them."""

from __future__ import annotations

import math
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import typer

from antenna_pin.cli._layout import Table, laid_out

# How the entries of a summary are called in a table, and their units; others keep their own names.
_ENTRIES = {
    "time": ("simulated time", "s"),
    "accepted": ("steps accepted", ""),
    "rejected": ("steps rejected", ""),
    "relocated": ("steps cut to a change of contact", ""),
    "wall_seconds": ("wall time", "s"),
    "compile_seconds": ("wall time of compiling, once", "s"),
    "energy_error": ("energy balance error", "J"),
    "energy_scale": ("energy scale: largest of gross work, kinetic, stored", "J"),
    "energy_error_relative": ("energy balance error, relative", "-"),
    "energy_tolerance": ("energy balance error that is explained", "J"),
    "gross_work": ("gross work of drives and forces", "J"),
    "linear_momentum_drift": ("linear momentum drift", "kg m/s"),
    "linear_momentum_scale": ("linear momentum scale", "kg m/s"),
    "linear_momentum_drift_relative": ("linear momentum drift, relative", "-"),
    "linear_momentum_tolerance": ("linear momentum drift that is explained", "kg m/s"),
    "angular_momentum_drift": ("angular momentum drift", "kg m²/s"),
    "angular_momentum_scale": ("angular momentum scale", "kg m²/s"),
    "angular_momentum_drift_relative": ("angular momentum drift, relative", "-"),
    "angular_momentum_tolerance": ("angular momentum drift that is explained", "kg m²/s"),
    "gap_difference": ("gaps, coal against closed form", "m"),
    "angle": ("angle at the end", "rad"),
    "rate": ("rate at the end", "rad/s"),
    "peak_acceleration": ("peak acceleration", "rad/s²"),
    "position": ("position at the end", "m"),
    "slide_rate": ("rate at the end", "m/s"),
    "peak_slide_acceleration": ("peak acceleration", "m/s²"),
    "peak_force": ("peak force", "N"),
    "peak_depth": ("peak depth", "m"),
    "largest_approach_speed": ("largest approach speed", "m/s"),
    "impulse": ("impulse", "N s"),
    "angular_impulse": ("angular impulse about the origin", "N m s"),
    "dissipated": ("energy lost", "J"),
    "closure_equations": ("equations of closures", ""),
    "couplings": ("those of couplings", ""),
    "closure_rank": ("independent equations of closures", ""),
    "rank": ("independent equations, those of motions among them", ""),
    "freedoms": ("freedoms of the tree", ""),
    "mobility": ("mobility: freedoms that closures leave", ""),
    "freedoms_left": ("freedoms that closures and motions leave", ""),
    "position_residual": ("largest residual of closures and motions", "m"),
    "angle_residual": ("largest residual of closures and motions", "rad"),
    "velocity_residual": ("largest residual of closures and motions", "m/s"),
    "rate_residual": ("largest residual of closures and motions", "rad/s"),
    "projection_energy": ("energy that corrections put in", "J"),
    "peak_moment": ("peak moment", "N m"),
    "peak_torque": ("peak torque", "N m"),
    "work": ("work", "J"),
    "peak_deflection": ("peak deflection", "rad"),
    "peak_shift": ("peak deflection", "m"),
    "peak_elastic_energy": ("peak energy in the spring", "J"),
    "touches": ("touches", ""),
    "fastest_touch": ("fastest touch", "rad/s, m/s"),
    "largest_blow": ("largest impulse", "N m s, N s"),
    "time_apart": ("time without contact", "s"),
    "time_slack": ("time with a slack strand", "s"),
    "captures": ("captures", ""),
    "refusals": ("refusals", ""),
    "largest_energy_refused": ("largest energy refused", "J"),
    "last_capture": ("last capture", "s"),
    "let_go": ("let go", ""),
    "ticks": ("instants", ""),
    "saturated": ("instants at limits", ""),
    "element_loss": ("energy lost", "J"),
    "elastic_loss": ("energy lost in the damper", "J"),
}
# What stands where an entry has no number, but for a dash.
_WITHOUT = {"energy balance error, relative [-]": "nothing moves"}
# Entries that tables leave out: what they say is said in a sentence.
_SAID = ("title", "message", "redundant", "singular", "energy_scale_of")
# Entries that they leave out where they are zero.
_UNLESS_ZERO = ("compile_seconds",)
# Groups of a summary whose entries are named things, each a row: what they are called.
_NAMED = {
    "motion": "joints",
    "slides": "sliding joints",
    "contacts": "contacts",
    "elastic_parts": "elastic parts",
    "closures": "closures",
    "motions": "motions",
    "couplings": "couplings",
    "bearings": "bearings",
    "stops": "stops",
    "latches": "latches",
    "gears": "gears",
    "forces": "forces",
    "controllers": "controllers",
    "blows": "surfaces",
}
# Groups of a summary whose name says nothing that their entries do not say.
_PLAIN_GROUPS = (
    "counts",
    "conservation",
    "motion",
    "slides",
    "contacts",
    "blows",
    "elastic_parts",
    "constraints",
    "closures",
    "motions",
    "couplings",
    "bearings",
    "forces",
)


def print_summaries(
    summaries: Sequence[tuple[str, Mapping[str, Any]]], text: Callable[[Any, str], str] | None = None
) -> None:
    """Print summaries side by side as far as the lines are long, the others below; one row per figure.

    Args:
        summaries: Labels and summaries.
        text: Returns a number of a row as it stands there.
    """
    told = text or (lambda value, name: text_of(value))

    def cell(column: Mapping[str, Any], row: str) -> str:
        lacks = row in column and column[row] is None
        return _WITHOUT[row] if lacks and row in _WITHOUT else told(column.get(row), row)

    columns = [dict(_rows(summary)) for _, summary in summaries]
    titles = dict.fromkeys(str(summary.get("title", "")) for _, summary in summaries)
    rows = []
    for row in dict.fromkeys(name for column in columns for name in column):
        rows.append([row, *(cell(column, row) for column in columns)])
    head = ["", *(label for label, _ in summaries)]
    _print(Table(title="; ".join(filter(None, titles)), head=head, rows=rows, sparse=True), pipe=_PAGE)


def print_summary(
    label: str, summary: Mapping[str, Any], text: Callable[[Any, str], str] | None = None
) -> None:
    """Print all of one summary: a table of the run, then one for each kind of thing, a row for each of them.

    Args:
        label: Of the run.
        summary: The summary.
        text: Returns a number of a row as it stands there.
    """
    told = text or (lambda value, name: text_of(value))
    print_summaries([(label, {key: one for key, one in summary.items() if key not in _NAMED})], text)
    for key, title in _NAMED.items():
        named = summary.get(key)
        if not named:
            continue
        entries = list(dict.fromkeys(entry for one in named.values() for entry in one))
        units = {entry: _named(entry) for entry in entries}
        head = (title, *units.values())
        rows = [
            [name, *(told(one.get(entry), units[entry]) for entry in entries)] for name, one in named.items()
        ]
        print_rows("", head, rows)


def _named(entry: str) -> str:
    """Return the name of an entry in tables, with its unit."""
    name, unit = _ENTRIES.get(entry, (entry.replace("_", " "), ""))
    return name + (f" [{unit}]" if unit else "")


def print_rows(title: str, head: Sequence[str], rows: Sequence[Sequence[str]], numbers: bool = True) -> None:
    """Print a table; ``numbers``: those of all columns but the first stand at the right."""
    _print(Table(title=title, head=head, rows=rows, numbers=numbers), pipe=_ENDLESS)


# A pipe has no width to keep to; but files go down at some point, not across.
_ENDLESS = 300
_PAGE = 130


def _print(table: Table, pipe: int) -> None:
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else pipe
    typer.echo("\n".join(laid_out(table, width)))


def flat(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries of a summary by the names that a table has for them, with units."""
    return dict(_rows(summary))


def _rows(summary: Mapping[str, Any], group: str = "") -> Iterator[tuple[str, Any]]:
    """Yield name and value of every entry of a summary, those of a group after its name."""
    for key, value in summary.items():
        if key in _SAID or (key in _UNLESS_ZERO and not value):
            continue
        if isinstance(value, dict):
            yield from _rows(value, group if key in _PLAIN_GROUPS else f"{group}{key} ")
        else:
            yield f"{group}{_named(key)}", value


def text_of(value: Any) -> str:
    """Return an entry as it stands in a table: a dash where there is nothing, or no number."""
    if value is None or value == "" or value != value:
        return "-"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(map(text_of, value))
    return str(value)


# --- numbers ---


def number_text(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) and abs(value) < 1e4 else integer_text(value)


def integer_text(value: float) -> str:
    return f"{value:.0f}" if math.isfinite(value) else "-"


def fixed_text(value: float) -> str:
    return f"{value:.7f}" if math.isfinite(value) else "-"


def percent_text(share: float) -> str:
    return f"{share:.1f}" if math.isfinite(share) else "-"


def length_text(value: float, digits: int = 4) -> str:
    """Return a length with a unit that suits it."""
    if not math.isfinite(value):
        return "-"
    size, unit = next(
        ((size, unit) for size, unit in ((1.0, "m"), (1e-3, "mm")) if value >= 0.1 * size), (1e-6, "um")
    )
    return f"{value / size:.{digits}g} {unit}"


def power_above(value: float) -> str:
    """Return the power of ten that a size does not exceed."""
    if not value > 0.0:
        return "0"
    return f"1e{math.ceil(math.log10(value))}"
