"""``antenna-pin fit``: numbers of a scenario from measured records."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import DOUBTFUL, executor_of, not_interrupted, refuse, say, writable_file
from antenna_pin.apps.cli._options import argument, flag, option
from antenna_pin.apps.cli._progress import fit_bar
from antenna_pin.apps.cli._tables import print_rows
from antenna_pin.apps.cli._usage import command_of
from antenna_pin.base.readable import number, readable
from antenna_pin.base.rules import NotNegativeInt, NumberRule

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from antenna_pin.studies.fit import Fit, FitPlan, Problem
    from antenna_pin.studies.sweep import Executor

_TESTS_SHOWN = 12  # experiments, so that an answer is seen at a glance

Tell = Callable[[int], None] | None


def _begun(
    plan: FitPlan, at: Path | None, executor: Executor, tell: Tell
) -> tuple[Problem, np.ndarray, float]:
    """Return a fit's problem, its values, and the variance of a weighted residual."""
    from antenna_pin.studies.fit import Problem, open_fit
    from antenna_pin.studies.fit.assessment import values_in
    from antenna_pin.studies.fit.run_service import RunService

    known = None if at is None else open_fit(at)
    problem = Problem(plan, RunService(executor, progress=tell))
    if known is None:
        return problem, problem.first, 1.0
    values, factor = values_in(known, problem, str(at))
    return problem, values, factor


def _saved(table: xr.Dataset, target: Path | None, context: typer.Context) -> None:
    from antenna_pin.trajectory import save_table

    table.attrs["command"] = command_of(context)
    if target is not None:
        save_table(table, target)
        say(f"saved {target}")


def _error(value: float, unit: str) -> str:
    return f"± {readable(value, unit or '1', 2)}" if math.isfinite(value) else "not identifiable"


def identify_before(
    plan: FitPlan,
    at: Path | None,
    target: Path | None,
    context: typer.Context,
    executor: Executor,
    tell: Tell,
    quiet: bool,
) -> None:
    """Print how well a fit's records determine its parameters."""
    from antenna_pin.studies.fit.assessment import identifiability_table, tells

    problem, values, factor = _begun(plan, at, executor, tell)
    found = tells(problem, values, factor)
    unknowns = problem.unknowns
    table = identifiability_table(
        found, unknowns.units, unknowns.titles, plan.scenario_of(next(iter(plan.records)))
    )
    with not_interrupted():
        if not quiet:
            rows = []
            for k, (name, unit) in enumerate(zip(found.names, unknowns.units, strict=True)):
                known = found.quantile * float(found.alone[k])
                wider = float(found.inflation[k])
                rows.append(
                    [
                        name,
                        readable(float(found.values[k]), unit or "1"),
                        _error(float(found.half[k]), unit),
                        _error(known, unit),
                        number(wider, 2) if math.isfinite(wider) else "–",
                    ]
                )
            head = ["", "value", "to expect (95 %)", "others known", "times wider"]
            print_rows("identifiability from the records", head, rows)
            for text in (*problem.notes, *found.together):
                say(text)
            for name in found.poor:
                say(f"{name}: to no better than its own size")
            if found.hold:
                say(f"hold {', '.join(found.hold)}, and the others become identifiable")
        _saved(table, target, context)


def next_test(
    plan: FitPlan,
    file: Path,
    at: Path | None,
    target: Path | None,
    context: typer.Context,
    executor: Executor,
    tell: Tell,
    quiet: bool,
) -> None:
    """Print which of some experiments would determine a fit's parameters best."""
    from antenna_pin.errors import UnknownNameError
    from antenna_pin.studies.fit.assessment import experiments_table, sizes_of, slopes_at
    from antenna_pin.studies.fit.confidence_bands import DOUBT
    from antenna_pin.studies.fit.experiments import Trial, load_experiments
    from antenna_pin.studies.fit.identifiability import design, planned
    from antenna_pin.studies.fit.run_service import RunService

    asked = load_experiments(file)
    if asked.wanted is not None and asked.wanted not in plan.parameters:
        raise UnknownNameError(f"{file}: wanted", "parameter", asked.wanted, plan.parameters)
    for name, one in asked.experiments.items():
        if one.like is not None and one.like not in plan.records:
            raise UnknownNameError(f"{file}: experiments.{name}.like", "record", one.like, plan.records)
    problem, values, factor = _begun(plan, at, executor, tell)
    trials = {  # all are checked before the first is run
        name: Trial(plan, name, one, values, lambda: RunService(executor, progress=tell))
        for name, one in asked.experiments.items()
    }
    known = slopes_at(problem, values) / math.sqrt(factor)
    made = {name: trial.slopes() / math.sqrt(factor) for name, trial in trials.items()}
    sizes = sizes_of(problem, values)
    found = design(
        made,
        problem.names,
        sizes,
        known=known,
        criterion=asked.criterion,
        wanted=asked.wanted,
        doubt=DOUBT,
    )
    how = None
    if asked.total and asked.criterion != "E":
        how = planned(
            made,
            problem.names,
            sizes,
            asked.total,
            known=known,
            criterion=asked.criterion,
            wanted=asked.wanted,
        )
    unknowns = problem.unknowns
    words = {name: one.words for name, one in asked.experiments.items()}
    scenario = plan.scenario_of(next(iter(plan.records)))
    table = experiments_table(found, how, values.tolist(), unknowns.units, unknowns.titles, words, scenario)
    with not_interrupted():
        if not quiet:
            _print(table)
        _saved(table, target, context)


def _print(table: xr.Dataset) -> None:
    names = [str(one) for one in table["parameter"].values]
    units = [str(one) for one in table["units"].values]
    criterion, wanted = str(table.attrs["criterion"]), str(table.attrs["wanted"])
    plan = "count" in table
    rows = [["before", *map(_error, table["before"].values.tolist(), units), "", *([""] * plan)]]
    for k in range(min(table.sizes["experiment"], _TESTS_SHOWN)):
        one = table.isel(experiment=k)
        rows.append(
            [
                str(one["experiment"].item()),
                *map(_error, one["half"].values.tolist(), units),
                number(float(one[criterion]), 3),
                *([str(int(one["count"]))] if plan else []),
            ]
        )
    of = f" of {wanted}" if criterion == "c" else ""
    often = [f"of {int(table.attrs['total'])} more"] if plan else []
    head = ["", *names, f"{criterion}{of}", *often]
    print_rows("intervals to expect after each experiment (95 %), the best first", head, rows)
    lacks = table.sizes["experiment"] - _TESTS_SHOWN
    if lacks > 0:
        say(f"... and {lacks} more; --out has all")


_SHOWN = 8  # parameters, so that an answer is seen at a glance


def fit(
    context: typer.Context,
    file: Annotated[str, argument("Fit file, NAME.fit.toml, or name of a shipped fit.", "FIT")],
    out: Annotated[
        Path | None, option("Result, NAME.nc; that of the fit file here if left out.", "FILE")
    ] = None,
    write_scenario: Annotated[
        Path | None, option("Scenario with the values found, NAME.toml, of the first record.", "FILE")
    ] = None,
    record: Annotated[str | None, option("Record of that scenario, if not the first.", "NAME")] = None,
    settings: Annotated[
        list[str] | None, options.settings_of("the fit", "loss=huber or 'parameters.play.start=0.1 mm'")
    ] = None,
    workers: Annotated[NotNegativeInt, option("Processes that make runs; 0 for this one alone.", "N")] = 0,
    identify: Annotated[
        bool, flag("--identify", "Fit nothing: print how well the records determine the parameters.")
    ] = False,
    experiments: Annotated[
        Path | None,
        option("Fit nothing: print which experiment of a file would determine most.", "FILE", "--next"),
    ] = None,
    at: Annotated[
        Path | None, option("With these: a saved fit for the values, instead of the starts.", "FIT.nc")
    ] = None,
    profile: Annotated[
        bool, flag("--profile", "Make the profile of each parameter: many fits of the others.")
    ] = False,
    draws: Annotated[
        int | None, option("Runs at drawn values, for nonlinear bands.", "N"), NumberRule("2 or more")
    ] = None,
    seed: Annotated[NotNegativeInt, option("Seed of the draws.", "N")] = 0,
    report: Annotated[bool, flag("--report", "Print lmfit's report, with correlations.")] = False,
    progress: Annotated[bool, option("Show the number of runs.")] = True,
    quiet: options.Quiet = False,
) -> None:
    """Fit numbers of a scenario, such as play, stiffness, friction, to measured records.

    Records, scenario and parameters are checked before the first run. The same command continues an
    interrupted or killed one.
    """
    from antenna_pin.studies.fit import load_fit, run_fit
    from antenna_pin.studies.fit.assessment import certain
    from antenna_pin.trajectory import save_table

    plan = load_fit(file, settings or ())
    tests = _asked_before(identify, experiments, at, [profile, draws, write_scenario, report])
    if tests and out is not None:
        writable_file(out, ".nc")
    if plan.surface is not None and (tests or profile or draws):
        refuse(
            "fit: --identify, --next, --profile and --draws must be left out with a surface, because its "
            "runs scatter"
        )
    target = writable_file(Path(f"{plan.name}.nc") if out is None else out, ".nc")
    scenario = None if write_scenario is None else writable_file(write_scenario, ".toml")
    for path in filter(None, (target, scenario)):
        plan.check_output(path)
    if record is not None and scenario is None:
        refuse("fit: --record must be given with --write-scenario, whose record it names")
    if record is not None and record not in plan.records:
        refuse(f"fit: --record must be one of {', '.join(plan.records)}, got {record}")
    executor = executor_of(workers)
    try:
        with fit_bar(plan.name, progress and not quiet) as tell:
            if experiments is not None:
                next_test(plan, experiments, at, out, context, executor, tell, quiet)
                return
            if identify:
                identify_before(plan, at, out, context, executor, tell, quiet)
                return
            notes: list[str] = []

            def judged(result: Fit) -> None:
                table, said = certain(result, profile=profile, draws=draws or 0, seed=seed)
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


def _say_found(result: Fit, notes: list[str], report: bool, target: Path, scenario: Path | None) -> None:
    """Print the answer: what speaks against it first."""
    if report:
        lines = [*result.verdict, *result.report().splitlines()]
    else:
        lines = result.lines()
        shown = len(result.verdict) + _SHOWN
        if (more := len(lines) - shown) > 0:
            lines[shown:] = [f"... and {more} more; --report has all, and their correlations"]
    bands = result.bands
    freedoms = f"for {bands.freedoms} degrees of freedom"
    lines.append(f"chi2 {number(bands.chi2)} {freedoms}; {result.runs} runs; {result.message}")
    lines += [*(one.words() for one in result.validation), *result.notes, *notes]
    for line in (*lines, *(f"saved {path}" for path in (target, scenario) if path is not None)):
        say(line)


def _asked_before(
    identify: bool, experiments: Path | None, at: Path | None, of_a_fit: Sequence[object]
) -> bool:
    """Return whether nothing is to be fitted; refuse options that exclude each other."""
    if identify and experiments is not None:
        refuse("fit: --identify must be left out with --next, which includes it for each experiment")
    before = identify or experiments is not None
    if at is not None and not before:
        refuse("fit: --at must be given with --identify or --next; it sets their parameter values")
    if before and any(of_a_fit):
        refuse("fit: --profile, --draws, --write-scenario and --report are of a fit; leave them out here")
    return before
