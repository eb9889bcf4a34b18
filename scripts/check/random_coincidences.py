#!/usr/bin/env python3
"""Random mechanisms of equal panels, whose elements meet at the same instants: are these solved at once?

Two or three equal panels, each of one link or two, deploy from a free or a fixed base; all have the same
elements, dealt at random: springs, dry friction, end stops, latches whose window ends at the stop or at an
angle that an event has too, hysteresis, drives that switch at the start, at an event or at a latch's capture,
elements that begin switched off. What must hold:

- the run completes on both engines: no NO_PROGRESS, no traceback, the ledger closed;
- the engines come to configurations no further apart than ``--apart``, or else than ten times what one engine
  comes to by itself where the velocities it starts with are others in their last bits;
- other names, and so another order of elements, change nothing but round-off (the same bound);
- where panels stand in a mirror image or on a fixed base they do the same, to the same bound.

A line for each mechanism that fails, and the verdict. Exit code 1 on any failure.
"""

from __future__ import annotations

import argparse
import math
import sys
import traceback
import warnings
from collections import Counter
from typing import Any

import numpy as np
import pinocchio as pin

from antenna_pin import RunSettings, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    BoucWen,
    ConstantDrive,
    EndStop,
    JointSpring,
    Latch,
    MaxwellSlip,
    RigidLatch,
    RigidStop,
    SineDrive,
    StickingFriction,
)
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.simulation import Event, Set, Time
from antenna_pin.run.simulation.events import Angle, Mark

DURATION = 1.5  # [s]
APART = 1e-7
_GROWS, _TRIES = 10.0, 2

_BASE = """<robot name="panels"><link name="bus"><inertial><mass value="{mass}"/>
<inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>
{panels}</robot>"""
_LINK = """<link name="{name}"><inertial><origin xyz="{x} 0 0"/><mass value="{mass}"/>
<inertia ixx="0.01" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="{joint}" type="continuous"><parent link="{parent}"/><child link="{name}"/>
<origin xyz="{at} 0 0" rpy="0 0 {turn}"/><axis xyz="0 {axis}"/></joint>"""


class Mechanism:
    """A random mechanism of equal panels.

    Args:
        seed: Of the random numbers.
    """

    def __init__(self, seed: int) -> None:
        """Draw it."""
        rng = np.random.default_rng([47, seed])
        self.panels = int(rng.integers(2, 4))
        self.links = int(rng.integers(1, 3)) if self.panels == 2 else 1 + int(rng.random() < 0.3)
        self.base = str(rng.choice(["free", "fixed"]))
        # Turned about z by equal angles, hinges across: as symmetric as a bus with panels is.
        self.inertia, self.mass = float(rng.uniform(1, 20)), float(rng.uniform(5, 50))
        self.link_mass, self.length = float(rng.uniform(0.5, 3)), float(rng.uniform(0.3, 1.0))
        self.start, self.rate = -float(rng.uniform(0.2, 0.8)), float(rng.uniform(0.3, 1.5))
        self.limit = float(rng.choice([0.0, 0.05, 0.1]))
        self.dealt = {
            name
            for name, share in (
                ("spring", 0.7),
                ("friction", 0.5),
                ("stop", 0.8),
                ("latch", 0.7),
                ("hysteresis", 0.2),
                ("drive", 0.5),
                ("event", 0.5),
                ("at start", 0.3),
            )
            if rng.random() < share
        }
        self.numbers = {name: float(rng.random()) for name in _NUMBERS}
        self.kinds = {
            "stop": str(rng.choice(["rigid", "plastic", "soft"])),
            "latch": str(rng.choice(["compliant", "rigid"])),
            "window": str(rng.choice(["to the stop", "point", "around the stop", "before the stop"])),
            "hysteresis": str(rng.choice(["bouc-wen", "maxwell-slip"])),
            "event": str(rng.choice(["mark", "spring off", "drive on", "friction on"])),
            "at": str(rng.choice(["window", "limit", "start", "turn"])),
        }

    @property
    def words(self) -> str:
        """What it is, in short."""
        kinds = ", ".join(
            f"{name} {self.kinds[name]}" if name in self.kinds else name for name in sorted(self.dealt)
        )
        return f"{self.panels} x {self.links} on a {self.base} base: {kinds}"

    def system(self, names: tuple[str, ...]) -> tuple[System, list[Event]]:
        """Build it, its panels named so, in this order; with its events."""
        n, texts = self.numbers, []
        drives: dict[str, Any] = {}
        springs: dict[str, Any] = {}
        elements: dict[str, dict[str, Any]] = {"stops": {}, "latches": {}, "frictions": {}}
        events: list[Event] = []
        for k, name in enumerate(names):
            for link in range(self.links):
                joint = f"{name}_{link}"
                texts.append(
                    _LINK.format(
                        name=f"l_{joint}",
                        joint=joint,
                        parent="bus" if link == 0 else f"l_{name}_{link - 1}",
                        x=0.5 * self.length,
                        at=0.3 if link == 0 else self.length,
                        turn=2.0 * np.pi * k / self.panels if link == 0 else 0.0,
                        axis="1 0",
                        mass=self.link_mass,
                        inertia=0.05 + 0.1 * self.link_mass * self.length**2,
                    )
                )
                self._deal(joint, n, drives, springs, elements, events)
        # The joint's origin stands in the turned frame of its panel: at the bus's rim.
        text = _BASE.format(mass=self.mass, inertia=self.inertia, panels="".join(texts))
        urdf = Urdf.from_text(_at_rims(text, names, self.panels), "panels.urdf")
        made = build_mechanism(urdf, self.base, (0.0, 0.0, 0.0))
        kept = {family: dealt for family, dealt in elements.items() if dealt}
        return System(made, drives=drives, springs=springs, elements=kept), events

    def _deal(
        self,
        joint: str,
        n: dict[str, float],
        drives: dict[str, Any],
        springs: dict[str, Any],
        elements: dict[str, dict[str, Any]],
        events: list[Event],
    ) -> None:
        """Give a joint what was dealt."""
        dealt, kinds, limit = self.dealt, self.kinds, self.limit
        late = "at start" in dealt
        if "spring" in dealt:
            rest = limit + (0.3 if n["preload"] < 0.7 else 0.0)
            springs[f"s_{joint}"] = JointSpring(
                joint=joint, stiffness=0.2 + 2.0 * n["stiffness"], rest_angle=rest
            )
        if "hysteresis" in dealt:
            if kinds["hysteresis"] == "bouc-wen":
                springs[f"h_{joint}"] = BoucWen(joint=joint, alpha=0.3, stiffness=1.0, yield_angle=0.05)
            else:
                springs[f"h_{joint}"] = MaxwellSlip(joint=joint, stiffness=(1.0, 2.0), slip=(0.05, 0.2))
        if "friction" in dealt:
            coulomb = 0.02 + 0.3 * n["friction"]
            static = coulomb * (1.3 if n["static"] < 0.5 else 1.0)
            on = not (late or ("event" in dealt and kinds["event"] == "friction on"))
            elements["frictions"][f"f_{joint}"] = StickingFriction(
                joint=joint, coulomb=coulomb, static=static, on=on
            )
        if "stop" in dealt:
            if kinds["stop"] == "soft":
                stop: Any = EndStop(
                    joint=joint, upper=limit, stiffness=500.0, law="kelvin-voigt", damping=1.0
                )
            else:
                e = 0.0 if kinds["stop"] == "plastic" else 0.2 + 0.8 * n["restitution"]
                stop = RigidStop(joint=joint, upper=limit, lower=self.start - 0.5, restitution=e)
            elements["stops"][f"e_{joint}"] = stop
        width, angle = self._window()
        if "latch" in dealt:
            more: dict[str, Any] = {"joint": joint, "angle": angle, "width": width}
            if n["most"] < 0.4:
                more["greatest_rate"] = 0.4 + n["rate"]
            if n["holding"] < 0.4:
                more["holding_torque"] = 0.3 + 2.0 * n["torque"]
            if "spring" in dealt and n["off"] < 0.3:
                more["switches_off"] = (f"springs.s_{joint}",)
            elements["latches"][f"k_{joint}"] = (
                RigidLatch(**more)
                if kinds["latch"] == "rigid"
                else Latch(stiffness=300.0, damping=2.0, **more)
            )
        if "drive" in dealt:
            on = not (late or ("event" in dealt and kinds["event"] == "drive on"))
            if n["sine"] < 0.5:
                drives[f"d_{joint}"] = SineDrive(
                    joint=joint, amplitude=0.5 * n["drive"], frequency=2.0, on=on
                )
            else:
                drives[f"d_{joint}"] = ConstantDrive(joint=joint, value=0.5 * n["drive"], on=on)
        for place in [f"frictions.f_{joint}"] if late and "friction" in dealt else []:
            events.append(Event(name=f"late_{joint}", when=Time(0.0), action=Set(f"{place}.on", True)))
        if "event" in dealt:
            self._event(joint, width, angle, events)

    def _window(self) -> tuple[float, float]:
        kind, limit = self.kinds["window"], self.limit
        return {
            "to the stop": (0.01, limit - 0.01),
            "point": (0.0, limit - (0.02 if "stop" in self.dealt else 0.0)),
            "around the stop": (0.02, limit),
            "before the stop": (0.01, limit - 0.05),
        }[kind]

    def _event(self, joint: str, width: float, angle: float, events: list[Event]) -> None:
        where = {"window": angle - width, "limit": self.limit, "start": self.start, "turn": angle}[
            self.kinds["at"]
        ]
        sets = {
            "mark": Mark(),
            "spring off": Set(f"springs.s_{joint}.on", False) if "spring" in self.dealt else Mark(),
            "drive on": Set(f"drives.d_{joint}.on", True) if "drive" in self.dealt else Mark(),
            "friction on": Set(f"frictions.f_{joint}.on", True) if "friction" in self.dealt else Mark(),
        }
        events.append(Event(name=f"at_{joint}", when=Angle(joint, where), action=sets[self.kinds["event"]]))

    def run(self, engine: str, names: tuple[str, ...], last_bits: int = 0) -> Any:
        """Run it; the rates of the start are others in their last bits, if that is not zero."""
        made, events = self.system(names)
        q, v = pin.neutral(made.model), np.zeros(made.model.nv)
        bits = np.random.default_rng(last_bits)
        for name in names:
            for link in range(self.links):
                slot = made.mechanism.joint(f"{name}_{link}")
                q[slot.q.start : slot.q.start + 2] = np.cos(self.start), np.sin(self.start)
                change = np.finfo(float).eps * bits.choice([-2.0, 2.0]) if last_bits else 0.0
                v[slot.v.start] = self.rate * (1.0 + change)
        settings = RunSettings(engine=engine, output_rate=20.0)
        return made, simulate(made, q=q, v=v, duration=DURATION, settings=settings, events=events)


_NUMBERS = "preload stiffness friction static restitution most rate holding torque off sine drive".split()


def _at_rims(text: str, names: tuple[str, ...], panels: int) -> str:
    """Put the hinges of panels where their turned axes say, at the rim of the bus."""
    for k, name in enumerate(names):
        turn = 2.0 * np.pi * k / panels
        at = f'<parent link="bus"/><child link="l_{name}_0"/>\n<origin xyz="0.3 0 0"'
        there = f"{0.3 * math.cos(turn)!r} {0.3 * math.sin(turn)!r} 0"
        text = text.replace(at, at.replace("0.3 0 0", there))
    return text


def _angles(made: System, run: Any, names: tuple[str, ...], links: int) -> Any:
    """Return the joints' angles over time, (time, panel, link)."""
    found = []
    for name in names:
        for link in range(links):
            slot = made.mechanism.joint(f"{name}_{link}")
            q = run.data.q.values[:, slot.q.start : slot.q.start + 2]
            found.append(np.unwrap(np.arctan2(q[:, 1], q[:, 0])))
    return np.array(found).T.reshape(len(run.data.time), len(names), links)


def _between(one: Any, other: Any) -> float:
    """Return by how much angles of two runs differ at most, of the panels at the same places."""
    times = np.intersect1d(one[1].data.time.values, other[1].data.time.values)
    first, second = (
        _angles(*each)[np.searchsorted(each[1].data.time.values, times)] for each in (one, other)
    )
    return float(np.abs(first - second).max())


def told(seed: int, apart: float = APART) -> tuple[str, str]:
    """Run a mechanism in all ways; return what failed ("" if nothing) and what it is."""
    one = Mechanism(seed)
    names = ("a", "b", "c")[: one.panels]
    # The same panels at the same places, under other names: the order of elements by name is another.
    others = names[::-1]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            runs = {
                what: (*one.run(engine, ways), ways, one.links)
                for what, engine, ways in (
                    ("compiled", "compiled", names),
                    ("pinocchio", "pinocchio", names),
                    ("renamed", "compiled", others),
                )
            }
    except Exception:
        return traceback.format_exc().strip().splitlines()[-1], one.words
    for what, (_, run, *_rest) in runs.items():
        if not run.completed:
            return f"{what}: {run.outcome.name}, {run.message}", one.words
    base = runs["compiled"]
    found = {what: _between(base, runs[what]) for what in ("pinocchio", "renamed")}
    angles = _angles(*base)
    if one.base == "fixed" or one.panels == 2:
        found["mirror"] = float(np.abs(angles - angles[:, :1]).max())
    most = max(found.values())
    if most > apart:
        grown = 0.0
        for k in range(1, _TRIES + 1):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                grown = max(grown, _between(base, (*one.run("compiled", names, k), names, one.links)))
        if most > _GROWS * grown:
            said = ", ".join(f"{name} {value:.2g}" for name, value in found.items())
            return f"apart: {said}; last bits {grown:.2g}", one.words
    return "", one.words


def main() -> int:
    """Run them; return the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=300, help="how many mechanisms (300)")
    parser.add_argument("--first", type=int, default=0, help="seed of the first (0)")
    parser.add_argument("--apart", type=float, default=APART, help="how far apart angles may be [rad] (1e-7)")
    given = parser.parse_args()
    failed: Counter[str] = Counter()
    for seed in range(given.first, given.first + given.count):
        what, words = told(seed, given.apart)
        if what:
            failed[what.split(":")[0]] += 1
            print(f"{seed}: {what} [{words}]", flush=True)
    print(f"{given.count} mechanisms: {sum(failed.values())} failed{f' {dict(failed)}' if failed else ''}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
