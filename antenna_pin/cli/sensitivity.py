"""``antenna-pin sensitivity``: by how much results change with numbers of the scenario."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, cast, get_args

import typer

from antenna_pin.capacity import check_count
from antenna_pin.cli._common import CaseOption, SetOption, load, not_interrupted
from antenna_pin.cli._export import CsvOption, JsonOption, csv_target, exported, plain
from antenna_pin.cli._quantities import positive_quantity
from antenna_pin.cli._tables import print_rows
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.sensitivity import Method, Sensitivities

__all__ = ["sensitivity"]

# What is told of contacts: of all of them together.
_OF_CONTACTS = {
    "peak_force": "max",
    "peak_depth": "max",
    "impulse": "sum",
    "dissipated": "sum",
    "onset_time": "last",
}


def sensitivity(
    scenario: Annotated[str, typer.Argument(metavar="SCENARIO", help="Scenario.")],
    keys: Annotated[
        list[str],
        typer.Argument(metavar="KEY[=SCALE]...", help="Numbers of it, as in --set; a scale where one is 0."),
    ],
    case: CaseOption = None,
    settings: SetOption = None,
    duration: Annotated[str | None, typer.Option(metavar="TIME", help="Of the run.")] = None,
    method: Annotated[
        str, typer.Option(metavar="NAME", help="runs, quick-runs (two runs a key), or equation.")
    ] = "runs",
    most: Annotated[int, typer.Option(help="Results to show at most, what changes most first.")] = 12,
    as_json: JsonOption = False,
    csv: CsvOption = None,
) -> None:
    """Say by how much results change with some numbers of a scenario, through all of its events.

    Of each number of the result, how large it is and by how much it changes per 1 % of each key (of its
    scale, if one is given), and what is in doubt of that.
    """
    table = csv_target(csv)
    check_count("sensitivity", "--most", most)
    from antenna_pin.sensitivity import Method, sensitivities

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
    span = None if duration is None else positive_quantity(duration, "s", "--duration", "sensitivity")
    found = sensitivities(known, scales, duration=span, method=cast("Method", method))
    rows = _rows(found)
    with not_interrupted():
        if not exported({"parameters": _parameters(found), "results": rows}, rows, as_json, table):
            _print(found, rows[:most])


def _parameters(found: Sensitivities) -> list[dict[str, Any]]:
    return [
        plain({"key": p.key, "value": p.value, "unit": p.unit, "scale": p.scale}) for p in found.parameters
    ]


def _rows(found: Sensitivities) -> list[dict[str, Any]]:
    """Return a row of each number, those that change most first."""
    import numpy as np

    rows = []
    for name in sorted(str(one)[2:] for one in found.data.data_vars if str(one).startswith("d_")):
        here = found.data[name]
        values, slopes, doubts = here.values, found.relative(name), found.doubt(name)
        doubts = doubts * np.array([one.scale for one in found.parameters])
        unit = str(here.attrs.get("units", ""))
        if "time" in here.dims:
            continue
        if "episode" in here.dims:
            way = _OF_CONTACTS.get(name)
            if way is None or not len(values):
                continue
            at = {"max": int(np.argmax(values)), "last": len(values) - 1}.get(way, -1)
            one = (float(values.sum()), slopes.sum(axis=0), doubts.sum(axis=0)) if way == "sum" else None
            rows.append(
                _row(found, f"{way} {name}", unit, *(one or (float(values[at]), slopes[at], doubts[at])))
            )
            continue
        for index in np.ndindex(values.shape):
            labels = [
                str(here[str(dim)].values[i])
                for dim, i in zip(here.dims, index, strict=True)
                if dim in here.coords
            ]
            label = f"{name} {' '.join(labels)}".strip()
            rows.append(_row(found, label, unit, float(values[index]), slopes[index], doubts[index]))
    changed = [row for row in rows if row.pop("_changes")]
    return sorted(changed, key=lambda row: -row.pop("_most"))


def _row(
    found: Sensitivities, label: str, unit: str, value: float, slopes: Any, doubts: Any
) -> dict[str, Any]:
    """Return the row of a number."""
    import numpy as np

    row: dict[str, Any] = {"result": label, "unit": unit, "value": value}
    for one, slope, doubt in zip(found.parameters, slopes.tolist(), doubts.tolist(), strict=True):
        row[f"per 1 % of {one.key}"], row[f"doubt of {one.key}"] = 0.01 * slope, 0.01 * doubt
    size = float(np.abs(slopes).max(initial=0.0))
    changes = bool((np.abs(slopes) > doubts).any())
    return {**plain(row), "_changes": changes, "_most": size / abs(value) if value else 0.0}


def _print(found: Sensitivities, rows: list[dict[str, Any]]) -> None:
    names = [f"({k})" for k in range(1, len(found.parameters) + 1)]
    for name, one in zip(names, found.parameters, strict=True):
        typer.echo(f"{name} {one.key} = {one.value:.6g}{' ' + one.unit if one.unit not in ('', '1') else ''}")
    lines = []
    for row in rows:
        changes = [_change(row, one.key) for one in found.parameters]
        lines.append([f"{row['result']} [{row['unit'] or '-'}]", f"{row['value']:.5g}", *changes])
    if not lines:
        typer.echo("no number of the result changes with these by more than is in doubt")
        return
    print_rows("Change per 1 %", ["", "is", *names], lines)


def _change(row: dict[str, Any], key: str) -> str:
    """Return a change as digits tell it: those that are in doubt are left out."""
    change, doubt = row[f"per 1 % of {key}"], row[f"doubt of {key}"]
    return f"{change:+.3g}" if change is not None and abs(change) > doubt else "-"
