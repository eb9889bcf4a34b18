"""``antenna-pin bifurcation``: the settled points of a section over a parameter."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.cli._common import (
    CaseOption,
    ScenarioArgument,
    SetOption,
    Width,
    WidthOption,
    load,
    not_interrupted,
    say,
)
from antenna_pin.cli._progress import study_bar
from antenna_pin.cli._saved import PlotOption, save_both, targets_of
from antenna_pin.cli._sections import (
    CountOption,
    Direction,
    DirectionOption,
    MostOption,
    PhaseOption,
    QuantityOption,
    SectionOption,
    ToleranceOption,
    TransientOption,
    section_from,
    values_from,
)
from antenna_pin.cli._tables import print_rows

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.nonlinear import Made

# Values that are named of those that failed.
_NAMED = 5


class BranchName(StrEnum):
    """How a value is come to."""

    FRESH = "fresh"
    FORWARD = "forward"
    BACKWARD = "backward"


def bifurcation(
    context: typer.Context,
    scenario: ScenarioArgument,
    over: Annotated[str, typer.Option(metavar="KEY", help="Key of the scenario, as in --set.")],
    values: Annotated[
        str, typer.Option(metavar="A:B:N", help="N values from A to B, as '0 mm:0.9 mm:10', or a list A,B,C.")
    ],
    quantity: QuantityOption,
    section: SectionOption = "period",
    direction: DirectionOption = Direction.RISING,
    phase: PhaseOption = 0.0,
    branch: Annotated[
        list[BranchName] | None,
        typer.Option(
            help="fresh: each value from the scenario's start; forward, backward: from the end of the one"
            " before. May be repeated; fresh if left out."
        ),
    ] = None,
    count: CountOption = 100,
    transient: TransientOption = None,
    most: MostOption = None,
    tolerance: ToleranceOption = 1e-4,
    case: CaseOption = None,
    settings: SetOption = None,
    out: Annotated[Path, typer.Option(metavar="FILE", help="Dataset of the diagram, NAME.nc.")] = Path(
        "bifurcation.nc"
    ),
    plot: PlotOption = None,
    width: WidthOption = Width.PAGE,
    workers: Annotated[
        int | None, typer.Option(metavar="N", help="Runs made at a time; one for each core if left out.")
    ] = None,
    progress: Annotated[bool, typer.Option(help="Show a progress bar.")] = True,
) -> None:
    """Draw how the points of a section change over a parameter.

    What was interrupted or killed goes on with the same command.
    """
    targets = targets_of(out, plot)
    from antenna_pin.nonlinear import bifurcation as made
    from antenna_pin.plot import figure_bifurcation
    from antenna_pin.sweep import Standing

    loaded = load(scenario, case, settings)
    with study_bar(over, progress) as report:

        def tell(now: Made) -> None:
            if report is not None:
                report(Standing("run", now.done, now.count, 0))

        found = made(
            loaded,
            over,
            values_from(values),
            section_from(section, direction, phase),
            quantity,
            branches=[one.value for one in branch] if branch else ("fresh",),
            count=count,
            transient=transient,
            most=most,
            tolerance=tolerance,
            out=targets[0],
            workers=workers,
            progress=tell,
        )
    with not_interrupted():
        save_both(found, lambda: figure_bifurcation(found, width=width.value), targets, context)
        _print(found)


def _print(found: xr.Dataset) -> None:
    rows = []
    for name in found["branch"].values:
        one = found.sel(branch=name)
        settled = one["settled"].values
        there = one["points"].values > 0
        counts = (settled.sum(), (there & ~settled).sum(), (~there).sum(), one["transient"].values.max())
        rows.append([str(name), *(str(int(count)) for count in counts)])
    head = ["branch", "settled", "not settled", "failed", "most points cut"]
    print_rows(f"{found.attrs['parameter']}: {found.sizes['value']} values", head, rows)
    failed = [
        (float(value), str(found["message"].sel(branch=name).values[k]))
        for name in found["branch"].values
        for k, value in enumerate(found["value"].values)
        if not found["points"].sel(branch=name).values[k]
    ]
    for value, message in failed[:_NAMED]:
        say(f"note: {found.attrs['parameter']} = {value:.6g}: {message}")
    if len(failed) > _NAMED:
        say(f"note: {len(failed) - _NAMED} more failed; their messages are in the dataset")
