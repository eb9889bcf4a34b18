"""``antenna-pin stress``: contact stress of a run, PV of bushings, static safety of ball bearings."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_target, label_of, load_result, say
from antenna_pin.apps.cli._export import csv_target, exported, save_plot
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._tables import length_text, number_text, print_rows

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


def _print(result: ContactStress, label: str) -> None:
    """Print tables of surfaces, bushings and bearings, and the notes."""
    met = [one for one in result.surfaces if one.force > 0.0]
    head = [
        "",
        "pressure [MPa]",
        "force [N]",
        "at [s]",
        "half-width",
        "shear [MPa]",
        "at depth",
        "limit [MPa]",
    ]
    head += ["share of limit", "margin"]
    rows = [
        [
            one.place,
            _mega(one.pressure),
            number_text(one.force),
            number_text(one.time),
            length_text(one.half_width),
            _mega(one.shear),
            length_text(one.shear_depth),
            _mega(one.limit),
            _plain(one.share),
            _plain(one.margin),
        ]
        for one in met
    ]
    if not met:
        say(f"{label}: no surface with a known geometry has met another")
    rule = f"margin = {result.yield_share:g} limit / ({result.factor:g} pressure) - 1"
    if met:
        print_rows(f"{label}: contact stress at its peak; {rule}", head, rows)
    if lines := [one for one in met if math.isfinite(one.line_load_ratio)]:
        head = ["", "largest / mean load", "at, along the axis", "length that touches", "edge loaded"]
        rows = [
            [
                one.place,
                _plain(one.line_load_ratio),
                length_text(one.along),
                length_text(one.loaded_length),
                "yes" if one.edge_loaded else "no",
            ]
            for one in lines
        ]
        print_rows("bores: load along the line at that peak, from the middle of the bore", head, rows)
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
        head = ["bushing", "pressure [MPa]", "speed [m/s]", "PV [MPa m/s]", "at [s]", "mean PV [MPa m/s]"]
        head += ["limit [MPa m/s]", "share of limit"]
        rows = [
            [
                bush.joint,
                _mega(bush.pressure),
                _plain(bush.speed),
                _mega(bush.pv),
                number_text(bush.time),
                _mega(bush.mean_pv),
                _mega(bush.limit),
                _plain(bush.share),
            ]
            for bush in result.bushings
        ]
        print_rows("bushings: mean pressure F / (L D), largest sliding speed, their product", head, rows)
    if result.bearings:
        head = ["bearing", "ball load [N]", "ball", "at [s]", "pressure [MPa]", "s0", "C0r of a row [N]"]
        head += ["C0a of a row [N]"]
        rows = [
            [
                ball.place,
                number_text(ball.ball_load),
                str(ball.ball),
                number_text(ball.time),
                _mega(ball.pressure),
                _plain(ball.static_factor),
                number_text(ball.radial_rating),
                number_text(ball.axial_rating),
            ]
            for ball in result.bearings
        ]
        print_rows(
            "ball bearings: static safety s0 by the pressure of 4200 MPa that ISO 76 permits", head, rows
        )
        for ball in result.bearings:
            for note in ball.notes:
                say(f"{ball.place}: {note}")
    for note in result.notes:
        say(note)


def _mega(value: float) -> str:
    return _plain(1e-6 * value)


def _plain(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else "-"
