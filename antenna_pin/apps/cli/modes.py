"""``antenna-pin modes``: natural frequencies, damping, shapes and frequency responses about a state."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_target, load, load_result, not_interrupted, say, writable_file
from antenna_pin.apps.cli._export import csv_target, exported, plain, save_plot
from antenna_pin.apps.cli._options import argument, flag, option, several
from antenna_pin.apps.cli._tables import formatted, print_rows
from antenna_pin.apps.cli._usage import vector_in
from antenna_pin.base.readable import bare
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.studies.linear import Modes

# Shares of energy below which a body is not named, and how many are at most.
_NAMED, _NAMES = 0.05, 3


class PlayName(StrEnum):
    """Model of joints with play."""

    IDEAL = "ideal"
    FREE = "free"
    CONTACT = "contact"


def modes(
    scenario: Annotated[
        str, argument("Scenario, or a result file: the state that its run left.", "SCENARIO")
    ],
    case: options.Case = None,
    at: Annotated[
        str | None, option("Time to run to first, or result that ended in the state.", "TIME|FILE")
    ] = None,
    play: Annotated[
        PlayName | None, option("Model of joints with play; ideal, or contact where they have a load.")
    ] = None,
    load_on: Annotated[
        list[str] | None,
        several(
            "Force that presses the journal into its bearing, in bearing axes [N].", "[JOINT=]X,Y,Z", "--load"
        ),
    ] = None,
    approach_speed: Annotated[
        str | None, option("Approach speed of contacts under a load; their joint's floor if left out.")
    ] = None,
    hold: Annotated[list[str] | None, several("Joint to hold, or base.", "JOINT")] = None,
    moving: Annotated[bool, flag("--moving", "Include velocities and accelerations of the state.")] = False,
    record: Annotated[Path | None, option("Page that shows the shapes in 3D, NAME.html.", "FILE")] = None,
    mode: Annotated[
        list[int] | None, several("Mode to record; all vibrations if left out.", "NUMBER")
    ] = None,
    amplitude: Annotated[float, option("Factor on the size of drawn shapes.")] = 1.0,
    plot: Annotated[Path | None, option("Figure of a frequency response: png, pdf or svg.", "FILE")] = None,
    source: Annotated[
        str | None, option("Excitation: drives.NAME, base.fx to base.mz.", "SOURCE", "--from")
    ] = None,
    target: Annotated[
        list[str] | None, several("Response: boresight, a joint, base.x to base.rz.", "TARGET", "--to")
    ] = None,
    width: options.FigureWidth = options.Width.PAGE,
    settings: options.Set = None,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute natural frequencies, damping ratios and mode shapes about a state.

    Rigid-body motions of a free base, and motions without resistance, are counted, not listed.
    """
    table, page = csv_target(csv), None if record is None else writable_file(record, ".html")
    figure_target(plot, "modes", "--plot")
    needed: tuple[tuple[str, object, Path | None, str], ...] = (
        ("--from", source, plot, "--plot"),
        ("--to", target, plot, "--plot"),
        ("--mode", mode, page, "--record"),
        ("--amplitude", None if amplitude == 1.0 else amplitude, page, "--record"),
    )
    for asked, given, other, name in needed:
        if given is not None and other is None:
            raise InvalidParameterError("modes", asked, f"given with {name} FILE", said=str(given))
    found = _linearised(scenario, case, settings, at, play, load_on, approach_speed, hold, moving)
    if page is not None:
        _record(found, page, mode, amplitude, quiet=as_json)
    if plot is not None:
        _plot(found, plot, source, target, width, quiet=as_json)
    if exported(found.to_dict(), _rows(found), as_json, table):
        return
    _print(found)


def _linearised(
    name: str,
    case: str | None,
    settings: list[str] | None,
    at: str | None,
    play: PlayName | None,
    loads: list[str] | None,
    approach_speed: str | None,
    hold: list[str] | None,
    moving: bool,
) -> Modes:
    from antenna_pin.base.units import quantity
    from antenna_pin.studies.linear import modes as linearised

    more: dict[str, Any] = {}
    model: Any
    if name.endswith(".nc"):
        for option, given in (("--case", case), ("--set", settings), ("--at", at)):
            if given:
                rule = "left out for a result, which has its own"
                raise InvalidParameterError("modes", option, rule, said=str(given))
        model = load_result(Path(name))
    else:
        model = load(name, case, settings)
        if at is not None and at.endswith(".nc"):
            more["at"] = load_result(Path(at))
        elif at is not None:
            more["at"] = quantity(bare(at), "s", "--at")
    speed = None if approach_speed is None else quantity(bare(approach_speed), "m/s", "--approach-speed")
    return linearised(
        model,
        play=None if play is None else play.value,
        load=_loads(loads),
        approach_speed=speed,
        hold=hold or (),
        moving=moving,
        **more,
    )


def _loads(texts: list[str] | None) -> Any:
    found: dict[str, tuple[float, ...]] = {}
    for text in texts or ():
        joint, _, numbers = text.rpartition("=")
        vector = vector_in(numbers)
        if vector is None:
            rule = "three numbers such as 100,0,0, with JOINT= before them or not"
            raise InvalidParameterError("modes", "--load", rule, text)
        found[joint] = vector
    if not found:
        return None
    return found[""] if list(found) == [""] else found


def _record(modes: Modes, page: Path, numbers: list[int] | None, amplitude: float, quiet: bool) -> None:
    from antenna_pin.show.record import record_several
    from antenna_pin.studies.linear import swing

    chosen = numbers or modes.elastic
    if not chosen:
        rule = "given --mode NUMBER, as nothing vibrates here"
        raise InvalidParameterError("modes", "--record", rule, str(page))
    swings = {f"mode {k}": swing(modes, k, amplitude) for k in chosen}
    with not_interrupted():
        record_several(swings.values(), page, title=modes.data.attrs["title"])
        if not quiet:
            typer.echo(f"saved {page}")


def _plot(
    modes: Modes, path: Path, source: str | None, targets: list[str] | None, width: options.Width, quiet: bool
) -> None:
    from antenna_pin.show.plot import figure_response
    from antenna_pin.studies.linear import first_source, frequency_response

    start = first_source(modes, "--from") if source is None else source
    figure = figure_response(frequency_response(modes, start, targets), width=width.value)
    save_plot(figure, path, quiet)


def _rows(modes: Modes) -> list[dict[str, Any]]:
    """Return one row for each mode, by names with units."""
    data = modes.data
    rows = []
    for mode in data["mode"].values:
        one = data.sel(mode=mode)
        row: dict[str, Any] = {
            "mode": int(mode),
            "kind": str(one["kind"].item()),
            "frequency [Hz]": float(one["frequency"].item()),
            "damped modulus [Hz]": float(one["damped_modulus"].item()),
            "damping ratio [-]": float(one["damping_ratio"].item()),
        }
        if "effective_mass" in one:
            for name, value in zip(data["component"].values, one["effective_mass"].values, strict=True):
                unit = "kg m^2" if str(name).startswith("r") else "kg"
                row[f"effective mass {name} [{unit}]"] = float(value)
        for kind, dimension in (("kinetic", "body"), ("strain", "part")):
            if f"{kind}_share" in one:
                shares = zip(data[dimension].values, one[f"{kind}_share"].values, strict=True)
                row |= {f"{kind} share {name} [-]": float(value) for name, value in shares}
        rows.append(plain(row))
    return rows


def _print(modes: Modes) -> None:
    data = modes.data
    shown = [k for k, kind in enumerate(data["kind"].values) if kind in ("elastic", "unstable")]
    head = ["mode", "frequency [Hz]", "damped [Hz]", "damping [%]", "moves most", "stores most"]
    rows = [
        [
            f"{data['mode'].values[k]}{' unstable' if data['kind'].values[k] == 'unstable' else ''}",
            _number(modes.frequency[k]),
            _number(float(data["damped_modulus"].values[k])),
            _number(100.0 * modes.damping_ratio[k]),
            _largest(data["body"].values, data["kinetic_share"].values[k]),
            _largest(data["part"].values, data["strain_share"].values[k]) if "strain_share" in data else "-",
        ]
        for k in shown
    ]
    title = ", ".join(filter(None, (data.attrs["title"], data.attrs["case"], _conditions(modes))))
    if rows:
        print_rows(title, head, rows, numbers=False)
    else:
        say(title)
        typer.echo("nothing vibrates")
    if "effective_mass" in data and shown:
        _print_masses(modes, shown)
    kinds = list(data["kind"].values)
    if kinds.count("rigid"):
        typer.echo(f"beside these {kinds.count('rigid')} motions of all as one rigid body")
    for note in modes.notes:
        say(f"note: {note}")


def _conditions(modes: Modes) -> str:
    attributes = modes.data.attrs
    words = [f"{name} {kind}" for name, kind in attributes["play"].items()]
    words += [
        f"{name} under {', '.join(f'{f:g}' for f in load)} N" for name, load in attributes["loads"].items()
    ]
    words += [f"{name} held" for name in attributes["hold"]]
    if attributes["time"] > 0.0:
        words.append(f"at {attributes['time']:g} s")
    return "; ".join(words)


def _print_masses(modes: Modes, shown: list[int]) -> None:
    data = modes.data
    names = [str(name) for name in data["component"].values]
    units = ["kg m²" if name.startswith("r") else "kg" for name in names]
    masses = data["effective_mass"].values
    lines = [(str(int(data["mode"].values[k])), masses[k]) for k in shown]
    lines += [("all modes", masses.sum(axis=0)), ("rigid whole", data["rigid_mass"].values)]
    rows = [[label, *(_number(float(value)) for value in values)] for label, values in lines]
    head = ["mode", *(f"{name} [{unit}]" for name, unit in zip(names, units, strict=True))]
    print_rows("effective masses, about the base's origin", head, rows)


def _number(value: float) -> str:
    return formatted(value, ".6g")


def _largest(names: Any, shares: Any) -> str:
    """Return what has most of an energy, with its share."""
    order = sorted(range(len(shares)), key=lambda k: -shares[k] if math.isfinite(shares[k]) else 0.0)
    kept = [k for k in order[:_NAMES] if math.isfinite(shares[k]) and shares[k] >= _NAMED]
    return ", ".join(f"{names[k]} {100.0 * shares[k]:.0f} %" for k in kept) or "-"
