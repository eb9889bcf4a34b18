"""What joints may have besides play, dealt to the joints of a random scenario.

Sizes follow from how far a joint goes in the time of the run and from its own inertia, so that stops are
struck, latches capture and refuse, frictions stick. At a joint with play stand those that act about its axis.
An element follows from seed, number and joint alone; a scenario without them stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scenario_generator import own_inertias

from antenna_pin import Scenario, build_system

Random = np.random.Generator
Table = dict[str, Any]

_SHARE = 0.45  # of the joints that each kind is dealt to


class _Joint:
    """A joint as elements see it: its name, where it is, how fast, how heavy, how far it goes."""

    def __init__(self, scenario: Scenario, name: str, inertia: float) -> None:
        """Read it from a scenario."""
        start = scenario.initial.joints[name]
        self.name, self.inertia = name, inertia
        self.play = name in scenario.clearance
        self.at = float((start.angle if self.play else start.position) or 0.0)
        self.rate = float((start.rate if self.play else start.velocity) or 0.0)
        self.time = float(scenario.duration)
        self.way = max(abs(self.rate) * self.time, 1e-3)
        self.effort = max(inertia * max(abs(self.rate), 0.1) / self.time, 1e-6)


def _stop(rng: Random, joint: _Joint) -> tuple[str, Table]:
    table: Table = {
        "lower": joint.at - joint.way * rng.uniform(0.3, 0.8),
        "upper": joint.at + joint.way * rng.uniform(0.3, 0.8),
        "restitution": rng.uniform(0.2, 1.0),
    }
    if not joint.play and rng.random() < 0.5:
        more = {"kind": "rigid", "upper_restitution": rng.uniform(0.0, 1.0)}
    else:
        # A touch takes a tenth of the run; a share of them differ above.
        stiffness = joint.inertia * (10.0 * np.pi / joint.time) ** 2
        more = {"stiffness": stiffness, "exponent": float(rng.choice([1.0, 1.5]))}
        if rng.random() < 0.4:
            damping = 0.1 * np.sqrt(stiffness * joint.inertia)
            more |= {"upper_law": "kelvin-voigt", "upper_damping": damping, "upper_exponent": 1.0}
    return "stops", table | more


def _latch(rng: Random, joint: _Joint) -> tuple[str, Table]:
    way = np.sign(joint.rate) or 1.0
    table: Table = {"angle": joint.at + way * joint.way * rng.uniform(0.05, 0.2), "width": 0.05 * joint.way}
    energy = 0.5 * joint.inertia * joint.rate**2
    if energy > 0.0 and rng.random() < 0.7:
        table["greatest_energy"] = energy * rng.uniform(0.3, 3.0)
    if rng.random() < 0.3:
        table["greatest_rate"] = abs(joint.rate) * rng.uniform(0.5, 2.0) + 1e-3
    if not joint.play and rng.random() < 0.5:
        return "latches", table | {"kind": "rigid"}
    stiffness = joint.inertia * (20.0 / joint.time) ** 2
    spring = {"stiffness": stiffness, "damping": 0.3 * np.sqrt(stiffness * joint.inertia)}
    return "latches", table | spring | {"play": float(rng.choice([0.0, 0.02 * joint.way]))}


def _friction(rng: Random, joint: _Joint) -> tuple[str, Table]:
    coulomb, slow = joint.effort * rng.uniform(0.1, 2.0), max(0.3 * abs(joint.rate), 1e-2)
    kinds = ["dahl", "lugre", "gonthier-bristle", *([] if joint.play else ["sticking"] * 3)]
    kind = str(rng.choice(kinds))
    table: Table = {"kind": kind, "coulomb": coulomb}
    if kind != "dahl":
        table |= {"static": coulomb * rng.uniform(1.0, 1.5), "stribeck_rate": slow}
    if kind != "sticking":
        stiffness = joint.inertia * (10.0 / joint.time) ** 2
        table["stiffness"] = stiffness
        if kind != "dahl":
            table["damping"] = 0.5 * np.sqrt(stiffness * joint.inertia)
    if kind == "gonthier-bristle":
        table["dwell_time"] = 0.2 * joint.time
    return "frictions", table


def _spring(rng: Random, joint: _Joint) -> tuple[str, Table]:
    stiffness = joint.inertia * (5.0 / joint.time) ** 2
    made: tuple[Callable[[], Table], ...] = (
        lambda: {
            "kind": "bouc-wen",
            "alpha": 0.3,
            "stiffness": stiffness,
            "yield_angle": 0.2 * joint.way,
            "rest_angle": joint.at,
        },
        lambda: {
            "kind": "maxwell-slip",
            "stiffness": [stiffness, 0.5 * stiffness],
            "slip": [0.1 * joint.way * stiffness, 0.2 * joint.way * stiffness],
        },
        lambda: {
            "kind": "constant-torque",
            "torque": joint.effort * rng.uniform(-1.0, 1.0),
            "upper": joint.at + 0.2 * joint.way,
            "ramp": 0.1 * joint.way,
        },
        lambda: {
            "kind": "table",
            "angle": [joint.at - 2.0 * joint.way, joint.at, joint.at + 2.0 * joint.way],
            "torque": [joint.effort, 0.1 * joint.effort, -joint.effort],
        },
        lambda: {
            "kind": "harness",
            "angle": [joint.at - joint.way, joint.at + joint.way],
            "torque": [0.2 * joint.effort, -0.4 * joint.effort],
            "torque_back": [0.3 * joint.effort, -0.2 * joint.effort],
            "reversal": 0.05 * joint.way,
        },
    )
    return "springs", made[int(rng.integers(len(made)))]()


def _drive(rng: Random, joint: _Joint) -> tuple[str, Table]:
    swing = {"kind": "sine", "amplitude": 0.2 * joint.way, "frequency": 2.0 / joint.time}
    stiffness = joint.inertia * (5.0 / joint.time) ** 2
    if not joint.play and rng.random() < 0.4:
        own = {"kind": "motor", "torque_constant": joint.effort, "resistance": 1.0, "ratio": 1.0}
        return "drives", own | {"inductance": float(rng.choice([0.0, 0.1 * joint.time]))}
    return "drives", {"kind": "pd", "kp": stiffness, "angle": joint.at, "follows": swing}


def _pair(rng: Random, one: _Joint, other: _Joint, turning: bool) -> tuple[str, Table]:
    """Return what couples two joints without play that turn, or a turning and a sliding one.

    Belts and cables are pulled where angles are zero, far from where these joints start.
    """
    heavy = min(one.inertia, other.inertia)
    stiffness = heavy * (20.0 / one.time) ** 2
    if not turning:
        numbers = {"radius": 0.1, "stiffness": stiffness / 0.01, "play": 0.05 * one.way * 0.1}
        numbers["offset"] = 0.1 * one.at - other.at  # it starts in the middle of its play
        return "gears", {"kind": "rack", "input": one.name, "output": other.name, **numbers}
    kind = str(rng.choice(["gear", "spline", "coupling"]))
    ratio = float(rng.choice([-2.0, -0.7, 1.0, 1.5]))
    if kind == "coupling":
        follows = {"follower": other.name, "leader": one.name, "multiplier": ratio}
        return "couplings", {**follows, "offset": other.at - ratio * one.at}
    table: Table = {"kind": kind, "input": one.name, "output": other.name, "stiffness": stiffness}
    by = {"gear": ratio, "spline": 1.0}[kind]
    table |= {"play": 0.1 * one.way, "offset": one.at / by - other.at}
    return "gears", table | ({"ratio": ratio} if kind == "gear" else {})


def _force(rng: Random, scenario: Scenario, size: float) -> Table:
    links = [part.split('"')[1] for part in scenario.urdf_text.split("<link ")[1:]]
    links = links if scenario.mechanism.base == "free" else links[1:]
    at = {"link": str(rng.choice(links)), "point": rng.uniform(-0.1, 0.1, 3).tolist()}
    if rng.random() < 0.5:
        starts = [0.2 * scenario.duration, 0.6 * scenario.duration]
        pulses = {"starts": starts, "durations": [0.1 * scenario.duration]}
        thrust = {"thrust": size, "direction": rng.normal(size=3).tolist()}
        return {"kind": "thruster", "at": at, **thrust, **pulses}
    force = (size * rng.normal(size=3)).tolist()
    return {"kind": "force", "at": at, "force": force, "frequency": 1.0 / scenario.duration}


def with_elements(scenario: Scenario, seed: int, number: int) -> Scenario:
    """Return a random scenario with elements at its joints."""
    rng = np.random.default_rng([seed, number, 1])
    inertias = own_inertias(scenario, build_system(scenario))
    spherical = {name for name, one in scenario.clearance.items() if one.model == "spherical"}
    joints = {
        name: _Joint(scenario, name, inertias[name])
        for name in scenario.initial.joints
        if name not in spherical
    }
    more: dict[str, Table] = {}
    driven = {drive.joint for drive in scenario.drives.values()}
    for name, joint in joints.items():
        for make in (_stop, _latch, _friction, _spring, _drive):
            if rng.random() < _SHARE and not (make is _drive and name in driven):
                _deal(more, scenario, name, *make(rng, joint))
    plain = [one for one in joints.values() if not one.play]
    kinds = {one.name: f'name="{one.name}" type="prismatic"' in scenario.urdf_text for one in plain}
    turning = [one for one in plain if not kinds[one.name]]
    sliding = [one for one in plain if kinds[one.name]]
    partner = turning[1:2] or sliding[:1]
    if turning and partner and rng.random() < 0.7:
        family, table = _pair(rng, turning[0], partner[0], turning=len(turning) > 1)
        more[f"{family}.mesh"] = table
        if family == "couplings":  # what is held begins as it is held
            speed = {"velocity": table["multiplier"] * turning[0].rate}
            more[f"initial.joints.{partner[0].name}"] = speed
    if rng.random() < 0.5 and joints:
        more["forces.outside"] = _force(rng, scenario, min(one.effort for one in joints.values()))
    if scenario.mechanism.base == "fixed" and rng.random() < 0.5:
        more["shake.base"] = {
            "kind": "sine",
            "direction": rng.normal(size=3).tolist(),
            "displacement": 1e-6,
            "frequency": 2.0 / scenario.duration,
            "fade_in": 0.3 * scenario.duration,
        }
    return scenario.with_overrides(more)


def _deal(more: dict[str, Table], scenario: Scenario, name: str, family: str, table: Table) -> None:
    """Put a joint's element, its reference and what commands it into what is set over a scenario."""
    own = f"{family[:5]}_{name}_own"
    follows: Mapping[str, Any] | None = table.pop("follows", None)
    if follows is not None:
        more[f"references.{own}"] = dict(follows)
        table["follows"] = own
    more[f"{family}.{own}"] = {"joint": name, **table}
    if table.get("kind") == "motor":
        gains = {"kp": 1.0, "ki": 0.1 / scenario.duration, "reference": 0.1}
        period = 0.02 * scenario.duration
        more[f"controllers.{own}"] = {"kind": "pid", "acts_on": own, "period": period, **gains}
