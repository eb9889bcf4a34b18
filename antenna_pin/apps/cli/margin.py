"""``antenna-pin margin``: motorization margin over a travel, in the worst case."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_target, load, say, writable_file
from antenna_pin.apps.cli._export import csv_target, exported, plain, save_plot
from antenna_pin.apps.cli._options import flag, option, several
from antenna_pin.apps.cli._tables import formatted, print_rows
from antenna_pin.base.readable import bare, printed_unit, readable
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario
    from antenna_pin.studies.margins import MotorizationMargin

# Cases that are printed, at most.
_CASES = 8


def margin(
    scenario: options.Scenario,
    joint: Annotated[str, option("Joint of the function, or a drive at it.", "JOINT")],
    case: options.Case = None,
    travel: Annotated[
        str | None,
        option("First and last position ('-90 deg:0'); the joint's limits if left out.", "FROM:TO"),
    ] = None,
    count: Annotated[int, option("Number of positions.")] = 61,
    factors: Annotated[str, option("Set of factors: ecss-e-st-33-01c, aiaa-s-114.", "SET")] = (
        "ecss-e-st-33-01c"
    ),
    factor: Annotated[
        list[str] | None, several("Factor of your own: F_R=2, motorization=1.5.", "NAME=NUMBER")
    ] = None,
    by_measurement: Annotated[
        list[str] | None, several("Source whose value is measured.", "SOURCE", "--measured")
    ] = None,
    additional: Annotated[
        list[str] | None, several("Further resistance, H_D='20 mN*m'.", "CLASS=TORQUE", "--add")
    ] = None,
    acceleration: Annotated[
        str, option("Acceleration asked of the function, for T_D.", "ACCELERATION")
    ] = "0",
    delivered_torque: Annotated[str, option("Torque to be delivered beside, T_L.", "TORQUE")] = "0",
    rate: Annotated[str, option("Rate of the joint, for a motor's back-EMF.", "RATE")] = "0",
    available: Annotated[list[str] | None, several("Torque of a drive at its joint.", "DRIVE=TORQUE")] = None,
    hold: Annotated[list[str] | None, several("Further joint that does not move.", "JOINT")] = None,
    extremes: Annotated[
        list[str] | None, several("Least and greatest value of a scenario key.", "KEY=LOW:HIGH", "--range")
    ] = None,
    cases: Annotated[
        list[str] | None,
        several("Case of extremes, cold:springs.x.rest_angle=0.", "NAME:KEY=VALUE", "--extreme"),
    ] = None,
    search: Annotated[
        bool, flag("--search", "Search the worst case within the ranges, beside their corners.")
    ] = False,
    write_worst: Annotated[Path | None, option("Scenario of the worst case, NAME.toml.", "FILE")] = None,
    settings: options.Set = None,
    plot: options.Plot = None,
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute the motorization margin over a travel: what drives over what resists, with factors."""
    table, target = csv_target(csv), figure_target(plot, "margin", "--plot")
    worst_file = None if write_worst is None else writable_file(write_worst, ".toml")
    from antenna_pin.studies import margins

    known = load(scenario, case, settings)
    tailored: Any = factors
    if factor:
        tailored = {
            "base": factors,
            **{name: _number(value, name) for name, value in _pairs(factor, "--factor")},
        }
    ends = None if travel is None else [bare(part) for part in _two(travel, "--travel")]
    named: dict[str, dict[str, Any]] = {}
    for name, rest in _pairs(cases, "--extreme", ":"):
        key, value = _pairs([rest], "--extreme")[0]
        named.setdefault(name, {})[key] = bare(value)
    found = margins.margin(
        known,
        joint,
        travel=ends,
        count=count,
        factors=tailored,
        by_measurement=by_measurement or (),
        additional={name: bare(value) for name, value in _pairs(additional, "--add")},
        acceleration=bare(acceleration),
        delivered_torque=bare(delivered_torque),
        rate=bare(rate),
        available={name: bare(value) for name, value in _pairs(available, "--available")},
        hold=hold or (),
        cases=named or None,
        ranges={
            key: [bare(one) for one in _two(value, "--range")] for key, value in _pairs(extremes, "--range")
        },
        search=search,
    )
    if target is not None:
        from antenna_pin.show.plot import figure_margin

        save_plot(figure_margin(found.data, width=width.value), target, as_json)
    if worst_file is not None:
        assert found.worst_scenario is not None
        _write(found.worst_scenario, worst_file, as_json)
    if not exported(found.to_dict(), _rows(found), as_json, table):
        _print(", ".join(filter(None, (known.title, known.case))), found)


def _pairs(texts: list[str] | None, option: str, sign: str = "=") -> list[tuple[str, str]]:
    """Return what stands before and behind a sign of each text."""
    found = []
    for text in texts or ():
        name, middle, value = text.partition(sign)
        if not (name and middle and value):
            raise InvalidParameterError("margin", option, f"of the form NAME{sign}VALUE", text)
        found.append((name.strip(), value.strip()))
    return found


def _two(text: str, option: str) -> list[str]:
    """Return both parts of a text with a colon."""
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2 or not all(parts):
        raise InvalidParameterError("margin", option, "two values with a colon between them", text)
    return parts


def _number(text: str, name: str) -> float:
    from antenna_pin.base.units import quantity

    return quantity(bare(text), "1", f"--factor {name}")


def _write(scenario: Scenario, path: Path, silent: bool) -> None:
    """Write a scenario beside which its URDF is found."""
    from antenna_pin.base.files import replacing
    from antenna_pin.scenario import found_from, scenario_toml

    text = scenario_toml(found_from(scenario, path.resolve().parent))
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8")
    if not silent:
        typer.echo(f"saved {path}")


def _rows(result: MotorizationMargin) -> list[dict[str, Any]]:
    """Return one row for each position, by names with units."""
    data = result.data
    unit, length = printed_unit(result.unit), "m" if result.sliding else "rad"
    rows = []
    for k, place in enumerate(data["position"].values):
        row: dict[str, Any] = {
            f"position [{length}]": float(place),
            "margin [-]": float(data["margin"].values[k]),
        }
        for name in ("actuation", "minimum_torque", "needed_torque"):
            row[f"{name.replace('_', ' ')} [{unit}]"] = float(data[name].values[k])
        for s, source in enumerate(data["source"].values):
            row[f"resistance {source} [{unit}]"] = float(data["resistance"].values[k, s])
            row[f"drive {source} [{unit}]"] = float(data["drive"].values[k, s])
        rows.append({name: plain(value) for name, value in row.items()})
    return rows


def _print(title: str, result: MotorizationMargin) -> None:
    from antenna_pin.studies.margins import WORDS_OF_RESISTANCE

    data, length = result.data, "m" if result.sliding else "rad"
    unit = printed_unit(result.unit)
    k = int(data["margin"].values.argmin())
    head = ["source", "class", f"resists [{unit}]", f"drives [{unit}]", "factor"]
    rows = []
    for s, source in enumerate(data["source"].values):
        resists, drives = (float(data[name].values[k, s]) for name in ("resistance", "drive"))
        own = "drive_factor" if drives else "resistance_factor"
        measured = " measured" if bool(data["by_measurement"].values[s]) else ""
        symbol = str(data["symbol"].values[s])
        words = f"{symbol} {WORDS_OF_RESISTANCE[symbol]}{measured}" if symbol else "drive"
        factor = f"{float(data[own].values[s]):g}" if resists or drives else "-"
        rows.append([str(source), words, formatted(resists, ".5g"), formatted(drives, ".5g"), factor])
    where = readable(result.position, length)
    print_rows(f"{title}: {result.joint} at {where}, where the margin is smallest", head, rows, numbers=False)
    minimum, actuation = (float(data[name].values[k]) for name in ("minimum_torque", "actuation"))
    say(f"actuation {readable(actuation, unit)}, at least {readable(minimum, unit)} needed with all factors")
    say(
        f"smallest margin {formatted(result.smallest, '.4g')} at {where}; "
        f"required {result.factors.required:g}"
    )
    if len(result.cases) > 1:
        rows = [
            [one.name, one.origin, formatted(one.margin, ".4g"), formatted(one.position, ".5g")]
            for one in result.cases[:_CASES]
        ]
        head = ["case", "origin", "smallest margin", f"at [{length}]"]
        print_rows(
            f"{len(result.cases)} combinations of extremes, the worst first", head, rows, numbers=False
        )
    say(f"factors: {result.factors.source}, {result.factors.clause}; numbers, no claim of compliance")
    for note in result.notes:
        say(f"note: {note}")
