"""``antenna-pin list`` and ``run``: shipped scenarios, and their simulation."""

from __future__ import annotations

import contextlib
import json
import shlex
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import (
    ENDED_EARLY,
    SIGNALLED,
    UNBALANCED,
    complain,
    load,
    not_interrupted,
    refuse,
    save_elsewhere,
    say,
    say_notes,
    say_start,
    stem,
    writable_file,
)
from antenna_pin.apps.cli._export import csv_target, rows_of, say_json, write_csv
from antenna_pin.apps.cli._options import argument, flag, option
from antenna_pin.apps.cli._progress import progress_bar
from antenna_pin.apps.cli._tables import flat, say_answer
from antenna_pin.apps.cli._usage import positive_quantity
from antenna_pin.base.interruption import ended_by
from antenna_pin.base.readable import decimal_in
from antenna_pin.errors import AssumedWarning, LedgerOpenWarning

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario


def list_scenarios(
    scenario: Annotated[
        str | None,
        argument(
            "Shipped name, TOML file or folder to list the cases of; all shipped ones if left out.",
            "[SCENARIO]",
        ),
    ] = None,
) -> None:
    """List the shipped scenarios and their cases, or the cases of one scenario."""
    from antenna_pin.scenario import list_scenarios as shipped
    from antenna_pin.scenario import scenario_summary

    for name, title, cases in shipped() if scenario is None else [scenario_summary(scenario)]:
        typer.echo(f"{name}: {title}".rstrip(": "))
        widest = max((len(case) for case, _ in cases), default=0)
        for case, description in cases:
            typer.echo(f"  {case:<{widest}}  {description}".rstrip())


def run(
    scenario: Annotated[
        str | None,
        argument("Name of a shipped scenario, or path of a TOML file; left out with --resume.", "[SCENARIO]"),
    ] = None,
    case: options.Case = None,
    duration: options.Duration = None,
    out: Annotated[Path | None, option("Result file; NAME-CASE.nc here if left out.")] = None,
    settings: options.Set = None,
    geometry: options.Gaps = None,
    engine: Annotated[
        options.Engine | None, option("Engine of the run; compiled needs --geometry closed-form.")
    ] = None,
    accuracy: Annotated[
        float | None, option("Wanted relative error, such as 1e-3: chooses the method and its tolerance.")
    ] = None,
    lean: Annotated[bool, flag("--lean", "Keep numbers and contact episodes only, no series.")] = False,
    at: Annotated[str | None, option("Sample at these times too, ascending, such as '0.1, 250 ms'.")] = None,
    max_wall_time: Annotated[
        str | None,
        option(
            "Wall time after which the run stops; --resume continues it: integrator.max_wall_time.", "TIME"
        ),
    ] = None,
    checkpoint: Annotated[str, option("Wall time from one checkpoint to the next.", "TIME")] = "5 min",
    resume: Annotated[
        Path | None, option("Continue the run of this result from its last checkpoint.", "FILE")
    ] = None,
    progress: options.Progress = True,
    summary: Annotated[bool, option("Print a summary of the result.")] = True,
    quiet: options.Quiet = False,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Simulate a scenario and save the result."""
    target = csv_target(csv)
    changes = [*(settings or ()), *(["output.form=lean"] if lean else ())]
    if engine is not None:
        changes.append(f"integrator.engine={engine.value}")
    if accuracy is not None:
        changes.append(f"integrator.accuracy={accuracy!r}")
    if at is not None:
        changes.append(f"output.times=[{', '.join(_toml(time.strip()) for time in at.split(','))}]")
    if max_wall_time is not None:
        limit = positive_quantity(max_wall_time, "s", "--max-wall-time", "run")
        changes.append(f"integrator.max_wall_time={limit!r}")
    interval = positive_quantity(checkpoint, "s", "--checkpoint", "run")
    if resume is None:
        if scenario is None:
            refuse("run: must be given a SCENARIO, or --resume FILE; `antenna-pin list` has what ships")
        chosen, span = load(scenario, case, changes, geometry, duration), None
        path = writable_file(out or Path(f"{stem(chosen)}.nc"), ".nc")
        if _has_checkpoint(path):
            complain(f"note: a run to {path} was stopped; --resume {path} continues it, this run replaces it")
    else:
        given: dict[str, Any] = {"SCENARIO": scenario, "--case": case, "--out": out, "--geometry": geometry}
        given |= {"--set": settings, "--engine": engine, "--accuracy": accuracy, "--lean": lean, "--at": at}
        for name, value in given.items():
            if value:
                refuse(
                    f"run: {name} must be left out with --resume, which continues the run as it was started"
                )
        chosen, path = _resumed(resume)
        chosen = chosen.with_overrides(changes) if changes else chosen
        span = None if duration is None else positive_quantity(duration, "s", "--duration", "run")

    from antenna_pin.run.simulation import UnsavedError, simulate

    with contextlib.ExitStack() as stack:
        with progress_bar(stem(chosen), progress and not quiet) as report:
            more: dict[str, Any] = {"out": path, "checkpoint": interval, "resume": resume is not None}
            for category in (LedgerOpenWarning, AssumedWarning):  # said at the end
                warnings.simplefilter("ignore", category)
            try:
                trajectory = simulate(chosen, duration=span, progress=report, **more)
            except UnsavedError as error:
                save_elsewhere(error.trajectory, path, error)
            stack.enter_context(not_interrupted())
        found = trajectory.summary() if target is not None or as_json else {}
        if target is not None:
            write_csv(target, *rows_of([{"file": str(path), **flat(found)}]), silent=quiet or as_json)
        if as_json:
            say_json({"file": str(path), **found})
        quiet = quiet or as_json
        if summary and not quiet and target is None:
            say_answer(trajectory)
        if not quiet:
            next_one = f"; all numbers: antenna-pin info --all {shlex.quote(str(path))}"
            typer.echo(f"saved {path}{next_one if summary and target is None else ''}")
            for said in json.loads(trajectory.data.attrs.get("assumed", "[]")):
                say(f"note: {said}")
            if trajectory.outcome.name == "COMPLETED" and (passed := trajectory.message.partition("; ")[2]):
                say(f"note: {passed}")
            say_start(trajectory, chosen, "note: ")
            say_notes(trajectory, "note: ")
        outcome = trajectory.outcome.name
        if trajectory.completed:
            if outcome != "COMPLETED" and not quiet:
                say(trajectory.message)
            return
        if outcome == "LEDGER_OPEN":
            complain(f"{stem(chosen)}: {trajectory.message} (the result is in {path})", colour="red")
            raise typer.Exit(UNBALANCED)
        way_on = f"; continue with --resume {path}" if trajectory.outcome.may_go_on else ""
        complain(f"{stem(chosen)}: {trajectory.message} (the result up to there is in {path}{way_on})")
    raise typer.Exit(SIGNALLED + ended_by() if outcome == "INTERRUPTED" else ENDED_EARLY)


def _toml(text: str) -> str:
    """Return a number as it is written, anything else as a text in TOML."""
    number = decimal_in(text)
    return json.dumps(text) if number is None else repr(number)


def _has_checkpoint(path: Path) -> bool:
    """Return whether a result's path has a checkpoint."""
    return path.with_name(path.name + ".parts").joinpath("checkpoint").is_file()


def _resumed(file: Path) -> tuple[Scenario, Path]:
    """Return the scenario of a stopped run, and the path of its result."""
    from antenna_pin.run.simulation import Checkpoint

    path = file.with_suffix("") if file.suffix == ".parts" else file
    scenario = Checkpoint.load(path).scenario
    if scenario is None:
        refuse(
            f"{path}: the run simulated a system built in Python; resume it in "
            f"Python, with simulate(resume=True)"
        )
    return scenario, writable_file(path, ".nc")
