"""Closures, couplings and motions in words; they need no result, but what is counted."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import GIVEN, number, readable
from antenna_pin.scenario import Scenario

_MINUS = "\N{MINUS SIGN}"
_NAMED = 5  # singular positions, and joints, that are said


@takes()
def said_of_constraints(counts: Mapping[str, Any]) -> str:
    """Return a sentence on the equations of closures and couplings, and the mobility.

    Mobility is everywhere what the closures leave, prescribed motions not counted.
    """
    equations, rank, motions = (counts[key] for key in ("closure_equations", "closure_rank", "motions"))
    mobility, left = counts["mobility"], counts["freedoms_left"]
    couplings = counts.get("couplings", 0)
    of = " and ".join(["closures"] * (equations > couplings) + ["couplings"] * (couplings > 0))
    parts = [f"{_many(equations, 'equation')} of {of}, {rank} independent" if equations else "no closures"]
    if equations > rank:
        parts[0] += f" ({_redundant(counts)})"
    if motions:
        parts.append(_many(motions, "motion"))
    leave = "of which the motion leaves" if motions == 1 else "of which the motions leave"
    parts.append(f"mobility {mobility}" + (f", {leave} {left}" if motions else ""))
    return "; ".join(parts)


@takes()
def said_of_coupling(one: Mapping[str, Any]) -> str:
    """Return a coupling as an equation: "finger = 2 · thumb + 5 mm"."""
    follower, leader = ("m" if one[key] else "rad" for key in ("slides", "leader_slides"))
    ratio = "" if follower == leader else f"{follower}/{leader}"
    factor = readable(one["multiplier"], ratio, GIVEN) if ratio else number(one["multiplier"], GIVEN)
    times = "" if factor == "1" else f"{factor} · "
    if (second := one.get("second")) is not None:
        own = "m" if one["second_slides"] else "rad"
        said = readable(abs(one["second_multiplier"]), "" if own == follower else f"{follower}/{own}", GIVEN)
        sign = "+" if one["second_multiplier"] > 0.0 else _MINUS
        other = f" {sign} {'' if said == '1' else f'{said} · '}{second}"
    else:
        other = ""
    offset = one["offset"]
    behind = f" {'+' if offset > 0.0 else _MINUS} {readable(abs(offset), follower, GIVEN)}" if offset else ""
    return f"{one['follower']} = {times}{one['leader']}{other}{behind}"


@takes()
def said_of_singular(counts: Mapping[str, Any]) -> str:
    """Return a sentence on the singular positions of a run; empty without any."""
    found = counts.get("singular", [])
    if not found:
        return ""
    times = ", ".join(readable(one["time"], "s", 4) for one in found[:_NAMED])
    more = f" and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
    return (
        f"passed {_many(len(found), 'singular position')}, at {times}{more}: where the motion of the loops "
        f"is not unique"
    )


@takes()
def said_of_moving(counts: Mapping[str, Any], scenario: Scenario) -> str:
    """Return a sentence on initial rates that follow from others; empty without any."""
    given = {name for name, one in scenario.initial.joints.items() if not one.guess and one.gives_a_rate}
    if scenario.initial.base.moves:
        given.add("base")
    found = {name: one for name, one in counts.get("moving", {}).items() if name not in given}
    if not found:
        return ""
    some = [f"{name} {readable(one['rate'], one['unit'])}" for name, one in found.items()][:_NAMED]
    more = f" and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
    return f"initial rates that follow from those given: {', '.join(some)}{more}"


def _many(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _redundant(counts: Mapping[str, Any]) -> str:
    """Return the number of redundant equations, and their closures."""
    found = counts["closure_equations"] - counts["closure_rank"]
    closures = counts.get("redundant", {})
    shared = sum(one["equations"] for one in closures.values()) > found
    places = []
    for name, one in closures.items():
        exact = len(one["among"]) == one["equations"]
        rows = ", ".join(one["among"]) if exact else f"{one['equations']} of {', '.join(one['among'])}"
        places.append(f"{name}: {rows}")
    return f"{found} redundant{', shared among' if shared else ','} {'; '.join(places)}"
