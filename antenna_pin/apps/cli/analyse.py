"""``antenna-pin analyse`` and ``impacts``: analyses of a run in tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import complain, label_of, load_result, refuse, say
from antenna_pin.apps.cli._export import csv_target, exported, parts_of, say_json, write_csv
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._tables import Zeros, print_rows, print_table, text_of
from antenna_pin.base.readable import bare
from antenna_pin.base.rules import NumberRule

JointOption = Annotated[str | None, option("Joint with clearance; all of them if left out.")]

_PEAKS = 3
# Parts in a CSV file, which has one row for each number.
_PARTS = (
    *("deviation", "impacts", "loads", "settling", "closures"),
    *("couplings", "drives", "elastic", "frequencies"),
)


def analyse(
    file: options.Result,
    ideal: Annotated[Path | None, option("Result with the ideal joint, as reference.", "FILE")] = None,
    longest_gap: Annotated[
        str, option("Longest time apart that counts as lasting contact ('1 ms').")
    ] = "1 ms",
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Analyse a run: deviation, impacts, loads, settling, closed loops, frequencies."""
    from antenna_pin.base.units import quantity

    target = csv_target(csv)
    gap = quantity(bare(longest_gap), "s", "--longest-gap")
    run = load_result(file, scenario=False)
    reference = None if ideal is None else load_result(ideal, scenario=False)

    from antenna_pin.analysis import numbers_of

    found: dict[str, Any] = {"file": str(file)} | numbers_of(run, reference, longest_gap=gap)
    notes = found.pop("notes")
    zeros = Zeros([run] if reference is None else [run, reference])
    if exported({**found, "notes": notes}, parts_of(found, _PARTS), as_json, target):
        return
    _print(label_of(run, file), found, zeros)
    zeros.say()
    for note in notes:
        say(note)


def _print(label: str, facts: dict[str, Any], zeros: Zeros) -> None:
    """Print the tables of an analysis."""
    if "deviation" in facts:
        keys = ("maximum", "time_of_maximum", "rms", "end")
        rows = [
            [f"{one['of']} [{one['units']}]", *(text_of(one[key]) for key in keys), one["growth"]]
            for one in facts["deviation"]
            if not one["round_off"]
        ]
        head = ("", "maximum", "at [s]", "rms", "at the end", "growth")
        if rows:
            print_rows(f"{label}: deviation from the ideal run", head, rows)
        if still := [one["of"] for one in facts["deviation"] if one["round_off"]]:
            typer.echo(f"deviation that is zero to round-off: {', '.join(still)}")
    if "loads" in facts:
        _print_contacts(label, facts, zeros)
        _print_settling(label, facts["settling"])
    if "constraints" in facts:
        _print_loops(label, facts, zeros)
    if "elastic" in facts:
        print_table(f"{label}: deflections of flexible links", "elastic motion", facts["elastic"], zeros)
    rows = [
        [
            f"{one['of']} [{one['units']}]",
            *(f"{f:.4g} ({a:.3g})" for f, a in zip(one["frequency"], one["amplitude"], strict=True)),
            *["-"] * (_PEAKS - len(one["frequency"])),
        ]
        for one in facts["frequencies"]
        if one["frequency"]
    ]
    quiet = [one["of"] for one in facts["frequencies"] if one["round_off"]]
    if len(facts["frequencies"]) > len(quiet) and not rows:
        typer.echo("no frequency stands out")
    if rows:
        title = f"{label}: dominant frequencies [Hz] (amplitude), resolution"
        title += f" {facts['frequencies'][0]['resolution']:.3g} Hz"
        print_rows(title, ("", "first", "second", "third"), rows)
    if quiet:
        typer.echo(f"nothing above round-off: {', '.join(quiet)}")


def _print_contacts(label: str, facts: dict[str, Any], zeros: Zeros) -> None:
    """Print impacts and loads, one column per joint and contact."""
    from antenna_pin.trajectory.quantities import TABLES

    columns = [str(one["of"]) for one in facts["loads"]]
    entries = {kind: {one["of"]: one for one in facts[kind]} for kind in ("impacts", "blows", "loads")}
    loads = dict(TABLES["loads"])
    others = [one for name, one in TABLES["impact statistics"].items() if name not in {*loads, "impacts"}]
    order = [("loads", loads.pop("episodes"))]
    order += [("blows", one) for one in TABLES["blow statistics"].values()]
    order += [("impacts", one) for one in others]
    order += [("loads", one) for one in sorted(loads.values(), key=lambda one: one.form != "share")]
    rows = [
        [of.heading(), *(zeros.text(entries[kind].get(one, {}).get(of.name), of) for one in columns)]
        for kind, of in order
    ]
    for percent in facts["loads"][0]["force_percentile"]:
        forces = [entries["loads"][column]["force_percentile"][percent] for column in columns]
        name = f"force not exceeded for {percent} % of the time [N]"
        rows.append([name, *(zeros.text(force, loads["peak_force"]) for force in forces)])
    print_rows(f"{label}: impacts and load", ("", *columns), rows)


def _print_loops(label: str, facts: Mapping[str, Any], zeros: Zeros) -> None:
    """Print loads of closures, couplings and drives, and counts of their equations."""
    from antenna_pin.analysis import said_of_constraints, said_of_singular

    drives = [
        one | {"name": f"{'motion' if one['motion'] else 'drive'} {one['of']}"} for one in facts["drives"]
    ]
    for title, name, rows in (
        ("forces of closures", "closure loads", facts["closures"]),
        ("torques of couplings, on followers", "coupling loads", facts["couplings"]),
        ("what drives exert", "drive loads", drives),
    ):
        if rows:
            print_table(f"{label}: {title}", name, rows, zeros)
    for text in (said_of_constraints(facts["constraints"]), said_of_singular(facts["constraints"])):
        if text:
            typer.echo(text)
    typer.echo()


def _print_settling(label: str, joints: Sequence[dict[str, Any]]) -> None:
    from antenna_pin.trajectory.quantities import TABLES

    rows = [
        [
            f"apart for no more than {1e3 * joints[0]['longest_gap']:g} ms from [s]",
            *(text_of(one["time"]) if one["time"] is not None else "never" for one in joints),
        ]
    ]
    for name in ("share_before", "share_after", "decay_rate", "decay_r2"):
        rows.append([TABLES["settling"][name].heading(), *(text_of(one[name]) for one in joints)])
        if name == "decay_rate":
            rows[-1][1:] = ["no decay" if one["decays"] is False else text_of(one[name]) for one in joints]
    print_rows(f"{label}: settling into lasting contact", ("", *(one["joint"] for one in joints)), rows)
    for one in joints:
        if one["time"] is None:
            typer.echo(f"{one['joint']} does not settle: {one['note']}")
        elif one["driven"]:
            typer.echo(f"{one['joint']} is driven: it may part again after the run, as its load turns")


_FLAGS = ("ended", "floored")


def impacts(
    file: options.Result,
    joint: JointOption = None,
    strongest: Annotated[
        int | None, option("List only the N impacts of largest force.", "N"), NumberRule("1 or more")
    ] = None,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """List the impacts of a run, or export them.

    An impact belongs to one contact. Overlapping impacts of the same surfaces, as at both ends of a bore,
    are one blow of the joint and have its number.
    """
    target = csv_target(csv)
    run = load_result(file, scenario=False)
    if not run.data.sizes.get("clearance_joint", 0):
        refuse(f"{file}: the run has no joint with clearance and so no impacts; take a case that has one")

    import numpy as np

    from antenna_pin.analysis import impacts as table_of
    from antenna_pin.trajectory import blow_counts, surfaces
    from antenna_pin.trajectory.quantities import TABLES

    table = table_of(run, joint)
    if strongest is not None:
        order = np.argsort(-table["peak_force"].values, kind="stable")[:strongest]
        table = table.isel(impact=np.sort(order))
    known = {name: one for name, one in TABLES["impacts"].items() if name not in ("blow", *_FLAGS)}
    columns, flags = ([table[name].values for name in names] for names in (known, _FLAGS))
    head = ("contact", "blow", *(one.heading() for one in known.values()), *_FLAGS)
    names = table["contact"].values, table["blow"].values
    if as_json:
        each = zip(*names, *columns, *flags, strict=True)
        keys = ("contact", "blow", *known, *_FLAGS)
        found = [dict(zip(keys, values, strict=True)) for values in each]
        say_json({"file": str(file), "impacts": found})
    if target is None and not as_json:
        numbers = ([text_of(float(x)) for x in row] for row in zip(*columns, strict=True))
        marks = (["yes" if x else "no" for x in row] for row in zip(*flags, strict=True))
        rows = [
            [str(contact), str(blow), *row, *flagged]
            for contact, blow, row, flagged in zip(*names, numbers, marks, strict=True)
        ]
        if not rows:
            complain(f"{file}: no impacts")
            return
        narrow = [name.replace(" [", "\n[") for name in head]
        print_rows(f"{label_of(run, file)}: impacts", narrow, rows)
        for surface, count in blow_counts(run.data).items() if strongest is None else ():
            mine = surfaces(run.data)[run.data["episode_contact"].values] == surface
            if count and joint in (None, surface.rpartition(".")[0]):
                say(f"blows of {surface}: {count}, of {int(mine.sum())} contacts")
    if target is not None:
        write_csv(target, head, zip(*names, *columns, *flags, strict=True), silent=as_json)
