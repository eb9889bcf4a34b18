"""``antenna-pin phase``: phase portraits of a run, and names of its quantities."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import FIGURES, load_result, not_interrupted, say
from antenna_pin.apps.cli._export import save_both, targets_of
from antenna_pin.apps.cli._options import flag, option
from antenna_pin.base.readable import DECIMAL, bare
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.analysis import Periods

_PERIODS = re.compile(rf"\s*({DECIMAL})\s*periods?\s*")


class Colour(StrEnum):
    """Meaning of a portrait's colours."""

    TIME = "time"
    DENSITY = "density"


def phase(
    context: typer.Context,
    file: options.Result,
    x: Annotated[str | None, option("Quantity across.", "NAME", "-x")] = None,
    y: Annotated[str | None, option("Quantity up.", "NAME", "-y")] = None,
    z: Annotated[str | None, option("Third one, for a portrait in 3D.", "NAME", "-z")] = None,
    start: Annotated[
        str | None,
        option(
            "End of the transient, which is cut; judge: until the statistics drift no more.",
            "TIME|N periods|judge",
            "--from",
        ),
    ] = None,
    period: Annotated[str | None, option("Period for --from 'N periods'.", "TIME")] = None,
    colour: Annotated[Colour, option("Line coloured by time, or the share of time.")] = Colour.TIME,
    out: Annotated[
        Path | None, option("Dataset, NAME.nc; or a figure, as --plot.", "FILE", "-o", "--out")
    ] = None,
    plot: options.Plot = None,
    width: options.FigureWidth = options.Width.PAGE,
    names: Annotated[bool, flag("--list", "List the run's quantities with their units, and stop.")] = False,
) -> None:
    """Draw two or three quantities of a run over each other, its transient cut.

    Names are those of the result's variables, as motion_angle[elevation], joint_force[elevation].x,
    |joint_force[elevation]|, v[base.wx], and of signals, as 'elevation force x'; --list has all.
    """
    if names:
        _list(file)
        return
    for name, given in (("-x", x), ("-y", y), ("-o", out or plot)):
        if given is None:
            what = "FILE" if name == "-o" else "NAME"
            raise InvalidParameterError("phase", name, f"given as {name} {what}, or --list", said="nothing")
    assert x is not None and y is not None
    if out is not None and out.suffix != ".nc" and plot is None:
        if out.suffix not in FIGURES:
            rule = f"a file that ends in {', '.join(FIGURES)} or .nc"
            raise InvalidParameterError("phase", "-o", rule, str(out))
        out, plot = None, out
    targets = targets_of(out, plot)
    transient = _transient(start, period)
    from antenna_pin.analysis import phase_portrait, portrait_table
    from antenna_pin.show.plot import figure_phase

    run = load_result(file, scenario=False)
    portrait = phase_portrait(run, x, y, z, transient=transient)
    with not_interrupted():
        say(f"{portrait.run} {portrait.rule}, {len(portrait.time)} samples")
        save_both(
            portrait_table(portrait, run),
            lambda: figure_phase(portrait, shade=colour.value, width=width.value),
            targets,
            context,
        )


def _transient(text: str | None, period: str | None) -> float | Periods | Literal["judge"] | None:
    from antenna_pin.analysis import Periods
    from antenna_pin.base.units import quantity

    counted = None if text is None else _PERIODS.fullmatch(text)
    if (counted is None) != (period is None):
        rule = "given with --period TIME" if counted else "given with --from 'N periods'"
        option, seen = ("--from", text) if counted else ("--period", period)
        raise InvalidParameterError("phase", option, rule, seen)
    if text is None or text == "judge":
        return "judge" if text else None
    if counted is not None:
        assert period is not None
        return Periods(quantity(bare(counted[1]), "1", "--from"), quantity(bare(period), "s", "--period"))
    return quantity(bare(text), "s", "--from")


def _list(file: Path) -> None:
    from antenna_pin.analysis import quantities
    from antenna_pin.base.readable import printed_unit

    found = quantities(load_result(file, scenario=False))
    width = max(map(len, found))
    for name, unit in found.items():
        say(f"{name:<{width}} {printed_unit(unit) or '-'}")
