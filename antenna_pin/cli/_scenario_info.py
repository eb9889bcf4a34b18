"""What ``antenna-pin info`` says of a scenario: joints, closures, couplings, motions, and what is free."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from antenna_pin.cli._common import load, say

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario


def names_scenario(text: str) -> bool:
    """Whether an argument is a scenario: a TOML file, a folder with one, or the name of a shipped one."""
    path = Path(text)
    if path.suffix == ".toml" or path.is_dir():
        return True
    if path.suffix or path.exists():
        return False
    from antenna_pin.scenario import list_scenarios

    return text in {one.name for one in list_scenarios()}


def say_scenario(name: str, case: str | None, settings: Sequence[str] | None, as_json: bool) -> None:
    """Print what a scenario is."""
    scenario = load(name, case, settings)

    from antenna_pin.assemble import scenario_facts

    facts = scenario_facts(scenario)
    if as_json:
        typer.echo(json.dumps({"scenario": scenario.name, "case": scenario.case or "", **facts}))
        return
    case_name = f", case {scenario.case}" if scenario.case else ""
    say(f"{scenario.name}{case_name}: {scenario.title}".rstrip(": "))
    for line in (*_lines(facts, scenario), *_of_file(facts)):
        say(f"  {line}")


def _lines(facts: dict[str, Any], scenario: Scenario) -> Iterator[str]:
    from antenna_pin.analysis import said_of_constraints, said_of_coupling, said_of_moving

    counts = facts["constraints"]
    joints = facts["joints"]
    moving, freedoms = _many(len(joints), "moving joint"), counts["freedoms"]
    yield f"{facts['base']} base, {moving}, {_many(freedoms, 'freedom')}"
    yield from _by_kind("joint", joints)
    closures = {
        name: f"{one['kind']}, {_many(one['equations'], 'equation')}"
        for name, one in facts["closures"].items()
    }
    yield from _by_kind("closure", closures, lambda name: _links(name, facts["closures"][name]))
    for coupling, one in facts["couplings"].items():
        yield f"coupling {coupling}: {said_of_coupling(one)}"
    # A drive's text ends in its joint, which mostly is called like it.
    alike = {name: text.removesuffix(f", at {name}") for name, text in facts["drives"].items()}
    shared = [text for text in set(alike.values()) if list(alike.values()).count(text) > 1]
    yield from _by_kind(
        "drive",
        {name: alike[name] if alike[name] in shared else text for name, text in facts["drives"].items()},
    )
    yield from _elements(scenario)
    yield said_of_constraints(counts)
    if facts["closures"] or facts["couplings"] or counts["motions"]:
        gap, turn = facts["residuals"]
        yield f"the start is closed to {gap:.2g} m and {turn:.2g} rad"
        slides = [joint for joint, text in joints.items() if text == "prismatic"]
        found = (
            f"{joint} {value:.6g} m" if joint in slides else f"{joint} {math.degrees(value):.6g} deg"
            for joint, value in facts["start"].items()
        )
        yield f"the start found: {', '.join(found) or 'no hinges or slides'}"
        if facts["moved"]:
            far = (f"{joint} by {_way(one)}" for joint, one in facts["moved"].items())
            yield f"moved far from where the search began: {', '.join(far)}"
        if moving := said_of_moving(counts, scenario):
            yield moving


def _by_kind(
    noun: str, kinds: Mapping[str, str], told: Callable[[str], str] = str, nouns: str = ""
) -> Iterator[str]:
    """Yield a line for each kind of thing, with the names of those of it."""
    names: dict[str, list[str]] = {}
    for name, kind in kinds.items():
        names.setdefault(kind, []).append(name)
    for kind, several in names.items():
        if len(several) == 1:
            yield f"{noun} {told(several[0])}: {kind}"
        else:
            each = " each" * ("equation" in kind)
            yield f"{len(several)} {nouns or noun + 's'} {', '.join(map(told, several))}: {kind}{each}"


def _links(name: str, closure: Mapping[str, Any]) -> str:
    """Return a closure's name with what it joins."""
    turned = "; the axes point opposite ways, and the second is taken the other way" * closure["turned"]
    return f"{name} ({' - '.join(closure['links'])}{turned})"


def _way(far: Mapping[str, float]) -> str:
    parts = [f"{math.degrees(far['turn']):.4g} deg"] * (far["turn"] > 0.0)
    return " and ".join([*parts, *[f"{far['shift']:.4g} m"] * (far["shift"] > 0.0)])


# Tables of a scenario whose entries are told by their kind: of one, of several.
_TABLES = {
    "springs": "spring",
    "stops": "stop",
    "latches": "latch",
    "gears": "gear",
    "bearings": "bearing",
    "forces": "force",
    "flexible": "flexible link",
    "controllers": "controller",
    "events": "event",
}


def _elements(scenario: Scenario) -> Iterator[str]:
    """Yield what a scenario has besides, by table and kind."""
    for table, noun in _TABLES.items():
        kinds = {name: str(one.kind) for name, one in (getattr(scenario, table, None) or {}).items()}
        yield from _by_kind(noun, kinds, nouns=table.replace("flexible", "flexible links"))
    for name, link in scenario.flexible.items():
        if reading := getattr(link, "reading", ""):
            yield f"flexible.{name}: {_many(len(link.frequency), 'mode')} of {link.file}, read from {reading}"


def _of_file(facts: dict[str, Any]) -> Iterator[str]:
    from antenna_pin.mechanism import PassedOver

    for what, lines in facts["passed_over"].items():
        yield f"passed over in the URDF: {PassedOver(what, tuple(lines)).said()}"
    if facts["unbounded"]:
        yield f"without bounds in the URDF: {', '.join(facts['unbounded'])}"
    if facts["points"]:
        yield f"taken as points, without moments in the URDF: {', '.join(facts['points'])}"
    if facts["unlimited"]:
        yield f"continuous, whatever bounds the URDF states: {', '.join(facts['unlimited'])}"
    for line in facts["impossible"]:
        yield f"inertia that no body has: {line}"


def _many(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
