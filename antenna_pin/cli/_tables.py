"""Tables for people, and numbers as they stand in them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import typer

# How the entries of a summary are called in a table, and their units; others keep their own names.
_ENTRIES = {
    "time": ("simulated time", "s"),
    "accepted": ("steps accepted", ""),
    "rejected": ("steps rejected", ""),
    "relocated": ("steps cut to a change of contact", ""),
    "wall_seconds": ("wall time", "s"),
    "energy_error": ("energy balance error", "J"),
    "energy_error_relative": ("energy balance error, relative", "-"),
    "gross_work": ("gross work of the drives", "J"),
    "linear_momentum_drift": ("linear momentum drift", "kg m/s"),
    "linear_momentum_scale": ("linear momentum scale", "kg m/s"),
    "linear_momentum_drift_relative": ("linear momentum drift, relative", "-"),
    "angular_momentum_drift": ("angular momentum drift", "kg m²/s"),
    "angular_momentum_scale": ("angular momentum scale", "kg m²/s"),
    "angular_momentum_drift_relative": ("angular momentum drift, relative", "-"),
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
    "dissipated": ("energy lost", "J"),
    "closure_equations": ("equations of closures", ""),
    "closure_rank": ("independent equations of closures", ""),
    "rank": ("independent equations, those of motions among them", ""),
    "freedoms": ("freedoms of the tree", ""),
    "mobility": ("freedoms that closures leave", ""),
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
    "elastic_loss": ("energy lost in the damper", "J"),
}
# Entries that tables leave out: what they say is said in a sentence.
_SAID = ("title", "case", "redundant", "singular")
# Groups of a summary whose name says nothing that their entries do not say.
_PLAIN_GROUPS = (
    "counts",
    "conservation",
    "motion",
    "slides",
    "contacts",
    "elastic_parts",
    "constraints",
    "closures",
    "motions",
)


def print_summaries(summaries: Sequence[tuple[str, dict[str, Any]]]) -> None:
    """Print summaries side by side, one row per figure."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    columns = [dict(_rows(summary)) for _, summary in summaries]
    titles = dict.fromkeys(str(summary.get("title", "")) for _, summary in summaries)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title="; ".join(filter(None, titles)))
    table.title_justify = "left"
    table.add_column("", no_wrap=True)
    for label, _ in summaries:
        table.add_column(label, justify="right", overflow="fold")
    for row in dict.fromkeys(name for column in columns for name in column):
        texts = [column.get(row, "-") for column in columns]
        if any(text != "-" for text in texts):  # a fixed base keeps no momentum, to take one
            table.add_row(row, *texts)
    # Units stand in brackets, which are no markup. A pipe has no width to keep to.
    console = Console(highlight=False, markup=False)
    if not console.is_terminal:
        console = Console(highlight=False, markup=False, width=max(100, 50 + 36 * len(summaries)))
    console.print(table)


def print_rows(
    title: str, head: Sequence[str], rows: Sequence[Sequence[str]], justify: Any = "right"
) -> None:
    """Print a table, without blanks at the ends of its lines; a pipe has no width to keep to."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title=title)
    table.title_justify = "left"
    for place, name in enumerate(head):
        table.add_column(name, justify="left" if place == 0 else justify, overflow="fold")
    for row in rows:
        table.add_row(*row)
    # Units stand in brackets, which are no markup.
    console = Console(highlight=False, markup=False)
    if not console.is_terminal:
        console = Console(highlight=False, markup=False, width=300)
    with console.capture() as printed:
        console.print(table)
    typer.echo("\n".join(line.rstrip() for line in printed.get().splitlines()))


def _rows(summary: dict[str, Any], group: str = "") -> Iterator[tuple[str, str]]:
    """Yield name and text of every entry of a summary, those of a group after its name."""
    for key, value in summary.items():
        if key in _SAID:
            continue
        if isinstance(value, dict):
            yield from _rows(value, group if key in _PLAIN_GROUPS else f"{group}{key} ")
        else:
            name, unit = _ENTRIES.get(key, (key.replace("_", " "), ""))
            yield f"{group}{name}" + (f" [{unit}]" if unit else ""), text_of(value)


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
