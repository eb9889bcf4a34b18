"""``antenna-pin orbit``: a periodic solution, whether neighbours come to it, and how that changes."""

from __future__ import annotations

import math
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.base.capacity import check_count
from antenna_pin.base.interruption import Ended, acknowledge, ended_by
from antenna_pin.cli._branch import (
    AmplitudeOption,
    ArcOption,
    MostOrbitsOption,
    OverOption,
    ValuesOption,
    ends_of,
    facts_of,
    print_branch,
    rows_of_branch,
)
from antenna_pin.cli._common import CaseOption, SetOption, Width, WidthOption, load, not_interrupted
from antenna_pin.cli._export import CsvOption, JsonOption, csv_target, exported, plain
from antenna_pin.cli._progress import branch_bar
from antenna_pin.cli._quantities import positive_quantity
from antenna_pin.cli._saved import PlotOption, TableOption, save_both, targets_of
from antenna_pin.cli._saved_orbit import AtOption, begun_from, is_saved, saved_branch
from antenna_pin.cli._tables import power_above, print_rows
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.base.state import State
    from antenna_pin.nonlinear import Orbit, Point
    from antenna_pin.scenario import Scenario

__all__ = ["PeriodOption", "orbit", "period_of"]

PeriodOption = Annotated[
    str | None, typer.Option(metavar="TIME", help="Period; that of the drives if left out.")
]
RtolOption = Annotated[
    float | None,
    typer.Option(
        "--rtol",
        metavar="NUMBER",
        help="Tolerance of the runs, 1e-12 if left out; a coarser one, as 1e-9, where periods are long.",
    ),
]


def period_of(scenario: Scenario, period: str | None, command: str) -> float:
    """Return the period that an option gives [s], or that of the scenario's drives."""
    from antenna_pin.nonlinear import drive_period

    return drive_period(scenario) if period is None else positive_quantity(period, "s", "--period", command)


def orbit(
    context: typer.Context,
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO|FILE.nc", help="Scenario, or a saved orbit or branch.")
    ],
    case: CaseOption = None,
    at: AtOption = None,
    period: PeriodOption = None,
    multiple: Annotated[int, typer.Option(help="Periods in which the orbit closes.")] = 1,
    free_period: Annotated[
        bool, typer.Option("--free-period", help="Find the period too, of what nothing drives.")
    ] = False,
    transient: Annotated[int, typer.Option(help="Periods to run before Newton's method begins.")] = 20,
    rtol: RtolOption = None,
    over: OverOption = None,
    values: ValuesOption = None,
    quantity: AmplitudeOption = None,
    arc: ArcOption = 0.1,
    most: MostOrbitsOption = 100,
    settings: SetOption = None,
    out: TableOption = None,
    plot: PlotOption = None,
    width: WidthOption = Width.COLUMN,
    as_json: JsonOption = False,
    csv: CsvOption = None,
    progress: Annotated[bool, typer.Option(help="Show a progress bar along --over.")] = True,
) -> None:
    """Find a periodic solution near where a scenario has come to, and say whether neighbours come to it.

    Multipliers are by how much they grow in a period. The instant of its start must be one between impacts.
    With --over the orbit is followed over a key of the scenario, through folds; what is interrupted is saved
    as far as it is. A saved branch is told again; from a saved orbit, or one of a branch by --at, Newton's
    method begins at once, with the scenario of the file and the changes of --set.
    """
    table, targets = csv_target(csv), targets_of(out, plot)
    for name, number, least in (("--multiple", multiple, 1), ("--transient", transient, 0)):
        check_count("orbit", name, number, least)
    for name, given in (("--values", values), ("--quantity", ", ".join(quantity or ()))):
        if given and over is None:
            raise InvalidParameterError("orbit", name, "given with --over KEY", said=given)
    if free_period and over is not None:
        raise InvalidParameterError("orbit", "--free-period", "left out beside --over", said="both")
    from antenna_pin.plot import figure_multipliers

    if is_saved(scenario):
        if case is not None:
            raise InvalidParameterError("orbit", "--case", "left out: the file holds its scenario", case)
        again = saved_branch(scenario) if over is None and at is None else None
        if again is not None:
            _tell(again, width, targets, context, as_json, table)
            return
        known, begin = begun_from(scenario, at, settings)
    else:
        known, begin = load(scenario, case, settings), None
        if at is not None:
            raise InvalidParameterError("orbit", "--at", "given with a saved branch", at)
    if over is not None:
        ends = ends_of(values, over, known)
        branch, cut = _followed(
            known, over, ends, period, multiple, transient, rtol, arc, most, quantity or [], progress, begin
        )
        with not_interrupted():
            _tell(branch, width, targets, context, as_json, table)
        if cut:
            raise Ended if ended_by() != signal.SIGINT else KeyboardInterrupt
        return
    from antenna_pin.nonlinear import flow_of, orbit_table, periodic_orbit

    span = multiple * period_of(known, period, "orbit")
    flow, start = flow_of(known, rtol=rtol)
    if begin is not None:
        start = begin
    elif transient:
        start = flow.after(start, transient * span)
    found = periodic_orbit(flow, start, span, free_period=free_period)
    kept = orbit_table(found, flow.system, known)
    with not_interrupted():
        save_both(kept, lambda: figure_multipliers(kept, width=width.value), targets, context, as_json)
        if not exported(_facts(found), _rows(found), as_json, table):
            _print(found)


def _tell(
    branch: xr.Dataset,
    width: Width,
    targets: tuple[Path | None, Path | None],
    context: typer.Context,
    as_json: bool,
    table: Path | None,
) -> None:
    """Save, draw and print a branch, as far as that is asked for."""
    from antenna_pin.plot import figure_branch

    save_both(branch, lambda: figure_branch(branch, width=width.value), targets, context, as_json)
    if not exported(facts_of(branch), rows_of_branch(branch), as_json, table):
        print_branch(branch)


def _followed(
    known: Scenario,
    over: str,
    ends: tuple[float, float, str],
    period: str | None,
    multiple: int,
    transient: int,
    rtol: float | None,
    arc: float,
    most: int,
    quantities: list[str],
    progress: bool,
    begin: State | None,
) -> tuple[xr.Dataset, bool]:
    """Return the branch of the orbit that a scenario has come to, and whether it was cut short."""
    from antenna_pin.nonlinear import amplitudes, branch_table, check_steps, continued, family_of, flow_of

    first, last, unit = ends
    check_steps((first, last), arc, most)
    given = None if period is None else period_of(known, period, "orbit")
    family = family_of(known, over, period=given, multiple=multiple, rtol=rtol)
    flow, span = family(first)
    _, start = flow_of(known.with_overrides({over: first}))
    if quantities:  # what is wrong with a name is said before a long way is gone
        from antenna_pin.analysis import quantity

        glance = flow.glance(start, span)
        for name in quantities:
            quantity(glance, name)
    if begin is not None:
        start = begin
    elif transient:
        start = flow.after(start, transient * span)
    with branch_bar(over, (first, last), progress) as report:

        def tell(point: Point) -> None:
            if report is not None:
                report(point.value)

        branch = continued(family, start, (first, last), arc=arc, most=most, progress=tell)
    found, cut = {}, branch.interrupted
    try:
        found = amplitudes(branch, family, quantities)
    except KeyboardInterrupt:  # the orbits are the longer work
        acknowledge()
        cut = True
    return branch_table(branch, flow.system, over, unit, known, found), cut


def _facts(found: Orbit) -> dict[str, Any]:
    facts: dict[str, Any] = plain(
        {
            "period": found.period,
            "time": found.start.time,
            "q": found.start.q.tolist(),
            "v": found.start.v.tolist(),
            "residual": found.residual,
            "stable": found.stable,
            "doubt": found.doubt,
            "neutral": found.neutral,
            "multipliers": [[one.real, one.imag] for one in found.multipliers.tolist()],
            "exponents": found.exponents.tolist(),
            "onsets": found.onsets[0],
            "events": found.onsets[1],
        }
    )
    return facts


def _rows(found: Orbit) -> list[dict[str, Any]]:
    return [
        plain(
            {
                "real [-]": one.real,
                "imaginary [-]": one.imag,
                "size [-]": abs(one),
                "exponent [1/s]": float(exponent),
            }
        )
        for one, exponent in zip(found.multipliers.tolist(), found.exponents, strict=True)
    ]


def _print(found: Orbit) -> None:
    from antenna_pin.analysis import said_of_multiplier

    words = {True: "stable", False: "unstable", None: "neutral, as far as can be told"}[found.stable]
    happens = [
        f"{count} {what}{'s' if count > 1 else ''}"
        for count, what in zip(found.onsets, ("contact", "event"), strict=True)
        if count
    ]
    rest = f"; {' and '.join(happens)} in a period" if happens else ""
    if found.neutral:
        rest += "; what lasting contacts remember, and elements keep, stays as it began"
    typer.echo(f"orbit of {found.period:.9g} s, {words}{rest}")
    # Digits that are known: one multiplier does not say more than the doubt of all.
    digits = min(12, max(0, math.floor(-math.log10(max(found.doubt, 1e-12)))))
    rows = [
        [said_of_multiplier(one, 6, digits), f"{round(abs(one), digits):.6g}", f"{exponent:.4g}"]
        for one, exponent in zip(found.multipliers.tolist(), found.exponents, strict=True)
    ]
    title = f"Floquet multipliers, to {power_above(found.doubt)}"
    print_rows(title, ["multiplier", "size", "exponent [1/s]"], rows)
