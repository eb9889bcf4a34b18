"""``antenna-pin fit``: numbers of a scenario from measured records."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.base.readable import number
from antenna_pin.cli._common import DOUBTFUL, not_interrupted, refuse, say, writable_file
from antenna_pin.cli._fit_tests import identify as identify_before
from antenna_pin.cli._fit_tests import next_test
from antenna_pin.cli._progress import fit_bar
from antenna_pin.cli._usage import command_of

if TYPE_CHECKING:
    from antenna_pin.fit import Fit

__all__ = ["fit"]

_SHOWN = 8  # parameters, so that an answer is seen at a glance


def fit(
    context: typer.Context,
    file: Annotated[
        str, typer.Argument(metavar="FIT", help="Fit file, NAME.fit.toml, or name of a shipped fit.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Result, NAME.nc; that of the fit file here if left out."),
    ] = None,
    write_scenario: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Scenario with the values found, NAME.toml, of the first record."),
    ] = None,
    record: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Of which record that scenario is, if not of the first."),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Change one entry of the fit, such as loss=huber or 'parameters.play.start=0.1 mm'. May be"
            " repeated.",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", help="Processes that make runs; this one alone if left out or 0."),
    ] = None,
    identify: Annotated[
        bool,
        typer.Option("--identify", help="Fit nothing: say what the records can tell of the parameters."),
    ] = False,
    experiments: Annotated[
        Path | None,
        typer.Option(
            "--next", metavar="FILE", help="Fit nothing: say which experiment of a file would tell most."
        ),
    ] = None,
    at: Annotated[
        Path | None,
        typer.Option(metavar="FIT.nc", help="With these: a saved fit whose values to take, not the starts."),
    ] = None,
    profile: Annotated[
        bool, typer.Option("--profile", help="Make the profile of each parameter: many fits of the others.")
    ] = False,
    draws: Annotated[
        int, typer.Option(metavar="N", help="Runs at drawn values, for bands that no straight line makes.")
    ] = 0,
    seed: Annotated[int, typer.Option(metavar="N", help="Of the draws.")] = 0,
    report: Annotated[
        bool, typer.Option("--report", help="Print lmfit's report, with correlations.")
    ] = False,
    progress: Annotated[bool, typer.Option(help="Show how many runs are made.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
) -> None:
    """Find numbers of a scenario, such as play, stiffness, friction, for which its runs are as measured.

    Records, scenario and parameters are checked before anything is run. What was interrupted or killed goes
    on with the same command.
    """
    from antenna_pin.fit import load_fit, run_fit
    from antenna_pin.fit.assessment import certain
    from antenna_pin.sweep import Cluster, Here
    from antenna_pin.trajectory import save_table

    plan = load_fit(file, settings or ())
    tests = _asked_before(identify, experiments, at, [profile, draws, write_scenario, report])
    if draws < 0 or draws == 1:
        refuse(f"fit: --draws must be 2 or more, or left out, got {draws}")
    if seed < 0:
        refuse(f"fit: --seed must be zero or more, got {seed}")
    if tests and out is not None:
        writable_file(out, ".nc")
    if plan.surface is not None and (tests or profile or draws):
        refuse(
            "fit: --identify, --next, --profile and --draws must be left out beside a surface: runs scatter"
        )
    target = writable_file(Path(f"{plan.name}.nc") if out is None else out, ".nc")
    scenario = None if write_scenario is None else writable_file(write_scenario, ".toml")
    for path in filter(None, (target, scenario)):
        plan.check_output(path)
    if record is not None and scenario is None:
        refuse("fit: --record must be given with --write-scenario, whose record it names")
    if record is not None and record not in plan.records:
        refuse(f"fit: --record must be one of {', '.join(plan.records)}, got {record}")
    if workers is not None and workers < 0:
        refuse(f"fit: --workers must be zero or more, got {workers}")
    executor = Cluster(workers) if workers else Here()
    try:
        with fit_bar(plan.name, progress and not quiet) as tell:
            if experiments is not None:
                next_test(plan, experiments, at, out, context, executor, tell, quiet)
                return
            if identify:
                identify_before(plan, at, out, context, executor, tell, quiet)
                return
            notes: list[str] = []

            def judged(found: Fit) -> None:
                table, said = certain(found, profile=profile, draws=draws, seed=seed)
                table.attrs["command"] = command_of(context)
                save_table(table, target)
                notes.extend(said)

            found = run_fit(plan, target, executor=executor, progress=tell, then=judged)
    finally:
        executor.close()
    with not_interrupted():
        if scenario is not None:
            found.write_scenario(scenario, record)
        if not quiet:
            _say_found(found, notes, report, target, scenario)
    if not found.trusted:
        raise typer.Exit(DOUBTFUL)


def _say_found(found: Fit, notes: list[str], report: bool, target: Path, scenario: Path | None) -> None:
    """Print the answer: what speaks against it first."""
    if report:
        say_each([*found.verdict, *found.report().splitlines()])
    else:
        lines = found.lines()
        shown = len(found.verdict) + _SHOWN
        say_each(lines[:shown])
        if len(lines) > shown:
            say(f"... and {len(lines) - shown} more; --report has all, and their correlations")
    bands = found.bands
    say(
        f"chi2 {number(bands.chi2)} for {bands.freedoms} degrees of freedom; {found.runs} runs; "
        f"{found.message}"
    )
    say_each([*(one.words() for one in found.validation), *found.notes, *notes])
    say(f"saved {target}")
    if scenario is not None:
        say(f"saved {scenario}")


def _asked_before(
    identify: bool, experiments: Path | None, at: Path | None, of_a_fit: Sequence[object]
) -> bool:
    """Return whether nothing is to be fitted, or say which options do not go together."""
    if identify and experiments is not None:
        refuse("fit: --identify must be left out beside --next, which says it for each experiment")
    before = identify or experiments is not None
    if at is not None and not before:
        refuse("fit: --at must be given with --identify or --next, whose values it is")
    if before and any(of_a_fit):
        refuse("fit: --profile, --draws, --write-scenario and --report are of a fit; leave them out here")
    return before


def say_each(lines: list[str]) -> None:
    """Print lines."""
    for line in lines:
        say(line)
