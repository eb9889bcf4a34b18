"""``antenna-pin poincare``: the points in which a motion returns to a section."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

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
from antenna_pin.cli._export import CsvOption, JsonOption, csv_target, exported
from antenna_pin.cli._saved import PlotOption, TableOption, save_both, targets_of
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
)
from antenna_pin.cli._tables import print_rows

if TYPE_CHECKING:
    import xarray as xr


def poincare(
    context: typer.Context,
    scenario: ScenarioArgument,
    quantity: QuantityOption,
    section: SectionOption = "period",
    direction: DirectionOption = Direction.RISING,
    phase: PhaseOption = 0.0,
    count: CountOption = 100,
    transient: TransientOption = None,
    most: MostOption = None,
    tolerance: ToleranceOption = 1e-4,
    case: CaseOption = None,
    settings: SetOption = None,
    out: TableOption = None,
    plot: PlotOption = None,
    width: WidthOption = Width.COLUMN,
    as_json: JsonOption = False,
    csv: CsvOption = None,
) -> None:
    """Say in which points a motion returns to a section, once it has settled.

    The scenario is run for as long as that takes, whatever its duration.
    """
    table = csv_target(csv)
    targets = targets_of(out, plot)
    from antenna_pin.nonlinear import poincare as returned
    from antenna_pin.plot import figure_section

    found = returned(
        load(scenario, case, settings),
        section_from(section, direction, phase),
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


def _print(found: xr.Dataset, names: list[str]) -> None:
    rows = []
    for name in names:
        values = found[name].values
        numbers = [f"{float(value):.6g}" for value in (values.min(), values.max(), values.mean(), values[-1])]
        rows.append([f"{name} [{found[name].units}]", *numbers])
    title = ", ".join(filter(None, (found.attrs["title"], found.attrs["case"], found.attrs["section"])))
    print_rows(title, ["quantity", "least", "largest", "mean", "last"], rows)
    kept = f"{found.sizes['point']} points from {float(found['time'].values[0]):.6g} s on"
    cut = f"behind {int(found['transient'].item())}"
    said = "settled" if found["settled"].item() else "NOT settled"
    say(f"{kept}, {cut}: {said}, drift {float(found['drift'].item()):.2g}")
    if found.attrs["outcome"] != "COMPLETED":
        say(f"note: {found.attrs['message']}")
