"""``antenna-pin analyse``: what a run shows, in tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from antenna_pin.base.numerals import bare
from antenna_pin.cli._common import label_of, load_result, say
from antenna_pin.cli._elastic import print_elastic
from antenna_pin.cli._export import CsvOption, JsonOption, csv_target, exported, parts_of
from antenna_pin.cli._loops import print_loops
from antenna_pin.cli._tables import print_rows, text_of
from antenna_pin.cli._zeros import Zeros

ResultArgument = Annotated[Path, typer.Argument(metavar="FILE", help="Result file of a run.")]
JointOption = Annotated[str | None, typer.Option(help="Joint with clearance; all of them if left out.")]

# Rows of the table of contacts: where each entry comes from, and what it is called.
_ROWS = (
    ("loads", "episodes", "impacts"),
    ("blows", "blows", "blows of the joint, ends that meet at once being one"),
    ("impacts", "floored", "impacts below the law's floor of speed"),
    ("impacts", "touching", "still touching at the end"),
    ("impacts", "median_approach_speed", "median approach speed [m/s]"),
    ("impacts", "largest_approach_speed", "largest approach speed [m/s]"),
    ("impacts", "median_restitution", "median restitution delivered [-]"),
    ("impacts", "median_duration", "median duration [s]"),
    ("loads", "contact_share", "share of the time in contact [-]"),
    ("loads", "peak_force", "peak force [N]"),
    ("loads", "mean_force", "mean force [N]"),
    ("loads", "mean_force_in_contact", "mean force in contact [N]"),
    ("loads", "rms_force", "rms force [N]"),
    ("loads", "impulse", "impulse [N s]"),
    ("loads", "dissipated", "energy lost [J]"),
)
_PEAKS = 3
# What a CSV file has, one row for each number.
_PARTS = (
    "deviation",
    "impacts",
    "loads",
    "settling",
    "closures",
    "couplings",
    "drives",
    "elastic",
    "frequencies",
)


def analyse(
    file: ResultArgument,
    ideal: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Result of the ideal joint, to compare with.")
    ] = None,
    longest_gap: Annotated[
        str, typer.Option(help="Longest time apart that counts as lasting contact ('1 ms').")
    ] = "1 ms",
    as_json: JsonOption = False,
    csv: CsvOption = None,
) -> None:
    """Say what a run shows: deviation, impacts, loads, settling, closed loops, dominant frequencies."""
    from antenna_pin.base.units import quantity

    target = csv_target(csv)
    gap = quantity(bare(longest_gap), "s", "--longest-gap")
    run = load_result(file, scenario=False)
    reference = None if ideal is None else load_result(ideal, scenario=False)

    from antenna_pin.analysis import numbers_of

    told = {"file": str(file)} | numbers_of(run, reference, longest_gap=gap)
    notes = told.pop("notes")
    found: dict[str, Any] = told
    zeros = Zeros([run] if reference is None else [run, reference])
    if exported({**found, "notes": notes}, parts_of(found, _PARTS), as_json, target):
        return
    _print(label_of(run, file), found, zeros)
    zeros.say()
    for note in notes:
        say(note)


def _print(label: str, found: dict[str, Any], zeros: Zeros) -> None:
    """Print the tables of an analysis."""
    if "deviation" in found:
        rows = [
            [
                f"{one['of']} [{one['units']}]",
                *(text_of(one[key]) for key in ("maximum", "time_of_maximum", "rms", "end")),
                one["growth"],
            ]
            for one in found["deviation"]
            if not one["round_off"]
        ]
        head = ("", "maximum", "at [s]", "rms", "at the end", "growth")
        if rows:
            print_rows(f"{label}: deviation from the ideal run", head, rows)
        if still := [one["of"] for one in found["deviation"] if one["round_off"]]:
            typer.echo(f"deviation that is zero to round-off: {', '.join(still)}")
    if "loads" in found:
        _print_contacts(label, found, zeros)
        _print_settling(label, found["settling"])
    if "constraints" in found:
        print_loops(label, found, zeros)
    if "elastic" in found:
        print_elastic(label, found["elastic"])
    rows = [
        [
            f"{one['of']} [{one['units']}]",
            *(f"{f:.4g} ({a:.3g})" for f, a in zip(one["frequency"], one["amplitude"], strict=True)),
            *["-"] * (_PEAKS - len(one["frequency"])),
        ]
        for one in found["frequencies"]
        if one["frequency"]
    ]
    quiet = [one["of"] for one in found["frequencies"] if one["round_off"]]
    if len(found["frequencies"]) > len(quiet) and not rows:
        typer.echo("no frequency stands out")
    if rows:
        title = f"{label}: dominant frequencies [Hz] (amplitude), resolution"
        title += f" {found['frequencies'][0]['resolution']:.3g} Hz"
        print_rows(title, ("", "first", "second", "third"), rows)
    if quiet:
        typer.echo(f"nothing above round-off: {', '.join(quiet)}")


def _print_contacts(label: str, found: dict[str, Any], zeros: Zeros) -> None:
    """Print impacts and loads, one column per joint and contact."""
    columns = [str(one["of"]) for one in found["loads"]]
    entries = {kind: {one["of"]: one for one in found[kind]} for kind in ("impacts", "blows", "loads")}
    rows = [
        [text, *(zeros.text(entries[kind].get(column, {}).get(name), text) for column in columns)]
        for kind, name, text in _ROWS
    ]
    for percent in found["loads"][0]["force_percentile"]:
        forces = [entries["loads"][column]["force_percentile"][percent] for column in columns]
        name = f"force not exceeded for {percent} % of the time [N]"
        rows.append([name, *(zeros.text(force, name) for force in forces)])
    print_rows(f"{label}: impacts and load", ("", *columns), rows)


def _print_settling(label: str, found: Sequence[dict[str, Any]]) -> None:
    rows = [
        [
            f"apart for no more than {1e3 * found[0]['longest_gap']:g} ms from [s]",
            *(text_of(one["time"]) if one["time"] is not None else "never" for one in found),
        ]
    ]
    for name, text in (
        ("share_before", "share of the time in contact before [-]"),
        ("share_after", "share of the time in contact after [-]"),
        ("decay_rate", "decay of approach speeds [1/s]"),
        ("decay_r2", "R2 of an exponential decay [-]"),
    ):
        rows.append([text, *(text_of(one[name]) for one in found)])
        if name == "decay_rate":
            rows[-1][1:] = ["no decay" if one["decays"] is False else text_of(one[name]) for one in found]
    print_rows(f"{label}: settling into lasting contact", ("", *(one["joint"] for one in found)), rows)
    for one in found:
        if one["time"] is None:
            typer.echo(f"{one['joint']} does not settle: {one['note']}")
        elif one["driven"]:
            typer.echo(f"{one['joint']} is driven: it may part again after the run, as its load turns")
