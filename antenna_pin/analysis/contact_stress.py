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
from antenna_pin.analysis.element_stress import bearing_stress, flank_stress, stop_stress
from antenna_pin.analysis.joint_stress import bushing_load, joint_surfaces
from antenna_pin.analysis.journal import clearance_shapes
from antenna_pin.analysis.stress_results import BearingRating, BushingLoad, ContactStress, SurfaceStress
from antenna_pin.analysis.surface_file import JointSurface, SurfaceFile
from antenna_pin.analysis.surface_stress import Pair, StressCriteria
from antenna_pin.base.arguments import takes
from antenna_pin.base.rules import Positive, PositiveOrInfinite
from antenna_pin.contact import MATERIALS, Material
from antenna_pin.elements import BallBearing
from antenna_pin.errors import UnknownNameError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.merge import key_parts
from antenna_pin.trajectory import Trajectory, elements_of, is_lean, names_along


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
