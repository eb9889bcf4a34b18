"""Figures of contact stress over time, and of play over temperature."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from antenna_pin.analysis import ContactStress
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario import JointPlay
from antenna_pin.show.plot._style import Width
from antenna_pin.show.plot.grammar import Axis, Panel, PlotCurve, PlotMark, Points, Rule, Sheet, figure

# Surfaces that a panel shows at most, those with the largest pressures.
_MOST = 6
# Largest over mean load of a line, from which on its pressure is drawn along the bore.
_TILTED = 1.01


@figure(stress="Contact stress of a run.", case="Name of the run's case, for the foot note.")
def figure_contact_stress(stress: ContactStress, *, case: str = "run", width: Width = "page") -> Sheet:
    """Return contact pressures over time and along bores, and PV of bushings."""
    met = [one for one in stress.surfaces if one.history.size and np.nanmax(one.history, initial=0.0) > 0.0]
    if not met:
        raise InvalidParameterError(
            "figure_contact_stress", "stress", "that of a run with samples in which surfaces met", said="none"
        )
    shown = sorted(met, key=lambda one: -one.pressure)[:_MOST]
    # Balls press a hundred times harder than bores: a panel, and limits, of their own.
    kinds = [
        (title, [(k, one) for k, one in enumerate(shown) if (one.surface == "raceway") is raceway])
        for title, raceway in (("contact pressure", False), ("contact pressure of balls", True))
    ]
    rows: list[list[Panel | None]] = []
    grey = False
    for title, mine in kinds:
        if not mine:
            continue
        marks: list[PlotMark] = [
            PlotCurve(one.place, stress.time, one.history, {"color": f"C{k}"}) for k, one in mine
        ]
        marks += [
            Points(np.array([[one.time, one.pressure]]), {"color": f"C{k}"})
            for k, one in mine
            if math.isfinite(one.time)
        ]
        largest = max(one.pressure for _, one in mine)
        limits = {
            stress.yield_share / stress.factor * one.limit for _, one in mine if one.surface != "raceway"
        }
        near = [limit for limit in sorted(limits) if limit < 3.0 * largest]
        marks += [Rule(limit, {"color": "#999999", "linewidth": 0.8}) for limit in near]
        grey = grey or bool(near)
        rows.append([Panel(title, marks, Axis("pressure", "Pa"))])
    tilted = [(k, one) for k, one in enumerate(shown) if one.line_load_ratio > _TILTED]
    if tilted:
        curves = [
            PlotCurve(one.place, 1e3 * one.places, one.profile, {"color": f"C{k}"}) for k, one in tilted
        ]
        along = Axis("along the bore's axis [mm]")
        rows.append([Panel("along the bore at its peak", curves, Axis("pressure", "Pa"), along, named=False)])
    if stress.bushings:
        curves = [
            PlotCurve(one.joint, stress.time, one.history, {"color": f"C{k}"})
            for k, one in enumerate(stress.bushings, start=len(shown))
        ]
        names = ", ".join(one.joint for one in stress.bushings)
        title = f"PV of {names}" if len(stress.bushings) == 1 else "PV of bushings"
        panel = Panel(title, curves, Axis("pressure times speed", "Pa m/s"), named=len(stress.bushings) > 1)
        rows.append([panel])
    notes = [f"{case}: dots, peaks between samples too"]
    if len(met) > len(shown):
        notes.append(f"of {len(met)} surfaces the {len(shown)} with the largest pressures")
    if grey:
        notes.append(f"grey: {stress.yield_share:g} of the yield limit over a factor of {stress.factor:g}")
    return Sheet(rows, width, 55.0 * len(rows) + 10.0, notes)


@figure(plays="Plays of each joint, by name, one a temperature of all parts.")
def figure_play_over_temperature(plays: Mapping[str, Sequence[JointPlay]], *, width: Width = "page") -> Sheet:
    """Return the radial play of joints over a temperature of all parts.

    Of a fit also the plays of its extreme sizes, as thin lines.
    """
    if not plays:
        rule = "those of a joint with play at least"
        raise InvalidParameterError("figure_play_over_temperature", "plays", rule, said="none")
    marks: list[PlotMark] = []
    for k, (name, several) in enumerate(plays.items()):
        degrees = np.array([one.bearing_temperature - 273.15 for one in several])
        radial = np.array([one.radial for one in several])
        marks.append(PlotCurve(name, degrees, radial, {"color": f"C{k}"}))
        fit = several[0].fit
        if fit is not None:
            grown = radial - several[0].reference
            marks += [
                PlotCurve("", degrees, end + grown, {"color": f"C{k}", "linewidth": 0.6})
                for end in (fit.least, fit.largest)
            ]
    marks.append(Rule(0.0))
    panel = Panel("radial play", marks, Axis("radial play", "m"), Axis("temperature of all parts [°C]"))
    fits = any(several[0].fit is not None for several in plays.values())
    return Sheet([[panel]], width, 70.0, ["thin: least and largest play of a fit"] if fits else [])
