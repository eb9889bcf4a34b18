"""Origin of the numbers: versions, scenarios in full, commands that repeat them."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path

from antenna_pin.base.arguments import takes
from antenna_pin.scenario import Scenario, list_scenarios, scenario_toml
from antenna_pin.show.report._page import Details, PageTable, Section, Statement, statement, words
from antenna_pin.show.report._runs import ReportedRun, labels_of
from antenna_pin.trajectory import library_versions


def provenance(
    runs: Sequence[ReportedRun], command: str | None, findings: Sequence[Path | None] = ()
) -> Section:
    """Return versions, dates, scenarios and commands.

    ``findings``: files reported beside the runs, which have their own commands.
    """
    statements = []

    def state(label: str, texts: Iterable[tuple[ReportedRun, object]], code: bool = False) -> None:
        if known := tuple(((run.label,), str(text)) for run, text in texts if text):
            statements.append(Statement(label=label, texts=known, code=code))

    state("repeat the runs", ((run, run_command(run) or _NO_COMMAND) for run in runs), True)
    again = command or report_command(runs, findings)
    if again is not None:
        statements.append(statement("repeat this report", again, True))
    state("runs finished (UTC)", ((run, run.data.attrs.get("finished")) for run in runs))
    state("files", ((run, run.file) for run in runs), True)
    state("assumed, or left out", ((run, "; ".join(run.run.assumed)) for run in runs))
    sources = dict.fromkeys(run.run.scenario.source for run in runs if run.run.scenario is not None)
    if any(sources):
        statements.append(statement("source of the numbers", "; ".join(filter(None, sources))))
    return Section(
        key="provenance",
        title="Provenance",
        folded=True,
        statements=tuple(statements),
        items=(Details(title="Versions", tables=(_versions(runs),)), *_sources(runs)),
    )


_NO_COMMAND = "a system built in Python: run its script again"


def _versions(runs: Sequence[ReportedRun]) -> PageTable:
    found = [json.loads(run.data.attrs.get("versions", "{}")) for run in runs]
    here = library_versions()
    names = dict.fromkeys(name for one in (*found, here) for name in one)
    return PageTable(
        columns=("", *labels_of(runs), "this report"),
        rows=tuple(words(name, (str(one.get(name, "")) for one in (*found, here))) for name in names),
        caption="Versions of the software for the runs and this report",
        key="versions",
    )


def _sources(runs: Sequence[ReportedRun]) -> list[Details]:
    """Return the scenarios and URDFs in full, each text once."""
    scenarios: dict[str, list[str]] = {}
    urdfs: dict[str, list[str]] = {}
    for run in runs:
        if run.run.scenario is not None:
            scenarios.setdefault(scenario_toml(run.run.scenario), []).append(run.label)
            urdfs.setdefault(run.run.scenario.urdf_text, []).append(run.label)
        elif "urdf" in run.data.attrs:
            urdfs.setdefault(str(run.data.attrs["urdf"]), []).append(run.label)
    return [
        Details(title=f"{what} of {', '.join(labels)}", text=text, key=what)
        for what, texts in (("Scenario", scenarios), ("URDF", urdfs))
        for text, labels in texts.items()
    ]


@takes()
def run_command(run: ReportedRun) -> str | None:
    """Return the command that repeats a run; None for a system built in Python."""
    scenario = run.run.scenario
    if scenario is None:
        return None
    parts = ["antenna-pin", "run", _place(scenario)]
    if scenario.case is not None:
        parts += ["--case", scenario.case]
    changes = list(scenario.overrides)
    if run.run.completed and abs(run.end - scenario.duration) > 1e-9 * scenario.duration:
        changes.append(f"duration={run.end!r}")
    for change in changes:
        parts += ["--set", change]
    command = shlex.join([*parts, "--out", str(run.file or Path(f"{_file_name(run.label)}.nc"))])
    if "start" in run.data.attrs:
        return f"{command}  # but from q and v given in Python; they are the first sample"
    return command


def _place(scenario: Scenario) -> str:
    """Return the name of a shipped scenario, or the path of another."""
    folder = scenario.folder
    shipped = {one.name for one in list_scenarios()}
    if (
        scenario.name in shipped
        and folder.name == scenario.name
        and folder.parent.name in ("models", "_models")
    ):
        return scenario.name
    return str(folder if folder.name == scenario.name else folder / f"{scenario.name}.toml")


def _file_name(label: str) -> str:
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in label)


@takes()
def report_command(runs: Sequence[ReportedRun], datasets: Sequence[Path | None] = ()) -> str | None:
    """Return a command that writes a report of files; None for objects.

    Args:
        runs: Runs that are reported.
        datasets: Files of reported datasets.
    """
    files = [*(run.file for run in runs), *datasets]
    if any(file is None for file in files):
        return None
    return shlex.join(["antenna-pin", "report", *map(str, files), "--out", "report.html"])
