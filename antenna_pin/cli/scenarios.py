"""``antenna-pin contact scenarios``: which pairs of radial and axial contact a joint's shape allows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.base.numerals import bare
from antenna_pin.cli._export import CsvOption, JsonOption, csv_target, exported
from antenna_pin.cli._quantities import clearance_of, positive_quantity
from antenna_pin.cli._tables import length_text, print_rows

if TYPE_CHECKING:
    from antenna_pin.analysis import ScenarioPair


def scenarios(
    bearing_radius: Annotated[str, typer.Option(help="Radius of the bearing.")] = "10 mm",
    radial_clearance: Annotated[str, typer.Option(help="Bearing radius minus journal radius.")] = "0.2 mm",
    bearing_length: Annotated[str, typer.Option(help="Length of the bearing.")] = "50 mm",
    axial_clearance: Annotated[
        str, typer.Option(help="Half of what the flanges' distance exceeds the bearing's length by.")
    ] = "0.2 mm",
    bearing_outer_radius: Annotated[str, typer.Option(help="Outer radius of the bearing.")] = "12 mm",
    flange_radius: Annotated[str, typer.Option(help="Radius of the journal's flanges.")] = "14 mm",
    penetration: Annotated[
        str, typer.Option(help="Largest depth at any contact; 0 for rigid parts.")
    ] = "0 mm",
    as_json: JsonOption = False,
    csv: CsvOption = None,
) -> None:
    """Say which of the 16 contact scenarios a joint's shape allows, each with a pose or a reason."""
    from antenna_pin.analysis import SCENARIO_COLUMNS, possible_scenarios, scenario_rows
    from antenna_pin.base.units import quantity
    from antenna_pin.geometry import RevoluteClearance

    target = csv_target(csv)
    radius = positive_quantity(bearing_radius, "m", "--bearing-radius")
    length = positive_quantity(bearing_length, "m", "--bearing-length")
    clearance = clearance_of(radial_clearance, radius, "contact scenarios")
    shape = RevoluteClearance(
        bearing_radius=radius,
        journal_radius=radius - clearance,
        bearing_length=length,
        flange_distance=length + 2.0 * positive_quantity(axial_clearance, "m", "--axial-clearance"),
        bearing_outer_radius=positive_quantity(bearing_outer_radius, "m", "--bearing-outer-radius"),
        flange_radius=positive_quantity(flange_radius, "m", "--flange-radius"),
    )
    depth = quantity(bare(penetration), "m", "--penetration")
    pairs = possible_scenarios(shape, depth)
    found = [_pair(pair) for pair in pairs]
    if exported({"penetration": depth, "scenarios": found}, found, as_json, target):
        return
    parts = f"parts that penetrate by up to {length_text(depth)}" if depth > 0.0 else "rigid parts"
    print_rows(f"contact scenarios of {parts}", SCENARIO_COLUMNS, scenario_rows(pairs), numbers=False)
    typer.echo(f"{sum(pair.possible for pair in pairs)} of {len(pairs)} are possible")


def _pair(pair: ScenarioPair) -> dict[str, Any]:
    """Return a pair of scenarios in plain values [m], [rad]."""
    names = {"radial": pair.radial.name.lower(), "axial": pair.axial.name.lower(), "possible": pair.possible}
    low, high = (pair.tilts.low, pair.tilts.high) if pair.possible else (None, None)
    centre, axis = (None, None) if pair.pose is None else (each.tolist() for each in pair.pose)
    pose = {"least_tilt": low, "largest_tilt": high, "centre": centre, "axis": axis}
    return names | pose | {"reason": pair.reason}
