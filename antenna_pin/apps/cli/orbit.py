"""``antenna-pin orbit``: periodic solutions, their stability, their branches."""

from __future__ import annotations

import math
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import load, not_interrupted, refuse, say
from antenna_pin.apps.cli._export import csv_target, exported, plain_dict, save_both, targets_of
from antenna_pin.apps.cli._options import argument, flag, option, several
from antenna_pin.apps.cli._progress import branch_bar
from antenna_pin.apps.cli._tables import power_above, print_rows
from antenna_pin.apps.cli._usage import positive_quantity
from antenna_pin.base.capacity import check_count
from antenna_pin.base.interruption import Ended, acknowledge, ended_by
from antenna_pin.base.readable import bare
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.base.state import State
    from antenna_pin.scenario import Scenario
    from antenna_pin.studies.nonlinear import Orbit, Point

OverOption = Annotated[str | None, option("Follow the orbit over a key of the scenario, as in --set.", "KEY")]
ValuesOption = Annotated[
    str | None, option("Range of --over, as '1 N*m:3 N*m'; given with it.", "FIRST:LAST")
]
AmplitudeOption = Annotated[
    list[str] | None, several("Quantity whose amplitude is stored along --over.", "NAME", "--quantity", "-q")
]
ArcOption = Annotated[
    float, option("First step along --over, in error scales and of the parameter's whole range.")
]
MostOrbitsOption = Annotated[int, option("Orbits along --over at most.", "N", "--most")]


def ends_of(text: str | None, over: str, known: Scenario) -> tuple[float, float, str]:
    """Return the ends of a key's range in SI units, and their unit."""
    from antenna_pin.base.units import any_quantity

    rule = "given with --over as FIRST:LAST, such as '1 N*m:3 N*m'"
    parts = [] if text is None else [bare(part.strip()) for part in text.split(":")]
    found = [any_quantity(part) for part in parts]
    if len(found) != 2 or None in found:
        raise InvalidParameterError("orbit", "--values", rule, said="nothing" if text is None else text)
    (first, one), (last, other) = (end for end in found if end is not None)
    if one and other and one != other:
        raise InvalidParameterError("orbit", "--values", "of one unit from first to last", text)
    for part in parts:
        known.with_overrides({over: part})  # says what is wrong with key or unit
    return first, last, one or other


def facts_of(branch: xr.Dataset) -> dict[str, Any]:
    """Return a branch as plain data."""
    return plain_dict(
        {
            "parameter": branch.attrs["parameter"],
            "message": branch.attrs["message"],
            "orbits": rows_of_branch(branch),
            "bifurcations": [
                {"kind": str(kind), "value": float(at), "doubt": float(doubt), "after": int(after)}
                for kind, at, doubt, after in zip(
                    *(branch[name].values for name in ("kind", "at", "at_doubt", "after")), strict=True
                )
            ],
        }
    )


def rows_of_branch(branch: xr.Dataset) -> list[dict[str, Any]]:
    """Return a row for each orbit of a branch."""
    import numpy as np

    parts = (np.nan_to_num(branch[f"multiplier_{part}"].values) for part in ("real", "imaginary"))
    real, imaginary = (part if part.shape[1] else np.zeros((len(part), 1)) for part in parts)
    unit = branch["value"].attrs["units"]
    rows = []
    for k in range(branch.sizes["point"]):
        row = {
            f"{branch.attrs['parameter']} [{unit or 'SI'}]": float(branch["value"].values[k]),
            "stability": str(branch["stability"].values[k]),
            "period [s]": float(branch["period"].values[k]),
            "largest multiplier, real [-]": float(real[k, 0]),
            "largest multiplier, imaginary [-]": float(imaginary[k, 0]),
            "largest multiplier, size [-]": float(np.hypot(real[k, 0], imaginary[k, 0])),
            "doubt [-]": float(branch["doubt"].values[k]),
        }
        for q, name in enumerate(branch["quantity"].values if "quantity" in branch else ()):
            row[f"amplitude of {name} [{branch['amplitude_unit'].values[q]}]"] = float(
                branch["amplitude"].values[q, k]
            )
        rows.append(plain_dict(row))
    return rows


def print_branch(branch: xr.Dataset) -> None:
    """Print the stability and the bifurcations of a branch."""
    from antenna_pin.analysis import said_of_multiplier, stability_spans, unexplained_changes
    from antenna_pin.base.readable import printed_unit

    unit = printed_unit(str(branch["value"].attrs["units"]))
    head = f"{branch.attrs['parameter']} [{unit}]" if unit else str(branch.attrs["parameter"])
    say(f"{branch.sizes['point']} orbits: {branch.attrs['message']}")
    rows = [
        [
            one.stability,
            f"{one.first:.6g}",
            f"{one.last:.6g}",
            str(one.orbits),
            said_of_multiplier(one.largest[1]),
        ]
        for one in stability_spans(branch)
    ]
    print_rows(f"Orbits over {head}", ["", "from", "to", "orbits", "largest multiplier"], rows)
    for before, behind in unexplained_changes(branch):
        say(f"between {before:.6g} and {behind:.6g} a multiplier passes 1; another branch may cross there")
    if not branch.sizes["bifurcation"]:
        say("no fold, branch point, flip, torus or graze between them")
        return
    parts = [branch[name].values for name in ("kind", "at", "at_doubt")]
    rows = [[str(kind), f"{at:.9g}", f"{doubt:.2g}"] for kind, at, doubt in zip(*parts, strict=True)]
    print_rows("What happens to them", ["", head, "known to"], rows)


AtOption = Annotated[
    int | None, option("Orbit of a saved branch to begin with; the first is 1.", "N", "--at")
]


def saved_branch(name: str) -> xr.Dataset | None:
    """Return the branch of a file; None if it holds an orbit.

    Raises:
        FileFormatError: It is not there, or of something else.
    """
    from antenna_pin.studies.nonlinear import open_branch
    from antenna_pin.trajectory import FORMATS, format_of

    if Path(name).is_file() and format_of(name) == FORMATS["orbit"]:
        return None
    return open_branch(name)


def begun_from(name: str, at: int | None, settings: list[str] | None) -> tuple[Scenario, State]:
    """Return the scenario and the start of a saved orbit, with the command line's changes.

    Raises:
        AntennaPinError: The file is not there, is of something else, or what is changed cannot be.
    """
    from antenna_pin.base.state import State
    from antenna_pin.scenario import Scenario
    from antenna_pin.studies.nonlinear import open_orbit

    table = saved_branch(name)
    changes: dict[str, object] = {}
    if table is None:
        if at is not None:
            refuse(f"{name}: is one orbit; --at is of branches")
        table = open_orbit(name)
    else:
        count = table.sizes["point"]
        if at is None or not 1 <= at <= count:
            got = "none" if at is None else str(at)
            refuse(f"{name}: --at must be from 1 to {count}, the orbits of the branch, got {got}")
        table = table.isel(point=at - 1)
        changes[str(table.attrs["parameter"])] = float(table["value"])
    if not table.attrs["scenario"]:
        refuse(
            f"{name}: comes from a system built in Python; continue in Python, with "
            f"State.from_json of its state"
        )
    known = Scenario.model_validate_json(table.attrs["scenario"])
    if changes:
        known = known.with_overrides(changes)
    if settings:
        known = known.with_overrides(settings)
    return known, State.from_json(str(table["state"].item()))


PeriodOption = Annotated[str | None, option("Period; that of the drives if left out.", "TIME")]
RtolOption = Annotated[
    float | None,
    option(
        "Tolerance of the runs, 1e-12 if left out; a coarser one, as 1e-9, where periods are long.",
        "NUMBER",
        "--rtol",
    ),
]


def period_of(scenario: Scenario, period: str | None, command: str) -> float:
    """Return the period that an option gives [s], or that of the scenario's drives."""
    from antenna_pin.studies.nonlinear import drive_period

    return drive_period(scenario) if period is None else positive_quantity(period, "s", "--period", command)


def orbit(
    context: typer.Context,
    scenario: Annotated[str, argument("Scenario, or a saved orbit or branch.", "SCENARIO|FILE.nc")],
    case: options.Case = None,
    at: AtOption = None,
    period: PeriodOption = None,
    multiple: Annotated[int, option("Periods of the orbit.")] = 1,
    free_period: Annotated[bool, flag("--free-period", "Find the period too, without a drive.")] = False,
    transient: Annotated[int, option("Periods to run before Newton's method begins.")] = 20,
    rtol: RtolOption = None,
    over: OverOption = None,
    values: ValuesOption = None,
    quantity: AmplitudeOption = None,
    arc: ArcOption = 0.1,
    most: MostOrbitsOption = 100,
    settings: options.Set = None,
    out: options.Dataset = None,
    plot: options.Plot = None,
    width: options.FigureWidth = options.Width.COLUMN,
    as_json: options.Json = False,
    csv: options.Csv = None,
    progress: Annotated[bool, option("Show a progress bar along --over.")] = True,
) -> None:
    """Find a periodic solution near the settled motion, and its stability.

    Multipliers are growth factors of perturbations over a period. The start must lie between impacts. With
    --over the orbit is followed over a key of the scenario, through folds; an interrupted branch is saved. A
    saved branch is printed again; from a saved orbit, or one of a branch by --at, Newton's method begins at
    once, with the scenario of the file and the changes of --set.
    """
    table, targets = csv_target(csv), targets_of(out, plot)
    for name, number, least in (("--multiple", multiple, 1), ("--transient", transient, 0)):
        check_count("orbit", name, number, least)
    for name, given in (("--values", values), ("--quantity", ", ".join(quantity or ()))):
        if given and over is None:
            raise InvalidParameterError("orbit", name, "given with --over KEY", said=given)
    if free_period and over is not None:
        raise InvalidParameterError("orbit", "--free-period", "left out with --over", said="both")
    from antenna_pin.show.plot import figure_multipliers

    if scenario.endswith(".nc"):
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
        branch, cut = _branch_over(
            known, over, ends, period, multiple, transient, rtol, arc, most, quantity or [], progress, begin
        )
        with not_interrupted():
            _tell(branch, width, targets, context, as_json, table)
        if cut:
            raise Ended if ended_by() != signal.SIGINT else KeyboardInterrupt
        return
    from antenna_pin.studies.nonlinear import flow_of, orbit_table, periodic_orbit

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
    width: options.Width,
    targets: tuple[Path | None, Path | None],
    context: typer.Context,
    as_json: bool,
    table: Path | None,
) -> None:
    """Save, draw and print a branch, as requested."""
    from antenna_pin.show.plot import figure_branch

    save_both(branch, lambda: figure_branch(branch, width=width.value), targets, context, as_json)
    if not exported(facts_of(branch), rows_of_branch(branch), as_json, table):
        print_branch(branch)


def _branch_over(
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
    """Return the branch from a scenario's orbit, and whether it was interrupted."""
    from antenna_pin.studies.nonlinear import (
        amplitudes,
        branch_table,
        check_steps,
        continued,
        family_of,
        flow_of,
    )

    first, last, unit = ends
    check_steps((first, last), arc, most)
    given = None if period is None else period_of(known, period, "orbit")
    family = family_of(known, over, period=given, multiple=multiple, rtol=rtol)
    flow, span = family(first)
    _, start = flow_of(known.with_overrides({over: first}))
    if quantities:  # what is wrong with a name is said before a long way is gone
        from antenna_pin.analysis import quantity

        glance = flow.probe(start, span)
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


def _facts(orbit: Orbit) -> dict[str, Any]:
    return plain_dict(
        {
            "period": orbit.period,
            "time": orbit.start.time,
            "q": orbit.start.q.tolist(),
            "v": orbit.start.v.tolist(),
            "residual": orbit.residual,
            "stable": orbit.stable,
            "doubt": orbit.doubt,
            "neutral": orbit.neutral,
            "multipliers": [[one.real, one.imag] for one in orbit.multipliers.tolist()],
            "exponents": orbit.exponents.tolist(),
            "onsets": orbit.onsets[0],
            "events": orbit.onsets[1],
        }
    )


def _rows(orbit: Orbit) -> list[dict[str, Any]]:
    return [
        plain_dict(
            {
                "real [-]": one.real,
                "imaginary [-]": one.imag,
                "size [-]": abs(one),
                "exponent [1/s]": float(exponent),
            }
        )
        for one, exponent in zip(orbit.multipliers.tolist(), orbit.exponents, strict=True)
    ]


def _print(orbit: Orbit) -> None:
    from antenna_pin.analysis import said_of_multiplier

    words = {True: "stable", False: "unstable", None: "neutral within the error estimate"}[orbit.stable]
    happens = [
        f"{count} {what}{'s' if count > 1 else ''}"
        for count, what in zip(orbit.onsets, ("contact", "event"), strict=True)
        if count
    ]
    rest = f"; {' and '.join(happens)} in a period" if happens else ""
    if orbit.neutral:
        rest += "; the discrete state of lasting contacts and elements stays as at the start"
    typer.echo(f"orbit of {orbit.period:.9g} s, {words}{rest}")
    # Digits that are known: one multiplier does not say more than the doubt of all.
    digits = min(12, max(0, math.floor(-math.log10(max(orbit.doubt, 1e-12)))))
    rows = [
        [said_of_multiplier(one, 6, digits), f"{round(abs(one), digits):.6g}", f"{exponent:.4g}"]
        for one, exponent in zip(orbit.multipliers.tolist(), orbit.exponents, strict=True)
    ]
    title = f"Floquet multipliers, to {power_above(orbit.doubt)}"
    print_rows(title, ["multiplier", "size", "exponent [1/s]"], rows)
