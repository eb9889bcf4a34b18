"""What random mechanisms get besides play: stops, friction that holds or bends, gears, closures, modes."""

from __future__ import annotations

import math
import re

import numpy as np
import pinocchio as pin
from scenario_generator import dealt, own_inertias

from antenna_pin import Scenario, build_system
from antenna_pin.scenario.assemble import initial_state

_KINDS = ("none", "stop", "rigid stop", "sticking", "lugre", "gear", "closure", "modes", "motion")
# Part of its link's mass that a mode has, and how stiff elements are [Hz].
_OF_MODE, _STIFF = 0.2, 100.0
# How many ideal joints what a ball joint holds must be left to, at the least: it holds three ways.
_LEAST = 3


def with_more(scenario: Scenario, seed: int, number: int) -> tuple[Scenario, str, tuple[str, ...]]:
    """Return a random scenario with something more, what that is, and which of its numbers are to be varied.

    Where its joints allow none of the kind that is dealt it gets the next one that they allow.
    """
    first = _KINDS.index(dealt(_KINDS, seed, "more", number))
    masses = {
        name: float(mass)
        for name, mass in re.findall(r'<link name="(\w+)">.*?<mass value="([^"]+)"', scenario.urdf_text or "")
    }
    last = sorted(masses)[-1]
    scenario = scenario.with_overrides({f"mechanism.links.{last}.mass": masses[last]})
    own = (f"mechanism.links.{last}.mass",)
    if _KINDS[first] == "none":
        return scenario, "none", own
    for kind in (*_KINDS[first:], *_KINDS[1:first]):
        more, keys = _more(kind, scenario, masses)
        if more:
            return scenario.with_overrides(more), kind, (*own, *keys)
    raise AssertionError("modes are always allowed")


def _more(
    kind: str, scenario: Scenario, masses: dict[str, float]
) -> tuple[dict[str, object], tuple[str, ...]]:
    """Return changes of a scenario, and keys; nothing where it has not the joints."""
    system = build_system(scenario)
    starts = {name: one for name, one in scenario.initial.joints.items() if name not in scenario.clearance}
    turning = [name for name in starts if system.mechanism.joints[name].kind == "revolute"]
    if kind == "modes":
        link = sorted(masses)[-1]
        centres = re.findall(f'<link name="{link}">.*?<origin xyz="([^"]+)"', scenario.urdf_text or "")
        mode = {
            "frequency": 0.5 * _STIFF,
            "damping_ratio": 0.01,
            "mass": _OF_MODE * masses[link],
            "direction": [1.0, 0.0, 0.0],
            "place": [float(word) for word in centres[0].split()],
        }
        return {f"flexible.{link}": {"kind": "modes", "modes": {"bend": mode}}}, ()
    if not starts:
        return {}, ()
    if kind == "closure":
        return _closure(scenario, list(starts), sorted(masses)), ()
    joint = turning[0] if turning else ""
    if not joint or (kind == "gear" and len(turning) < 2):
        return {}, ()
    inertia = own_inertias(scenario, system)[joint]
    place, rate = (float(getattr(starts[joint], name) or 0.0) for name in ("position", "velocity"))
    way, stiffness = 0.3 * abs(rate) * scenario.duration, inertia * (2.0 * math.pi * _STIFF) ** 2
    coulomb = 2.0 * inertia * abs(rate) / scenario.duration
    ends = {"joint": joint, "lower": place - way, "upper": place + way, "restitution": 0.6}
    if kind == "stop":
        return {"stops.more": {**ends, "stiffness": stiffness}}, ("stops.more.stiffness",)
    if kind == "rigid stop":
        return {"stops.more": {**ends, "kind": "rigid"}}, ("stops.more.restitution",)
    if kind == "sticking":
        friction = {"joint": joint, "coulomb": coulomb, "static": 1.5 * coulomb}
        return {"frictions.more": friction}, ("frictions.more.coulomb",)
    if kind == "lugre":
        bristles = {"stiffness": coulomb / (0.1 * way), "damping": 0.0, "stribeck_rate": 0.1 * abs(rate)}
        friction = {"joint": joint, "kind": "lugre", "coulomb": coulomb, "static": 1.5 * coulomb, **bristles}
        return {"frictions.more": friction}, ("frictions.more.coulomb",)
    if kind == "gear":
        teeth = {
            "input": joint,
            "output": turning[1],
            "ratio": 2.0,
            "stiffness": stiffness,
            "play": 0.1 * way,
        }
        return {"gears.more": teeth}, ("gears.more.stiffness",)
    motion = {"joint": joint, "kind": "motion", "rate": rate, "position": place}
    return {f"drives.drive_{joint}": motion | {"replace": True}}, ()


def _closure(scenario: Scenario, ideal: list[str], links: list[str]) -> dict[str, object]:
    """Return a ball joint that closes a loop with three ideal joints or more, where there is such."""
    if len(ideal) < _LEAST:
        return {}
    system = build_system(scenario)
    q, _ = initial_state(scenario, system)
    model = system.mechanism.model
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    first, last = (data.oMf[system.mechanism.frame(name)] for name in (links[0], links[-1]))
    point = np.array([0.05, 0.0, 0.1])
    sides = {
        "first": {"link": links[0], "point": first.actInv(last.act(point)).tolist()},
        "second": {"link": links[-1], "point": point.tolist()},
    }
    guesses = {f"initial.joints.{name}.guess": True for name in ideal}
    return {"closures.more": {"kind": "spherical", **sides}, **guesses}
