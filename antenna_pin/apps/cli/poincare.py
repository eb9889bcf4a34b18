"""``antenna-pin poincare``: the points in which a motion returns to a section."""

from __future__ import annotations

import json
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import load, not_interrupted, say
from antenna_pin.apps.cli._export import csv_target, exported, save_both, targets_of
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._tables import print_rows

if TYPE_CHECKING:
    import xarray as xr


class Direction(StrEnum):
    """Direction of counted crossings."""

    RISING = "rising"
    FALLING = "falling"
    BOTH = "both"


SECTION = typer.Option(
    help="Section: period (of the drives), period=DRIVE, period='0.5 s',"
    " angle.JOINT=VALUE, rate.JOINT=VALUE, gap.CONTACT=VALUE or force.CONTACT=VALUE."
)
DIRECTION = typer.Option(help="Crossings of a surface that count.")
PHASE = typer.Option(help="Phase of the section in the period, from 0 to below 1.")
QUANTITY = typer.Option(
    "--quantity", "-q", metavar="NAME", help="Quantity at each point, such as 'v[hinge]'. May be repeated."
)
COUNT = typer.Option(metavar="N", help="Number of points, 32 or more.")
TOLERANCE = typer.Option(help="Settled: drift below this part of a quantity's largest value.")
TransientOption = Annotated[
    int | None, option("Points of the transient, which are cut; until they have settled if left out.", "N")
]
MostOption = Annotated[int | None, option("Largest transient; 20 times --count if left out.", "N")]


def poincare(
    context: typer.Context,
    scenario: options.Scenario,
    quantity: Annotated[list[str], QUANTITY],
    section: Annotated[str, SECTION] = "period",
    direction: Annotated[Direction, DIRECTION] = Direction.RISING,
    phase: Annotated[float, PHASE] = 0.0,
    count: Annotated[int, COUNT] = 100,
    transient: TransientOption = None,
    most: MostOption = None,
    tolerance: Annotated[float, TOLERANCE] = 1e-4,
    case: options.Case = None,
    settings: options.Set = None,
    out: options.Dataset = None,
    plot: options.Plot = None,
    width: options.FigureWidth = options.Width.COLUMN,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute the points in which a settled motion returns to a section.

    The run lasts until the motion has settled, whatever the scenario's duration.
    """
    table = csv_target(csv)
    targets = targets_of(out, plot)
    from antenna_pin.show.plot import figure_section
    from antenna_pin.studies.nonlinear import poincare as computed
    from antenna_pin.studies.nonlinear import section_of

    found = computed(
        load(scenario, case, settings),
        section_of(section, direction.value, phase),
        quantity,
        count=count,
        transient=transient,
        most=most,
        tolerance=tolerance,
    )
    with not_interrupted():
        save_both(found, lambda: figure_section(found, width=width.value), targets, context, silent=as_json)
        names = json.loads(found.attrs["quantities"])
        facts = {
            "settled": bool(found["settled"].item()),
            "transient": int(found["transient"].item()),
            "drift": float(found["drift"].item()),
            "outcome": found.attrs["outcome"],
            "message": found.attrs["message"],
            "section": found.attrs["section"],
            "time": found["time"].values.tolist(),
            **{name: found[name].values.tolist() for name in names},
        }
        columns = {"time [s]": found["time"], **{f"{n} [{found[n].units}]": found[n] for n in names}}
        rows = [
            {head: float(column.values[k]) for head, column in columns.items()}
            for k in range(found.sizes["point"])
        ]
        if not exported(facts, rows, as_json, table):
            _print(found, names)


def _print(section: xr.Dataset, names: list[str]) -> None:
    rows = []
    for name in names:
        values = section[name].values
        numbers = [f"{float(value):.6g}" for value in (values.min(), values.max(), values.mean(), values[-1])]
        rows.append([f"{name} [{section[name].units}]", *numbers])
    title = ", ".join(filter(None, (section.attrs["title"], section.attrs["case"], section.attrs["section"])))
    print_rows(title, ["quantity", "least", "largest", "mean", "last"], rows)
    kept = f"{section.sizes['point']} points from {float(section['time'].values[0]):.6g} s on"
    cut = f"behind {int(section['transient'].item())}"
    said = "settled" if section["settled"].item() else "NOT settled"
    say(f"{kept}, {cut}: {said}, drift {float(section['drift'].item()):.2g}")
    if section.attrs["outcome"] != "COMPLETED":
        say(f"note: {section.attrs['message']}")
