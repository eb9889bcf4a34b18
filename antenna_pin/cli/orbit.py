"""``antenna-pin orbit``: a periodic solution, its Floquet multipliers, and whether neighbours come to it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.cli._common import CaseOption, SetOption, load
from antenna_pin.cli._export import CsvOption, JsonOption, csv_target, exported, plain
from antenna_pin.cli._quantities import positive_quantity
from antenna_pin.cli._tables import power_above, print_rows
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.nonlinear import Orbit
    from antenna_pin.scenario import Scenario

__all__ = ["orbit", "period_of"]

PeriodOption = Annotated[
    str | None, typer.Option(metavar="TIME", help="Period; that of the drives if left out.")
]


def period_of(scenario: Scenario, period: str | None, command: str) -> float:
    """Return the period that an option gives [s], or that of the scenario's drives."""
    from antenna_pin.nonlinear import drive_period

    return drive_period(scenario) if period is None else positive_quantity(period, "s", "--period", command)


def orbit(
    scenario: Annotated[str, typer.Argument(metavar="SCENARIO", help="Scenario.")],
    case: CaseOption = None,
    period: PeriodOption = None,
    multiple: Annotated[int, typer.Option(help="Periods in which the orbit closes.")] = 1,
    free_period: Annotated[
        bool, typer.Option("--free-period", help="Find the period too, of what nothing drives.")
    ] = False,
    transient: Annotated[int, typer.Option(help="Periods to run before Newton's method begins.")] = 20,
    settings: SetOption = None,
    as_json: JsonOption = False,
    csv: CsvOption = None,
) -> None:
    """Find a periodic solution near where a scenario has come to, and say whether neighbours come to it.

    Multipliers are by how much they grow in a period. The instant of its start must be one between impacts.
    """
    from antenna_pin.nonlinear import flow_of, periodic_orbit

    table = csv_target(csv)
    for name, number, least in (("--multiple", multiple, 1), ("--transient", transient, 0)):
        if number < least:
            raise InvalidParameterError("orbit", name, f"{least} or more", number)
    known = load(scenario, case, settings)
    span = multiple * period_of(known, period, "orbit")
    flow, start = flow_of(known)
    if transient:
        start = flow.after(start, transient * span)
    found = periodic_orbit(flow, start, span, free_period=free_period)
    if exported(_facts(found), _rows(found), as_json, table):
        return
    _print(found)


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
    words = {True: "stable", False: "unstable", None: "neutral, as far as can be told"}[found.stable]
    happens = [
        f"{count} {what}{'s' if count > 1 else ''}"
        for count, what in zip(found.onsets, ("contact", "event"), strict=True)
        if count
    ]
    rest = f"; {' and '.join(happens)} in a period" if happens else ""
    typer.echo(f"orbit of {found.period:.9g} s, {words}{rest}")
    # Digits that are known: one multiplier does not say more than the doubt of all.
    digits = min(12, max(0, math.floor(-math.log10(max(found.doubt, 1e-12)))))
    rows = [
        [*(f"{round(part, digits):.6g}" for part in (one.real, one.imag, abs(one))), f"{exponent:.4g}"]
        for one, exponent in zip(found.multipliers.tolist(), found.exponents, strict=True)
    ]
    title = f"Floquet multipliers, to {power_above(found.doubt)}"
    print_rows(title, ["real", "imaginary", "size", "exponent [1/s]"], rows)
