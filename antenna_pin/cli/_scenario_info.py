"""What ``antenna-pin info`` says of a scenario: joints, closures, couplings, motions, and what is free."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import typer

from antenna_pin.cli._common import load, say


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
    for line in (*_lines(facts), *_of_file(facts)):
        say(f"  {line}")


def _lines(facts: dict[str, Any]) -> Iterator[str]:
    from antenna_pin.analysis import said_of_constraints, said_of_coupling

    counts = facts["constraints"]
    joints = facts["joints"]
    moving, freedoms = _many(len(joints), "moving joint"), counts["freedoms"]
    yield f"{facts['base']} base, {moving}, {_many(freedoms, 'freedom')}"
    for joint, text in joints.items():
        yield f"joint {joint}: {text}"
    for closure, one in facts["closures"].items():
        first, second = one["links"]
        turned = "; the axes point opposite ways, and the second is taken the other way" * one["turned"]
        equations = _many(one["equations"], "equation")
        yield f"closure {closure}: {one['kind']}, {first} - {second}, {equations}{turned}"
    for coupling, one in facts["couplings"].items():
        yield f"coupling {coupling}: {said_of_coupling(one)}"
    for drive, text in facts["drives"].items():
        yield f"drive {drive}: {text}"
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
        for joint, far in facts["moved"].items():
            parts = [f"{math.degrees(far['turn']):.4g} deg"] * (far["turn"] > 0.0)
            parts += [f"{far['shift']:.4g} m"] * (far["shift"] > 0.0)
            yield f"moved far from where the search began: {joint} by {' and '.join(parts)}"


def _of_file(facts: dict[str, Any]) -> Iterator[str]:
    from antenna_pin.mechanism import PassedOver

    for what, lines in facts["passed_over"].items():
        yield f"passed over in the URDF: {PassedOver(what, tuple(lines)).said()}"
    if facts["unbounded"]:
        yield f"without bounds in the URDF: {', '.join(facts['unbounded'])}"
    if facts["points"]:
        yield f"taken as points, without moments in the URDF: {', '.join(facts['points'])}"


def _many(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
