"""``antenna-pin fit --identify`` and ``--next``: what a test can tell, and which test tells more."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from antenna_pin.base.readable import number, readable
from antenna_pin.cli._common import not_interrupted, say
from antenna_pin.cli._tables import print_rows
from antenna_pin.cli._usage import command_of

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from antenna_pin.fit import FitPlan, Problem
    from antenna_pin.sweep import Executor

__all__ = ["identify", "next_test"]

_SHOWN = 12  # experiments, so that an answer is seen at a glance

Tell = Callable[[int], None] | None


def _begun(
    plan: FitPlan, at: Path | None, executor: Executor, tell: Tell
) -> tuple[Problem, np.ndarray, float]:
    """Return a fit's problem, values to look at, and the variance of a weighted residual."""
    from antenna_pin.fit import Problem, open_fit
    from antenna_pin.fit.assessment import values_in
    from antenna_pin.fit.run_service import RunService

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
    return f"± {readable(value, unit or '1', 2)}" if math.isfinite(value) else "cannot be told"


def identify(
    plan: FitPlan,
    at: Path | None,
    target: Path | None,
    context: typer.Context,
    executor: Executor,
    tell: Tell,
    quiet: bool,
) -> None:
    """Say what a fit's records can tell of its parameters, before it is made."""
    from antenna_pin.fit.assessment import identifiability_table, tells

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
            print_rows("what the records can tell of it", head, rows)
            for text in (*problem.notes, *found.together):
                say(text)
            for name in found.poor:
                say(f"{name}: to no better than its own size")
            if found.hold:
                say(f"hold {', '.join(found.hold)}, and the others can be told")
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
    """Say which of some experiments tells most, added to a fit's records."""
    from antenna_pin.errors import UnknownNameError
    from antenna_pin.fit.assessment import experiments_table, sizes_of, slopes_at
    from antenna_pin.fit.confidence_bands import DOUBT
    from antenna_pin.fit.experiments import Trial, load_experiments
    from antenna_pin.fit.identifiability import design, planned
    from antenna_pin.fit.run_service import RunService

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
    for k in range(min(table.sizes["experiment"], _SHOWN)):
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
    lacks = table.sizes["experiment"] - _SHOWN
    if lacks > 0:
        say(f"... and {lacks} more; --out has all")
