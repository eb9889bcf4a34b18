"""``antenna-pin info`` and ``plot``: what results and scenarios are, and the standard figures of results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.cli._answers import say_answer
from antenna_pin.cli._common import (
    CaseOption,
    FilesArgument,
    SetOption,
    Width,
    complain,
    figure_folder,
    figure_formats,
    label_of,
    labels_of,
    load_result,
    refuse,
    say,
    say_limits,
    say_spin,
)
from antenna_pin.cli._export import CsvOption, csv_target, rows_of, say_json, write_csv
from antenna_pin.cli._plot_tables import draw_tables, kinds_of
from antenna_pin.cli._tables import flat, print_summaries, print_summary
from antenna_pin.cli._zeros import Zeros

if TYPE_CHECKING:
    from antenna_pin.trajectory import Trajectory


def info(
    files: Annotated[
        list[str], typer.Argument(metavar="FILES...", help="Result files of runs, or one scenario.")
    ],
    case: CaseOption = None,
    settings: SetOption = None,
    everything: Annotated[
        bool, typer.Option("--all", help="All numbers, by kind of thing; of several results side by side.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object per file, each on one line.")
    ] = False,
    csv: CsvOption = None,
) -> None:
    """Say what results are: how they ended, what happened, what is kept; or what a scenario is.

    Of a scenario with closed loops: whether they can be closed, and how many freedoms are left. A CSV file
    has a row for each result.
    """
    from antenna_pin.cli._scenario_info import names_scenario, say_scenario

    target = csv_target(csv)

    if any(map(names_scenario, files)):
        if len(files) > 1:
            refuse(f"{' '.join(files)}: give result files (NAME.nc), any number, or one scenario alone")
        if csv is not None:
            refuse(f"--csv: is for results, and {files[0]} is a scenario; --json has what is said of it")
        say_scenario(files[0], case, settings, as_json)
        return
    for option, given in (("--case", case), ("--set", settings)):
        if given:
            refuse(f"{option}: is for scenarios only, and {files[0]} is a result; leave it out")
    runs = [(path, load_result(path, scenario=False)) for path in map(Path, files)]
    if everything or as_json or target is not None:
        facts = [_facts(trajectory) for _, trajectory in runs]
    if target is not None:
        flats = [{"file": str(path), **flat(each)} for (path, _), each in zip(runs, facts, strict=True)]
        write_csv(target, *rows_of(flats), silent=as_json)
    if as_json:
        for (path, _), each in zip(runs, facts, strict=True):
            say_json({"file": str(path), **each})
    if as_json or target is not None:
        return
    labels = labels_of([path for path, _ in runs])
    if everything:
        zeros = Zeros(trajectory for _, trajectory in runs)
        if len(runs) == 1:
            print_summary(labels[0], facts[0], zeros.text)
        else:
            print_summaries(list(zip(labels, facts, strict=True)), zeros.text)
        zeros.say()
    for label, (_, trajectory) in zip(labels, runs, strict=True):
        if not everything:
            say_answer(trajectory, label if len(runs) > 1 else "")
        _say_notes(label, trajectory, everything)


def _say_notes(label: str, trajectory: Trajectory, everything: bool) -> None:
    """Say what a run's reader has to know besides its numbers."""
    if trajectory.outcome.name != "COMPLETED":
        say(f"{label}: {trajectory.message}")
    elif trajectory.advice:
        say(f"{label}: the run was {trajectory.advice}")
    for line in trajectory.assumed:
        say(f"{label}: {line}")
    say_spin(trajectory, f"{label}: ")
    say_limits(trajectory, f"{label}: ")
    if counts := trajectory.constraints:
        from antenna_pin.analysis import said_of_constraints, said_of_singular

        if everything:
            say(f"{label}: {said_of_constraints(counts)}")
        if singular := said_of_singular(counts):
            say(f"{label}: {singular}")


def _facts(trajectory: Trajectory) -> dict[str, Any]:
    """Return the summary of a run with the share of time that each joint spent in each contact scenario.

    A lean result does not hold the shares.
    """
    from antenna_pin.analysis import scenario_shares
    from antenna_pin.trajectory import contacts_of, is_lean

    if is_lean(trajectory.data):
        return trajectory.summary()
    shares = scenario_shares(trajectory)
    many = {
        joint
        for joint in map(str, shares["clearance_joint"].values)
        if len(contacts_of(trajectory.data, joint)) > 1
        and not contacts_of(trajectory.data, joint, flanges=True)
    }
    found = {
        str(joint): {
            _pair(str(radial), str(axial), joint in many): float(share)
            for radial, row in zip(shares["radial"].values, table, strict=True)
            for axial, share in zip(shares["axial"].values, row, strict=True)
            if share > 0.0
        }
        for joint, table in zip(shares["clearance_joint"].values, shares.values, strict=True)
    }
    return trajectory.summary() | ({"share of time": found} if found else {})


def _pair(radial: str, axial: str, many: bool) -> str:
    """Return a pair of scenarios in words; of a slider's many contacts only whether there is any is known."""
    if many:
        return "no contact" if radial == "none" else "contact"
    return f"radial {radial}, axial {axial}".replace("_", " ")


def plot(
    files: FilesArgument,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the figures; made if missing.")],
    formats: Annotated[
        str, typer.Option("--format", metavar="LIST", help="Any of png, pdf, svg, separated by commas.")
    ] = "png",
    joint: Annotated[
        str | None, typer.Option(help="The one joint to draw; every joint with clearance if left out.")
    ] = None,
    names: Annotated[
        list[str] | None,
        typer.Option(
            "--figure", metavar="NAME", help="Figure to draw, instead of the standard ones. May be repeated."
        ),
    ] = None,
    width: Annotated[Width, typer.Option(help="Width of the figures: 88 mm or 180 mm.")] = Width.PAGE,
) -> None:
    """Draw the figures that results allow: runs, or fits, orbits, diagrams and what else is saved."""
    suffixes = figure_formats(formats)
    figure_folder(out)
    tables = kinds_of(files)
    if tables:
        others = [str(path) for path in files if path not in tables]
        if others:
            refuse(f"plot: {others[0]} must be drawn apart from datasets that are no runs")
        if joint is not None:
            refuse(f"plot: --joint must be left out: {files[0]} is no run")
        draw_tables(tables, out, suffixes, names, width.value)
        return
    runs = [(path, load_result(path)) for path in files]
    from antenna_pin.plot import check_one_mechanism, processes_to_draw, save_figures

    check_one_mechanism([(str(path), run) for path, run in runs])
    labels = [label_of(trajectory, path) for path, trajectory in runs]
    if len(set(labels)) < len(labels):  # the same case twice: the files tell them apart
        labels = [path.stem for path, _ in runs]

    pairs = [(label, trajectory) for label, (_, trajectory) in zip(labels, runs, strict=True)]

    def left_out(name: str, reason: str) -> None:
        complain(f"{name} is not drawn: {reason}")

    files = save_figures(
        pairs,
        out,
        suffixes,
        joint=joint,
        names=names,
        width=width.value,
        on_left_out=left_out,
        processes=processes_to_draw(),
    )
    for figure in files:
        typer.echo(figure)
