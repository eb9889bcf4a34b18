"""Displacements through changes of mode against differences of runs, and what they do to volumes.

Each element is seen while it acts, behind that, and where the joint sticks or rests at the end.
"""

import numpy as np
import pytest

from antenna_pin import RunSettings, System, Urdf, build_mechanism
from antenna_pin.elements import (
    EndStop,
    JointSpring,
    Latch,
    MaxwellSlip,
    RigidLatch,
    RigidStop,
    SineDrive,
    StickingFriction,
)
from antenna_pin.studies.nonlinear import Flow

SLIPS = MaxwellSlip(joint="way", stiffness=(10.0, 20.0), slip=(0.5, 2.0))
SOFT = EndStop(joint="way", upper=0.1, restitution=0.5, stiffness=1e3)
RESTS = RigidStop(joint="way", upper=0.1, restitution=0.2, rest_rate=0.02)
STICKS = StickingFriction(joint="way", coulomb=1.5, static=1.8, stribeck_rate=0.1)
HOLDS = StickingFriction(joint="way", coulomb=2.0, static=4.5)
CATCHES = {"joint": "way", "angle": 0.05, "width": 0.04}

#: Element, its family, span [s], modes at the end.
CASES = {
    "a bounce": (RigidStop(joint="way", upper=0.1, restitution=0.7), "stops", 1.0, "free"),
    "turned back in it": (SOFT, "stops", 0.43, "upper"),
    "off a stop": (SOFT, "stops", 1.0, "free"),
    "rests on a stop and leaves": (RESTS, "stops", 1.5, "free"),
    "slips the other way at once": (StickingFriction(joint="way", coulomb=0.5), "frictions", 1.0, "backward"),
    "sticks": (HOLDS, "frictions", 0.8, "sticks"),
    "comes to rest": (RigidStop(joint="way", upper=0.1, restitution=0.0), "stops", 0.38, "upper"),
    "sticks and slips": (HOLDS, "frictions", 1.3, "backward"),
    "slips by a rate of Stribeck's": (STICKS, "frictions", 2.0, "forward"),
    "springs that slip": (SLIPS, "springs", 0.3, "up"),
    "springs that are dragged back": (SLIPS, "springs", 1.0, "down"),
    "a latch": (Latch(stiffness=50.0, damping=1.0, **CATCHES), "latches", 0.6, "held"),
    "a rigid latch": (RigidLatch(**CATCHES), "latches", 0.6, "held"),
    "a latch that lets go": (RigidLatch(holding_torque=2.5, **CATCHES), "latches", 1.0, "outside"),
}


def system_of(oscillator, element, family):
    more = {"stiffness": 10.0, "damping": 0.3}
    system = oscillator(amplitude=3.0, frequency=0.7, **more)
    if family == "springs":
        return System(system.mechanism, springs={"own": element}, drives=system.drives)
    return System(
        system.mechanism, springs=system.springs, drives=system.drives, elements={family: {"own": element}}
    )


def mode_of(system, state, place):
    element = next(each[place[1]] for name, each in system.families.items() if name == place[0])
    return element.modes[int(dict(state.adjusted).get(f"{place[0]}.{place[1]}.mode", element.mode))]


OTHER_ENGINE = [(case, "pinocchio") for case in ("a bounce", "sticks and slips")]


@pytest.mark.parametrize(("case", "engine"), [*((case, "compiled") for case in CASES), *OTHER_ENGINE])
def test_elements_with_modes(oscillator, case, engine):
    """The variational equation with its saltation against differences of sixth order of runs."""
    element, family, span, mode = CASES[case]
    system = system_of(oscillator, element, family)
    flow = Flow(system, RunSettings(rtol=1e-12, engine=engine))
    start = flow.first(np.array([-0.2]), np.array([0.5]))
    ours, runs = flow.tangent(start, span), flow.tangent_by_runs(start, span)
    assert mode_of(system, ours.end, (family, "own")) == mode
    # Differences of runs at 1e-12 are known to some 1e-9 of the largest number; 1e-12 of a joint that is held
    # where it is whatever its neighbours do.
    assert ours.matrix.shape == runs.matrix.shape
    least = 5e-9 * np.abs(runs.matrix).max(initial=2e-4)
    assert np.abs(ours.matrix - runs.matrix).max(initial=0.0) < least


def test_a_bounce_takes_the_square_of_its_restitution_of_a_volume(oscillator):
    """dx dv before, e^2 dx dv behind: where neighbours meet the stop moves by v dt. Damping: e^(-c t)."""
    element = RigidStop(joint="way", upper=0.1, restitution=0.7)
    flow = Flow(system_of(oscillator, element, "stops"))
    start = flow.first(np.array([-0.2]), np.array([0.5]))
    assert flow.traverse(start, 1.0).events == 1
    # To what pieces of steps are good to.
    assert np.linalg.det(flow.tangent(start, 1.0).matrix) == pytest.approx(0.49 * np.exp(-0.3), rel=1e-9)


def test_where_a_joint_comes_to_rest_a_direction_is_lost(oscillator):
    """One where it sticks, and it keeps where; both on a stop, whose place is given."""
    for case, size, lost in (("sticks", 1, 1), ("comes to rest", 0, 2)):
        element, family, span, _ = CASES[case]
        flow = Flow(system_of(oscillator, element, family))
        start = flow.first(np.array([-0.2]), np.array([0.5]))
        found = flow.tangent(start, span)
        assert found.matrix.shape == (size, 2) and found.lost == lost
        # It slips, or leaves, later on, and what is lost is not found again.
        whole = flow.tangent(start, 1.3)
        assert whole.lost == lost and whole.matrix.shape == (2, 2)
        assert np.linalg.matrix_rank(whole.matrix, tol=1e-9) == 2 - lost


# --- several joints -----------------------------------------------------------------------------------------


LINK = (
    '<link name="{name}"><inertial><origin xyz="{centre}"/><mass value="{mass}"/>'
    '<inertia ixx="{i[0]}" iyy="{i[1]}" izz="{i[2]}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="j{k}" type="{kind}"><origin xyz="{place}"/><parent link="{parent}"/>'
    '<child link="l{child}"/><axis xyz="{axis}"/>{limit}</joint>'
)
LIMIT = '<limit lower="-9" upper="9" effort="1" velocity="1"/>'


def numbers(values):
    return " ".join(f"{value:.17g}" for value in values)


def some_tree(chance, joints):
    """A tree of as many joints of random kinds, axes, places and masses."""
    parts = []
    for k in range(joints + 1):
        mass = chance.uniform(0.5, 3.0)
        inertia = mass * chance.uniform(0.2, 0.4, 3)  # of a body: no two make up less than the third
        centre = numbers(chance.uniform(-0.3, 0.3, 3))
        parts.append(LINK.format(name=f"l{k}", centre=centre, mass=mass, i=inertia))
    for k in range(joints):
        axis = chance.normal(size=3)
        kind = ("revolute", "continuous", "prismatic")[chance.integers(3)]
        parts.append(
            JOINT.format(
                k=k,
                kind=kind,
                place=numbers(chance.uniform(-0.4, 0.4, 3)),
                parent=f"l{chance.integers(k + 1)}",
                child=k + 1,
                axis=numbers(axis / np.linalg.norm(axis)),
                limit="" if kind == "continuous" else LIMIT,
            )
        )
    return Urdf.from_text(f'<robot name="tree">{"".join(parts)}</robot>', "tree")


def some_element(chance, joint):
    """An element with modes at a joint, of a random kind, and its family."""
    kind = chance.integers(6)
    if kind == 0:
        return "stops", RigidStop(joint=joint, lower=-0.2, upper=0.15, restitution=chance.uniform(0.3, 0.9))
    if kind == 1:
        return "stops", EndStop(joint=joint, lower=-0.2, upper=0.15, restitution=0.6, stiffness=300.0)
    if kind == 2:
        return "frictions", StickingFriction(joint=joint, coulomb=chance.uniform(0.2, 0.8), static=0.9)
    if kind == 3:
        return "springs", MaxwellSlip(joint=joint, stiffness=(4.0, 6.0), slip=(0.3, 1.0))
    if kind == 4:
        hold = {"stiffness": 50.0, "damping": 0.5, "holding_torque": 3.0}
        return "latches", Latch(joint=joint, angle=0.2, width=0.05, **hold)
    return "stops", RigidStop(joint=joint, upper=0.1, restitution=0.05, rest_rate=0.05)


def some_system(seed):
    chance, joints = np.random.default_rng(seed), 3
    urdf = some_tree(chance, joints)
    mechanism = build_mechanism(urdf, "free" if chance.random() < 0.5 else "fixed", (0.0, 0.0, -1.0))
    families = {"springs": {}, "drives": {}}
    for k in range(joints):
        families["springs"][f"s{k}"] = JointSpring(
            joint=f"j{k}", stiffness=chance.uniform(2, 8), damping=0.05
        )
        families["drives"][f"d{k}"] = SineDrive(
            joint=f"j{k}",
            amplitude=chance.uniform(0.5, 2.0),
            frequency=chance.uniform(0.5, 1.5),
            phase=chance.uniform(0.0, 6.0),
        )
        family, element = some_element(chance, f"j{k}")
        families.setdefault(family, {})[f"own{k}"] = element
    springs, drives = families.pop("springs"), families.pop("drives")
    system = System(mechanism, springs=springs, drives=drives, elements=families)
    return system, 0.4 * chance.normal(size=mechanism.model.nv)


@pytest.mark.parametrize("seed", [4, 15, *(pytest.param(k, marks=pytest.mark.slow) for k in (8, 11))])
def test_trees_of_several_joints(seed):
    """Free and fixed bases, several elements: an impulse at one joint goes through all that is held."""
    system, v = some_system(seed)
    flow = Flow(system, RunSettings(rtol=1e-12, engine="compiled" if seed % 2 == 0 else "pinocchio"))
    start = flow.after(flow.first(system.neutral(), v), 0.3)
    assert flow.traverse(start, 0.8).events >= 1
    ours, off = flow.tangent(start, 0.8), []
    size = np.abs(ours.matrix).max()
    for step in (1e-4, 2e-5):
        off.append(np.abs(flow.tangent_by_runs(start, 0.8, step=step).matrix - ours.matrix).max() / size)
    # Differences of second order tend to the equation's derivative with the square of their step.
    assert off[1] < 1e-5
    assert off[0] / off[1] == pytest.approx(25.0, rel=0.1) or off[1] < 1e-9


def two_masses(carried):
    """Two masses of one frequency, each thrown at a stop of its own; if carried, on a carriage that moves."""
    own = 'iyy="1" izz="1" ixy="0" ixz="0" iyz="0"'
    link = '<link name="{}"><inertial><mass value="{}"/><inertia ixx="1" ' + own + "/></inertial></link>"
    ends = '<parent link="{}"/><child link="{}"/><axis xyz="1 0 0"/></joint>'
    slide = '<joint name="{}" type="prismatic">' + ends
    parts = [link.format("a", 2), link.format("b", 3)]
    on = "carriage" if carried else "world"
    if carried:
        parts += [link.format("carriage", 5), slide.format("rail", "world", "carriage")]
    parts += [slide.format("one", on, "a"), slide.format("two", on, "b")]
    urdf = Urdf.from_text(f'<robot name="r"><link name="world"/>{"".join(parts)}</robot>', "r.urdf")
    masses = {"one": 2.0, "two": 3.0}
    return System(
        build_mechanism(urdf, "fixed"),
        springs={name: JointSpring(joint=name, stiffness=10.0 * m) for name, m in masses.items()},
        elements={"stops": {name: RigidStop(joint=name, upper=0.1, restitution=0.7) for name in masses}},
    )


def test_blows_at_one_instant_that_do_not_feel_each_other_are_each_their_own():
    flow = Flow(two_masses(False), RunSettings(rtol=1e-12, engine="pinocchio"))
    start = flow.first(np.zeros(2), np.array([0.5, 0.5]))
    assert flow.traverse(start, 0.35).events == 2
    ours, runs = flow.tangent(start, 0.35).matrix, flow.tangent_by_runs(start, 0.35).matrix
    assert np.abs(ours - runs).max() < 1e-9


def test_blows_at_one_instant_that_feel_each_other_have_no_derivative():
    """In neighbours one comes before the other, and which decides. Next to it there is one."""
    flow = Flow(two_masses(True), RunSettings(rtol=1e-12, engine="compiled"))
    start = flow.first(np.zeros(3), np.array([0.0, 0.5, 0.5]))
    assert flow.traverse(start, 0.35).events == 2
    assert np.isnan(flow.tangent(start, 0.35).matrix).all()
    apart = flow.first(np.zeros(3), np.array([0.0, 0.5, 0.4]))
    ours, runs = flow.tangent(apart, 0.35).matrix, flow.tangent_by_runs(apart, 0.35).matrix
    assert np.abs(ours - runs).max() < 1e-8 * np.abs(runs).max()
