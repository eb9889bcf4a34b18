"""``antenna-pin bifurcation``: the settled points of a section over a parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import load, not_interrupted, refuse, say
from antenna_pin.apps.cli._export import save_both, targets_of
from antenna_pin.apps.cli._options import argument, option
from antenna_pin.apps.cli._progress import diagram_bar
from antenna_pin.apps.cli._tables import print_rows
from antenna_pin.apps.cli.poincare import (
    COUNT,
    DIRECTION,
    PHASE,
    QUANTITY,
    SECTION,
    TOLERANCE,
    Direction,
    MostOption,
    TransientOption,
)

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.scenario import Scenario
    from antenna_pin.studies.nonlinear import DiagramPlan

# Failed values whose messages are printed.
_NAMED = 5


class BranchName(StrEnum):
    """Starting point of each value."""

    FRESH = "fresh"
    FORWARD = "forward"
    BACKWARD = "backward"


def bifurcation(
    context: typer.Context,
    scenario: Annotated[
        str,
        argument(
            "Name of a shipped scenario, or path of a TOML file; or a diagram, NAME.diagram.toml or a"
            " shipped one as chen2021/friction, whose keys the options replace.",
            "SCENARIO|DIAGRAM",
        ),
    ],
    over: Annotated[str | None, option("Key of the scenario, as in --set.", "KEY")] = None,
    values: Annotated[
        str | None, option("Values, as '0 mm:0.9 mm:10', or a list with commas.", "FIRST:LAST:COUNT")
    ] = None,
    quantity: Annotated[list[str] | None, QUANTITY] = None,
    section: Annotated[str | None, SECTION] = None,
    direction: Annotated[Direction | None, DIRECTION] = None,
    phase: Annotated[float | None, PHASE] = None,
    branch: Annotated[
        list[BranchName] | None,
        option(
            "fresh: each value from the scenario's start; forward, backward: from the end of the one"
            " before. May be repeated; fresh if left out."
        ),
    ] = None,
    count: Annotated[int | None, COUNT] = None,
    transient: TransientOption = None,
    most: MostOption = None,
    tolerance: Annotated[float | None, TOLERANCE] = None,
    case: options.Case = None,
    settings: options.Set = None,
    out: Annotated[Path, option("Dataset of the diagram, NAME.nc.", "FILE")] = Path("bifurcation.nc"),
    plot: options.Plot = None,
    orbits: Annotated[
        list[Path] | None,
        option(
            "Saved branch of orbits over the same key ('orbit --over KEY --out FILE'), drawn over"
            " the points of the figure with its stability. May be repeated.",
            "FILE",
        ),
    ] = None,
    width: options.FigureWidth = options.Width.PAGE,
    workers: Annotated[
        int | None, option("Number of simultaneous runs; one for each core if left out.", "N")
    ] = None,
    progress: options.Progress = True,
) -> None:
    """Draw how the points of a section change over a parameter.

    The same command continues an interrupted or killed one.
    """
    targets = targets_of(out, plot)
    from antenna_pin.show.plot import figure_bifurcation
    from antenna_pin.studies.nonlinear import bifurcation as computed

    given = {
        "case": case,
        "parameter": over,
        "values": values,
        "quantities": quantity,
        "section": section,
        "direction": None if direction is None else direction.value,
        "phase": phase,
        "branches": [one.value for one in branch] if branch else None,
        "count": count,
        "transient": transient,
        "most": most,
        "tolerance": tolerance,
    }
    plan, loaded = _planned(scenario, given, settings)
    branches = [_orbits(path, plan) for path in orbits or ()]
    if branches and targets[1] is None:
        refuse("bifurcation: --orbits must be given with --plot, whose figure they lie over")
    with diagram_bar(plan.parameter, progress) as tell:
        how = {**plan.how(), "out": targets[0], "workers": workers, "progress": tell}
        found = computed(loaded, values=plan.argument_values(), **how)
    with not_interrupted():
        save_both(
            found,
            lambda: figure_bifurcation(found, orbits=branches, width=width.value),
            targets,
            context,
        )
        _print(found)


def _orbits(path: Path, plan: DiagramPlan) -> xr.Dataset:
    """Return a saved branch over a diagram's key, with points in the section."""
    from antenna_pin.studies.nonlinear import open_branch, orbits_in_section

    branch, how = open_branch(path), plan.how()
    key = branch.attrs["parameter"]
    if key != plan.parameter:
        refuse(f"{path}: --orbits must be over {plan.parameter}, as the diagram, got {key}")
    return orbits_in_section(branch, how["section"], how["quantities"])


def _planned(
    name: str, replaced: Mapping[str, Any], settings: Sequence[str] | None
) -> tuple[DiagramPlan, Scenario]:
    """Return the plan, from a diagram's file or from given, and the scenario."""
    from antenna_pin.studies.nonlinear import DiagramPlan, load_plan
    from antenna_pin.studies.nonlinear.diagram_plan import is_plan

    given = {key: value for key, value in replaced.items() if value is not None}
    if is_plan(name):
        plan = load_plan(name, given)
        return plan, plan.base(settings or ())
    for key, asked in (("parameter", "--over"), ("values", "--values"), ("quantities", "--quantity")):
        if key not in given:
            refuse(f"bifurcation: {asked} must be given; or name a diagram, as chen2021/friction")
    # What is wrong with the rest is said where it is used.
    return DiagramPlan.model_construct(scenario=name, **given), load(name, replaced["case"], settings)


def _print(diagram: xr.Dataset) -> None:
    from antenna_pin.analysis import diagram_verdicts, said_of_verdicts
    from antenna_pin.base.readable import prefixed

    rows = []
    for name in diagram["branch"].values:
        one = diagram.sel(branch=name)
        settled = one["settled"].values
        there = one["points"].values > 0
        counts = (settled.sum(), (there & ~settled).sum(), (~there).sum(), one["transient"].values.max())
        rows.append([str(name), *(str(int(count)) for count in counts)])
    head = ["branch", "settled", "not settled", "failed", "most points cut"]
    print_rows(f"{diagram.attrs['parameter']}: {diagram.sizes['value']} values", head, rows)
    numbers = diagram["value"].values.tolist()
    factor, unit = prefixed(str(diagram["value"].attrs.get("units", "")) or "1", numbers)
    values = [factor * value for value in numbers]
    for name in diagram["branch"].values:
        verdicts = diagram_verdicts(diagram, branch=str(name))
        for line in said_of_verdicts(values, verdicts, unit):
            say(f"{name}: {line}")
    failed = [
        (float(value), str(diagram["message"].sel(branch=name).values[k]))
        for name in diagram["branch"].values
        for k, value in enumerate(diagram["value"].values)
        if not diagram["points"].sel(branch=name).values[k]
    ]
    for value, message in failed[:_NAMED]:
        say(f"note: {diagram.attrs['parameter']} = {value:.6g}: {message}")
    if len(failed) > _NAMED:
        say(f"note: {len(failed) - _NAMED} more failed; their messages are in the dataset")
