"""Variants of a scenario's URDF: flexible links, rotors, a shaken base, changed joints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.base.changes import JointChange
from antenna_pin.base.readable import alternatives
from antenna_pin.elements import FAMILIES
from antenna_pin.errors import MechanismError, ScenarioError
from antenna_pin.mechanism import (
    JointVariant,
    Urdf,
    WrittenUrdf,
    check_size,
    check_turns,
    with_rotor,
    with_shaken_base,
)
from antenna_pin.mechanism.flexible import ElasticPart, split
from antenna_pin.scenario import AnchorSpec, ElementSpec, JointsSpec, Scenario
from antenna_pin.scenario.assemble.places import as_written, check_known, where
from antenna_pin.scenario.clearance import TouchingSpec

# --- parts of flexible links --------------------------------------------------------------------------------


def with_flexible_links(scenario: Scenario, urdf: Urdf) -> tuple[Urdf, tuple[ElasticPart, ...]]:
    """Return a URDF whose flexible links are hubs with elastic parts, and these parts.

    Raises:
        AntennaPinError: A link or shape that there is not, or one that a part asks too much of.
    """
    found: list[ElasticPart] = []
    freedoms = len(urdf.robot.joints)
    for name, spec in scenario.flexible.items():
        links = {link.name for link in urdf.robot.links}
        check_known(scenario, [spec.link], "link", links, "flexible", name, "link")
        kind, place = spec.build(), where(scenario, "flexible", name)
        freedoms += len(kind.frequencies)
        check_size(place, freedoms, "take the modes of lowest frequency, or those of largest effective mass")
        made = split(kind, name, urdf.mass_properties(spec.link), place)
        urdf = urdf.with_parts(spec.link, made)
        found += made.parts
    return urdf, tuple(found)


def by_name(scenario: Scenario, parts: Iterable[ElasticPart]) -> dict[str, ElasticPart]:
    """Return elastic parts by name, which is also that of their joint and their spring.

    Raises:
        ScenarioError: A spring of the scenario has the name of a part.
    """
    found = {part.name: part for part in parts}
    for name in scenario.springs:
        if name in found:
            raise ScenarioError(
                f"{where(scenario, 'springs', name)}: must have another name than an elastic part of a "
                "flexible link, whose own spring bears it"
            )
    return found


# --- rotors -------------------------------------------------------------------------------------------------


def with_rotors(scenario: Scenario, urdf: Urdf) -> Urdf:
    """Return a URDF with the rotors of a scenario that are bodies; all are checked.

    Raises:
        AntennaPinError: A joint that there is not, or that does not turn about an axis of its own.
    """
    for name, spec in scenario.rotors.items():
        joints = [joint.name for joint in urdf.robot.joints]
        check_known(scenario, [spec.joint], "joint", joints, "rotors", name, "joint")
        try:
            rotor = spec.build()
            if rotor.kind == "exact":
                urdf = with_rotor(urdf, name, rotor)
            else:
                check_turns(urdf, name, rotor)
        except MechanismError as error:
            raise MechanismError(f"{where(scenario, 'rotors', name)}: {error}") from None
    return urdf


def armature_of(scenario: Scenario) -> dict[str, float]:
    """Return the armature of joints by their plain rotors, by name [kg m^2]."""
    found: dict[str, float] = {}
    for spec in scenario.rotors.values():
        if spec.kind == "armature":
            found[spec.joint] = found.get(spec.joint, 0.0) + spec.ratio**2 * spec.inertia
    return found


# --- shaken base --------------------------------------------------------------------------------------------


def with_shaken(scenario: Scenario, urdf: Urdf) -> Urdf:
    """Return a URDF whose base moves on joints, by a scenario's base motions.

    Raises:
        AntennaPinError: The base floats, or cannot be shaken so.
    """
    shakes = scenario.families.get("shake", {})
    for name, spec in shakes.items():
        place = where(scenario, "shake", name)
        if scenario.mechanism.base != "fixed":
            raise ScenarioError(
                f'{place}: mechanism.base must be "fixed" for a base that is shaken, got '
                f"{scenario.mechanism.base!r}; a free base is moved by forces"
            )
        actual = "translation" if spec.build().slides else "rotation"
        if spec.motion not in (None, actual):
            raise ScenarioError(
                f"{place}: units must be those of a {actual}, for the base is shaken "
                f"{'along a direction' if actual == 'translation' else 'about an axis'}, got units of a "
                f"{spec.motion}"
            )
    try:
        return with_shaken_base(urdf, {name: spec.build() for name, spec in shakes.items()})
    except MechanismError as error:
        raise MechanismError(f"{where(scenario, 'shake')}: {error}") from None


def elements_by_family(
    scenario: Scenario, families: dict[str, dict[str, Any]]
) -> Mapping[str, dict[str, Any]]:
    """Return elements by the system's families, from whichever scenario tables.

    Raises:
        ScenarioError: Two of one family have one name.
    """
    merged: dict[str, dict[str, Any]] = {}
    for table, elements in families.items():
        own = FAMILIES[table].among or table
        for name in elements.keys() & merged.get(own, {}).keys():
            raise ScenarioError(
                f"{where(scenario, table, name)}: must have another name than {own}.{name}, as both are "
                f"{own} of a system; rename one"
            )
        merged[own] = {**merged.get(own, {}), **elements}
    return merged


# --- variants of a URDF -------------------------------------------------------------------------------------

# --- where else a loop could be cut, for a joint with play that stands among the closures ---


def check_not_closures(scenario: Scenario, urdf: WrittenUrdf) -> None:
    """Refuse play at a closure: joints with play belong to the tree.

    Raises:
        ScenarioError: It names which joints of the tree could close the loop instead.
    """
    for name in scenario.clearance:
        if name in scenario.closures and name not in urdf.joints:
            raise ScenarioError(
                f"{where(scenario, 'clearance', name)}: must be a joint of the tree, got a closure; "
                f"{_way_out(scenario, urdf, name)}"
            )


def _way_out(scenario: Scenario, urdf: WrittenUrdf, name: str) -> str:
    types = {joint: one.type for joint, one in urdf.joints.items()}
    loop = [joint for joint in _loop(scenario, urdf, name) if types[joint] != "fixed"]
    ideal = [joint for joint in loop if not isinstance(scenario.clearance.get(joint), TouchingSpec)]
    if not ideal:
        which = f" ({alternatives(loop)})" if loop else ""
        return f"nothing is left to cut: give one joint of the loop no play{which}"
    elements = [one for named in scenario.families.values() for one in named.values()]
    acting = {one.joint for one in elements if isinstance(one, ElementSpec)}
    acting |= {end for one in elements if isinstance(one, JointsSpec) for end in (one.input, one.output)}
    free = [joint for joint in ideal if joint not in acting]
    if not free:
        return (
            f"all joints of its loop without play ({', '.join(ideal)}) have drives or springs, which act at "
            "joints of the tree: take them off one of these to cut the loop there"
        )
    return f"cut the loop at {alternatives(free)} instead, so that {name} can be a joint of the URDF"


def _loop(scenario: Scenario, urdf: WrittenUrdf, name: str) -> list[str]:
    """Return the joints of the tree between the two sides of a closure."""
    closure = scenario.closures[name]
    first, second = (_path(urdf, _link(urdf, side)) for side in (closure.first, closure.second))
    return [joint for joint in (*first, *second) if (joint in first) != (joint in second)]


def _link(urdf: WrittenUrdf, side: AnchorSpec) -> str:
    if side.link is not None:
        return side.link
    assert side.frame is not None
    children = {joint: one.child for joint, one in urdf.joints.items()}
    return children.get(side.frame, side.frame)


def _path(urdf: WrittenUrdf, link: str) -> list[str]:
    """Return the joints from a link to the root; none from the world."""
    above = {one.child: (joint, one.parent) for joint, one in urdf.joints.items()}
    found = []
    while link in above:
        joint, link = above[link]
        found.append(joint)
    return found


@takes()
def urdf_variant(scenario: Scenario) -> Urdf:
    """Return the URDF of a scenario's case, with changed joints and all overrides.

    Raises:
        MechanismError: The URDF is not a mechanism, or a change makes no sense.
        UnknownNameError: A link or joint that it does not have.
    """
    return variant_and_parts(scenario)[0]


def variant_and_parts(scenario: Scenario) -> tuple[Urdf, tuple[ElasticPart, ...]]:
    """Return the URDF of a scenario's case, and the elastic parts of its flexible links.

    Raises:
        MechanismError: The URDF is not a mechanism, or a change makes no sense.
        UnknownNameError: A link or joint that it does not have.
    """
    spec = scenario.mechanism
    urdf = as_written(scenario)
    check_known(scenario, spec.joints, "joint", urdf.joints, "mechanism.joints")
    check_known(scenario, spec.links, "link", urdf.links, "mechanism.links")
    check_not_closures(scenario, urdf)
    check_known(scenario, scenario.clearance, "joint", urdf.joints, "clearance")
    if scenario.pointing is not None:
        check_known(scenario, [scenario.pointing.body], "link", urdf.links, "pointing.body")
    _check_bounds(scenario, urdf)
    variants: dict[str, JointVariant] = {
        name: change.kind for name, change in spec.joints.items() if change.kind is not None
    }
    for name, clearance in scenario.clearance.items():
        kind = urdf.joints[name].type
        if kind not in clearance.urdf_types:
            names = alternatives(clearance.urdf_types)
            raise MechanismError(
                f"{where(scenario, 'clearance', name)}: a clearance joint must be {names} in the URDF, "
                f"got {kind} (model = {clearance.model!r}); name another joint or change the URDF"
            )
        # A ball joint has no URDF type: a joint written as floating is taken as it is.
        if kind != "floating":
            variants[name] = clearance.variant
    variants |= _on_bearings(scenario, urdf)
    changed = urdf.variant(
        joints=variants,
        links={name: change.build() for name, change in spec.links.items()},
        origins={
            name: change.build() for name, change in spec.joints.items() if change.build() != JointChange()
        },
    )
    return with_flexible_links(scenario, with_shaken(scenario, with_rotors(scenario, changed)))


def _on_bearings(scenario: Scenario, urdf: WrittenUrdf) -> dict[str, JointVariant]:
    """Return what becomes of the joints that bearings carry: without play they are free."""
    found: dict[str, JointVariant] = {}
    for name, spec in scenario.families.get("bearings", {}).items():
        place = where(scenario, "bearings", name)
        check_known(scenario, [spec.joint], "joint", urdf.joints, "bearings", name, "joint")
        kind, play = urdf.joints[spec.joint].type, scenario.clearance.get(spec.joint)
        if kind not in ("revolute", "continuous"):
            raise MechanismError(
                f"{place}: a bearing's joint must be revolute or continuous in the URDF, got {kind}; name "
                "another joint or change the URDF"
            )
        model = "none" if play is None else play.model
        if model in ("planar", "constraint"):
            raise MechanismError(
                f"{place}: clearance.{spec.joint}.model must leave the joint all its freedoms or be ideal, "
                f"got {model!r}; take one of the two away"
            )
        change = scenario.mechanism.joints.get(spec.joint)
        if change is not None and change.kind is not None:
            raise MechanismError(
                f"{where(scenario, 'mechanism', 'joints', spec.joint, 'kind')}: must be left out, for "
                f"bearing {name!r} decides it, got {change.kind!r}"
            )
        if spec.fills.frees:
            found[spec.joint] = "free"
    return found


def _check_bounds(scenario: Scenario, urdf: WrittenUrdf) -> None:
    """Refuse bounds of a joint in units of another motion."""
    for name, change in scenario.mechanism.joints.items():
        if change.lower is None and change.upper is None:
            continue
        kind = urdf.joints[name].type
        actual = "translation" if kind == "prismatic" else "rotation"
        if change.motion not in (None, actual):
            raise ScenarioError(
                f"{where(scenario, 'mechanism', 'joints', name)}: units must be those of a {actual}, "
                f"for joint {name!r} is {kind}, got units of a {change.motion}"
            )
