"""Description of the runs, from their scenario and mechanism."""

from __future__ import annotations

import itertools
import json
from collections.abc import Collection, Iterator, Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import (
    closures_of,
    couplings_of,
    drives_of,
    elastic_parts_of,
    mechanism_of,
    said_of_coupling,
)
from antenna_pin.base.readable import GIVEN, number, printed_unit, readable
from antenna_pin.elements import FAMILIES, ForceElement, JointFriction
from antenna_pin.errors import AntennaPinError
from antenna_pin.joints.geometry import LOOKS
from antenna_pin.mechanism import Mechanism
from antenna_pin.scenario import ClearanceSpec, PointingSpec, Scenario, TouchingSpec
from antenna_pin.scenario.clearance import words_of_assumed
from antenna_pin.show.report._page import Section, Statement
from antenna_pin.show.report._runs import ReportedRun, labels_of
from antenna_pin.trajectory.quantities import slides_along

# --- laws of contact and friction in words, with all parameters as they were used, and materials ---

# What contacts of a kind are called, of joints that have several.
_PLACES = {"radial": "bore", "axial": "flanges", "wall": "walls"}


def words_of_laws(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield the laws of each joint with clearance, their limits, and materials."""
    scenario = run.run.scenario
    joints: dict[str, dict[str, Any]] = json.loads(run.data.attrs.get("clearance_joints", "{}"))
    for name, joint in joints.items():
        contacts = joint["contacts"].values()
        said = {_PLACES.get(of["kind"], of["kind"]): _law(of["normal_law"]) for of in contacts}
        if len(set(said.values())) == 1:
            said = {"contact": next(iter(said.values()))}
        for place, text in said.items():
            yield f"{name}, {place}", text
        yield f"{name}, friction", _law(joint["friction_law"])
        floor = readable(joint["approach_speed_floor"], "m/s", GIVEN)
        deepest = readable(min(of["depth_limit"] for of in contacts), "m", GIVEN)
        yield (
            f"{name}, limits",
            f"approach speeds count as {floor} at least; a run ends at a depth of {deepest}",
        )
        if scenario is None:
            continue
        spec = scenario.clearance[name]
        if parts := words_of_assumed(spec):
            yield f"{name}, assumed", parts
        for part, material in zip(("bearing", "journal"), getattr(spec, "materials", ()), strict=False):
            if material is not None:
                yield f"{name}, {part}'s material", _material(scenario, material)


def _material(scenario: Scenario, name: str) -> str:
    found = scenario.material(name)
    young, poisson = readable(found.young, "Pa", 5), number(found.poisson, 5)
    return f"{name}: Young's modulus {young}, Poisson's ratio {poisson}"


def _law(law: dict[str, Any]) -> str:
    """Return a law that a result carries, with all its parameters."""
    given = ", ".join(
        f"{name.replace('_', ' ')} {readable(value, unit, 6)}"
        for name, (value, unit) in law["parameters"].items()
    )
    text = f"{law['law']}: {given}" if given else str(law["law"])
    return f"{text}; dissipation {_law(law['dissipation'])}" if "dissipation" in law else text


# --- flexible links in words: their elastic parts, those that are alike together ---


def words_of_flexible(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield each flexible link of a run, with its elastic parts."""
    about = elastic_parts_of(run.run)
    for hub in dict.fromkeys(one["hub"] for one in about.values()):
        texts = []
        mine = [(name, one) for name, one in about.items() if one["hub"] == hub]
        for said, group in itertools.groupby(mine, key=lambda pair: _elastic_part(pair[1])):
            names = [name for name, _ in group]
            texts.append(
                f"{names[0]}: {said}"
                if len(names) == 1
                else f"{names[0]} to {names[-1]}, {len(names)} in all: each {said}"
            )
        yield hub, "; ".join(texts)


def _elastic_part(part: dict[str, Any]) -> str:
    unit, verb = ("kg", "slides") if part["slides"] else ("kg m^2", "turns")
    return (
        f"{readable(part['moved'], unit, 4)} that {verb} against a spring, "
        f"{readable(part['frequency'], 'Hz', 5)} with the hub held, "
        f"damping ratio {number(part['damping_ratio'], 4)}"
    )


# --- drives, springs and forces in words: each knows its own ---


def words_of_elements(scenario: Scenario, sliding: Collection[str]) -> Iterator[tuple[str, str]]:
    """Yield each element of a scenario, with what it does, by the joints that slide."""
    for table, specs in scenario.families.items():
        for name, spec in specs.items():
            element: ForceElement = spec.build()
            slides = getattr(spec, "motion", None) == "translation" or element.acts_at in sliding
            text = element.words(slides)
            if element.acts_at not in (None, name):
                text += f", at {element.acts_at}"
            clearance = scenario.clearance.get(element.acts_at or "")
            play = clearance is not None and clearance.model != "ideal"
            if play and element.about in ("bearing", "journal"):
                text += f", about the {element.about}'s axis"
            yield f"{FAMILIES[table].word} {name}", text + ("" if element.acts else ", off at the start")


def words_of_bearings(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield what bearings of a run carried."""
    for k, name in enumerate(run.names("bearing")):
        force, moment = (float(run.data[f"peak_bearing_{what}"][k]) for what in ("force", "moment"))
        yield (
            f"load of bearing {name}",
            f"at most {readable(force, 'N')} and {readable(moment, 'N m')} at a sample",
        )


def words_of_forces(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield what forces on links have brought in."""
    for k, name in enumerate(run.names("force")):
        impulse, turning = (
            float(np.linalg.norm(run.data[f"total_{what}"].values[k]))
            for what in ("impulse", "angular_impulse")
        )
        work = float(run.data["total_force_work"][k])
        yield (
            f"impulse of force {name}",
            f"{readable(impulse, 'N s')} and {readable(turning, 'N m s')} about the world's origin, "
            f"work {readable(work, 'J')}",
        )


def words_of_friction(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield the friction that joints of a run have of their own."""
    springs = () if run.run.scenario is None else run.run.scenario.springs
    for name, given in json.loads(run.data.attrs.get("joint_friction", "{}")).items():
        if name in springs:  # said there
            continue
        slides = given.pop("slides")
        yield f"friction of joint {given['joint']}", JointFriction(**given).words(slides)


def names_of_elements(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield names of drives, springs and forces of a system built in Python."""
    about = drives_of(run.run)
    for dimension, word in (("drive", "drives"), ("spring", "springs"), ("force", "forces")):
        motions = {name: one["joint"] for name, one in about.items() if one.get("motion")}
        names = (
            f"{name} (prescribed motion of {motions[name]})" if name in motions else name
            for name in run.names(dimension)
        )
        if text := ", ".join(names):
            yield word, text


# --- closures of loops and couplings in words: what they join, where, and along what ---


def words_of_closures(run: ReportedRun, mechanism: Mechanism) -> Iterator[tuple[str, str]]:
    """Yield each closure of a loop, but those that hold a tree's joint."""
    for name, closure in closures_of(run.run).items():
        if name in mechanism.joints:
            continue
        places = []
        for side in ("first", "second"):
            seven = np.array(closure[f"{side}_placement"])
            text = f"{closure[f'{side}_body']} at ({', '.join(readable(float(x), 'm') for x in seven[:3])})"
            if closure["axis"]:
                axis = Rotation.from_quat(seven[3:]).as_matrix()[:, 2]
                text += f", axis ({', '.join(number(float(x), 5) for x in _cleared(axis))})"
            places.append(text)
        yield name, f"{closure['kind']}, {closure['equations']} equations: {places[0]}; {places[1]}"


def _cleared(axis: np.ndarray) -> np.ndarray:
    """Return a direction without the round-off of a quaternion."""
    return np.where(np.abs(axis) < 1e-12, 0.0, axis)


# --- joints with clearance in words; those of a kind are its own (:class:`antenna_pin.joints.geometry.Look`)
# ---

#: What is said of a joint that a scenario's table ``[clearance]`` describes, and that has no play.
_WITHOUT_PLAY = {"constraint": "without play, held by constraint", "ideal": "without play"}


def how_held(spec: ClearanceSpec) -> str:
    """Return what holds a joint together."""
    return LOOKS[spec.kind].held if isinstance(spec, TouchingSpec) else _WITHOUT_PLAY[spec.model]


def words_of_clearances(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield each joint with play, with its dimensions and how its contacts are found."""
    for name, spec in scenario.clearance.items():
        if not isinstance(spec, TouchingSpec):
            continue
        parts = LOOKS[spec.kind].dimensions(spec.sizes())
        if spec.fit is not None:
            parts.append(f"fit {spec.fit}")
        if scenario.temperature is not None:
            parts.append("dimensions at the reference temperature; the assumptions say the play used")
        if spec.offset:
            parts.append(f"{readable(spec.offset, 'm', GIVEN)} along the axis from the joint's origin")
        if spec.bearing_on == "child":
            parts.append("the bearing is on the joint's child")
        gaps = "coal's distance queries" if spec.geometry == "coal" else "the closed form"
        parts.append(f"gaps by {gaps}")
        if spec.load == "distributed":
            parts.append(
                f"load spread over {spec.strips} strips of the bore and {spec.sectors} sectors of each flange"
            )
        else:
            parts.append("one force at each contact")
        yield name, "; ".join(parts)


#: Of dimensions that are no lengths.
_UNITS = {"roll": "rad"}


def words_of_carried_clearances(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield the clearance joints of a system built in Python."""
    places: dict[str, Any] = json.loads(run.data.attrs.get("clearance_joints", "{}"))
    for name, place in places.items():
        given = ", ".join(
            f"{key.replace('_', ' ')} {readable(value, _UNITS.get(key, 'm'), GIVEN)}"
            for key, value in place["dimensions"].items()
            if isinstance(value, float)
        )
        yield name, f"{place['kind']}, {place['journal_body']} in {place['bearing_body']}; {given}"


_KINDS = {
    "revolute": "turns about the axis",
    "continuous": "turns without end about the axis",
    "prismatic": "slides along the axis",
    "floating": "free in six directions, axis",
    "planar": "free in the plane across the axis",
    "spherical": "turns in all directions, axis",
}

Words = dict[str, str]
"""Text on one run in a section, by label."""

_ORDER = (
    "Scenario",
    "Mechanism",
    "Joints",
    "Closures",
    "Couplings",
    "Flexible links",
    "Clearance",
    "Contact and friction",
    "Controllers",
    "Drives and springs",
    "Start",
    "Computation",
)


def scenario_sections(runs: Sequence[ReportedRun]) -> list[Section]:
    """Return the sections that describe the runs; facts common to all runs are stated once."""
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


def _merged(statements: Sequence[Words], labels: Sequence[str]) -> Iterator[Statement]:
    """Yield one statement per label, with its runs unless it applies to all."""
    for label in dict.fromkeys(label for words in statements for label in words):
        by_text: dict[str, list[str]] = {}
        for words, name in zip(statements, labels, strict=True):
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
        yield "Closures", dict(words_of_closures(run, mechanism))
        yield "Couplings", {name: said_of_coupling(one) for name, one in couplings_of(run.run).items()}
    yield "Flexible links", dict(words_of_flexible(run))
    if scenario is not None:
        yield "Clearance", dict(words_of_clearances(scenario))
        yield "Controllers", {name: _controller(table) for name, table in scenario.controllers.items()}
        elements = words_of_elements(scenario, slides_along(run.data, "sliding_joint"))
    else:
        yield "Clearance", dict(words_of_carried_clearances(run))
        elements = names_of_elements(run)
    carried = (*words_of_bearings(run), *words_of_forces(run), *words_of_friction(run))
    yield "Drives and springs", dict((*elements, *carried))
    yield "Contact and friction", dict(words_of_laws(run))
    yield "Start", dict(_start(run, mechanism))
    yield "Computation", dict(_computation(run))


def _controller(table: Any) -> str:
    """Return a controller in words, with its sampling."""
    own = table.build()
    late = f", {own.delay:g} s late" if own.delay else ""
    late = f", {own.delay_periods:g} periods late" if own.delay_periods else late
    return f"{own.words()}, every {own.period:g} s{late}, commands {', '.join(own.commands)}"


def _vector(values: Sequence[float] | np.ndarray, unit: str = "1", digits: int = 5) -> str:
    text = ", ".join(number(float(value), digits) for value in values)
    return f"({text}) {printed_unit(unit)}".rstrip()


def _scenario(scenario: Scenario, label: str) -> Iterator[tuple[str, str]]:
    title = f"{scenario.name}: {scenario.title}" if scenario.title else scenario.name
    yield "scenario", title or "without a name"
    if scenario.case:
        # The run's label says its case already, as a rule.
        said = scenario.case == label and bool(scenario.description)
        yield "case", ": ".join(filter(None, ("" if said else scenario.case, scenario.description)))
    yield "simulated time", readable(scenario.duration, "s", GIVEN)
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
    if allowed := mechanism.urdf.allow_impossible_inertia:
        yield "inertia against the triangle rule, allowed by name", ", ".join(allowed)


def _joints(
    mechanism: Mechanism, scenario: Scenario | None, run: ReportedRun
) -> Iterator[tuple[str, str]]:  # fmt: skip
    closures, elastic = closures_of(run.run), elastic_parts_of(run.run)
    for name, slot in mechanism.joints.items():
        if name in elastic:
            continue
        joint = mechanism.urdf.joint(name)
        body = mechanism.bodies[slot.joint_id - 1]
        kind = closures[name]["kind"] if name in closures else slot.kind  # free in the tree, and held
        text = f"carries {body} on {joint.parent}; {_KINDS[kind]} {_vector(slot.axis)}"
        if scenario is not None and name in scenario.clearance:
            text += f"; {how_held(scenario.clearance[name])}"
        elif name in run.names("clearance_joint"):
            text += "; with play, held by contact"
        elif name in closures:
            text += "; without play, held by constraint"
        if scenario is not None:
            bearings = scenario.families.get("bearings", {})
            if own := [one for one, spec in bearings.items() if spec.joint == name]:
                text += f"; on bearing{'s' if own[1:] else ''} {', '.join(own)}"
        yield name, text
    joints = {} if scenario is None else scenario.mechanism.joints
    if locked := [name for name, joint in joints.items() if joint.kind == "locked"]:
        yield "locked", ", ".join(locked)


# --- start and computation ---


def _start(run: ReportedRun, mechanism: Mechanism | None) -> Iterator[tuple[str, str]]:
    data = run.data
    for dimension, series, unit, verb in (
        ("sliding_joint", ("slide_position", "slide_rate"), "m", "sliding"),
        ("joint", ("motion_angle", "motion_rate"), "rad", "turning"),
    ):
        for k, name in enumerate(run.names(dimension)):
            place, speed = (float(_sample(run, one)[k]) for one in series)
            moving = f"{verb} at {readable(speed, f'{unit}/s')}" if speed else "at rest"
            yield name, f"{readable(place, unit)}, {moving}"
    if "base_position" in data:
        place, turn = _sample(run, "base_position"), _sample(run, "base_attitude")
        speed, spin = _sample(run, "base_velocity"), _sample(run, "base_angular_velocity")
        text = f"at {_vector(place, 'm')}" if place.any() else "at the origin"
        if np.abs(turn[:3]).any():
            text += f", attitude {_vector(turn)} (quaternion xyzw)"
        if speed.any() or spin.any():
            text += f", moving at {_vector(speed, 'm/s')}, turning at {_vector(spin, 'rad/s')} (its own axes)"
        else:
            text += ", at rest"
        yield "base", text
    for k, name in enumerate(run.names("clearance_joint")):
        centre = _sample(run, "journal_position")[k]
        tilt = float(_sample(run, "journal_tilt")[k])
        where = "centred" if not centre.any() else f"centre at {_vector(1e6 * centre)} µm in bearing axes"
        turned = f"tilted by {readable(tilt, 'rad')}" if tilt else "not tilted"
        yield f"{name}, journal", f"{where}, {turned}"


def _sample(run: ReportedRun, name: str) -> Any:
    """Return a variable's first sample, without reading the rest."""
    return np.asarray(run.data[name][0].values)


def _computation(run: ReportedRun) -> Iterator[tuple[str, str]]:
    scenario = run.run.scenario
    if scenario is not None:
        spec = scenario.integrator
        if spec.method == "rk4":
            how = f"rk4, fixed step {readable(spec.step, 's', GIVEN)}"
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
            scales = (f"{name.replace('_', ' ')} {number(value)}" for name, value in changed.items())
            yield "error scales", ", ".join(scales)
        yield "samples", f"{readable(scenario.output.rate, 'Hz')}, and at every contact event and force peak"
    counts = run.run.counts
    yield (
        "steps",
        f"{counts.accepted} accepted, {counts.rejected} rejected, {counts.relocated} cut to a change of "
        f"contact; {counts.evaluations} evaluations",
    )
    yield "time taken", readable(counts.wall_seconds, "s", 3)
    if counts.compile_seconds:
        yield "compiling, once", readable(counts.compile_seconds, "s", 3)
