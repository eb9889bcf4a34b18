"""Short runs with every kind of element, joint with play, closure and coupling, and how they end."""

import dataclasses
import math

import numpy as np

from antenna_pin import Closure, Coupling, RunSettings, System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.contact import CustomFriction, CustomNormal, Hertz
from antenna_pin.dynamics.constraints import CLOSURES, Anchor
from antenna_pin.elements import (
    AxialPreload,
    BallBearing,
    Belt,
    BoucWen,
    Cable,
    CallableDrive,
    CallableElement,
    CallableForce,
    CallableMotion,
    ConstantDrive,
    ConstantSpring,
    DahlFriction,
    DistanceMotion,
    EndStop,
    Gear,
    GonthierFriction,
    GravityGradient,
    HarnessSpring,
    JointFriction,
    JointSpring,
    Latch,
    LuGreFriction,
    MaxwellSlip,
    Motor,
    OutsideForce,
    PDController,
    PointSpring,
    PrescribedMotion,
    Rack,
    RandomShake,
    RigidLatch,
    RigidStop,
    SineDrive,
    SineShake,
    Spline,
    StickingFriction,
    StiffnessBearing,
    SweepShake,
    TableDrive,
    TableShake,
    TableSpring,
    Thruster,
)
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import CylindricalClearance, RevoluteClearance
from antenna_pin.mechanism import with_shaken_base
from antenna_pin.scenario.assemble import build_system, initial_state

LINK = (
    '<link name="{0}"><inertial><origin xyz="0.1 0.05 0"/><mass value="1"/>'
    '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{0}_link"/><origin xyz="0.3 0 0"/>'
    '<axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'
)

DRIVES = {
    "constant": ConstantDrive(joint="a", value=1.0),
    "sine": SineDrive(joint="b", amplitude=2.0, frequency=30.0),
    "table": TableDrive(joint="c", time=(0.0, 0.5, 1.0), torque=(1.0, 2.0, 0.0)),
    "pd": PDController(joint="d", kp=5.0, kd=0.3, angle=0.2, limit=0.8),
    "motion": PrescribedMotion(joint="e", rate=2.0, coefficients=(1.0, 3.0), amplitude=0.1, frequency=5.0),
    "servo": Motor(
        joint="b",
        value=3.0,
        torque_constant=0.5,
        resistance=2.0,
        inductance=0.05,
        current_limit=1.2,
        cogging=0.02,
        cycles=6,
        ratio=3.0,
    ),
    "distance": DistanceMotion(joint="f", offset=(0.3, 0.4, 0.0), velocity=(0.1, 0.0, 0.2)),
}
IN_PYTHON = {
    "given": CallableDrive(joint="a", torque=lambda t, angle, rate: math.cos(t) - angle - rate),
    "given motion": CallableMotion(
        joint="b", position=math.sin, velocity=math.cos, acceleration=lambda t: -math.sin(t)
    ),
}
SPRINGS = {
    "spring": JointSpring(joint="g", stiffness=3.0, damping=0.2, rest_angle=0.4),
    "friction": JointFriction(joint="g", damping=0.1, friction=0.2),
    "wen": BoucWen(joint="g", alpha=0.3, stiffness=2.0, yield_angle=0.1, exponent=1.5),
    "slips": MaxwellSlip(joint="g", stiffness=(2.0, 1.0), slip=(0.05, 0.2)),
    "cable": TableSpring(joint="g", angle=(-1.0, 0.0, 1.0), torque=(1.0, 0.2, -1.0)),
    "harness": HarnessSpring(
        joint="g", angle=(-1.0, 1.0), torque=(0.2, -0.4), torque_back=(0.3, -0.2), reversal=0.05
    ),
    "tape": ConstantSpring(joint="g", torque=0.3, upper=0.5, ramp=0.1),
    "strut": PointSpring(
        first=("base", (0.0, 0.0, 0.5)),
        second=("g_link", (0.1, 0.0, 0.0)),
        free_length=0.2,
        stiffness=9.0,
        damping=0.5,
    ),
}
_ROLLS = {"input_radius": 0.1, "output_radius": 0.2, "stiffness": 900.0}
GEARS = {
    "gear": Gear(
        input="a",
        output="c",
        ratio=-2.0,
        stiffness=40.0,
        damping=0.2,
        play=0.02,
        efficiency=0.9,
        error_angle=(0.0, 0.3, 0.5, 0.8, 1.0),
        error=(0.0, 0.002, 0.003, -0.002, 0.0),
    ),
    "rack": Rack(input="a", output="i", radius=-0.1, stiffness=2e3, damping=1.0, play=2e-3),
    "spline": Spline(input="c", output="d", stiffness=30.0, damping=0.1),
    "belt": Belt(input="a", output="d", pretension=4.0, damping=2.0, **_ROLLS),
    "cable": Cable(input="c", output="a", slack=0.01, **_ROLLS),
}
#: Forces on links, of all courses, with a pulse that begins and one that ends.
FORCES = {
    "constant": OutsideForce(at=("a_link", (0.1, 0.0, 0.2)), force=(1.0, 0.0, 2.0), torque=(0.1, 0.0, 0.0)),
    "sine": OutsideForce(at=("base", (0.0, 0.0, 0.0)), force=(0.0, 3.0, 0.0), axes="world", frequency=40.0),
    "table": OutsideForce(
        at=("f_link", (0.0, 0.0, 0.0)),
        force=(0.0, 0.0, 1.0),
        time=(0.0, 4e-4, 1.0),
        factors=(1.0, 2.0, 0.0),
        interpolation="cubic",
    ),
    "jet": Thruster(
        at=("b_link", (0.1, 0.0, 0.0)), direction=(1, 1, 0), thrust=4.0, starts=(0.0, 5e-4), durations=(2e-4,)
    ),
    "slow jet": Thruster(
        at=("base", (0.1, 0.0, 0.0)),
        direction=(0, 1, 0),
        thrust=4.0,
        starts=(1e-4,),
        durations=(3e-4,),
        misalignment=0.01,
        seed=3,
        rise_time=1e-4,
        fall_time=2e-4,
    ),
    "field": GravityGradient(rate=2.0),
}


def pulled(t, p, links, joints, states, whole):
    """Draw two links together in proportion, turn a joint by what has added up."""
    for k in range(3):
        links[1].force[k] = -p[0] * (links[1].place[k] - links[0].place[k])
        whole.energy += 0.5 * p[0] * (links[1].place[k] - links[0].place[k]) ** 2
    states[0].rate = joints[0].angle
    joints[0].torque = 0.1 * states[0].value


FORCES_IN_PYTHON = {
    "pulled": CallableElement(
        act=pulled,
        links=(("base", (0.0, 0.1, 0.0)), ("c_link", (0.0, 0.0, 0.0))),
        joints=("d",),
        parameters={"stiffness": 5.0},
        integrates=("sum",),
        internal=True,
    ),
    "wind": CallableForce(
        at=("e_link", (0.0, 0.0, 0.0)),
        wrench=lambda t, pose, twist: np.array([*(-0.3 * twist[:3]), math.cos(t), 0.0, 0.0]),
    ),
}
#: Elements with modes: pressed in, near, captured, locked, stuck; and those that act on a whole joint.
WITH_MODES = {
    "stops": {
        "soft": EndStop(joint="a", lower=0.01, stiffness=30.0, restitution=0.5),
        "hard": RigidStop(joint="b", upper=0.05, restitution=0.5),
    },
    "latches": {
        "soft": Latch(joint="c", angle=0.0, width=0.2, stiffness=20.0, damping=0.1),
        "hard": RigidLatch(joint="d", angle=0.0, width=0.2),
    },
    "frictions": {
        "dry": StickingFriction(joint="e", coulomb=0.2, static=0.3, viscous=0.1),
        "dahl": DahlFriction(joint="a", coulomb=0.1, stiffness=4.0, shape=1.5, start=0.2),
        "lugre": LuGreFriction(
            joint="e",
            coulomb=0.1,
            static=0.15,
            stribeck_rate=0.2,
            stiffness=5.0,
            damping=0.05,
            viscous=0.02,
            coefficient=0.1,
            radius=0.02,
            start=-0.3,
        ),
        "gonthier": GonthierFriction(
            joint="c",
            coulomb=0.1,
            static=0.2,
            stribeck_rate=0.2,
            stiffness=5.0,
            damping=0.05,
            dwell_time=0.1,
            start=0.4,
        ),
    },
    "bearings": {
        "springs": StiffnessBearing(joint="g", radial=2e3, axial=1e3, tilt=5.0, damping_time=1e-4),
        "balls": BallBearing(
            joint="h",
            count=5,
            ball_diameter=6e-3,
            pitch_diameter=0.04,
            contact_angle=0.3,
            preload=0.1,
            by="balls",
        ),
        "push": AxialPreload(joint="j", force=3.0, stiffness=100.0, given_at="centred"),
    },
}
#: Shipped scenarios by joint with play: case, and a time in which its contacts touch [s].
PLAY = {
    "contact": ("impact_pair", "contact", 1.02e-3),
    "planar": ("impact_pair", "planar", 1.02e-3),
    "spherical": ("impact_pair", "spherical", 1.02e-3),
    "prismatic": ("slider", "rest", 1e-4),
    "coal": ("impact_pair", "contact", 1.02e-3),
}


#: One that no shipped scenario has.
ROUND = "cylindrical"


def elements(drives, forces):
    """A body with an element at each of its joints, forces, and two joints that follow others."""
    kinds = dict.fromkeys("abcdegh", "continuous") | {"f": "prismatic", "i": "prismatic"}
    text = LINK.format("base")
    for name in "abcdefghi":
        text += JOINT.format(name, kinds[name], "a_link" if name == "b" else "base") + LINK.format(
            f"{name}_link"
        )
    couplings = {
        "gear": Coupling(follower="h", leader="a", multiplier=-3.0, offset=0.1),
        "rack": Coupling(follower="i", leader="g", multiplier=0.05, second="d", second_multiplier=0.01),
    }
    mechanism = build_mechanism(Urdf.from_text(f'<robot name="star">{text}</robot>', "star"), "free")
    more = {"gears": GEARS, "forces": forces}
    return System(mechanism, drives=drives, springs=SPRINGS, couplings=couplings, elements=more)


def with_modes():
    """A body with an element that has modes, or a bearing, at each of its joints; the last has play."""
    text = LINK.format("base") + "".join(
        JOINT.format(name, "continuous", "base") + LINK.format(f"{name}_link") for name in "abcdeghj"
    )
    urdf = Urdf.from_text(f'<robot name="modes">{text}</robot>', "modes")
    mechanism = build_mechanism(urdf.variant(joints=dict.fromkeys("ghj", "free")), "free")
    shape = RevoluteClearance.from_clearances(
        bearing_radius=0.01,
        radial_clearance=1e-3,
        bearing_length=0.02,
        axial_clearance=1e-3,
        bearing_outer_radius=0.015,
        flange_radius=0.014,
    )
    law = Hertz(stiffness=1e5)
    joint = ClearanceJoint(name="j", geometry=shape, radial=law, axial=law, backend="closed-form")
    return System(mechanism, clearances=[joint], elements=WITH_MODES)


def closed(kind):
    """A body that a closure of a kind holds to the world, and one that hangs on it."""
    text = LINK.format("base") + JOINT.format("free", "floating", "base") + LINK.format("free_link")
    text += JOINT.format("hinge", "revolute", "free_link") + LINK.format("hinge_link")
    across = (1.0, 0.0, 0.0) if kind == "universal" else (0.0, 0.0, 1.0)
    first, second = Anchor.at("base", (0.3, 0.0, 0.0)), Anchor.at("free_link", axis=across)
    mechanism = build_mechanism(
        Urdf.from_text(f'<robot name="loop">{text}</robot>', "loop"), "fixed", (0.0, -9.8, 0.5)
    )
    return System(mechanism, closures={"it": Closure(kind=kind, first=first, second=second)})


#: Motions of a shaken base, each another way.
SHAKES = {
    "swings": SineShake(
        joint="swings", axis=(0.0, 0.0, 1.0), point=(0.1, 0.0, 0.0), frequency=30.0, velocity=1.0
    ),
    "swept": SweepShake(
        joint="swept",
        direction=(1.0, 0.0, 0.0),
        displacement=1e-3,
        acceleration=30.0,
        start_frequency=20.0,
        end_frequency=60.0,
        hertz_per_second=50.0,
        fade_in=0.1,
    ),
    "random": RandomShake(
        joint="random",
        direction=(0.0, 1.0, 0.0),
        frequency=(20.0, 60.0),
        density=(1.0, 2.0),
        period=0.5,
        seed=7,
    ),
    "table": TableShake(
        joint="table",
        direction=(0.0, 0.0, 1.0),
        of="acceleration",
        time=(0.0, 0.4, 1.0),
        course=(1.0, -3.0, 2.0),
        start_velocity=0.1,
    ),
}


def shaken():
    """A base that is shaken in all ways there are, and an arm on it."""
    text = LINK.format("base") + JOINT.format("a", "continuous", "base") + LINK.format("a_link")
    urdf = with_shaken_base(Urdf.from_text(f'<robot name="shaken">{text}</robot>', "shaken"), SHAKES)
    return System(build_mechanism(urdf, "fixed", (0.0, -9.8, 0.5)), drives=SHAKES)


def started(system):
    """A state that fits: positions and rates that closures, couplings and motions allow."""
    from antenna_pin.dynamics import assembled

    return assembled(system, system.neutral(), 0.1 * np.cos(np.arange(system.model.nv)))


def systems():
    """Yield the name of each system, with the engine that it runs with."""
    yield "elements", (elements(DRIVES, FORCES), "compiled")
    yield "modes", (with_modes(), "compiled")
    yield "shaken", (shaken(), "compiled")
    yield "in Python", (elements(IN_PYTHON, FORCES_IN_PYTHON), "pinocchio")
    for kind in CLOSURES:
        yield f"{kind} closure", (closed(kind), "compiled")


def round_slider():
    """Run the rig of a slider with a round one on the floor of its guide."""
    scenario = load_scenario("slider", case="rest")
    system = build_system(scenario)
    shape = CylindricalClearance(
        bearing_radius=0.02, journal_radius=0.02 - 5e-5, slider_length=0.1, guide_length=0.05
    )
    joint = dataclasses.replace(system.clearances[0], geometry=shape)
    q, v = initial_state(scenario, system)
    system = System(system.mechanism, clearances=[joint])
    settings = RunSettings(engine="compiled", rtol=1e-3)
    return simulate(system, duration=1e-4, q=q, v=v, settings=settings)


def asked_outside():
    """Run a closed loop through an impact, with all that is asked outside: Pinocchio, coal, laws."""
    scenario = load_scenario("slider_crank", case="planar", overrides=["integrator.rtol=1e-3"])
    system = build_system(scenario)
    (joint,) = system.clearances
    law = joint.radial
    normal = CustomNormal(force=law.force, elastic_force=law.elastic_force, elastic_energy=law.elastic_energy)
    friction = CustomFriction(coefficient=lambda speed: 0.1 * math.tanh(speed))
    slow = dataclasses.replace(joint, radial=normal, friction=friction, backend="coal")
    system = System(system.mechanism, clearances=[slow], drives=system.drives, closures=system.closures)
    q, v = initial_state(scenario, system)
    run = simulate(system, duration=2.9e-4, q=q, v=v, settings=RunSettings(rtol=1e-3))
    assert len(run.data["onset_time"]) == 1
    return run


def ends():
    """Yield the name of each run, and the run."""
    yield "asked outside", asked_outside()
    yield ROUND, round_slider()
    for name, (system, engine) in systems():
        q, v = started(system)
        settings = RunSettings(engine=engine, max_step=1e-3, rtol=1e-3, method="bogacki-shampine-32")
        yield name, simulate(system, duration=1e-3, q=q, v=v, settings=settings)
    for model, (scenario, case, duration) in PLAY.items():
        loaded = load_scenario(scenario, case=case)
        kind, engine = ("coal", "pinocchio") if model == "coal" else ("closed-form", "compiled")
        changes = {f"clearance.{joint}.geometry": kind for joint in loaded.clearance}
        chosen = loaded.with_overrides({**changes, "integrator.engine": engine, "integrator.rtol": 1e-3})
        yield model, simulate(chosen, duration=duration)


def told():
    """Return evaluations and end of each run, by name, in plain numbers."""
    return {name: [run.counts.evaluations, run.end.y.tolist()] for name, run in ends()}
