"""Contact stress of joints with play: bores, sockets, sliders, flanges, and PV of bushings."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis.journal import clearance_shapes
from antenna_pin.analysis.sampled import time_mean
from antenna_pin.analysis.stress_results import BushingLoad, SurfaceStress
from antenna_pin.analysis.surface_file import JointSurface
from antenna_pin.contact import Material, effective_modulus, make_normal_law
from antenna_pin.contact.pressure import hertz_line, hertz_point, persson_line
from antenna_pin.contact.socket_pressure import ball_in_socket
from antenna_pin.errors import AntennaPinError
from antenna_pin.trajectory import names_along
from antenna_pin.trajectory.read import is_lean

__all__ = ["StressCriteria", "Pair", "bushing_load", "joint_surfaces", "surface_of"]

Array = NDArray[np.float64]

# Approach by the law over that of geometry and materials, within which they are taken to agree.
_AGREES = 2.0
# Share of a peak force that is damping, above which it is told.
_DAMPED = 0.05
# Largest line load over the mean one, above which the tilt is told.
_UNEVEN = 1.5


@dataclass(frozen=True, slots=True, kw_only=True)
class StressCriteria:
    """Criteria of the analysis.

    Attributes:
        yield_share: Share of the yield limit that a pressure may reach [-].
        factor: Factor on the pressure [-].
        conformal_above: Half-width over radius above which a bore is conformal [-].
    """

    yield_share: float
    factor: float
    conformal_above: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Two materials that touch, by name.

    Attributes:
        names: Their names; empty where none is known.
        materials: Their numbers.
        modulus: E* [Pa]; NaN if unknown.
    """

    names: tuple[str, ...]
    materials: tuple[Material, ...]
    modulus: float

    @classmethod
    def of(cls, bearing: str, journal: str, known: Callable[[str], Material]) -> Pair:
        """Return the pair of two names."""
        both = known(bearing), known(journal)
        return cls(names=(bearing, journal), materials=both, modulus=effective_modulus(*both))

    @property
    def weakest(self) -> tuple[str, float]:
        """Name and yield limit of the weaker known material [Pa]; NaN without any."""
        limits = [(one.yield_strength, name) for name, one in zip(self.names, self.materials, strict=True)]
        known = [(limit, name) for limit, name in limits if limit is not None]
        limit, name = min(known, default=(math.nan, ""))
        return name, limit

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names of the materials without a known yield limit, each once."""
        both = zip(self.names, self.materials, strict=True)
        return tuple(dict.fromkeys(name for name, one in both if one.yield_strength is None))

    @property
    def poisson(self) -> float:
        """Poisson's ratio of the weaker material, 0.3 if unknown [-]."""
        name, _ = self.weakest
        return self.materials[self.names.index(name)].poisson if name in self.names else 0.3


class Stresses(NamedTuple):
    """Stress over some forces, each (n,)."""

    pressure: Array  # [Pa]
    half_width: Array  # [m]
    half_length: Array  # [m]
    shear: Array  # [Pa]
    shear_depth: Array  # [m]


class ForcePeak(NamedTuple):
    """Largest force of a contact, between samples too."""

    force: float  # [N]
    time: float  # [s]
    slope: float  # of the journal towards the contact [-]


def surface_of(
    place: str,
    surface: str,
    theory: str,
    pair: Pair,
    limits: StressCriteria,
    peak: ForcePeak,
    stress: Stresses,
    history: Array,
    notes: list[str],
) -> SurfaceStress:
    """Return the row of a surface with its margin against yield.

    Args:
        place: Name of the surface.
        surface: What it is.
        theory: Of the pressure.
        pair: Materials.
        limits: Criteria.
        peak: Force and time of the peak.
        stress: At the peak, of one entry.
        history: Pressure at the samples [Pa].
        notes: Lines, to which an unknown limit is added.
    """
    name, limit = pair.weakest
    pressure = float(stress.pressure[0])
    for unknown in pair.unknown:
        notes = [
            *notes,
            f"the yield limit of {unknown} is not known: give materials.{unknown}.yield_strength",
        ]
    loaded = pressure > 0.0
    return SurfaceStress(
        place=place,
        surface=surface,
        theory=theory,
        time=peak.time,
        force=peak.force,
        pressure=pressure,
        half_width=float(stress.half_width[0]),
        half_length=float(stress.half_length[0]),
        shear=float(stress.shear[0]),
        shear_depth=float(stress.shear_depth[0]),
        material=name,
        limit=limit,
        share=pressure / limit,
        margin=limits.yield_share * limit / (limits.factor * pressure) - 1.0 if loaded else math.inf * limit,
        notes=tuple(notes),
        history=history,
    )


# --- contacts of a joint ------------------------------------------------------------------------------------


def joint_surfaces(
    data: xr.Dataset, joint: str, pair: Pair, own: JointSurface, length: float | None, limits: StressCriteria
) -> list[SurfaceStress]:
    """Return the stress of all contacts of a joint with play.

    Args:
        data: Of the run.
        joint: Name of the joint.
        pair: Materials of bearing and journal.
        own: What is given of the joint's surfaces beside.
        length: Of the line of contact of all ends together [m]; None of a point, or if unknown.
        limits: Criteria.
    """
    about = clearance_shapes(data)[joint]
    found = []
    for contact, facts in about["contacts"].items():
        kind = facts["kind"]
        peak = _peak(data, contact, joint)
        force = _series(data, "normal_force", contact)
        slope = _slopes(data, contact, joint, force)
        make = _KINDS.get(kind)
        place = contact if contact.startswith(joint) else f"{joint}.{contact}"
        if make is None:
            continue
        theory, of, notes = make(about, pair, own, length, limits, peak, about["load"])
        if pair.names == () and math.isnan(pair.modulus):
            notes = ["no materials: give bearing_material and journal_material of the joint", *notes]
        stress = of(np.array([peak.force]), np.array([peak.slope]))
        history = of(force, slope).pressure if force.size else np.zeros(0)
        notes += _notes_of_law(data, contact, facts, peak, about, pair, length)
        largest = int(np.argmax(history)) if history.size and np.isfinite(history).any() else 0
        if history.size and history[largest] > stress.pressure[0]:  # a tilted sample, not the largest force
            peak = ForcePeak(
                float(force[largest]), float(data["time"].values[largest]), float(slope[largest])
            )
            stress = of(np.array([peak.force]), np.array([peak.slope]))
        surface = {"radial": "bore", "axial": "flange", "spherical": "socket"}.get(kind, kind)
        found.append(surface_of(place, surface, theory, pair, limits, peak, stress, history, notes))
    return found


_Made = tuple[str, Callable[[Array, Array], Stresses], list[str]]


def _bore(
    about: Mapping[str, Any],
    pair: Pair,
    own: JointSurface,
    length: float | None,
    limits: StressCriteria,
    peak: ForcePeak,
    load: str,
) -> _Made:
    """Return theory, stress and notes of a line contact in a bore."""
    size = about["dimensions"]
    outer, inner = float(size["bearing_radius"]), float(size["journal_radius"])
    ends = 1 if about["kind"] == "planar" else 2
    if length is None:
        rule = (
            f"the length of the line of contact is not known: give joints.NAME.length of {about['kind']} play"
        )
        return "none", _nothing, [rule]
    part = length / ends
    play, curvature = outer - inner, 1.0 / inner - 1.0 / outer
    mean_radius = math.sqrt(outer * inner)

    def line_load(force: Array, slope: Array) -> Array:
        """Largest load per length along the part of the bore [N/m]."""
        mean = force / part
        with np.errstate(divide="ignore", invalid="ignore"):
            stiffness = (
                math.pi
                * pair.modulus
                / np.maximum(np.log(4.0 * math.pi * pair.modulus * play / mean) - 1.0, 2.0)
            )
            whole = force / part + 0.5 * stiffness * slope * part
            partly = np.sqrt(2.0 * stiffness * slope * force)
        found: Array = np.where(
            force > 0.0, np.where(0.5 * stiffness * slope * part <= mean, whole, partly), 0.0
        )
        return found

    def hertz(force: Array, slope: Array) -> Stresses:
        return _line(hertz_line(line_load(force, slope), curvature, pair.modulus), part)

    def conformal(force: Array, slope: Array) -> Stresses:
        return _line(persson_line(line_load(force, slope), mean_radius, play, pair.modulus), part)

    if math.isnan(pair.modulus):
        return "none", _nothing, []
    notes = [f"the force is spread over {1e3 * part:.4g} mm of the bore"]
    at_peak = line_load(np.array([peak.force]), np.array([peak.slope]))
    uneven = float(at_peak[0]) * part / peak.force if peak.force > 0.0 else 1.0
    if uneven > _UNEVEN:
        notes.append(
            f"tilt at the peak makes the line load at the end {uneven:.3g} times its mean; the edge's own "
            "stress is not in it"
        )
    share = float(hertz(np.array([peak.force]), np.array([peak.slope])).half_width[0]) / inner
    if share <= limits.conformal_above:
        theory = f"Hertz, line (half-width {share:.2g} of the radius, at most {limits.conformal_above:g})"
        return theory, hertz, notes
    if len(set(pair.names)) > 1:
        notes.append("Persson's solution is of one material; of two it is an approximation")
    criterion = f"Hertz's half-width {share:.2g} of the radius, above {limits.conformal_above:g}"
    return f"Persson, conformal line ({criterion})", conformal, notes


def _socket(
    about: Mapping[str, Any],
    pair: Pair,
    own: JointSurface,
    length: float | None,
    limits: StressCriteria,
    peak: ForcePeak,
    load: str,
) -> _Made:
    """Return theory, stress and notes of a ball in its socket."""
    size = about["dimensions"]
    outer, inner = float(size["socket_radius"]), float(size["ball_radius"])
    curvature = 1.0 / inner - 1.0 / outer
    if math.isnan(pair.modulus):
        return "none", _nothing, []

    def hertz(force: Array, slope: Array) -> Stresses:
        return _point(hertz_point(force, curvature, curvature, pair.modulus, pair.poisson))

    def conformal(force: Array, slope: Array) -> Stresses:
        bearing, journal = pair.materials
        return _point(ball_in_socket(force, math.sqrt(outer * inner), outer - inner, journal, bearing))

    share = float(hertz(np.array([peak.force]), np.zeros(1)).half_width[0]) / inner
    if share <= limits.conformal_above or not pair.materials:
        return f"Hertz, point (half-width {share:.2g} of the radius)", hertz, []
    criterion = f"Hertz's half-width {share:.2g} of the radius, above {limits.conformal_above:g}"
    return f"elastic ball in a spherical hollow, conformal ({criterion})", conformal, []


def _corner(
    about: Mapping[str, Any],
    pair: Pair,
    own: JointSurface,
    length: float | None,
    limits: StressCriteria,
    peak: ForcePeak,
    load: str,
) -> _Made:
    """Return theory, stress and notes of a rounded corner or edge on a plane wall."""
    radius = own.edge_radius or float(about["dimensions"].get("corner_radius") or 0.0)
    if not radius:
        return "none", _nothing, ["a sharp corner has no finite pressure: give joints.NAME.edge_radius"]
    if math.isnan(pair.modulus):
        return "none", _nothing, []

    def hertz(force: Array, slope: Array) -> Stresses:
        return _point(hertz_point(force, 1.0 / radius, 1.0 / radius, pair.modulus, pair.poisson))

    return "Hertz, point: rounded corner on a plane", hertz, []


def _flange(
    about: Mapping[str, Any],
    pair: Pair,
    own: JointSurface,
    length: float | None,
    limits: StressCriteria,
    peak: ForcePeak,
    load: str,
) -> _Made:
    """Return theory, stress and notes of a flange on an end face."""
    size = about["dimensions"]
    rim = min(float(size["bearing_outer_radius"]), float(size["flange_radius"]))
    bore = float(size["bearing_radius"])
    area = math.pi * (rim**2 - bore**2)
    edge = own.edge_radius

    def flat(force: Array, slope: Array) -> Stresses:
        pressure = force / area
        none = np.full_like(pressure, math.nan)
        return Stresses(pressure, np.full_like(pressure, 0.5 * (rim - bore)), none, none, none)

    notes = ["mean pressure over the ring"]
    if edge is None:
        notes.append("a sharp edge has no finite pressure: give joints.NAME.edge_radius for that of the edge")
        return "mean pressure of a flat ring", flat, notes
    if math.isnan(pair.modulus):
        return "none", _nothing, []

    def rounded(force: Array, slope: Array) -> Stresses:
        """Edge on a plane: an ellipse where tilted, a line where flat."""
        around = hertz_line(force / (2.0 * math.pi * rim), 1.0 / edge, pair.modulus)
        columns = [
            np.array(one)
            for one in (
                around.pressure,
                around.half_width,
                np.full_like(force, math.pi * rim),
                around.shear,
                around.shear_depth,
            )
        ]
        for k in np.flatnonzero((force > 0.0) & (slope > 0.0)):
            lean = float(np.sin(np.arctan(slope[k]))) / (rim - edge + edge * float(slope[k]))
            if lean < 1e-7 / edge:
                continue
            one = hertz_point(float(force[k]), 1.0 / edge, lean, pair.modulus, pair.poisson)
            if float(one.pressure) > columns[0][k]:
                for column, value in zip(
                    columns,
                    (one.pressure, one.half_width, one.half_length, one.shear, one.shear_depth),
                    strict=True,
                ):
                    column[k] = float(value)
        return Stresses(*columns)

    return (
        f"Hertz: edge of {1e3 * edge:.3g} mm on a plane, around the rim or, tilted, at a point",
        rounded,
        [],
    )


def _line(one: Any, length: float) -> Stresses:
    half = np.full_like(one.pressure, 0.5 * length)
    return Stresses(one.pressure, one.half_width, half, one.shear, one.shear_depth)


def _point(one: Any) -> Stresses:
    return Stresses(one.pressure, one.half_width, one.half_length, one.shear, one.shear_depth)


def _nothing(force: Array, slope: Array) -> Stresses:
    """Return no stress but NaN, and zero where there is no force."""
    none = np.where(force > 0.0, math.nan, 0.0)
    return Stresses(none, none, none, none, none)


_KINDS: dict[str, Callable[..., _Made]] = {
    "radial": _bore,
    "axial": _flange,
    "spherical": _socket,
    "wall": _corner,
    "key": _corner,
}


# --- what a run says of a contact ---------------------------------------------------------------------------


def _series(data: xr.Dataset, name: str, contact: str) -> Array:
    """Return a series of a contact; empty of a lean result."""
    if is_lean(data):
        return np.zeros(0)
    return np.asarray(data[name].sel(contact=contact).values, dtype=float)


def _slopes(data: xr.Dataset, contact: str, joint: str, force: Array) -> Array:
    """Return how the journal's axis leans towards a contact, at the samples [-]."""
    if not force.size:
        return np.zeros(0)
    attitude = np.asarray(data["journal_attitude"].sel(clearance_joint=joint).values, dtype=float)
    x, y, z, w = attitude.T
    axis = np.stack([2.0 * (x * z + y * w), 2.0 * (y * z - x * w)], axis=1)
    along = 1.0 - 2.0 * (x * x + y * y)
    point = np.asarray(data["contact_point"].sel(contact=contact).values, dtype=float)[:, :2]
    size = np.linalg.norm(point, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        lean = np.abs((axis * point).sum(axis=1) / (size * along))
    return np.where((size > 0.0) & (along != 0.0), lean, 0.0)


def _peak(data: xr.Dataset, contact: str, joint: str) -> ForcePeak:
    """Return the largest force of a contact: of its episodes, or of a sample."""
    number = names_along(data, "contact").index(contact)
    mine = np.asarray(data["episode_contact"].values, dtype=int) == number
    forces = np.asarray(data["peak_force"].values, dtype=float)[mine]
    times = np.asarray(data["peak_time"].values, dtype=float)[mine]
    force, time = (float(forces.max()), float(times[np.argmax(forces)])) if forces.size else (0.0, math.nan)
    sampled = _series(data, "normal_force", contact)
    slope = 0.0
    if sampled.size:
        own = np.asarray(data["time"].values, dtype=float)
        if sampled.max() > force:
            force, time = float(sampled.max()), float(own[np.argmax(sampled)])
        slopes = _slopes(data, contact, joint, sampled)
        slope = float(np.interp(time, own, slopes)) if math.isfinite(time) else 0.0
    return ForcePeak(force, time, slope)


def _notes_of_law(
    data: xr.Dataset,
    contact: str,
    facts: Mapping[str, Any],
    peak: ForcePeak,
    about: Mapping[str, Any],
    pair: Pair,
    length: float | None,
) -> list[str]:
    """Return what contradicts the geometry in the law that made the force."""
    if not peak.force > 0.0:
        return ["never touched"]
    law = facts["normal_law"]
    try:
        numbers = {name: value for name, (value, _) in law["parameters"].items()}
        elastic = make_normal_law(law["law"], numbers)
    except AntennaPinError:  # a law of a user's, of which a result holds the name alone
        return [f"law {law['law']} is a user's own: its stiffness was not compared with the geometry"]
    depth = _depth_at_peak(data, contact)
    notes = []
    springs = float(elastic.force(depth, 0.0, 1.0)) if math.isfinite(depth) else math.nan
    share = 1.0 - springs / peak.force
    by_geometry = _approach(about, pair, length, facts["kind"], springs) if springs > 0.0 else math.nan
    if by_geometry > 0.0 and not _is_of_geometry(numbers, about):
        ratio = depth / by_geometry
        if not 1.0 / _AGREES <= ratio <= _AGREES:
            how = "softer" if ratio > 1.0 else "stiffer"
            notes.append(
                f"law {law['law']} gives {ratio:.3g} times the approach of this geometry, so it is {how}: "
                "the peak force of an impact is the law's, and its pressure not that of the real pair"
            )
    if share > _DAMPED:
        name = law.get("dissipation", law)["law"]
        notes.append(
            f"{100.0 * share:.2g} % of the peak force is damping, which {name} fits to a restitution: no "
            "elastic pressure stands for it"
        )
    return notes


def _is_of_geometry(numbers: Mapping[str, float], about: Mapping[str, Any]) -> bool:
    """Return whether a law along a line has the joint's own radii."""
    size = about["dimensions"]
    return all(
        name in numbers and math.isclose(numbers[name], float(size.get(name, math.nan)), rel_tol=1e-9)
        for name in ("bearing_radius", "journal_radius")
    )


def _depth_at_peak(data: xr.Dataset, contact: str) -> float:
    """Return the depth at the largest force [m]."""
    force, depth = _series(data, "normal_force", contact), _series(data, "depth", contact)
    if force.size and force.max() > 0.0:
        return float(depth[np.argmax(force)])
    number = names_along(data, "contact").index(contact)
    mine = np.asarray(data["episode_contact"].values, dtype=int) == number
    depths = np.asarray(data["peak_depth"].values, dtype=float)[mine]
    forces = np.asarray(data["peak_force"].values, dtype=float)[mine]
    return float(depths[np.argmax(forces)]) if forces.size else math.nan


def _approach(about: Mapping[str, Any], pair: Pair, length: float | None, kind: str, force: float) -> float:
    """Return the elastic approach of geometry and materials under a force [m]; NaN if unknown."""
    size = about["dimensions"]
    if kind == "radial" and length is not None:
        play = float(size["bearing_radius"]) - float(size["journal_radius"])
        load = force / (length / (1 if about["kind"] == "planar" else 2))
        inside = 4.0 * math.pi * pair.modulus * play / load
        if inside > math.exp(3.0):  # Johnson's, well before it turns over
            return load / (math.pi * pair.modulus) * (math.log(inside) - 1.0)
        edge = float(
            persson_line(np.array(load), float(size["bearing_radius"]), play, pair.modulus).half_angle
        )
        return play * (1.0 / math.cos(edge) - 1.0)
    if kind == "spherical":
        curvature = 1.0 / float(size["ball_radius"]) - 1.0 / float(size["socket_radius"])
        return float((0.75 * force / pair.modulus) ** (2.0 / 3.0) * curvature ** (1.0 / 3.0))
    radius = float(size.get("corner_radius") or 0.0)
    if kind == "wall" and radius:
        return float((0.75 * force / pair.modulus) ** (2.0 / 3.0) * radius ** (-1.0 / 3.0))
    return math.nan


# --- bushings -----------------------------------------------------------------------------------------------


def bushing_load(data: xr.Dataset, joint: str, length: float, limit: float | None) -> BushingLoad | None:
    """Return pressure, speed and PV of a bushing; None of a lean result.

    Args:
        data: Of the run.
        joint: Name of the joint, a bore.
        length: Of the bearing [m].
        limit: Permitted product [W/m^2], if any.
    """
    if is_lean(data):
        return None
    about = clearance_shapes(data)[joint]
    contacts = [name for name, facts in about["contacts"].items() if facts["kind"] == "radial"]
    time = np.asarray(data["time"].values, dtype=float)
    force = np.asarray(data["joint_force"].sel(clearance_joint=joint).values, dtype=float)
    forces = np.asarray(data["normal_force"].sel(contact=contacts).values, dtype=float)
    slip = np.asarray(data["slip_speed"].sel(contact=contacts).values, dtype=float)
    pressure = np.hypot(force[:, 0], force[:, 1]) / (
        length * 2.0 * float(about["dimensions"]["bearing_radius"])
    )
    speed = np.where(forces > 0.0, slip, 0.0).max(axis=1)
    product = pressure * speed
    k = int(np.argmax(product))
    permitted = math.nan if limit is None else limit
    return BushingLoad(
        joint=joint,
        pressure=float(pressure.max()),
        speed=float(speed.max()),
        pv=float(product[k]),
        time=float(time[k]),
        mean_pv=float(time_mean(time, product)),
        limit=permitted,
        share=float(product[k]) / permitted,
        history=product,
    )
