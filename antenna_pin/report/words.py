"""What was run, in words: from the scenario and the mechanism that a run carries, whatever they are."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from antenna_pin.analysis import mechanism_of
from antenna_pin.assemble import build_system
from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, DampedContact
from antenna_pin.errors import AntennaPinError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.mechanism import Mechanism
from antenna_pin.readable import number, printed_unit, readable
from antenna_pin.report._parts import Section, Statement
from antenna_pin.report._runs import ReportedRun, labels_of
from antenna_pin.scenario import (
    ConstantDrive,
    ContactClearance,
    DriveSpec,
    PlanarClearance,
    PointingSpec,
    Scenario,
    SineDrive,
    SphericalClearance,
)

__all__ = ["scenario_sections"]

# Digits of what people gave: as many as they wrote.
_GIVEN = 10

_MODELS = {
    "contact": "a journal with flanges in a bore, held by contact alone",
    "planar": "a journal in a bore, held in the plane by contact alone",
    "spherical": "a ball in a socket, held by contact alone",
    "constraint": "without play, by constrained dynamics",
    "ideal": "without play",
}
_KINDS = {
    "revolute": "turns about the axis",
    "continuous": "turns without end about the axis",
    "prismatic": "slides along the axis",
    "floating": "free in six directions, axis",
    "planar": "free in the plane across the axis",
    "spherical": "turns in all directions, axis",
}

Words = dict[str, str]
"""What is said of one run in a section, by label."""

_ORDER = (
    "Scenario",
    "Mechanism",
    "Joints",
    "Clearance",
    "Contact and friction",
    "Drives and springs",
    "Start",
    "Computation",
)


def scenario_sections(runs: Sequence[ReportedRun]) -> list[Section]:
    """Return the sections that say what was run; what holds for all runs is said once."""
    said = [dict(_words(run)) for run in runs]
    titles = [title for title in _ORDER if any(words.get(title) for words in said)]
    return [
        Section(
            key="what-" + title.lower().replace(" ", "-"),
            title=title,
            statements=tuple(_merged([words.get(title, {}) for words in said], labels_of(runs))),
        )
        for title in titles
    ]


def _merged(said: Sequence[Words], labels: Sequence[str]) -> Iterator[Statement]:
    """Yield one statement per label, with the runs that it holds for unless it holds for all."""
    for label in dict.fromkeys(label for words in said for label in words):
        by_text: dict[str, list[str]] = {}
        for words, name in zip(said, labels, strict=True):
            if label in words:
                by_text.setdefault(words[label], []).append(name)
        texts = tuple((tuple(names), text) for text, names in by_text.items())
        everywhere = len(texts) == 1 and len(texts[0][0]) == len(labels)
        yield Statement(label=label, texts=(((), texts[0][1]),) if everywhere else texts)


def _words(run: ReportedRun) -> Iterator[tuple[str, Words]]:
    scenario = run.run.scenario
    if scenario is not None:
        yield "Scenario", dict(_scenario(scenario, run.label))
    try:
        mechanism: Mechanism | None = mechanism_of(run.run)
    except AntennaPinError as error:
        mechanism = None
        yield "Mechanism", {"model": f"not known: {error}"}
    if mechanism is not None:
        yield "Mechanism", dict(_mechanism(mechanism, scenario))
        yield "Joints", dict(_joints(mechanism, scenario, run))
    if scenario is not None:
        yield "Clearance", dict(_clearances(scenario))
        yield "Contact and friction", dict(_laws(scenario))
        yield "Drives and springs", dict(_drives(scenario))
    else:
        yield "Clearance", dict(_carried_clearances(run))
        yield "Drives and springs", dict(_carried_drives(run))
    yield "Start", dict(_start(run, mechanism))
    yield "Computation", dict(_computation(run))


def _vector(values: Sequence[float] | np.ndarray, unit: str = "1", digits: int = 5) -> str:
    text = ", ".join(number(float(value), digits) for value in values)
    return f"({text}) {printed_unit(unit)}".rstrip()


def _scenario(scenario: Scenario, label: str) -> Iterator[tuple[str, str]]:
    yield (
        "scenario",
        f"{scenario.name}: {scenario.title}" if scenario.title else scenario.name or "without a name",
    )
    if scenario.case:
        # The run's label says its case already, as a rule.
        words = [] if scenario.case == label and scenario.description else [scenario.case]
        yield "case", ": ".join([*words, *([scenario.description] if scenario.description else [])])
    yield "simulated time", readable(scenario.duration, "s", _GIVEN)
    if scenario.pointing is not None:
        yield "pointing", _looks(scenario.pointing)
    if scenario.overrides:
        yield "set over the file", ", ".join(scenario.overrides)


def _looks(pointing: PointingSpec) -> str:
    text = f"{pointing.body} looks along {_vector(pointing.boresight)} in its own axes"
    if pointing.direction is None:
        return f"{text}, and should as in the ideal run"
    return f"{text}, and should along {_vector(pointing.direction)} in {pointing.commanded} axes"


# --- mechanism ---


def _mechanism(mechanism: Mechanism, scenario: Scenario | None) -> Iterator[tuple[str, str]]:
    source = "" if scenario is None else f", from {scenario.mechanism.urdf}"
    yield "model", f"{mechanism.name}{source}"
    free = mechanism.base == "free"
    yield "base", f"{mechanism.base_body}, {'floating freely' if free else 'fixed in the world'}"
    gravity = np.asarray(mechanism.model.gravity.linear)
    yield "gravity", _vector(gravity, "m/s^2") if gravity.any() else "none"
    masses = {
        name: float(inertia.mass)
        for name, inertia in zip(mechanism.bodies, list(mechanism.model.inertias)[1:], strict=True)
    }
    # Of a planar joint's massless link nothing is known but that it carries what is mounted on it.
    listed = ", ".join(f"{name} {readable(mass, 'kg', 6)}" for name, mass in masses.items())
    yield "bodies", f"{listed}; {readable(sum(masses.values()), 'kg', 6)} in all"
    if mechanism.urdf.allow_impossible_inertia:
        yield (
            "inertia against the triangle rule, allowed by name",
            ", ".join(mechanism.urdf.allow_impossible_inertia),
        )


def _joints(
    mechanism: Mechanism, scenario: Scenario | None, run: ReportedRun
) -> Iterator[tuple[str, str]]:  # fmt: skip
    for name, slot in mechanism.joints.items():
        joint = mechanism.urdf.joint(name)
        body = mechanism.bodies[slot.joint_id - 1]
        text = f"carries {body} on {joint.parent}; {_KINDS[slot.kind]} {_vector(slot.axis)}"
        if scenario is not None and name in scenario.clearance:
            text += f"; {_MODELS[scenario.clearance[name].model]}"
        elif name in run.names("clearance_joint"):
            text += "; with play, held by contact"
        yield name, text
    locked = (
        [] if scenario is None else [n for n, j in scenario.mechanism.joints.items() if j.kind == "locked"]
    )
    if locked:
        yield "locked", ", ".join(locked)


# --- play, laws, materials ---


def _clearances(scenario: Scenario) -> Iterator[tuple[str, str]]:
    for name, spec in scenario.clearance.items():
        if not isinstance(spec, ContactClearance | PlanarClearance | SphericalClearance):
            continue
        ball = isinstance(spec, SphericalClearance)
        journal = spec.bearing_radius - spec.radial_play
        parts = [
            f"radial clearance {_length(spec.radial_play)}: {'socket' if ball else 'bore'} of radius "
            f"{_length(spec.bearing_radius)}, {'ball' if ball else 'journal'} of {_length(journal)}"
        ]
        if isinstance(spec, ContactClearance):
            flanges = spec.bearing_length + 2.0 * spec.axial_play
            parts += [
                f"axial clearance {_length(spec.axial_play)} at each flange: bearing "
                f"{_length(spec.bearing_length)} long, flanges {_length(flanges)} apart",
                f"bearing's outer radius {_length(spec.bearing_outer_radius)}, flanges' radius "
                f"{_length(spec.flange_radius)}",
            ]
        if spec.offset:
            parts.append(f"{_length(spec.offset)} along the axis from the joint's origin")
        gaps = "coal's distance queries" if spec.geometry == "coal" else "the closed form"
        parts.append(f"gaps by {gaps}")
        if spec.load == "distributed":
            parts.append(
                f"load spread over {spec.strips} strips of the bore and {spec.sectors} sectors of each flange"
            )
        else:
            parts.append("one force at each contact")
        yield name, "; ".join(parts)


def _length(value: float) -> str:
    return readable(value, "m", _GIVEN)


def _laws(scenario: Scenario) -> Iterator[tuple[str, str]]:
    try:
        joints: Sequence[ClearanceJoint] = build_system(scenario).clearances
    except AntennaPinError as error:
        yield "laws", f"cannot be built any more: {error}"
        return
    for joint in joints:
        spec = scenario.clearance[joint.name]
        normals = {"bore": joint.radial, "flanges": joint.axial}
        said = {place: _law(law) for place, law in normals.items() if law is not None}
        if len(set(said.values())) == 1:
            said = {"contact": next(iter(said.values()))}
        for place, text in said.items():
            yield f"{joint.name}, {place}", text
        yield f"{joint.name}, friction", _law(joint.friction) if joint.friction is not None else "none"
        floor = readable(spec.approach_speed_floor, "m/s", _GIVEN)
        yield (
            f"{joint.name}, limits",
            (
                f"approach speeds count as {floor} at least; a run ends at a depth of "
                f"{_length(min(joint.depth_limits))}"
            ),
        )
        for part in ("bearing", "journal"):
            material = getattr(spec, f"{part}_material")
            if material is not None:
                yield f"{joint.name}, {part}'s material", _material(scenario, material)


def _material(scenario: Scenario, name: str) -> str:
    found = scenario.material(name)
    young, poisson = readable(found.young, "Pa", 5), number(found.poisson, 5)
    return f"{name}: Young's modulus {young}, Poisson's ratio {poisson}"


def _law(law: Any) -> str:
    """Return a law, or an elastic law with its dissipation, with all parameters as they are used."""
    if isinstance(law, DampedContact):
        return f"{_law(law.elastic)}; dissipation {_law(law.dissipation)}"
    given = []
    for item in dataclasses.fields(law) if dataclasses.is_dataclass(law) else ():
        value = getattr(law, item.name)
        if isinstance(value, int | float):
            unit = str(item.metadata.get("unit", "1"))
            if "exponent" in unit:
                unit = unit.replace("exponent", number(law.exponent, 6))
            given.append(f"{item.name.replace('_', ' ')} {readable(float(value), unit, 6)}")
    known = {cls: name for names in (NORMAL_LAWS, DISSIPATIONS, FRICTION_LAWS) for name, cls in names.items()}
    name = known.get(type(law), type(law).__name__)
    return f"{name}: {', '.join(given)}" if given else name


# --- drives and springs ---


def _drives(scenario: Scenario) -> Iterator[tuple[str, str]]:
    for name, drive in scenario.drives.items():
        text = _drive(drive)
        if drive.joint != name:
            text += f", at {drive.joint}"
        clearance = scenario.clearance.get(drive.joint)
        if clearance is not None and clearance.model != "ideal":
            text += f", about the {drive.axis}'s axis"
        yield f"drive {name}", text
    for name, spring in scenario.springs.items():
        slides = spring.motion == "translation"
        units = ("N/m", "N s/m", "m") if slides else ("N m/rad", "N m s/rad", "rad")
        parts = [
            f"{word} {readable(value, unit, _GIVEN)}"
            for word, value, unit in zip(
                ("stiffness", "damping", "at rest at"),
                (spring.stiffness, spring.damping, spring.rest_angle),
                units,
                strict=True,
            )
            if value
        ]
        yield f"spring {name}", ", ".join(parts) + ("" if spring.joint == name else f", at {spring.joint}")


def _drive(drive: DriveSpec) -> str:
    unit = "N" if drive.motion == "translation" else "N m"
    if isinstance(drive, ConstantDrive):
        return f"constant {readable(drive.value, unit, _GIVEN)}"
    if isinstance(drive, SineDrive):
        phase = f" + {readable(drive.phase, 'rad', _GIVEN)}" if drive.phase else ""
        frequency = number(drive.frequency, _GIVEN)
        return f"{readable(drive.amplitude, unit, _GIVEN)} × sin(2π · {frequency} Hz · t{phase})"
    largest = max(abs(value) for value in drive.torque)
    where = "" if drive.file is None else f" of {drive.file}"
    return (
        f"table{where}: {len(drive.time)} points from {number(drive.time[0])} to {number(drive.time[-1])} s, "
        f"{drive.interpolation} between them, up to {readable(largest, unit)}"
    )


def _carried_clearances(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield what the result of a system built in Python tells of its clearance joints."""
    places: dict[str, Any] = json.loads(run.data.attrs.get("clearance_geometry", "{}"))
    for name, place in places.items():
        given = ", ".join(
            f"{key.replace('_', ' ')} {_length(value)}"
            for key, value in place["dimensions"].items()
            if isinstance(value, float)
        )
        yield name, f"{place['kind']}, {place['journal_body']} in {place['bearing_body']}; {given}"


def _carried_drives(run: ReportedRun) -> Iterator[tuple[str, str]]:
    for dimension, word in (("drive", "drives"), ("spring", "springs")):
        if names := run.names(dimension):
            yield word, ", ".join(names)


# --- start and computation ---


def _start(run: ReportedRun, mechanism: Mechanism | None) -> Iterator[tuple[str, str]]:
    data = run.data
    for k, name in enumerate(run.names("joint")):
        angle, rate = (float(run.values(f"motion_{key}")[0, k]) for key in ("angle", "rate"))
        yield (
            name,
            f"{readable(angle, 'rad')}, " + (f"turning at {readable(rate, 'rad/s')}" if rate else "at rest"),
        )
    if "base_position" in data:
        place, turn = run.values("base_position")[0], run.values("base_attitude")[0]
        speed, spin = run.values("base_velocity")[0], run.values("base_angular_velocity")[0]
        text = f"at {_vector(place, 'm')}" if place.any() else "at the origin"
        if np.abs(turn[:3]).any():
            text += f", attitude {_vector(turn)} (quaternion xyzw)"
        if speed.any() or spin.any():
            text += f", moving at {_vector(speed, 'm/s')}, turning at {_vector(spin, 'rad/s')} (its own axes)"
        else:
            text += ", at rest"
        yield "base", text
    for k, name in enumerate(run.names("clearance_joint")):
        centre = run.values("journal_position")[0, k]
        tilt = float(run.values("journal_tilt")[0, k])
        where = "centred" if not centre.any() else f"centre at {_vector(1e6 * centre)} µm in bearing axes"
        yield (
            f"{name}, journal",
            f"{where}, {'not tilted' if tilt == 0.0 else 'tilted by ' + readable(tilt, 'rad')}",
        )


def _computation(run: ReportedRun) -> Iterator[tuple[str, str]]:
    scenario = run.run.scenario
    if scenario is not None:
        spec = scenario.integrator
        if spec.method == "rk4":
            how = f"rk4, fixed step {readable(spec.step, 's', _GIVEN)}"
        else:
            longest = readable(spec.max_step, "s")
            how = f"{spec.method}, relative tolerance {number(spec.rtol)}, steps up to {longest}"
        yield "integrator", how
        changed = {
            name: value
            for name, value in spec.scales.model_dump().items()
            if value != type(spec.scales).model_fields[name].default
        }
        if changed:
            yield (
                "error scales",
                ", ".join(f"{name.replace('_', ' ')} {number(v)}" for name, v in changed.items()),
            )
        yield "samples", f"{readable(scenario.output.rate, 'Hz')}, and at every contact event and force peak"
    counts = run.run.counts
    yield (
        "steps",
        f"{counts.accepted} accepted, {counts.rejected} rejected, {counts.relocated} cut to a change of "
        f"contact; {counts.evaluations} evaluations",
    )
    yield "time taken", readable(counts.wall_seconds, "s", 3)
