"""``antenna-pin stress``: contact stress of a run, PV of bushings, static safety of ball bearings."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_target, label_of, load_result, say
from antenna_pin.apps.cli._export import csv_target, exported, save_plot
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._tables import Columns, length_text, number_text, print_columns

if TYPE_CHECKING:
    from antenna_pin.analysis import ContactStress


def stress(
    file: options.Result,
    joint: Annotated[str | None, option("Clearance joint; all surfaces if left out.", "NAME")] = None,
    surfaces: Annotated[
        Path | None, option("TOML file of what the result does not hold: stops, teeth, edges.", "FILE")
    ] = None,
    yield_share: Annotated[
        float, option("Share of the yield limit that a pressure may reach (ECSS-E-ST-33-01C).")
    ] = 0.93,
    factor: Annotated[float, option("Factor on the pressure.")] = 1.0,
    conformal_above: Annotated[
        float, option("Half-width over radius above which a bore is conformal (Persson).")
    ] = 0.1,
    plot: Annotated[
        Path | None, option("Figure of the pressures: png, pdf or svg.", "FILE", "--plot")
    ] = None,
    width: options.FigureWidth = options.Width.PAGE,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Compute the contact stress of a run: pressure, width, shear, share of the yield limit.

    Of bores, sockets, flanges, stops, teeth and balls of bearings; PV of bushings. Nothing is simulated.
    """
    from antenna_pin.analysis import contact_stress, numbers_of_row, read_surfaces

    target, figure = csv_target(csv), figure_target(plot, "stress", "--plot")
    given = None if surfaces is None else read_surfaces(surfaces)
    run = load_result(file)
    found = contact_stress(
        run,
        joint=joint,
        surfaces=given,
        yield_share=yield_share,
        factor=factor,
        conformal_above=conformal_above,
    )
    rows = [numbers_of_row(one) for one in found.surfaces]
    facts: dict[str, Any] = {
        "file": str(file),
        "yield_share": yield_share,
        "factor": factor,
        "conformal_above": conformal_above,
        "surfaces": rows,
        "bushings": [numbers_of_row(one) for one in found.bushings],
        "bearings": [numbers_of_row(one) for one in found.bearings],
        "notes": list(found.notes),
    }
    if not exported(facts, rows, as_json, target):
        _print(found, label_of(run, file))
    if figure is not None:
        from antenna_pin.show.plot import figure_contact_stress

        case = run.data.attrs.get("case") or "run"
        save_plot(figure_contact_stress(found, case=case, width=width.value), figure, as_json)


_MET: Columns = {
    "": lambda one: one.place,
    "pressure [MPa]": lambda one: _mega(one.pressure),
    "force [N]": lambda one: number_text(one.force),
    "at [s]": lambda one: number_text(one.time),
    "half-width": lambda one: length_text(one.half_width),
    "shear [MPa]": lambda one: _mega(one.shear),
    "at depth": lambda one: length_text(one.shear_depth),
    "limit [MPa]": lambda one: _mega(one.limit),
    "share of limit": lambda one: _plain(one.share),
    "margin": lambda one: _plain(one.margin),
}
_ALONG: Columns = {
    "": lambda one: one.place,
    "largest / mean load": lambda one: _plain(one.line_load_ratio),
    "at, along the axis": lambda one: length_text(one.along),
    "length that touches": lambda one: length_text(one.loaded_length),
    "edge loaded": lambda one: "yes" if one.edge_loaded else "no",
}
_BUSHINGS: Columns = {
    "bushing": lambda one: one.joint,
    "pressure [MPa]": lambda one: _mega(one.pressure),
    "speed [m/s]": lambda one: _plain(one.speed),
    "PV [MPa m/s]": lambda one: _mega(one.pv),
    "at [s]": lambda one: number_text(one.time),
    "mean PV [MPa m/s]": lambda one: _mega(one.mean_pv),
    "limit [MPa m/s]": lambda one: _mega(one.limit),
    "share of limit": lambda one: _plain(one.share),
}
_BEARINGS: Columns = {
    "bearing": lambda one: one.place,
    "ball load [N]": lambda one: number_text(one.ball_load),
    "ball": lambda one: str(one.ball),
    "at [s]": lambda one: number_text(one.time),
    "pressure [MPa]": lambda one: _mega(one.pressure),
    "s0": lambda one: _plain(one.static_factor),
    "C0r of a row [N]": lambda one: number_text(one.radial_rating),
    "C0a of a row [N]": lambda one: number_text(one.axial_rating),
}


def _print(result: ContactStress, label: str) -> None:
    """Print tables of surfaces, bushings and bearings, and the notes."""
    met = [one for one in result.surfaces if one.force > 0.0]
    if met:
        rule = f"margin = {result.yield_share:g} limit / ({result.factor:g} pressure) - 1"
        print_columns(f"{label}: contact stress at its peak; {rule}", met, _MET)
    else:
        say(f"{label}: no surface with a known geometry has met another")
    if lines := [one for one in met if math.isfinite(one.line_load_ratio)]:
        title = "bores: load along the line at that peak, from the middle of the bore"
        print_columns(title, lines, _ALONG)
    said: dict[str, list[str]] = {}
    for one in met:
        theory = one.theory + (f"; limit of {one.material}" if math.isfinite(one.limit) else "")
        for line in (theory, *one.notes):
            said.setdefault(line, []).append(one.place)
    for line, places in said.items():
        say(f"{', '.join(places)}: {line}")
    if silent := [one.place for one in result.surfaces if not one.force > 0.0]:
        say(f"never touched: {', '.join(silent)}")
    if result.bushings:
        title = "bushings: mean pressure F / (L D), largest sliding speed, their product"
        print_columns(title, result.bushings, _BUSHINGS)
    if result.bearings:
        title = "ball bearings: static safety s0 by the pressure of 4200 MPa that ISO 76 permits"
        print_columns(title, result.bearings, _BEARINGS)
        for ball in result.bearings:
            for note in ball.notes:
                say(f"{ball.place}: {note}")
    for note in result.notes:
        say(note)


def _mega(value: float) -> str:
    return _plain(1e-6 * value)


def _plain(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else "-"
