"""``antenna-pin figures``: the figures of a paper, or the standard ones of a scenario, runs included."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.cli._common import (
    ENDED_EARLY,
    Geometry,
    ScenarioArgument,
    SetOption,
    Width,
    complain,
    figure_folder,
    figure_formats,
    load,
    not_interrupted,
)
from antenna_pin.cli._index import FigureIndex
from antenna_pin.cli._run_store import RunStore
from antenna_pin.errors import AntennaPinError

if TYPE_CHECKING:
    from antenna_pin.plot import PaperFigure


def figures(
    scenario: ScenarioArgument,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Folder for the figures; NAME-figures here if left out."),
    ] = None,
    runs: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Folder of results. Those of the same scenario are used again, others are made there."
            " OUT/runs if left out.",
        ),
    ] = None,
    cases: Annotated[
        list[str] | None,
        typer.Option(
            "--case",
            help="Case to draw the standard figures of, instead of a paper's. May be repeated.",
        ),
    ] = None,
    duration: Annotated[
        str | None, typer.Option(help="Simulated time, in seconds or with a unit ('20 ms').")
    ] = None,
    settings: SetOption = None,
    geometry: Annotated[
        Geometry | None, typer.Option(help="How gaps are found, for all joints with clearance.")
    ] = None,
    formats: Annotated[
        str, typer.Option("--format", metavar="LIST", help="Any of png, pdf, svg, separated by commas.")
    ] = "png,pdf",
    width: Annotated[Width, typer.Option(help="Width of the figures: 88 mm or 180 mm.")] = Width.PAGE,
    progress: Annotated[bool, typer.Option(help="Show a progress bar for each run.")] = True,
) -> None:
    """Draw all figures of the paper that a shipped scenario repeats, and run what they need.

    Files are named after the paper's figures, and index.md says what each shows there and here. A scenario
    that repeats no paper gets the standard figures of its cases.
    """
    suffixes = figure_formats(formats)
    numbered = () if cases else _paper(scenario)
    wanted = cases or list(dict.fromkeys(case for each in numbered for case in each.cases))
    # Everything is read and checked before the first run.
    loaded = {
        case: load(scenario, case, settings, geometry, duration) for case in wanted or _all_cases(scenario)
    }
    first = next(iter(loaded.values()))
    target = figure_folder(out or Path(f"{first.name}-figures"))

    from antenna_pin.plot import folder_for_figures

    folder_for_figures(target)
    store = RunStore(folder_for_figures(runs or target / "runs"), list(loaded.values()), progress)
    index = FigureIndex(
        target, first.title, first.source, _command(scenario, cases, duration, settings, geometry)
    )
    try:
        if numbered:
            _draw_paper(numbered, store, index, suffixes, width)
        else:
            _draw_standard(store, index, suffixes, width)
    finally:  # what is done counts, after Ctrl-C as well
        with not_interrupted():
            index.write(store)
            typer.echo(index.path)
    if store.early:
        raise typer.Exit(ENDED_EARLY)


def _paper(name: str) -> tuple[PaperFigure, ...]:
    """Return the figures of the paper that a shipped scenario repeats; none if it repeats none."""
    from antenna_pin.plot import PAPERS

    return PAPERS.get(name, ())


def _all_cases(name: str) -> list[str | None]:
    """Return all cases of a scenario; None stands for one that has no cases."""
    from antenna_pin.scenario import scenario_cases

    return [case.name for case in scenario_cases(name)] or [None]


def _command(
    scenario: str,
    cases: Sequence[str] | None,
    duration: str | None,
    settings: Sequence[str] | None,
    geometry: Geometry | None,
) -> str:
    """Return the command that makes the same figures, but for folders and formats."""
    words = ["antenna-pin", "figures", scenario]
    words += [word for case in cases or () for word in ("--case", case)]
    words += [] if duration is None else ["--duration", duration]
    words += [word for setting in settings or () for word in ("--set", setting)]
    words += [] if geometry is None else ["--geometry", geometry.value]
    return shlex.join(words)


def _draw_paper(
    numbered: Sequence[PaperFigure],
    store: RunStore,
    index: FigureIndex,
    suffixes: Sequence[str],
    width: Width,
) -> None:
    """Draw figure after figure, each as soon as the runs it takes are there."""
    from antenna_pin.plot import save_figure

    index.expected = [f"Figure {each.number}" for each in numbered]
    for each in numbered:
        runs = [store.run_of(case) for case in each.cases]
        title = f"Figure {each.number}"
        try:
            drawn = each.draw(runs, width=width.value)
            found = f"{_VERDICTS[each.judge(runs)]}{each.describe(runs)}"
        except AntennaPinError as error:
            complain(f"{title} is not drawn: {error}")
            index.add(title, (), each.shows, f"not drawn: {error}")
            continue
        with not_interrupted():
            files = save_figure(drawn, index.folder / each.name, suffixes)
        index.add(title, files, each.shows, found)
        for file in files:
            typer.echo(file)


_VERDICTS = {True: "**agrees**: ", False: "**differs**: ", None: ""}


def _draw_standard(store: RunStore, index: FigureIndex, suffixes: Sequence[str], width: Width) -> None:
    """Draw the standard figures of all cases."""
    from antenna_pin.plot import save_figures

    runs = [store.run_of(case) for case in store.cases]

    def left_out(name: str, reason: str) -> None:
        complain(f"{name} is not drawn: {reason}")
        index.add(name.replace("_", " "), (), "", f"not drawn: {reason}")

    labels = [str(run.data.attrs.get("case") or store.name) for run in runs]
    pairs = [(label, run.data) for label, run in zip(labels, runs, strict=True)]
    by_name: dict[str, list[Path]] = {}
    for file in save_figures(pairs, index.folder, suffixes, width=width.value, on_left_out=left_out):
        by_name.setdefault(file.stem, []).append(file)
        typer.echo(file)
    for name, files in by_name.items():
        index.add(name.replace("_", " "), files, "", "")
