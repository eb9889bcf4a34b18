"""Random trees that float, with elements of all kinds at their joints; ``random_elements.py`` judges them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from antenna_pin import RunSettings, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    Belt,
    BoucWen,
    Chirp,
    ConstantSpring,
    DahlFriction,
    EndStop,
    Gear,
    GonthierFriction,
    HarnessSpring,
    JointFriction,
    JointSpring,
    Latch,
    LuGreFriction,
    MaxwellSlip,
    Motor,
    PDController,
    PrescribedMotion,
    Rack,
    RigidLatch,
    RigidStop,
    SCurve,
    Sine,
    StickingFriction,
    StiffnessBearing,
)
from antenna_pin.elements.control import Pid
from antenna_pin.mechanism import Urdf, build_mechanism

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
    static = slips * chance.uniform(1.0, 2.0)
    bristles: dict[str, Any] = {"joint": joint, "coulomb": slips, "stiffness": 200.0 * slips}
    falls = {"static": static, "stribeck_rate": 0.1, "damping": slips}
    # By digits of a number that is drawn already: trees without bristles stay as they are.
    which = int(1e6 * slips) % 6
    if which == 0:
        return "frictions", DahlFriction(**bristles, shape=1.5)
    if which == 1:
        return "frictions", LuGreFriction(**bristles, **falls, viscous=0.01)
    if which == 2:
        return "frictions", GonthierFriction(**bristles, **falls, dwell_time=0.3)
    return "frictions", StickingFriction(
        joint=joint, coulomb=slips, static=static, stribeck_rate=0.1, viscous=0.01
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


def _reference(chance: Chance) -> Any:
    size = chance.uniform(0.05, 0.3)
    made: tuple[Callable[[], Any], ...] = (
        lambda: Sine(amplitude=size, frequency=chance.uniform(0.5, 3.0)),
        lambda: Chirp(amplitude=size, first=0.5, last=4.0, duration=0.7),
        lambda: SCurve(end=size, rate=1.0, acceleration=4.0, jerk=40.0),
    )
    return made[int(chance.integers(len(made)))]()


def _latch_with_play(chance: Chance, joint: str) -> Latch:
    play = chance.uniform(1e-3, 4e-3)
    return Latch(
        joint=joint, angle=0.0, width=0.02, greatest_rate=1.5, stiffness=500.0, damping=1.0, play=play
    )


@dataclass
class Drawn:
    """A tree of a number."""

    system: System  # links, joints, elements
    v: np.ndarray  # the velocity that it is set going with
    controllers: dict[str, Pid]  # what commands motors
    elements: list[str] = field(default_factory=list)  # names of the kinds that it has

    def run(self, engine: str, duration: float, **more: Any) -> Any:
        """Run it."""
        settings = RunSettings(engine=engine, output_rate=50.0, **more)
        return simulate(
            self.system, v=self.v, duration=duration, settings=settings, controllers=self.controllers
        )


def _driven(chance: Chance, joint: str, elements: dict[str, dict[str, Any]]) -> dict[str, Pid]:
    """Deal a joint something that drives it; return what commands that."""
    which, drives = chance.random(), elements.setdefault("drives", {})
    if which < 0.3:
        drives[joint] = PDController(joint=joint, kp=8.0, kd=0.5, limit=2.0, follows=_reference(chance))
    elif which < 0.4:
        drives[joint] = PDController(
            joint=joint, kp=3.0, kd=0.2, time=(0.0, 0.4, 2.0), reference=(0.0, 0.3, 0.1)
        )
    elif which < 0.6:
        motor = {"torque_constant": 0.05, "resistance": 0.8, "ratio": 20.0, "current_limit": 3.0}
        drives[joint] = Motor(
            joint=joint, inductance=float(chance.choice([0.0, 1e-3])), cogging=1e-3, **motor
        )
        return {joint: Pid(acts_on=joint, period=0.01, kp=6.0, ki=3.0, kd=0.4, reference=0.2, delay=0.004)}
    elif which < 0.75:
        elements.setdefault("springs", {})[f"{joint}_harness"] = HarnessSpring(
            joint=joint,
            angle=(-1.0, 0.0, 1.0),
            torque=(0.4, -0.05, -0.6),
            torque_back=(0.6, 0.05, -0.4),
            reversal=0.05,
        )
    return {}


def drawn(seed: int, number: int) -> Drawn:
    """Return the tree of a number."""
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
    controllers: dict[str, Pid] = {}
    turning = [f"j{k}" for k, kind in enumerate(kinds) if kind != "prismatic"]
    for k, kind in enumerate(kinds):
        joint = f"j{k}"
        if kind != "prismatic" and chance.random() < 0.15:
            free[joint] = "free"
            stiff = StiffnessBearing(joint=joint, radial=2e3, axial=1e3, tilt=30.0, damping_time=1e-3)
            elements.setdefault("bearings", {})[joint] = stiff
            turning.remove(joint)
            continue
        later = np.random.default_rng([seed, number, 2, k])
        if kind != "prismatic" and later.random() < 0.1:
            elements.setdefault("drives", {})[joint] = PrescribedMotion(
                joint=joint, follows=_reference(later)
            )
            turning.remove(joint)
            continue
        if kind != "prismatic":
            controllers |= _driven(later, joint, elements)
        for make, share in ((_stop, 0.6), (_latch, 0.4), (_friction, 0.4), (_spring, 0.5)):
            if chance.random() < share:
                table, element = make(chance, joint)
                elements.setdefault(table, {})[f"{joint}_{make.__name__}"] = element
        latches = elements.setdefault("latches", {})
        if kind != "prismatic" and f"{joint}__latch" not in latches and later.random() < 0.4:
            latches[f"{joint}_loose"] = _latch_with_play(later, joint)
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
    kinds_of = [type(one).__name__ for family in elements.values() for one in family.values()]
    springs, drives = elements.pop("springs", {}), elements.pop("drives", {})
    system = System(mechanism, drives=drives, springs=springs, elements=elements)
    v = 0.7 * chance.normal(size=mechanism.model.nv)
    for one in drives.values():
        if isinstance(one, PrescribedMotion):
            v[mechanism.joint(one.joint).v] = one.at(0.0)[1]
    return Drawn(system, v, controllers, sorted(kinds_of))
