#!/usr/bin/env python3
"""Random free-floating trees with random elements of all kinds: what is kept, and do the engines agree?

A tree of 2 to 5 links floats without gravity and is set going; each joint is dealt some of what a joint may
have besides play: stops, latches, dry friction, springs with hysteresis, gears, racks and belts to another
joint, ball bearings. Both engines run it at default tolerances. What must hold:

- the run completes, by both;
- linear and angular momentum stay, over the largest they are made of (``--momentum``);
- the ledger of energy closes, over the kinetic energy at the start (``--energy``);
- the engines come to the same changes of mode and the same configuration (``--apart``), as long as motions
  are not so sensitive that round-off of theirs has grown by then.

Exit code 1 on any failure; each is told with its number, which with the seed repeats it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from antenna_pin import AntennaPinError, RunSettings, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    Belt,
    BoucWen,
    ConstantSpring,
    EndStop,
    Gear,
    JointFriction,
    JointSpring,
    Latch,
    MaxwellSlip,
    Rack,
    RigidLatch,
    RigidStop,
    StickingFriction,
    StiffnessBearing,
)
from antenna_pin.mechanism import Urdf, build_mechanism

__all__ = ["drawn", "told"]

_LINK = (
    '<link name="l{k}"><inertial><origin xyz="{c[0]} {c[1]} {c[2]}"/><mass value="{m}"/>'
    '<inertia ixx="{i[0]}" iyy="{i[1]}" izz="{i[2]}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
_JOINT = (
    '<joint name="j{k}" type="{kind}"><parent link="l{p}"/><child link="l{n}"/>'
    '<origin xyz="{o[0]} {o[1]} {o[2]}"/>'
    '<axis xyz="{a[0]} {a[1]} {a[2]}"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'
)

Chance = np.random.Generator


def _stop(chance: Chance, joint: str) -> tuple[str, Any]:
    lower, upper = -chance.uniform(0.1, 0.4), chance.uniform(0.1, 0.4)
    if chance.random() < 0.5:
        return "stops", RigidStop(joint=joint, lower=lower, upper=upper, restitution=chance.uniform(0.0, 1.0))
    return "stops", EndStop(
        joint=joint,
        lower=lower,
        upper=upper,
        stiffness=10.0 ** chance.uniform(2.0, 4.0),
        exponent=float(chance.choice([1.0, 1.5])),
        restitution=chance.uniform(0.3, 1.0),
    )


def _latch(chance: Chance, joint: str) -> tuple[str, Any]:
    window: dict[str, Any] = {"joint": joint, "angle": chance.uniform(-0.08, 0.08), "width": 0.01}
    window["greatest_rate"] = chance.uniform(0.1, 0.8)
    if chance.random() < 0.5:
        return "latches", RigidLatch(**window)
    return "latches", Latch(**window, stiffness=500.0, damping=1.0)


def _friction(chance: Chance, joint: str) -> tuple[str, Any]:
    slips = chance.uniform(0.01, 0.1)
    if chance.random() < 0.3:
        return "springs", JointFriction(joint=joint, damping=slips, friction=slips, regularisation_speed=0.05)
    return "frictions", StickingFriction(
        joint=joint, coulomb=slips, static=slips * chance.uniform(1.0, 2.0), stribeck_rate=0.1, viscous=0.01
    )


def _spring(chance: Chance, joint: str) -> tuple[str, Any]:
    stiffness = chance.uniform(0.5, 5.0)
    made: tuple[Callable[[], Any], ...] = (
        lambda: JointSpring(
            joint=joint, stiffness=stiffness, damping=0.02, rest_angle=chance.uniform(-0.5, 0.5)
        ),
        lambda: BoucWen(joint=joint, alpha=0.3, stiffness=stiffness, yield_angle=0.1),
        lambda: MaxwellSlip(joint=joint, stiffness=(stiffness, 2.0), slip=(0.1, 0.3)),
        lambda: ConstantSpring(joint=joint, torque=chance.uniform(-0.3, 0.3), upper=0.3, ramp=0.1),
    )
    return "springs", made[int(chance.integers(len(made)))]()


def _gear(chance: Chance, first: str, second: str) -> tuple[str, Any]:
    if chance.random() < 0.5:
        return "gears", Belt(
            input=first, output=second, input_radius=0.1, output_radius=0.05, stiffness=2e3, pretension=1.0
        )
    # With a ratio near zero a mesh is so stiff that tolerances are as large as what it is pressed in at rest.
    ratio = chance.uniform(-3.0, 3.0)
    ratio += np.copysign(0.3, ratio)
    return "gears", Gear(input=first, output=second, ratio=ratio, stiffness=50.0, damping=0.1, play=0.02)


def drawn(seed: int, number: int) -> tuple[System, np.ndarray]:
    """Return a system of a number, and the velocity that it is set going with."""
    chance = np.random.default_rng([seed, number])
    n = int(chance.integers(1, 5))
    kinds = chance.choice(["revolute", "continuous", "prismatic"], n)
    text = "".join(
        _LINK.format(
            k=k, c=chance.uniform(-0.2, 0.2, 3), m=chance.uniform(0.5, 3), i=chance.uniform(0.1, 0.2, 3)
        )
        for k in range(n + 1)
    )
    for k, kind in enumerate(kinds):
        at = {"p": chance.integers(0, k + 1), "o": chance.uniform(-0.3, 0.3, 3), "a": chance.normal(size=3)}
        text += _JOINT.format(k=k, n=k + 1, kind=kind, **at)
    elements: dict[str, dict[str, Any]] = {}
    free: dict[str, Any] = {}
    turning = [f"j{k}" for k, kind in enumerate(kinds) if kind != "prismatic"]
    for k, kind in enumerate(kinds):
        joint = f"j{k}"
        if kind != "prismatic" and chance.random() < 0.15:
            free[joint] = "free"
            stiff = StiffnessBearing(joint=joint, radial=2e3, axial=1e3, tilt=30.0, damping_time=1e-3)
            elements.setdefault("bearings", {})[joint] = stiff
            turning.remove(joint)
            continue
        for make, share in ((_stop, 0.6), (_latch, 0.4), (_friction, 0.4), (_spring, 0.5)):
            if chance.random() < share:
                table, element = make(chance, joint)
                elements.setdefault(table, {})[f"{joint}_{make.__name__}"] = element
    if len(turning) > 1 and chance.random() < 0.5:
        table, element = _gear(chance, turning[0], turning[1])
        elements.setdefault(table, {})["mesh"] = element
    sliding = [f"j{k}" for k, kind in enumerate(kinds) if kind == "prismatic"]
    other = np.random.default_rng([seed, number, 1])
    if turning and sliding and other.random() < 0.5:
        elements.setdefault("gears", {})["rack"] = Rack(
            input=turning[-1],
            output=sliding[0],
            radius=other.uniform(-0.2, 0.2),
            stiffness=2e3,
            damping=other.uniform(0.0, 5.0),
            play=2e-3,
        )
    urdf = Urdf.from_text(f'<robot name="r">{text}</robot>', "r.urdf")
    mechanism = build_mechanism(urdf.variant(joints=free), "free", (0.0, 0.0, 0.0))
    springs = elements.pop("springs", {})
    return System(mechanism, springs=springs, elements=elements), 0.7 * chance.normal(size=mechanism.model.nv)


def _changes(data: Any) -> list[str]:
    """Return the changes of mode in order; those of one instant, whose order is round-off's, by name."""
    if "change" not in data:
        return []
    pairs = zip(data.change_time.values.tolist(), data.change.values.tolist(), strict=True)
    return [name for _, name in sorted(pairs)]


def told(seed: int, number: int, duration: float) -> tuple[float, float, float, str]:
    """Return by how much momentum, energy and configurations are off, and what is wrong in words."""
    system, v = drawn(seed, number)
    runs = [
        simulate(system, v=v, duration=duration, settings=RunSettings(engine=engine, output_rate=50.0))
        for engine in ("pinocchio", "compiled")
    ]
    momentum = energy = 0.0
    for run in runs:
        if not run.completed:
            return momentum, energy, 0.0, run.message
        for name in ("linear_momentum", "angular_momentum"):
            values = run.data[name].values
            momentum = max(momentum, float(np.abs(values - values[0]).max() / np.abs(values).max()))
        energy = max(
            energy, float(np.abs(run.data.energy_error).max()) / float(run.data.kinetic_energy.values[0])
        )
    one, other = (run.data.q.values for run in runs)
    names = [_changes(run.data) for run in runs]
    wrong = (
        "" if names[0] == names[1] else f"{len(names[0])} changes by one engine, {len(names[1])} by the other"
    )
    return momentum, energy, float(np.abs(one[-1] - other[-1]).max()), wrong


def _failures(asked: argparse.Namespace) -> Iterator[str]:
    worst = np.zeros(3)
    for number in range(asked.count) if asked.only is None else asked.only:
        try:
            *found, wrong = told(asked.seed, number, asked.duration)
        except AntennaPinError as error:
            yield f"{number}: {error}"
            continue
        worst = np.maximum(worst, found)
        limits = {"momentum": asked.momentum, "energy": asked.energy, "engines apart": asked.apart}
        beyond = [
            f"{name} {one:.2g}"
            for (name, limit), one in zip(limits.items(), found, strict=True)
            if one > limit
        ]
        if wrong or beyond:
            yield f"{number}: {', '.join([*([wrong] if wrong else []), *beyond])}"
    print(f"worst: momentum {worst[0]:.2g}, energy {worst[1]:.2g}, engines apart {worst[2]:.2g}")


def main() -> int:
    """Run them and tell of those that fail."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="of trees [%(default)s]")
    parser.add_argument("--seed", type=int, default=1, help="[%(default)s]")
    parser.add_argument("--only", type=int, action="append", help="one again")
    parser.add_argument("--duration", type=float, default=1.0, help="[s] [%(default)s]")
    parser.add_argument("--momentum", type=float, default=1e-9, help="relative [%(default)s]")
    parser.add_argument("--energy", type=float, default=1e-5, help="relative [%(default)s]")
    parser.add_argument("--apart", type=float, default=1e-6, help="[rad] or [m] [%(default)s]")
    asked = parser.parse_args()
    failed = 0
    for line in _failures(asked):
        failed += 1
        print(f"--seed {asked.seed} --only {line}", flush=True)
    print(f"{asked.count if asked.only is None else len(asked.only)} trees, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
