"""``antenna-pin sensitivity``: derivatives of results over numbers of the scenario."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast, get_args

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import load, not_interrupted
from antenna_pin.apps.cli._export import csv_target, exported, plain_dict, save_both, targets_of
from antenna_pin.apps.cli._options import argument, option
from antenna_pin.apps.cli._tables import print_rows
from antenna_pin.apps.cli._usage import positive_quantity
from antenna_pin.base.capacity import check_count
from antenna_pin.errors import FileFormatError, InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.base.state import State
    from antenna_pin.studies.sensitivity import Changed, Method, Sensitivities


def sensitivity(
    context: typer.Context,
    scenario: Annotated[str, argument("Scenario.", "SCENARIO")],
    keys: Annotated[
        list[str], argument("Numbers of the scenario, as in --set; a scale where one is 0.", "KEY[=SCALE]...")
    ],
    case: options.Case = None,
    settings: options.Set = None,
    duration: Annotated[str | None, option("Duration of the run.", "TIME")] = None,
    method: Annotated[str, option("runs, quick-runs (two runs a key), or equation.", "NAME")] = "runs",
    start: Annotated[Path | None, option("State at the start, JSON of State.to_json.", "FILE")] = None,
    pieces: Annotated[
        str | None, option("Length of pieces, each from the run's own state at its start.", "TIME")
    ] = None,
    most: Annotated[int, option("Largest number of rows, the largest changes first.")] = 12,
    out: options.Dataset = None,
    plot: options.Plot = None,
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Differentiate results over numbers of a scenario, through all of its events.

    Each number of the result has its value, its change per 1 % of each key (of its scale, if one is given)
    and the error estimate; derivatives of the motion have the time up to which they are known.
    """
    table, targets = csv_target(csv), targets_of(out, plot)
    check_count("sensitivity", "--most", most)
    from antenna_pin.show.plot import figure_sensitivity
    from antenna_pin.studies.sensitivity import Method, results_of, sensitivities, sensitivity_table

    if method not in get_args(Method):
        rule = f"one of {', '.join(get_args(Method))}"
        raise InvalidParameterError("sensitivity", "--method", rule, method)

    scales: dict[str, float | str | None] = {}
    for text in keys:
        key, equals, scale = text.partition("=")
        if key.strip() in scales:
            raise InvalidParameterError("sensitivity", "KEY", "named once each", said=f"{key.strip()} twice")
        scales[key.strip()] = scale.strip() if equals else None
    known = load(scenario, case, settings)
    span, length = (
        None if text is None else positive_quantity(text, "s", option, "sensitivity")
        for text, option in ((duration, "--duration"), (pieces, "--pieces"))
    )
    found = sensitivities(
        known,
        scales,
        duration=span,
        method=cast("Method", method),
        start=None if start is None else _state(start),
        pieces=length,
    )
    results = results_of(found)
    rows = [_row(found, one) for one in results]
    kept = sensitivity_table(found, known)
    with not_interrupted():
        save_both(kept, lambda: figure_sensitivity(kept, width=width.value), targets, context, silent=as_json)
        if not exported(_facts(found, rows), rows, as_json, table):
            _print(found, rows[:most])


def _state(path: Path) -> State:
    """Return the state in a file."""
    from antenna_pin.base.state import State

    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        rule = "a file with a state, the text of State.to_json"
        raise InvalidParameterError("sensitivity", "--start", rule, said=f"{path} ({error})") from None
    try:
        return State.from_json(text)
    except FileFormatError as error:
        raise FileFormatError(f"--start {path}: {error}") from None


def _facts(result: Sensitivities, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return all that is known, in plain numbers."""
    from antenna_pin.studies.sensitivity import refused_in

    keys = ("key", "value", "unit", "scale")
    return {
        "parameters": [plain_dict({key: getattr(one, key) for key in keys}) for one in result.parameters],
        "results": rows,
        "growth": [plain_dict(one._asdict()) for one in result.growth()],
        "refused": refused_in(result),
    }


def _row(result: Sensitivities, one: Changed) -> dict[str, Any]:
    """Return the row of a number."""
    row: dict[str, Any] = {"result": one.result, "unit": one.unit, "value": one.value}
    for parameter, slope, doubt in zip(
        result.parameters, one.slopes.tolist(), one.doubts.tolist(), strict=True
    ):
        row[f"per 1 % of {parameter.key}"], row[f"doubt of {parameter.key}"] = 0.01 * slope, 0.01 * doubt
    return plain_dict(row)


def _print(result: Sensitivities, rows: list[dict[str, Any]]) -> None:
    names = [f"({k})" for k in range(1, len(result.parameters) + 1)]
    for name, one in zip(names, result.parameters, strict=True):
        typer.echo(f"{name} {one.key} = {one.value:.6g}{' ' + one.unit if one.unit not in ('', '1') else ''}")
    lines = []
    for row in rows:
        changes = [_change(row, one.key) for one in result.parameters]
        lines.append([f"{row['result']} [{row['unit'] or '-'}]", f"{row['value']:.5g}", *changes])
    from antenna_pin.studies.sensitivity import growth_said, refused_in

    if lines:
        print_rows("Change per 1 %", ["", "is", *names], lines)
    elif "piece_begin" not in result.data.coords:
        typer.echo("no number of the result changes with these by more than is in doubt")
    typer.echo(growth_said(result))
    for piece in refused_in(result):
        typer.echo(f"no derivatives from {piece['begin']:.6g} s to {piece['end']:.6g} s: {piece['why']}")


def _change(row: dict[str, Any], key: str) -> str:
    """Return a change, or a dash below its error estimate."""
    change, doubt = row[f"per 1 % of {key}"], row[f"doubt of {key}"]
    return f"{change:+.3g}" if change is not None and abs(change) > doubt else "-"
