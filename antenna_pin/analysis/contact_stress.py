"""Stress where surfaces meet, from a result that exists.

Forces are the run's; pressure, width and shear follow from them, from the geometry and from the materials
alone (:mod:`antenna_pin.contact.pressure`). A contact law takes no part, except that it shares a distributed
load out, so a note tells where its stiffness contradicts the geometry: the force of an impact then is that of
the law's stiffness, and so is the pressure.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import choose, floats
from antenna_pin.analysis.joint_stress import bushing_load, joint_surfaces
from antenna_pin.analysis.journal import clearance_shapes
from antenna_pin.analysis.stress_results import BearingRating, BushingLoad, ContactStress, SurfaceStress
from antenna_pin.analysis.surface_file import FlankSurface, JointSurface, StopSurface, SurfaceFile
from antenna_pin.analysis.surface_stress import ForcePeak, Pair, StressCriteria, Stresses, surface_of
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.rules import Positive, PositiveOrInfinite
from antenna_pin.contact import MATERIALS, Material
from antenna_pin.contact.pressure import ISO76_PRESSURE, hertz_line, hertz_point, point_shear, static_rating
from antenna_pin.elements import BallBearing
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.merge import key_parts
from antenna_pin.trajectory import Trajectory, elements_of, is_lean, mesh_touches, names_along, touches


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


@takes()
def contact_stress(
    run: Trajectory,
    *,
    joint: str | None = None,
    surfaces: SurfaceFile | None = None,
    yield_share: Positive = 0.93,
    factor: Positive = 1.0,
    conformal_above: PositiveOrInfinite = 0.1,
) -> ContactStress:
    """Return the contact stress of a finished run, surface by surface.

    Bores are lines: Hertz's while the half-width at the peak is small beside the radius, else Persson's
    conformal contact; balls in sockets, corners and stops are points or lines, flanges flat rings, gears'
    flanks lines at the pitch point, balls of bearings ellipses on both raceways.

    Args:
        run: A run, with its scenario, which names the materials.
        joint: Name of a clearance joint, whose surfaces alone are computed; all surfaces if left out.
        surfaces: What the result does not hold (:func:`antenna_pin.analysis.read_surfaces`).
        yield_share: Share of the yield limit of the weaker material that a peak pressure may reach [-];
            0.93 of separable surfaces, ECSS-E-ST-33-01C (2009).
        factor: Factor on the pressure [-].
        conformal_above: Half-width over radius above which a bore is conformal [-].

    Raises:
        UnknownNameError: There is no such joint, material, stop or gear.
        InvalidParameterError: A share or factor is not positive.
    """
    data, described = run.data, surfaces or SurfaceFile()
    limits = StressCriteria(yield_share=yield_share, factor=factor, conformal_above=conformal_above)
    known = _materials(described, run.scenario)
    joints = choose("contact_stress", "clearance joint", joint, names_along(data, "clearance_joint"))
    _check_names(data, described)
    rows: list[SurfaceStress] = []
    bushings: list[BushingLoad] = []
    bearings: list[BearingRating] = []
    notes: list[str] = []
    for name in joints:
        own = described.joints.get(name, JointSurface())
        pair = _pair_of_joint(run, name, own, known)
        length = own.length or _length(run, name)
        rows += joint_surfaces(data, name, pair, own, length, limits)
        if length is not None and clearance_shapes(data)[name]["kind"] in ("revolute", "planar"):
            found = bushing_load(data, name, length, own.pv_limit)
            bushings += [found] if found is not None else []
    if joint is None:
        rows += _elements(run, described, known, limits, notes)
        more, bearings = _bearings(run, notes)
        rows += more
    return ContactStress(
        surfaces=tuple(rows),
        bushings=tuple(bushings),
        bearings=tuple(bearings),
        time=np.zeros(0) if is_lean(data) else floats(data["time"]),
        yield_share=yield_share,
        factor=factor,
        notes=tuple(notes),
    )


def _materials(described: SurfaceFile, scenario: Scenario | None) -> Callable[[str], Material]:
    """Return a function that finds a material by name: described, of the scenario, shipped."""

    def known(name: str) -> Material:
        if name in described.materials:
            made: Material = described.materials[name].build()
            return made
        if scenario is not None:
            return _at_temperature(scenario, name)
        if name not in MATERIALS:
            raise UnknownNameError("contact_stress", "material", name, {*described.materials, *MATERIALS})
        return MATERIALS[name]

    return known


def _at_temperature(scenario: Scenario, name: str) -> Material:
    """Return a material of a scenario with the numbers that tables give at its temperatures."""
    found, spec = scenario.material(name), scenario.temperature
    for table in () if spec is None else spec.tables.values():
        parts = key_parts(table.key)
        if spec is None or parts[:2] != ["materials", name] or len(parts) != 3:
            continue
        value = table.at(spec.of(table.part))
        if value is not None:
            own = float(getattr(found, parts[2])) if table.factor is not None else 1.0
            change: dict[str, Any] = {parts[2]: value * own}
            found = replace(found, **change)
    return found


def _pair_of_joint(run: Trajectory, joint: str, own: JointSurface, known: Callable[[str], Material]) -> Pair:
    """Return the materials of a joint; of a law with its own modulus that alone."""
    names: tuple[str | None, str | None] = (own.bearing_material, own.journal_material)
    spec = None if run.scenario is None else run.scenario.clearance.get(joint)
    of_spec = getattr(spec, "materials", (None, None))
    bearing, journal = (one or other for one, other in zip(names, of_spec, strict=True))
    if bearing is not None and journal is not None:
        return Pair.of(bearing, journal, known)
    for facts in clearance_shapes(run.data)[joint]["contacts"].values():
        modulus = facts["normal_law"].get("parameters", {}).get("modulus")
        if modulus is not None:
            return Pair(names=(), materials=(), modulus=float(modulus[0]))
    return Pair(names=(), materials=(), modulus=math.nan)


def _length(run: Trajectory, joint: str) -> float | None:
    """Return the length of a joint's line of contact [m]; None if unknown."""
    about = clearance_shapes(run.data)[joint]
    size: Mapping[str, Any] = about["dimensions"]
    if about["kind"] == "revolute":
        return float(size["bearing_length"])
    if about["kind"] == "cylindrical":
        return float(size["slider_length"])
    if about["kind"] != "planar":
        return None
    spec = None if run.scenario is None else run.scenario.clearance.get(joint)
    if spec is not None and spec.bearing_length is not None:
        return float(spec.bearing_length)
    for facts in about["contacts"].values():
        length = facts["normal_law"].get("parameters", {}).get("length")
        if length is not None:
            return float(length[0])
    return None


def _check_names(data: xr.Dataset, described: SurfaceFile) -> None:
    """Refuse surfaces of what the run does not have."""
    places = elements_of(data)
    for what, table, names in (
        ("clearance joint", described.joints, names_along(data, "clearance_joint")),
        ("stop", described.stops, [one.partition(".")[2] for one in places if one.startswith("stops.")]),
        ("gear", described.gears, [one.partition(".")[2] for one in places if one.startswith("gears.")]),
    ):
        for name in table:
            if name not in names:
                raise UnknownNameError("contact_stress", what, name, names)


def _elements(
    run: Trajectory,
    described: SurfaceFile,
    known: Callable[[str], Material],
    limits: StressCriteria,
    notes: list[str],
) -> list[SurfaceStress]:
    """Return stops and gears whose surfaces are given; add what is without to the notes."""
    rows = []
    for place, about in elements_of(run.data).items():
        family, _, name = place.partition(".")
        if family == "stops" and name in described.stops:
            surface = described.stops[name]
            rows.append(stop_stress(run.data, name, surface, Pair.of(*surface.materials, known), limits))
        elif family == "gears" and name in described.gears:
            teeth = described.gears[name]
            side = (
                "output"
                if run.scenario is None
                else str(getattr(_table(run, "gears", name), "side", "output"))
            )
            rows.append(flank_stress(run.data, name, teeth, Pair.of(*teeth.materials, known), side, limits))
        elif family == "stops" or about["kind"] in ("Gear", "Rack"):
            notes.append(f"{place}: no surface is given; [{place}] of a file of surfaces describes it")
    return rows


def _table(run: Trajectory, family: str, name: str) -> Any:
    assert run.scenario is not None
    return run.scenario.families.get(family, {}).get(name)


def _bearings(run: Trajectory, notes: list[str]) -> tuple[list[SurfaceStress], list[BearingRating]]:
    """Return stress and ratings of the ball bearings whose balls are known."""
    rows: list[SurfaceStress] = []
    ratings: list[BearingRating] = []
    for name in names_along(run.data, "bearing"):
        place = f"bearings.{name}"
        spec = None if run.scenario is None else _table(run, "bearings", name)
        made = None if spec is None else spec.build()
        if not isinstance(made, BallBearing):
            if elements_of(run.data).get(place, {}).get("kind") != "AxialPreload":
                notes.append(f"{place}: its balls are not known, a stiffness alone has no contact stress")
            continue
        if is_lean(run.data):
            notes.append(
                f"{place}: a lean result has no places of the journal; run it with output.form = 'full'"
            )
            continue
        more, rating = bearing_stress(run.data, name, made)
        rows += more
        ratings.append(rating)
    return rows, ratings
