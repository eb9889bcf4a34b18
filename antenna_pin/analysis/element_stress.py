"""Contact stress of stops, gears and the balls of bearings."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import floats
from antenna_pin.analysis.stress_results import BearingRating, SurfaceStress
from antenna_pin.analysis.surface_file import FlankSurface, StopSurface
from antenna_pin.analysis.surface_stress import ForcePeak, Pair, StressCriteria, Stresses, surface_of
from antenna_pin.base.arrays import Array
from antenna_pin.contact.pressure import ISO76_PRESSURE, hertz_line, hertz_point, point_shear, static_rating
from antenna_pin.elements import BallBearing
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import elements_of, is_lean, mesh_touches, touches


def stop_stress(
    data: xr.Dataset, name: str, surface: StopSurface, pair: Pair, limits: StressCriteria
) -> SurfaceStress:
    """Return the stress of a stop, whose surface is given.

    Raises:
        InvalidParameterError: A lever is missing at a joint that turns, or given at one that slides.
    """
    place = f"stops.{name}"
    slides = bool(elements_of(data)[place]["slides"])
    if slides != (surface.lever is None):
        rule = (
            "left out: the joint slides" if slides else "given: the joint turns, and a lever makes the force"
        )
        raise InvalidParameterError(
            place, "lever", rule, surface.lever, said="none" if surface.lever is None else ""
        )
    peak, effort = _peak_effort(data, place, [one for one in touches(data) if one.stop == place])
    arm = surface.lever or 1.0
    notes = (
        [] if math.isfinite(peak.force) else ["a rigid stop's blow has an impulse and no force: no pressure"]
    )
    curvature = 1.0 / surface.radius - (1.0 / surface.hollow_radius if surface.hollow_radius else 0.0)

    def line(force: Array) -> Stresses:
        assert surface.length is not None
        found = hertz_line(force / surface.length, curvature, pair.modulus)
        half = np.full_like(found.pressure, 0.5 * surface.length)
        return Stresses(found.pressure, found.half_width, half, found.shear, found.shear_depth)

    def point(force: Array) -> Stresses:
        found = hertz_point(force, curvature, curvature, pair.modulus, pair.poisson)
        return Stresses(found.pressure, found.half_width, found.half_length, found.shear, found.shear_depth)

    theory, of = ("Hertz, point", point) if surface.length is None else ("Hertz, line", line)
    theory += " on a flat" if surface.hollow_radius is None else " in a hollow"
    return _row(place, "stop", theory, pair, limits, peak, effort, 1.0 / arm, of, notes)


def flank_stress(
    data: xr.Dataset, name: str, surface: FlankSurface, pair: Pair, ratio_side: str, limits: StressCriteria
) -> SurfaceStress:
    """Return the stress of gears or a rack, as cylinders at the pitch point.

    One pair of teeth carries all of the force, along the whole width; no factor of application, dynamics or
    load distribution is in it.

    The torque is recorded on ``ratio_side``: ``input`` or ``output``.
    """
    place = f"gears.{name}"
    about = elements_of(data)[place]
    rack = bool(about["slides"])
    if rack != (surface.output_radius is None):
        rule = "left out of a rack" if rack else "given: both gears have a pitch radius"
        raise InvalidParameterError(
            place,
            "output_radius",
            rule,
            surface.output_radius,
            said="none" if surface.output_radius is None else "",
        )
    if about["kind"] not in ("Gear", "Rack"):
        raise InvalidParameterError(place, "surface", "that of gears or a rack with flanks", about["kind"])
    peak, effort = _peak_effort(data, place, [one for one in mesh_touches(data) if one.stop == place])
    angle = surface.pressure_angle
    radius = (
        1.0
        if rack
        else (surface.input_radius if ratio_side == "input" else surface.output_radius or math.nan)
    )
    curvature = (
        1.0 / surface.input_radius + (0.0 if rack else 1.0 / (surface.output_radius or math.nan))
    ) / math.sin(angle)

    def line(force: Array) -> Stresses:
        found = hertz_line(force / surface.width, curvature, pair.modulus)
        half = np.full_like(found.pressure, 0.5 * surface.width)
        return Stresses(found.pressure, found.half_width, half, found.shear, found.shear_depth)

    notes = ["one pair of teeth at the pitch point carries all; factors of ISO 6336 are not in it"]
    scale = 1.0 / (radius * math.cos(angle))
    return _row(
        place, "flank", "Hertz, line at the pitch point", pair, limits, peak, effort, scale, line, notes
    )


def _row(
    place: str,
    surface: str,
    theory: str,
    pair: Pair,
    limits: StressCriteria,
    peak: ForcePeak,
    effort: Array,
    scale: float,
    of: Callable[[Array], Stresses],
    notes: list[str],
) -> SurfaceStress:
    own = ForcePeak(peak.force * scale, peak.time)
    if not math.isfinite(own.force):
        nothing = np.full(1, math.nan)
        stress = Stresses(*(nothing,) * 5)
        return surface_of(place, surface, "none", pair, limits, own, stress, np.zeros(0), notes)
    stress = of(np.array([own.force]))
    history = of(effort * scale).pressure if effort.size else np.zeros(0)
    return surface_of(place, surface, theory, pair, limits, own, stress, history, notes)


def _peak_effort(data: xr.Dataset, place: str, met: list[Any]) -> tuple[ForcePeak, Array]:
    """Return the largest effort of an element and its sizes at the samples."""
    effort = np.zeros(0)
    force, time = 0.0, math.nan
    if not is_lean(data):
        own = floats(data["time"])
        effort = np.abs(floats(data["element_effort"].sel(element=place)))
        if effort.size and effort.max() > 0.0:
            force, time = float(effort.max()), float(own[np.argmax(effort)])
    for one in met:
        if one.peak_effort > force:
            force, time = one.peak_effort, one.onset
    return ForcePeak(force, time), effort


# --- ball bearings ------------------------------------------------------------------------------------------


def bearing_stress(
    data: xr.Dataset, name: str, bearing: BallBearing
) -> tuple[list[SurfaceStress], BearingRating]:
    """Return the stress on both raceways, and the static safety of a ball bearing.

    The load of each ball follows from the journal's recorded place and tilt, as ``by = "balls"`` has it.
    """
    place = f"bearings.{name}"
    time = floats(data["time"])
    centre = floats(data["bearing_place"].sel(bearing=name))
    tilt = floats(data["bearing_tilt"].sel(bearing=name))
    loads = ball_loads(bearing, centre, tilt)
    sample, ball = (int(one) for one in np.unravel_index(int(np.argmax(loads)), loads.shape))
    load = float(loads[sample, ball])
    notes = ["quasi-static: no centrifugal force; without clearance or misfit of the rings"]
    if bearing.by == "linear":
        notes.append(
            'the run took the stiffness at the preload (by = "linear"); loads of balls follow from place and '
            "tilt"
        )
    rows = []
    limits = StressCriteria(yield_share=1.0, factor=1.0, conformal_above=math.inf)
    for raceway, ellipse in zip(("inner", "outer"), bearing.ellipses, strict=True):
        share, depth = point_shear(ellipse.half_width / ellipse.half_length, bearing.poisson)
        cube = np.cbrt(loads.max(axis=1))
        history = 1.5 * cube / (math.pi * ellipse.half_length * ellipse.half_width)
        pressure, peak = float(history[sample]), float(cube[sample])
        rows.append(
            SurfaceStress(
                place=f"{place}.{raceway}",
                surface="raceway",
                theory="Hertz, ellipse of a ball in a groove",
                time=float(time[sample]),
                force=load,
                pressure=pressure,
                half_width=ellipse.half_width * peak,
                half_length=ellipse.half_length * peak,
                shear=share * pressure,
                shear_depth=depth * ellipse.half_width * peak,
                material="ISO 76",
                limit=ISO76_PRESSURE,
                share=pressure / ISO76_PRESSURE,
                margin=limits.yield_share * ISO76_PRESSURE / pressure - 1.0 if pressure else math.inf,
                notes=("limit of ISO 76 in the middle of the contact, no yield limit",),
                history=history,
            )
        )
    permitted = bearing.ball_limit
    radial, axial = static_rating(bearing.count, bearing.contact_angle, permitted)
    rating = BearingRating(
        place=place,
        radial_rating=radial,
        axial_rating=axial,
        ball_load=load,
        ball=ball + 1,
        time=float(time[sample]),
        pressure=max(row.pressure for row in rows),
        static_factor=permitted / load if load else math.inf,
        loads=loads,
        notes=tuple(notes),
    )
    return rows, rating


def ball_loads(bearing: BallBearing, place: Array, tilt: Array) -> Array:
    """Return the load of each ball [N], (samples, balls).

    The journal's places are at the reference point, in bearing axes, (samples, 3) [m]; tilts are z x axis,
    (samples, 2 or 3) [-].
    """
    balls = bearing.balls()
    cosine, sine, height, radius, off, along, rest, hertz = balls.T
    x, y, z = (column[:, np.newaxis] for column in place.T[:3])
    lean = cosine * tilt[:, 1:2] - sine * tilt[:, 0:1]
    way = np.hypot(off + cosine * x + sine * y + height * lean, along + z - radius * lean)
    depth = np.maximum(way - rest, 0.0)
    loads: Array = hertz * depth**1.5
    return loads
