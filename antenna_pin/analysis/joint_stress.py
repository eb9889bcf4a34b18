"""Contact stress of joints with play: bores, sockets, sliders, flanges, and PV of bushings."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis._run import floats
from antenna_pin.analysis.journal import clearance_shapes, journal_motion
from antenna_pin.analysis.sampled import time_mean
from antenna_pin.analysis.stress_results import BushingLoad, SurfaceStress
from antenna_pin.analysis.strip_load import LawStrips, LineLoad, PlaneStrips, StripLaw, bore_depths, line_load
from antenna_pin.analysis.surface_file import JointSurface
from antenna_pin.analysis.surface_stress import ForcePeak, Pair, StressCriteria, Stresses, surface_of
from antenna_pin.base.arrays import Array
from antenna_pin.contact import make_normal_law
from antenna_pin.contact.normal import CompiledNormalLaw
from antenna_pin.contact.pressure import LinePressure, hertz_line, hertz_point, persson_line
from antenna_pin.contact.socket_pressure import ball_in_socket
from antenna_pin.errors import AntennaPinError
from antenna_pin.trajectory import contact_ends, names_along
from antenna_pin.trajectory.read import is_lean

Samples = NDArray[np.int64]  # indices of samples

# Approach by the law over that of geometry and materials, within which they are taken to agree.
_AGREES = 2.0
# Share of a peak force that is damping, above which it is told.
_DAMPED = 0.05
# Largest line load over the mean one, above which a bore that is loaded most at its end is edge loaded.
_UNEVEN = 1.5
# Share of the mean line load, by which loads that are equal differ at most.
_EVEN = 1e-9
# Nodes along the line of contact at one end of a bore; a tilt in one plane is exact with two.
_NODES = 17
# Points of the pressure that is drawn along it.
_DRAWN = 129


# --- contacts of a joint ------------------------------------------------------------------------------------


class _Line(NamedTuple):
    """Line of contact of one end of a bore.

    The last row of the arrays, at index -1, is without tilt.
    """

    depth: Array  # at the nodes, (samples + 1, nodes) [m]
    places: Array  # of the nodes, from the middle of the bore along its axis, (samples + 1, nodes) [m]
    law: StripLaw
    tilts: bool  # whether the joint lets its journal tilt

    def length(self, sample: int) -> float:
        """Return the length of the line at a sample [m]."""
        return abs(float(self.places[sample, -1] - self.places[sample, 0]))

    def loads(self, force: Array, samples: Samples) -> LineLoad:
        """Return the loads along the line under forces [N] at samples."""
        return line_load(force, self.depth[samples], self.places[samples], self.law)


class _Contact(NamedTuple):
    """Facts of one contact of a joint that its theory needs."""

    about: Mapping[str, Any]  # kind and dimensions of the joint
    pair: Pair
    own: JointSurface
    limits: StressCriteria
    peak: ForcePeak
    force: Array  # (samples,) [N]
    slope: Array  # of the journal towards the contact, (samples,) [-]
    line: _Line | None  # of a bore, if its length is known


class _Theory(NamedTuple):
    """Theory of a contact's pressure."""

    name: str
    stresses: Callable[[Array, Samples], Stresses]  # under forces [N] at samples
    notes: list[str]
    of_line: Callable[[Array], LinePressure] | None = None  # of loads along a bore [N/m]
    history: Array | None = None  # pressure at the samples [Pa], if it is known already

    def at(self, peak: ForcePeak) -> Stresses:
        """Return the stress at a peak."""
        return self.stresses(np.array([peak.force]), np.array([peak.sample]))


def joint_surfaces(
    data: xr.Dataset, joint: str, pair: Pair, own: JointSurface, length: float | None, limits: StressCriteria
) -> list[SurfaceStress]:
    """Return the stress of all contacts of a joint with play.

    The line of contact of all ends together has a length [m]; None of a point, or if unknown.
    """
    about = clearance_shapes(data)[joint]
    found = []
    for name, facts in about["contacts"].items():
        kind, law = facts["kind"], _law_of(facts)
        if kind not in _KINDS:
            continue
        peak, force = _peak(data, name), _series(data, "normal_force", name)
        line = None
        if kind == "radial" and length is not None and not math.isnan(pair.modulus):
            line = _line_of(data, joint, name, own.length, length, _strips(about, pair, law))
        contact = _Contact(about, pair, own, limits, peak, force, _slopes(data, name, joint, force), line)
        theory = _KINDS[kind](contact)
        stress = theory.at(peak)
        history = theory.history
        if history is None:
            history = theory.stresses(force, np.arange(force.size)).pressure
        notes = [*theory.notes, *_notes_of_law(data, name, facts, law, contact)]
        if pair.names == () and math.isnan(pair.modulus):
            notes = ["no materials: give bearing_material and journal_material of the joint", *notes]
        largest = int(np.argmax(history)) if history.size and np.isfinite(history).any() else 0
        if history.size and history[largest] > stress.pressure[0]:  # a tilted sample, not the largest force
            peak = ForcePeak(float(force[largest]), float(data["time"].values[largest]), largest)
            stress = theory.at(peak)
        along, told = _along(line, theory, peak)
        surface = {"radial": "bore", "axial": "flange", "spherical": "socket"}.get(kind, kind)
        place = name if name.startswith(joint) else f"{joint}.{name}"
        row = surface_of(place, surface, theory.name, pair, limits, peak, stress, history, [*notes, *told])
        found.append(replace(row, **along))
    return found


# --- bores --------------------------------------------------------------------------------------------------


def _strips(about: Mapping[str, Any], pair: Pair, law: CompiledNormalLaw | None) -> StripLaw:
    """Return the strips of a bore: the law of a distributed load, else plane contacts."""
    if about["load"] == "distributed" and law is not None:
        return LawStrips(law=law)
    size = about["dimensions"]
    play = float(size["bearing_radius"]) - float(size["journal_radius"])
    return PlaneStrips(modulus=pair.modulus, clearance=play)


def _line_of(
    data: xr.Dataset, joint: str, contact: str, own_length: float | None, length: float, law: StripLaw
) -> _Line:
    """Return the line of contact of one end of a bore over a run."""
    about = clearance_shapes(data)[joint]
    size, side = about["dimensions"], {"+": 1.0, "-": -1.0}.get(contact_ends(data)[contact], 0.0)
    along = np.linspace(0.0, 1.0, _NODES)
    level = length * (0.5 * side * along if side else along - 0.5)
    if is_lean(data) or not side:
        places = np.broadcast_to(level, (data.sizes.get("time", 0) + 1, _NODES))
        return _Line(np.zeros(places.shape), places, law, bool(side))
    plus, minus = np.moveaxis(journal_motion(data, joint)["offset"].values, 1, 0)
    span = plus - minus
    share = 0.5 * side * along * np.ones((len(span), 1))
    if own_length is not None:
        share *= own_length / np.where(span[:, 2:] > 0.0, span[:, 2:], 1.0)
    nodes = 0.5 * (plus + minus)[:, None, :] + share[..., None] * span[:, None, :]
    places = nodes[..., 2]
    circle = float(size["bearing_radius"]) if about["kind"] == "revolute" else 0.0
    play = float(size["bearing_radius"]) - float(size["journal_radius"])
    depth = bore_depths(nodes[..., :2], places, play, circle)
    return _Line(np.vstack([depth, np.zeros(_NODES)]), np.vstack([places, level]), law, True)


def _along(line: _Line | None, theory: _Theory, peak: ForcePeak) -> tuple[dict[str, Any], list[str]]:
    """Return fields and notes of a surface on its load along the bore."""
    if line is None or theory.of_line is None or not peak.force > 0.0:
        return {}, []
    found, length = line.loads(np.array([peak.force]), np.array([peak.sample])), line.length(peak.sample)
    ratio, loaded = float(found.peak[0]) * length / peak.force, float(found.loaded[0])
    place, end = float(found.along[0]), float(found.places[0, -1])
    edge = ratio > _UNEVEN and place == end
    notes = [f"the force is spread over {1e3 * length:.4g} mm of the bore"]
    if peak.sample < 0 and line.tilts:
        notes.append("no sample of the journal at the peak: its tilt is not known, the load taken as even")
    if edge:
        notes.append(
            f"edge loaded: {1e3 * loaded:.3g} mm touch, the load at the end is {ratio:.3g} times its mean; "
            "the stress of a sharp edge itself is not in it"
        )
    fine = np.linspace(float(found.places[0, 0]), end, _DRAWN)
    if fine[-1] < fine[0]:
        fine = fine[::-1]
    stress = theory.of_line(found.at(fine, line.law))
    width = 2.0 * float(stress.half_width.max())
    if loaded < width:
        notes.append(
            f"the line that touches is shorter than its width of {1e3 * width:.3g} mm: no strips describe it"
        )
    row: dict[str, Any] = {"line_load_ratio": ratio, "along": place if ratio > 1.0 + _EVEN else math.nan}
    row |= {"loaded_length": loaded, "edge_loaded": edge, "places": fine, "profile": stress.pressure}
    return row, notes


def _bore(contact: _Contact) -> _Theory:
    """Return the theory of a line contact in a bore."""
    size, pair, line = contact.about["dimensions"], contact.pair, contact.line
    if math.isnan(pair.modulus):
        return _Theory("none", _nothing, [])
    if line is None:
        rule = f"give joints.NAME.length of {contact.about['kind']} play"
        return _Theory("none", _nothing, [f"the length of the line of contact is not known: {rule}"])
    outer, inner = float(size["bearing_radius"]), float(size["journal_radius"])
    play, curvature = outer - inner, 1.0 / inner - 1.0 / outer

    def hertz(load: Array) -> LinePressure:
        return hertz_line(load, curvature, pair.modulus)

    def conformal(load: Array) -> LinePressure:
        return persson_line(load, math.sqrt(outer * inner), play, pair.modulus)

    def stresses(force: Array, samples: Samples) -> Stresses:
        loads = line.loads(force, samples)
        one, half = of_line(loads.peak), 0.5 * np.abs(loads.places[:, -1] - loads.places[:, 0])
        return Stresses(one.pressure, one.half_width, half, one.shear, one.shear_depth)

    at_peak = line.loads(np.array([contact.peak.force]), np.array([contact.peak.sample])).peak
    over = line.loads(contact.force, np.arange(contact.force.size)).peak
    widest = hertz(np.append(over, at_peak).max(keepdims=True)).half_width
    share, most = float(widest[0]) / inner, contact.limits.conformal_above
    notes = []
    of_line, name = hertz, f"Hertz, line (half-width {share:.2g} of the radius, at most {most:g})"
    if share > most:
        of_line = conformal
        name = f"Persson, conformal line (Hertz's half-width {share:.2g} of the radius, above {most:g})"
        if len(set(pair.names)) > 1:
            notes = ["Persson's solution is of one material; of two it is an approximation"]
    return _Theory(name, stresses, notes, of_line, of_line(over).pressure)


def _socket(contact: _Contact) -> _Theory:
    """Return the theory of a ball in its socket."""
    size, pair = contact.about["dimensions"], contact.pair
    outer, inner = float(size["socket_radius"]), float(size["ball_radius"])
    curvature = 1.0 / inner - 1.0 / outer
    if math.isnan(pair.modulus):
        return _Theory("none", _nothing, [])

    def hertz(force: Array, samples: Samples) -> Stresses:
        return _point(hertz_point(force, curvature, curvature, pair.modulus, pair.poisson))

    def conformal(force: Array, samples: Samples) -> Stresses:
        bearing, journal = pair.materials
        return _point(ball_in_socket(force, math.sqrt(outer * inner), outer - inner, journal, bearing))

    most = contact.limits.conformal_above
    share = float(hertz(np.array([contact.peak.force]), np.array([-1])).half_width[0]) / inner
    if share <= most or not pair.materials:
        return _Theory(f"Hertz, point (half-width {share:.2g} of the radius)", hertz, [])
    criterion = f"Hertz's half-width {share:.2g} of the radius, above {most:g}"
    return _Theory(f"elastic ball in a spherical hollow, conformal ({criterion})", conformal, [])


def _corner(contact: _Contact) -> _Theory:
    """Return the theory of a rounded corner or edge on a plane wall."""
    size, pair = contact.about["dimensions"], contact.pair
    radius = contact.own.edge_radius or float(size.get("corner_radius") or 0.0)
    if not radius:
        rule = "a sharp corner has no finite pressure: give joints.NAME.edge_radius"
        return _Theory("none", _nothing, [rule])
    if math.isnan(pair.modulus):
        return _Theory("none", _nothing, [])

    def hertz(force: Array, samples: Samples) -> Stresses:
        return _point(hertz_point(force, 1.0 / radius, 1.0 / radius, pair.modulus, pair.poisson))

    return _Theory("Hertz, point: rounded corner on a plane", hertz, [])


def _flange(contact: _Contact) -> _Theory:
    """Return the theory of a flange on an end face."""
    size, pair, edge = contact.about["dimensions"], contact.pair, contact.own.edge_radius
    rim = min(float(size["bearing_outer_radius"]), float(size["flange_radius"]))
    bore = float(size["bearing_radius"])
    area = math.pi * (rim**2 - bore**2)

    def flat(force: Array, samples: Samples) -> Stresses:
        pressure = force / area
        none = np.full_like(pressure, math.nan)
        return Stresses(pressure, np.full_like(pressure, 0.5 * (rim - bore)), none, none, none)

    notes = ["mean pressure over the ring"]
    if edge is None:
        notes.append("a sharp edge has no finite pressure: give joints.NAME.edge_radius for that of the edge")
        return _Theory("mean pressure of a flat ring", flat, notes)
    if math.isnan(pair.modulus):
        return _Theory("none", _nothing, [])

    def rounded(force: Array, samples: Samples) -> Stresses:
        """Edge on a plane: an ellipse where tilted, a line where flat."""
        slope = np.append(contact.slope, 0.0)[samples]
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

    name = f"Hertz: edge of {1e3 * edge:.3g} mm on a plane, around the rim or, tilted, at a point"
    return _Theory(name, rounded, [])


def _point(one: Any) -> Stresses:
    return Stresses(one.pressure, one.half_width, one.half_length, one.shear, one.shear_depth)


def _nothing(force: Array, samples: Samples) -> Stresses:
    """Return no stress but NaN, and zero where there is no force."""
    none = np.where(force > 0.0, math.nan, 0.0)
    return Stresses(none, none, none, none, none)


_KINDS: dict[str, Callable[[_Contact], _Theory]] = {
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
    return floats(data[name].sel(contact=contact))


def _slopes(data: xr.Dataset, contact: str, joint: str, force: Array) -> Array:
    """Return how the journal's axis leans towards a contact, at the samples [-]."""
    if not force.size:
        return np.zeros(0)
    attitude = floats(data["journal_attitude"].sel(clearance_joint=joint))
    x, y, z, w = attitude.T
    axis = np.stack([2.0 * (x * z + y * w), 2.0 * (y * z - x * w)], axis=1)
    along = 1.0 - 2.0 * (x * x + y * y)
    point = floats(data["contact_point"].sel(contact=contact))[:, :2]
    size = np.linalg.norm(point, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        lean = np.abs((axis * point).sum(axis=1) / (size * along))
    return np.where((size > 0.0) & (along != 0.0), lean, 0.0)


def _peak(data: xr.Dataset, contact: str) -> ForcePeak:
    """Return the largest force of a contact: of its episodes, or of a sample."""
    number = names_along(data, "contact").index(contact)
    mine = np.asarray(data["episode_contact"].values, dtype=int) == number
    forces = floats(data["peak_force"])[mine]
    times = floats(data["peak_time"])[mine]
    force, time = (float(forces.max()), float(times[np.argmax(forces)])) if forces.size else (0.0, math.nan)
    sampled = _series(data, "normal_force", contact)
    sample = -1
    if sampled.size:
        own = floats(data["time"])
        if sampled.max() > force:
            force, time = float(sampled.max()), float(own[np.argmax(sampled)])
        touching = np.flatnonzero(sampled > 0.0)
        if touching.size and math.isfinite(time):
            sample = int(touching[np.argmin(np.abs(own[touching] - time))])
    return ForcePeak(force, time, sample)


def _law_of(facts: Mapping[str, Any]) -> CompiledNormalLaw | None:
    """Return the normal law of a contact; None of a law of a user's own."""
    law = facts["normal_law"]
    try:
        made: CompiledNormalLaw = make_normal_law(
            law["law"], {name: value for name, (value, _) in law["parameters"].items()}
        )
    except AntennaPinError:
        return None
    return made


def _notes_of_law(
    data: xr.Dataset, name: str, facts: Mapping[str, Any], law: CompiledNormalLaw | None, contact: _Contact
) -> list[str]:
    """Return what contradicts the geometry in the law that made the force."""
    peak, about = contact.peak, contact.about
    if not peak.force > 0.0:
        return ["never touched"]
    told = facts["normal_law"]
    if law is None:
        return [f"law {told['law']} is a user's own: its stiffness was not compared with the geometry"]
    numbers = {name: value for name, (value, _) in told["parameters"].items()}
    depth = _depth_at_peak(data, name)
    notes = []
    springs = float(law.force(depth, 0.0, 1.0)) if math.isfinite(depth) else math.nan
    share = 1.0 - springs / peak.force
    by_geometry = _approach(contact, facts["kind"], springs) if springs > 0.0 else math.nan
    if by_geometry > 0.0 and not _is_of_geometry(numbers, about):
        ratio = depth / by_geometry
        if not 1.0 / _AGREES <= ratio <= _AGREES:
            how = "softer" if ratio > 1.0 else "stiffer"
            notes.append(
                f"law {told['law']} gives {ratio:.3g} times the approach of this geometry, so it is {how}: "
                "the peak force of an impact is the law's, and its pressure not that of the real pair"
            )
    if share > _DAMPED:
        source = told.get("dissipation", told)["law"]
        notes.append(
            f"{100.0 * share:.2g} % of the peak force is damping, which {source} fits to a restitution: no "
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
    depths = floats(data["peak_depth"])[mine]
    forces = floats(data["peak_force"])[mine]
    return float(depths[np.argmax(forces)]) if forces.size else math.nan


def _approach(contact: _Contact, kind: str, force: float) -> float:
    """Return the elastic approach of geometry and materials under a force [m]; NaN if unknown."""
    size, pair = contact.about["dimensions"], contact.pair
    if kind == "radial" and contact.line is not None:
        play = float(size["bearing_radius"]) - float(size["journal_radius"])
        load = np.array(force / contact.line.length(contact.peak.sample))
        return float(PlaneStrips(modulus=pair.modulus, clearance=play).depth(load))
    if kind == "spherical":
        curvature = 1.0 / float(size["ball_radius"]) - 1.0 / float(size["socket_radius"])
        return float((0.75 * force / pair.modulus) ** (2.0 / 3.0) * curvature ** (1.0 / 3.0))
    radius = float(size.get("corner_radius") or 0.0)
    if kind == "wall" and radius:
        return float((0.75 * force / pair.modulus) ** (2.0 / 3.0) * radius ** (-1.0 / 3.0))
    return math.nan


# --- bushings -----------------------------------------------------------------------------------------------


def bushing_load(data: xr.Dataset, joint: str, length: float, limit: float | None) -> BushingLoad | None:
    """Return pressure, speed and PV of a bushing; None of a lean result."""
    if is_lean(data):
        return None
    about = clearance_shapes(data)[joint]
    contacts = [name for name, facts in about["contacts"].items() if facts["kind"] == "radial"]
    time = floats(data["time"])
    force = floats(data["joint_force"].sel(clearance_joint=joint))
    forces = floats(data["normal_force"].sel(contact=contacts))
    slip = floats(data["slip_speed"].sel(contact=contacts))
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
