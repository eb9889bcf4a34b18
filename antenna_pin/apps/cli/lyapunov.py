"""``antenna-pin lyapunov``: Lyapunov exponents and a verdict on chaos."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import load, not_interrupted
from antenna_pin.apps.cli._export import csv_target, exported, plain_dict, save_both, targets_of
from antenna_pin.apps.cli._options import argument, flag, option
from antenna_pin.apps.cli._progress import exponent_bar
from antenna_pin.apps.cli._tables import print_rows
from antenna_pin.apps.cli._usage import positive_quantity
from antenna_pin.apps.cli.orbit import PeriodOption, RtolOption, period_of
from antenna_pin.base.capacity import check_count

if TYPE_CHECKING:
    from antenna_pin.studies.nonlinear import Exponents


def lyapunov(
    context: typer.Context,
    scenario: Annotated[str, argument("Scenario.", "SCENARIO")],
    case: options.Case = None,
    period: PeriodOption = None,
    interval: Annotated[
        str | None, option("Time between renormalisations; the period if left out.", "TIME")
    ] = None,
    count: Annotated[int, option("Number of intervals.")] = 200,
    transient: Annotated[int, option("Intervals of the transient.")] = 20,
    spectrum: Annotated[
        bool, flag("--spectrum", "All exponents, by tangents, instead of the largest alone.")
    ] = False,
    seed: Annotated[int, option("Seed of the first perturbation.")] = 0,
    rtol: RtolOption = None,
    settings: options.Set = None,
    out: options.Dataset = None,
    plot: options.Plot = None,
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
    progress: options.Progress = True,
) -> None:
    """Compute Lyapunov exponents, as natural logarithms per second."""
    table, targets = csv_target(csv), targets_of(out, plot)
    from antenna_pin.show.plot import figure_exponents
    from antenna_pin.studies.nonlinear import exponents_table, flow_of, largest_exponent, lyapunov_spectrum

    check_count("lyapunov", "--count", count, 1)
    check_count("lyapunov", "--transient", transient, 0)
    known = load(scenario, case, settings)
    if interval is not None:
        span = positive_quantity(interval, "s", "--interval", "lyapunov")
    else:
        span = period_of(known, period, "lyapunov")
    flow, start = flow_of(known, rtol=rtol)
    with exponent_bar(known.title, count, progress) as report:
        how: dict[str, Any] = {"transient": transient * span, "progress": report}
        if spectrum:
            found = lyapunov_spectrum(flow, start, span, count, **how)
        else:
            found = largest_exponent(flow, start, span, count, seed=seed, **how)
    rows = [
        plain_dict({"exponent [1/s]": float(value), "error [1/s]": float(error)})
        for value, error in zip(found.values, found.errors, strict=True)
    ]
    kept = exponents_table(found, known)
    with not_interrupted():
        save_both(kept, lambda: figure_exponents(kept, width=width.value), targets, context, silent=as_json)
        if not exported(_facts(found), rows, as_json, table):
            _print(found, period is not None or interval is None)


def _facts(exponents: Exponents) -> dict[str, Any]:
    return plain_dict(
        {
            "verdict": exponents.verdict,
            "exponents": exponents.values.tolist(),
            "errors": exponents.errors.tolist(),
            "interval": exponents.interval,
            "intervals": len(exponents.growth),
            "running": exponents.running[:, 0].tolist(),
        }
    )


def _print(exponents: Exponents, periodic: bool) -> None:
    typer.echo(f"{exponents.verdict}, over {len(exponents.growth)} intervals of {exponents.interval:.6g} s")
    unit = "per period" if periodic else "per interval"
    rows = [
        [
            f"{value:.4g}",
            f"{error:.2g}" if math.isfinite(error) else "unknown",
            f"{value * exponents.interval:.4g}",
        ]
        for value, error in zip(exponents.values, exponents.errors, strict=True)
    ]
    print_rows("Lyapunov exponents", ["[1/s]", "standard error [1/s]", unit], rows)
