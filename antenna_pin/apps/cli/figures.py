"""``antenna-pin figures``: figures of a paper, or the standard ones of a scenario."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any
from urllib.parse import quote

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import (
    ENDED_EARLY,
    complain,
    figure_folder,
    figure_formats,
    load,
    not_interrupted,
    refuse,
)
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._run_store import AttractorStore, CaseRuns
from antenna_pin.base.files import replacing
from antenna_pin.base.rules import AtLeastTwo, NumberRule
from antenna_pin.errors import AntennaPinError

if TYPE_CHECKING:
    from antenna_pin.show.plot import AttractorFigure, DiagramFigure, PaperFigure

    AnyFigure = PaperFigure | AttractorFigure | DiagramFigure


@dataclass
class FigureIndex:
    """Page that lists the figures."""

    folder: Path  # of figures and page
    title: str  # of the scenario
    source: str  # of the scenario
    command: str  # that makes the figures
    expected: list[str] = field(default_factory=list)  # titles of a paper's figures
    # Title, files, content of the paper's figure, result here.
    entries: list[tuple[str, list[str], str, str]] = field(default_factory=list)

    @property
    def path(self) -> Path:
        """The page's file."""
        return self.folder / "index.md"

    def add(self, title: str, files: Iterable[Path], shows: str, result: str) -> None:
        """Add a figure in its files, with the paper's content and the result here."""
        self.entries.append((title, [file.name for file in files], shows, result))

    def write(self, store: CaseRuns) -> None:
        """Write the page, in Markdown."""
        numbered = bool(self.expected)
        text = [f"# {self.title or 'Figures'}", ""]
        text += [f"Source: {self.source}.", ""] if self.source else []
        text += ["Made by", "", f"    {self.command}", ""]
        if store.cases:
            text += ["| case | description | result | outcome |", "|---|---|---|---|"]
        for case, run in store.runs.items():
            what = store.scenarios[case].description or store.scenarios[case].title
            file = Path(os.path.relpath(store.files[case], self.folder)).as_posix()
            link = f"[{_cell(file)}]({quote(file)})"
            text.append(f"| {_cell(case or store.name)} | {_cell(what)} | {link} | {_cell(run.message)} |")
        waiting = [case or store.name for case in store.cases if case not in store.runs]
        text += ["", f"Not run: {', '.join(waiting)}."] if waiting else []
        missing = [title for title in self.expected if title not in [entry[0] for entry in self.entries]]
        text += ["", f"Not drawn: {', '.join(missing)}."] if missing else []
        if not self.entries:
            pass
        elif numbered:
            text += ["", "| figure | the paper shows | here |", "|---|---|---|"]
        else:
            text += ["", "| figure | files |", "|---|---|"]
        for title, files, shows, found in self.entries:
            links = ", ".join(f"[{Path(file).suffix[1:]}]({file})" for file in files)
            cells = [f"{title} {links}", shows, found] if numbered else [title, links or found]
            text.append(f"| {' | '.join(_cell(cell) for cell in cells)} |")
        for title, files, _, _ in self.entries:
            picture = next((file for file in files if not file.endswith(".pdf")), None)
            text += ["", f"![{title}]({picture})"] if picture else []
        with replacing(self.path) as partial:
            partial.write_text("\n".join(text) + "\n", encoding="utf-8", errors="backslashreplace")


def _cell(text: str) -> str:
    """Return text that fits into a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def figures(
    scenario: options.Scenario,
    out: Annotated[
        Path | None, option("Folder for the figures; NAME-figures here if left out.", "DIR")
    ] = None,
    runs: Annotated[
        Path | None,
        option(
            "Folder of results. Results of the same scenario are reused; others "
            "are simulated and saved there."
            " OUT/runs if left out.",
            "DIR",
        ),
    ] = None,
    cases: Annotated[
        list[str] | None,
        option(
            "Case to draw the standard figures of, instead of a paper's. May be repeated.", None, "--case"
        ),
    ] = None,
    numbers: Annotated[
        list[int] | None, option("Number of a figure in the paper; all if left out.", "N", "--figure")
    ] = None,
    count: Annotated[AtLeastTwo, option("Values of a parameter in figures over one.", "N")] = 20,
    points: Annotated[
        int, option("Points of each Poincare map, behind its transient.", "N"), NumberRule("32 or more")
    ] = 400,
    duration: options.Duration = None,
    settings: options.Set = None,
    geometry: options.Gaps = None,
    formats: options.FigureFormats = "png,pdf",
    width: options.FigureWidth = options.Width.PAGE,
    progress: Annotated[bool, option("Show a progress bar for each run.")] = True,
) -> None:
    """Draw the figures of the paper that a shipped scenario repeats, runs included.

    Files are named after the paper's figures; index.md compares both. A scenario that repeats no paper gets
    the standard figures of its cases. Settled motions run as long as they need, whatever the duration,
    compiled and with gaps in closed form.
    """
    from antenna_pin.scenario import scenario_cases

    suffixes = figure_formats(formats)
    of_runs, of_attractors = _paper(scenario, cases, numbers)
    numbered = bool(of_runs or of_attractors)
    wanted: list[str | None] = [*(cases or dict.fromkeys(case for each in of_runs for case in each.cases))]
    if not wanted and not numbered:
        wanted = [one.name for one in scenario_cases(scenario)] or [None]
    # Everything is read and checked before the first run.
    loaded = {case: load(scenario, case, settings, geometry, duration) for case in wanted}
    first = next(iter(loaded.values()), None) or load(scenario, None, settings, geometry)

    target = figure_folder(out or Path(f"{first.name}-figures"))

    from antenna_pin.show.plot import folder_for_figures

    name = str(first.name)
    attractors = AttractorStore(runs or target / "runs", settings or (), points, count, progress)
    attractors.check(of_attractors)
    folder_for_figures(target)
    store = CaseRuns(folder_for_figures(runs or target / "runs"), name, list(loaded.values()), progress)
    command = _command(scenario, cases, duration, settings, geometry)
    command += "".join(f" --figure {number}" for number in numbers or ())
    if of_attractors:
        command += f" --count {count} --points {points}"
    index = FigureIndex(target, first.title, first.source, command)
    index.expected = [f"Figure {each.number}" for each in (*of_runs, *of_attractors)]
    try:
        if numbered:
            for each in of_runs:  # as soon as its runs are there
                _draw(each, [store.run_of(case) for case in each.cases], index, suffixes, width)
            _draw_settled(of_attractors, attractors, index, suffixes, width)
        else:
            _draw_standard(store, index, suffixes, width)
    finally:  # what is done counts, after Ctrl-C as well
        with not_interrupted():
            index.write(store)
            typer.echo(index.path)
    if store.early:
        raise typer.Exit(ENDED_EARLY)


def _paper(
    name: str, cases: Sequence[str] | None, numbers: Sequence[int] | None
) -> tuple[list[PaperFigure], list[AttractorFigure | DiagramFigure]]:
    """Return the figures of the paper that a shipped scenario repeats, if any.

    Those of runs stand before those of settled motions.
    """
    from antenna_pin.show.plot import ATTRACTORS, PAPERS

    every = PAPERS.get(name, ()), ATTRACTORS.get(name, ())
    if cases:
        if numbers:
            refuse("figures: --figure must be left out with --case, which draws the standard figures")
        return [], []
    known = [each.number for group in every for each in group]
    for number in numbers or ():
        if number not in known:
            have = f"one of {', '.join(map(str, known))}" if known else "left out: it repeats no paper"
            refuse(f"{name}: --figure must be {have}, got {number}")
    chosen = set(numbers or known)
    return (
        [each for each in every[0] if each.number in chosen],
        [each for each in every[1] if each.number in chosen],
    )


def _command(
    scenario: str,
    cases: Sequence[str] | None,
    duration: str | None,
    settings: Sequence[str] | None,
    geometry: options.Geometry | None,
) -> str:
    """Return the command that makes the same figures, but for folders and formats."""
    words = ["antenna-pin", "figures", scenario]
    words += [word for case in cases or () for word in ("--case", case)]
    words += [] if duration is None else ["--duration", duration]
    words += [word for setting in settings or () for word in ("--set", setting)]
    words += [] if geometry is None else ["--geometry", geometry.value]
    return shlex.join(words)


def _draw_settled(
    numbered: Sequence[AttractorFigure | DiagramFigure],
    store: AttractorStore,
    index: FigureIndex,
    suffixes: Sequence[str],
    width: options.Width,
) -> None:
    """Draw figures of settled motions, each as soon as what it takes is there."""
    from antenna_pin.show.plot import AttractorFigure

    portraits = [each for each in numbered if isinstance(each, AttractorFigure)]
    for each in numbered:
        taken: Any
        try:
            if isinstance(each, AttractorFigure):
                taken = store.attractors(each, portraits)
            else:
                taken = store.diagram(each.diagram)
        except AntennaPinError as error:
            _left_out(each, index, error)
            continue
        _draw(each, taken, index, suffixes, width)


def _draw(
    each: AnyFigure, content: Any, index: FigureIndex, suffixes: Sequence[str], width: options.Width
) -> None:
    """Draw a figure and enter it into the index."""
    from antenna_pin.show.plot import save_figure

    try:
        drawn = each.draw(content, width=width.value)
        found = f"{_VERDICTS[each.judge(content)]}{each.describe(content)}"
    except AntennaPinError as error:
        _left_out(each, index, error)
        return
    with not_interrupted():
        files = save_figure(drawn, index.folder / each.name, suffixes)
    index.add(f"Figure {each.number}", files, each.shows, found)
    for file in files:
        typer.echo(file)


def _left_out(each: AnyFigure, index: FigureIndex, error: AntennaPinError) -> None:
    complain(f"Figure {each.number} is not drawn: {error}")
    index.add(f"Figure {each.number}", (), each.shows, f"not drawn: {error}")


_VERDICTS = {True: "**agrees**: ", False: "**differs**: ", None: ""}


def _draw_standard(
    store: CaseRuns, index: FigureIndex, suffixes: Sequence[str], width: options.Width
) -> None:
    """Draw the standard figures of all cases."""
    from antenna_pin.show.plot import processes_to_draw, save_figures

    runs = [store.run_of(case) for case in store.cases]

    def left_out(name: str, reason: str) -> None:
        complain(f"{name} is not drawn: {reason}")
        index.add(name.replace("_", " "), (), "", f"not drawn: {reason}")

    pairs = [(str(run.data.attrs.get("case") or store.name), run.data) for run in runs]
    by_name: dict[str, list[Path]] = {}
    drawn = save_figures(
        pairs,
        index.folder,
        suffixes,
        width=width.value,
        on_left_out=left_out,
        processes=processes_to_draw(),
    )
    for file in drawn:
        by_name.setdefault(file.stem, []).append(file)
        typer.echo(file)
    for name, files in by_name.items():
        index.add(name.replace("_", " "), files, "", "")
