"""``antenna-pin pointing``: pointing error indices of ECSS."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import label_of, load_result, refuse, say
from antenna_pin.apps.cli._export import csv_target, say_json, write_csv
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._tables import print_rows
from antenna_pin.apps.cli._usage import direction_of, seconds_in
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.analysis import Antenna
    from antenna_pin.trajectory import Trajectory

_COMPONENTS = {
    "boresight": "about the boresight (clocking)",
    "cross": "about the axis square to boresight and up",
    "up": "about the part of up that is square to the boresight",
    "half-cone": "angle between the boresights; means and differences are taken of the vector that turns one "
    "into the other",
}

# Up to which magnitude [rad] a row is told in which unit.
_UNITS = ((1e-3, "µrad", 1e6), (0.1, "mrad", 1e3), (math.inf, "deg", 180.0 / math.pi))


def pointing(
    files: options.Results,
    ideal: Annotated[Path | None, option("Result of the reference run.", "FILE")] = None,
    direction: Annotated[
        str | None, option("Commanded direction in world axes, instead of an ideal run.", "X,Y,Z")
    ] = None,
    window: Annotated[
        str | None, option("Length of the windows for MPE, RPE, PDE and PRE ('0.5 s').", "TIME")
    ] = None,
    drift_spacing: Annotated[str | None, option("Time between the two windows of the PDE.", "TIME")] = None,
    period: Annotated[
        str | None, option("Length of the observation periods for PDE and PRE.", "TIME")
    ] = None,
    confidence: Annotated[float, option("Confidence of the levels.")] = 0.997,
    body: Annotated[
        str | None, option("Link with the boresight; the scenario's if left out.", "LINK")
    ] = None,
    boresight: Annotated[
        str | None, option("Boresight in the link's frame; the scenario's if left out.", "X,Y,Z")
    ] = None,
    up: Annotated[str | None, option("Second axis, reference of clocking.", "X,Y,Z")] = None,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute pointing error indices of ECSS-E-ST-60-10C.

    Several results have levels for each statistical interpretation. Angles are in radians in JSON and
    CSV.
    """
    target = csv_target(csv)
    windows = {
        "window": seconds_in(window, "--window"),
        "drift_spacing": seconds_in(drift_spacing, "--drift-spacing"),
        "periods": seconds_in(period, "--period"),
    }
    runs = [load_result(path, scenario=False) for path in files]
    reference = None if ideal is None else load_result(ideal, scenario=False)

    from antenna_pin.analysis import Command, error_components, pointing_error, pointing_indices

    for path, run in zip(files, runs, strict=True):
        _check_options(path, run, {"--ideal": ideal, "--direction": direction}, body, boresight)
    command = None if direction is None else Command(direction=_axis(direction, "--direction"))
    errors, notes = [], []
    for path, run in zip(files, runs, strict=True):
        if not run.completed:
            notes.append(f"{path}: the run {run.outcome.verdict}: {run.message}")
        compared = run if reference is None else _covered(run, reference, path, notes)
        antenna = _antenna(run, body, boresight, up)
        errors.append(pointing_error(compared, reference, antenna=antenna, command=command))
    found = pointing_indices(
        [one["time"].values for one in errors],
        [error_components(one) for one in errors],
        window=windows["window"],
        drift_spacing=windows["drift_spacing"],
        periods=windows["periods"],
        confidence=confidence,
    )
    between = max(one.attrs["interpolation_error"] for one in errors)
    if between > 0.0:
        notes.append(f"error of the ideal attitude between its samples: some {between:.1g} rad")
    about = {
        "files": [str(path) for path in files],
        "body": errors[0].attrs["body"],
        "against": errors[0].attrs["against"] if ideal is None else str(ideal),
        "confidence": confidence,
        "resolution": found.attrs["resolution"],
    } | windows
    indices = _plain(found)
    if target is not None:
        names = [str(name) for name in found["component"].values]
        write_csv(target, ("index", "value", *(f"{name} [rad]" for name in names)), _values(indices), as_json)
    if as_json:
        say_json({**about, "indices": indices, "notes": notes})
    if as_json or target is not None:
        return
    labels = dict.fromkeys(label_of(run, path) for path, run in zip(files, runs, strict=True))
    title = f"{', '.join(labels)}: pointing error of {about['body']} against {about['against']}"
    _print(title, found)
    for note in notes:
        say(note)


def _covered(run: Trajectory, ideal: Trajectory, path: Path, notes: list[str]) -> Trajectory:
    """Return the part of a run that the ideal run covers."""
    end = float(ideal.data["time"].values[-1])
    time = run.data["time"].values
    inside = time <= end * (1.0 + 1e-9)
    if inside.all():
        return run
    notes.append(f"{path}: compared up to the end of the ideal run at {end:g} s")
    return dataclasses.replace(run, data=run.data.isel(time=inside))


def _check_options(
    path: Path, run: Trajectory, against: Mapping[str, Any], body: str | None, boresight: str | None
) -> None:
    """Refuse a pointing that neither scenario nor options define."""
    from antenna_pin.analysis import pointing_spec

    known = pointing_spec(run)
    missing = [option for option, given in (("--body", body), ("--boresight", boresight)) if given is None]
    if known is None and missing:
        load_result(path)  # which tells a scenario that cannot be read from one without [pointing]
        refuse(
            f"{path}: its scenario has no [pointing] table with body and boresight; "
            f"add {' and '.join(missing)}"
        )
    commanded = known is not None and known.commanded != "ideal"
    if not commanded and all(given is None for given in against.values()):
        refuse(f"{path}: there is nothing to compare with; add --ideal FILE or --direction X,Y,Z")


def _antenna(run: Trajectory, body: str | None, boresight: str | None, up: str | None) -> Antenna | None:
    """Return the antenna that the options name, completed by the scenario's; None for that alone."""
    from antenna_pin.analysis import Antenna

    if body is None and boresight is None and up is None:
        return None
    if body is not None and boresight is not None:
        return Antenna(
            body=body,
            boresight=_axis(boresight, "--boresight"),
            up=_axis(up, "--up") if up else None,
        )
    known = Antenna.of(run)
    if body is not None and body != known.body:
        raise InvalidParameterError(
            "pointing", "--body", "given with --boresight, an axis of that link", body
        )
    axis = known.boresight if boresight is None else _axis(boresight, "--boresight")
    second = known.up if boresight is None else None
    return Antenna(body=known.body, boresight=axis, up=_axis(up, "--up") if up else second)


def _axis(text: str, option: str) -> tuple[float, float, float]:
    return direction_of(text, "pointing", option)


def _plain(indices: xr.Dataset) -> dict[str, Any]:
    """Return the indices in plain numbers; None where there is none."""

    def row(values: xr.DataArray) -> dict[str, float | None]:
        return {
            str(name): None if math.isnan(value) else float(value)
            for name, value in zip(indices["component"].values, values.values, strict=True)
        }

    return {
        str(kind): {name: row(indices[name].sel(index=kind)) for name in ("extreme", "lowest", "highest")}
        | {
            "level": {
                str(name): row(indices["level"].sel(index=kind, interpretation=name))
                for name in indices["interpretation"].values
            },
            "definition": str(indices["definition"].sel(index=kind).item()),
        }
        for kind in indices["index"].values
    }


def _values(indices: Mapping[str, Any]) -> Iterator[list[Any]]:
    """Yield index, which value of it, and that of each component."""
    for kind, one in indices.items():
        for name in ("extreme", "lowest", "highest"):
            yield [kind, name, *one[name].values()]
        for name, level in one["level"].items():
            yield [kind, f"level, {name}", *level.values()]


def _print(title: str, indices: xr.Dataset) -> None:
    """Print the table, and what its rows and columns are."""
    from antenna_pin.analysis import INTERPRETATIONS

    several = indices.attrs["runs"] > 1
    share = f"{100.0 * indices.attrs['confidence']:g} %"
    rows: list[list[str]] = []
    for kind in indices["index"].values:
        one = indices.sel(index=kind)
        rows.append(_row(f"{kind} largest", one["extreme"]))
        for name in indices["interpretation"].values if several else ["temporal"]:
            label = f"{kind} {share}, {name}" if several else f"{kind} {share}"
            rows.append(_row(label, one["level"].sel(interpretation=name)))
    names = [str(name) for name in indices["component"].values]
    print_rows(title, ("", *names), rows)
    for kind in indices["index"].values:
        typer.echo(f"{kind}: {indices['definition'].sel(index=kind).item()}")
    for name in names:
        typer.echo(f"{name}: {_COMPONENTS[name]}")
    for name, text in INTERPRETATIONS.items() if several else [("temporal", "share of the time")]:
        typer.echo(f"{share}{f', {name}' if several else ''}: not exceeded for that {text}")


def _row(label: str, angles: xr.DataArray) -> list[str]:
    """Return a row of angles [rad] in a unit that suits them."""
    values = [float(angle) for angle in angles.values]
    largest = max(map(abs, values))
    unit, factor = next((unit, factor) for limit, unit, factor in _UNITS if largest < limit)
    return [f"{label} [{unit}]", *(f"{factor * value:.4g}" for value in values)]
