"""``antenna-pin figures``: the figures of a paper, or the standard ones of a scenario, runs included."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated
from urllib.parse import quote

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
    stem,
)
from antenna_pin.cli._progress import progress_bar
from antenna_pin.errors import AntennaPinError, FileFormatError
from antenna_pin.files import replacing

if TYPE_CHECKING:
    from antenna_pin.plot import PaperFigure
    from antenna_pin.scenario import Scenario
    from antenna_pin.trajectory import Trajectory

# What of a scenario tells where it came from, not what it is.
_ORIGIN = {"name", "description", "overrides", "folder"}


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
    store = _Store(folder_for_figures(runs or target / "runs"), list(loaded.values()), progress)
    index = _Index(target, first.title, first.source, _command(scenario, cases, duration, settings, geometry))
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
    numbered: Sequence[PaperFigure], store: _Store, index: _Index, suffixes: Sequence[str], width: Width
) -> None:
    """Draw figure after figure, each as soon as the runs it takes are there."""
    from antenna_pin.plot import save_figure

    index.expected = [f"Figure {each.number}" for each in numbered]
    for each in numbered:
        runs = [store.run_of(case) for case in each.cases]
        title = f"Figure {each.number}"
        try:
            drawn = each.draw(runs, width=width.value)
            found = each.describe(runs)
        except AntennaPinError as error:
            complain(f"{title} is not drawn: {error}")
            index.add(title, (), each.shows, f"not drawn: {error}")
            continue
        with not_interrupted():
            files = save_figure(drawn, index.folder / each.name, suffixes)
        index.add(title, files, each.shows, found)
        for file in files:
            typer.echo(file)


def _draw_standard(store: _Store, index: _Index, suffixes: Sequence[str], width: Width) -> None:
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


class _Store:
    """The runs of some cases: those in a folder whose scenario is the same, the others made."""

    def __init__(self, folder: Path, scenarios: Sequence[Scenario], progress: bool) -> None:
        self.folder = folder
        self.scenarios = {scenario.case: scenario for scenario in scenarios}
        self.name = scenarios[0].name
        self.progress = progress
        self.early = False
        self.files: dict[str | None, Path] = {}
        self.runs: dict[str | None, Trajectory] = {}

    @property
    def cases(self) -> list[str | None]:
        return list(self.scenarios)

    def run_of(self, case: str | None) -> Trajectory:
        """Return the run of a case: at hand, from a file, or made now."""
        if case not in self.runs:
            found = self._found(self.scenarios[case])
            self.runs[case] = self._made(self.scenarios[case]) if found is None else found
        return self.runs[case]

    def _found(self, scenario: Scenario) -> Trajectory | None:
        """Return a completed run of the scenario, of this version of the file format, from the folder."""
        from antenna_pin.trajectory import FORMAT, Trajectory

        likely = self.folder / f"{stem(scenario)}.nc"
        others = sorted(path for path in self.folder.glob("*.nc") if path != likely)
        for path in [likely, *others]:
            try:
                run = Trajectory.load(path)
            except FileFormatError:  # not there, or something else
                continue
            current = run.data.attrs["format"] == FORMAT
            if current and run.completed and run.scenario and _same(run.scenario, scenario):
                complain(f"{stem(scenario)}: using {path}")
                self.files[scenario.case] = path
                return run
        return None

    def _made(self, scenario: Scenario) -> Trajectory:
        """Run a scenario and save the result; what Ctrl-C cuts short is saved, too, and ends the command."""
        from antenna_pin.simulation import simulate
        from antenna_pin.trajectory import Trajectory

        path = self._free(scenario)
        complain(f"{stem(scenario)}: running {scenario.duration:g} s")
        with progress_bar(stem(scenario), self.progress) as report:
            run = simulate(scenario, progress=report)
        with not_interrupted():
            run.save(path)
        self.files[scenario.case] = path
        if run.outcome.name == "INTERRUPTED":
            self.runs[scenario.case] = run  # for the index
            raise KeyboardInterrupt
        if not run.completed:
            self.early = True
            complain(f"{stem(scenario)}: {run.message} (the result up to there is in {path} and is drawn)")
        return Trajectory.load(path)  # as it is next time: what the file adds decides which figures there are

    def _free(self, scenario: Scenario) -> Path:
        """Return where a result may be written: not over a file of another scenario."""
        from antenna_pin.trajectory import Trajectory

        number = 1
        while True:
            path = self.folder / f"{stem(scenario)}{f'-{number}' if number > 1 else ''}.nc"
            if not path.exists():
                return path
            try:
                old = Trajectory.load(path).scenario
            except FileFormatError:
                old = None
            if old is not None and _same(old, scenario):  # cut short, or of an older format
                return path
            number += 1


def _same(one: Scenario, other: Scenario) -> bool:
    """Whether two scenarios are the same but for where they came from."""
    return one.model_dump(exclude=_ORIGIN) == other.model_dump(exclude=_ORIGIN)


@dataclass
class _Index:
    """The page that lists the figures.

    Attributes:
        folder: Where figures and index are.
        title: Of the scenario.
        source: Of the scenario.
        command: That makes the figures.
        expected: Titles of a paper's figures.
        entries: Title, files, what the paper shows, what is found here.
    """

    folder: Path
    title: str
    source: str
    command: str
    expected: list[str] = field(default_factory=list)
    entries: list[tuple[str, list[str], str, str]] = field(default_factory=list)

    @property
    def path(self) -> Path:
        return self.folder / "index.md"

    def add(self, title: str, files: Iterable[Path], shows: str, found: str) -> None:
        self.entries.append((title, [file.name for file in files], shows, found))

    def write(self, store: _Store) -> None:
        """Write the page, in Markdown."""
        numbered = bool(self.expected)
        text = [f"# {self.title or 'Figures'}", ""]
        text += [f"Source: {self.source}.", ""] if self.source else []
        text += ["Made by", "", f"    {self.command}", ""]
        text += ["| case | what it is | result | how it ended |", "|---|---|---|---|"]
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
            partial.write_text("\n".join(text) + "\n", encoding="utf-8")


def _cell(text: str) -> str:
    """Return text that fits into a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")
