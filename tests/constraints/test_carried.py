"""What joints carry, and friction by it: against inverse dynamics, and another way to hold a joint."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin.dynamics import System, Workspace
from antenna_pin.elements import DahlFriction, LuGreFriction, OutsideForce, PointSpring, StickingFriction
from antenna_pin.elements.sticking_friction import BACKWARD, FORWARD
from antenna_pin.mechanism import Urdf, build_mechanism, transmitted_wrenches

AXES = ("0 1 0", "0.6 0 0.8", "0 0.28 0.96")
LINK = """<link name="l{k}"><inertial><origin xyz="{c}"/><mass value="{m}"/>
<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0.02" iyz="0"/></inertial></link>"""
JOINT = """<joint name="j{k}" type="{type}"><parent link="l{p}"/><child link="l{k}"/>
<origin xyz="0.1 {k}e-1 0.3" rpy="0.3 {k} 0.1"/><axis xyz="{axis}"/>
<limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>"""
KINDS = ("revolute", "prismatic", "continuous")
PARENTS = (0, 1, 1)
LAWS = (
    {"coefficient": 0.3, "radius": 0.05, "axial_radius": 0.04, "bending_arm": 0.2, "middle": 0.1},
    {"coefficient": 0.2, "bending_arm": 0.8, "coulomb": 0.1},
    {"coefficient": 0.4, "radius": 0.03, "viscous": 0.2},
)


#: From point to point, one to the world; at a point with a torque: on the link before a joint and beyond.
SPRINGS = {
    "strut": PointSpring(
        first=("l1", (0.1, 0.2, 0.0)),
        second=("l3", (0.0, -0.1, 0.2)),
        stiffness=400.0,
        damping=3.0,
        free_length=0.2,
    ),
    "stay": PointSpring(
        first=("world", (1.0, 0.5, 2.0)),
        second=("l2", (0.2, 0.0, 0.1)),
        free_length=0.4,
        stiffness=60.0,
        damping=5.0,
    ),
}
FORCES = {
    "push": OutsideForce(at=("l3", (0.1, 0.0, -0.2)), force=(20.0, -8.0, 30.0), torque=(2.0, 1.0, -4.0)),
    "blow": OutsideForce(at=("l1", (0.0, 0.3, 0.0)), force=(0.0, 15.0, 9.0), axes="world"),
}
ON_LINKS = {"nothing": {}, "springs": {"springs": SPRINGS}, "forces": {"forces": FORCES}}
ON_LINKS["both"] = {"springs": SPRINGS, "forces": FORCES}


def _applied(system: System, y: np.ndarray, on_links: str) -> dict[str, np.ndarray]:
    """Return what elements on links do to each link, by formulas of their own: about the world's origin."""
    model, data = system.model, system.model.createData()
    pin.forwardKinematics(model, data, y[: model.nq], y[model.nq : model.nq + model.nv])
    found = {f"l{k}": np.zeros(6) for k in range(4)}

    def at(link, point):
        if link == "world":
            return np.array(point), np.zeros(3), np.eye(3)
        frame = model.frames[system.mechanism.frame(link)]
        place, moves = data.oMi[frame.parentJoint] * frame.placement, data.v[frame.parentJoint]
        spin = data.oMi[frame.parentJoint].rotation @ moves.angular
        origin = data.oMi[frame.parentJoint].rotation @ moves.linear
        here = place.act(np.array(point))
        return here, origin + np.cross(spin, here - data.oMi[frame.parentJoint].translation), place.rotation

    def put(link, point, force, torque):
        if link != "world":
            found[link] += np.hstack([force, torque + np.cross(point, force)])

    for spring in ON_LINKS[on_links].get("springs", {}).values():
        (a, u, _), (b, w, _) = at(*spring.first), at(*spring.second)
        length = np.linalg.norm(b - a)
        along = (b - a) / length
        drawn = spring.stiffness * (length - spring.free_length) + spring.damping * along @ (w - u)
        put(spring.first[0], a, drawn * along, np.zeros(3))
        put(spring.second[0], b, -drawn * along, np.zeros(3))
    for force in ON_LINKS[on_links].get("forces", {}).values():
        here, _, axes = at(*force.at)
        turn = np.eye(3) if force.axes == "world" else axes
        put(force.at[0], here, turn @ np.array(force.force), turn @ np.array(force.torque or (0.0, 0.0, 0.0)))
    return found


def _system(base: str, kinds=KINDS, held=None, variant=None, own=None, on_links="nothing") -> System:
    parts = [LINK.format(k=k, c=f"0.1 0.{k}2 -0.3", m=1.0 + k) for k in range(4)]
    parts += [
        JOINT.format(k=k + 1, p=PARENTS[k], type=kinds[k], axis=AXES[k]) for k in range(3)
    ]  # fmt: skip
    urdf = Urdf.from_text(f'<robot name="tree">{"".join(parts)}</robot>', "tree.urdf")
    if variant:
        urdf = urdf.variant(joints=variant)
    modes = (FORWARD, BACKWARD, FORWARD)
    frictions = {
        f"j{k + 1}": StickingFriction(joint=f"j{k + 1}", mode=modes[k], **LAWS[k])
        for k in range(3)
        if f"j{k + 1}" not in (held or {})
    }
    mechanism = build_mechanism(urdf, base, (0.3, -0.2, -9.81))
    more = dict(ON_LINKS[on_links])
    elements = {"frictions": frictions | (own or {}), "forces": more.pop("forces", {})}
    return System(mechanism, elements=elements, held=held or {}, **more)


def _state(system: System, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    q = pin.integrate(system.model, pin.neutral(system.model), rng.uniform(-1, 1, system.model.nv))
    return system.state(q, rng.uniform(-1, 1, system.model.nv))


def _loads(system: System, y: np.ndarray, a: np.ndarray, on_links: str) -> tuple[list[float], np.ndarray]:
    """Return the loads of the three joints by Pinocchio, and the generalized forces that motion needs."""
    nq, nv = system.model.nq, system.model.nv
    v, data = y[nq : nq + nv], system.model.createData()
    applied = _applied(system, y, on_links)
    links = [(name, wrench[None]) for name, wrench in applied.items() if name != "l0" or nv > 3]
    wrenches = transmitted_wrenches(system.mechanism, y[None, :nq], v[None], a[None], links)[0]
    pin.forwardKinematics(system.model, data, y[:nq])
    outside = [pin.Force.Zero() for _ in range(system.model.njoints)]
    for name, wrench in applied.items():
        joint = system.model.frames[system.mechanism.frame(name)].parentJoint
        outside[joint] += data.oMi[joint].actInv(pin.Force(wrench))
    needed = pin.rnea(system.model, data, y[:nq], v, a, outside)
    loads = []
    for k, law in enumerate(LAWS):
        name = f"j{k + 1}"
        slot, place = system.mechanism.joint(name), list(system.mechanism.joints).index(name)
        axis = data.oMi[slot.joint_id].rotation @ slot.axis
        force, moment = wrenches[place, :3], wrenches[place, 3:]
        moment = moment - np.cross(law.get("middle", 0.0) * axis, force)
        across = np.linalg.norm(force - (force @ axis) * axis)
        bending = np.linalg.norm(moment - (moment @ axis) * axis)
        if slot.kind == "prismatic":
            load = across + np.linalg.norm(moment) / law["bending_arm"]
        else:
            load = law["radius"] * (across + (bending / law["bending_arm"] if "bending_arm" in law else 0.0))
            load += law.get("axial_radius", 0.0) * abs(force @ axis)
        loads.append(load)
    return loads, needed


@pytest.mark.parametrize("on_links", list(ON_LINKS))
@pytest.mark.parametrize("base", ["fixed", "free"])
@pytest.mark.parametrize("seed", range(5))
def test_friction_is_that_of_the_load_of_inverse_dynamics(base: str, seed: int, on_links: str) -> None:
    """The accelerations that come out give loads, by Pinocchio, that make the friction that went in."""
    system = _system(base, on_links=on_links)
    y, nq, nv = _state(system, seed), system.model.nq, system.model.nv
    # A moving joint has the direction of its mode.
    for k, direction in enumerate((1.0, -1.0, 1.0)):
        y[nq + nv - 3 + k] = direction * abs(y[nq + nv - 3 + k])
    workspace, rates = Workspace(system), np.zeros(nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    loads, needed = _loads(system, y, rates[:nv], on_links)
    losses = 0.0
    for k, (law, load) in enumerate(zip(LAWS, loads, strict=True)):
        start = system.mechanism.joint(f"j{k + 1}").v.start
        rate = y[nq + start]
        dry = law.get("coulomb", 0.0) + law["coefficient"] * load
        friction = -np.sign(rate) * dry - law.get("viscous", 0.0) * rate
        assert needed[start] == pytest.approx(friction, rel=1e-10)  # round-off, of loads of 100 N
        losses -= friction * rate
    assert rates[nv + system.element_x].sum() == pytest.approx(losses, rel=1e-10)


@pytest.mark.parametrize("on_links", ["nothing", "both"])
@pytest.mark.parametrize("seed", range(3))
def test_bristles_bear_the_load_of_inverse_dynamics(seed: int, on_links: str) -> None:
    """Bent bristles of Dahl's and LuGre's law beside a joint that slips: each has (1 + mu N / T) its own."""
    numbers = {"coulomb": 0.5, "stiffness": 20.0}
    own = {
        "j1": DahlFriction(joint="j1", start=-0.3, shape=1.5, viscous=0.2, **numbers, **LAWS[0]),
        "j2": LuGreFriction(
            joint="j2", start=0.6, damping=0.1, coefficient=0.2, bending_arm=0.8, **numbers
        ),
    }  # fmt: skip
    system = _system("free", own=own, on_links=on_links)
    y, nq, nv = _state(system, seed), system.model.nq, system.model.nv
    y[nq + nv - 1] = abs(y[nq + nv - 1])
    workspace, rates = Workspace(system), np.zeros(nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    loads, needed = _loads(system, y, rates[:nv], on_links)
    v = [y[nq + system.mechanism.joint(f"j{k + 1}").v.start] for k in range(3)]
    grown = v[1] - 20.0 * abs(v[1]) / 0.5 * 0.6 * 0.5 / 20.0
    bristles = -0.3 * 0.5, 0.6 * 0.5 + 0.1 * grown
    factors = 1.0 + 0.3 * loads[0] / 0.5, 1.0 + 0.2 * loads[1] / 0.5
    wanted = [-factors[0] * bristles[0] - 0.2 * v[0], -factors[1] * bristles[1]]
    wanted.append(-0.4 * loads[2] - 0.2 * v[2])
    for k, torque in enumerate(wanted):
        assert needed[system.mechanism.joint(f"j{k + 1}").v.start] == pytest.approx(torque, rel=1e-10)
    # What bristles hold by their own torque is kept, the rest is lost.
    kept = -0.3 * 0.5 * abs(v[0]) * np.sign(v[0]) * abs(1.0 + 0.3 * np.sign(v[0])) ** 1.5
    kept += 0.6 * 0.5 * grown
    lost = -sum(torque * rate for torque, rate in zip(wanted, v, strict=True)) - kept
    assert rates[nv + system.element_x].sum() == pytest.approx(lost, rel=1e-10)


@pytest.mark.parametrize("seed", range(3))
def test_a_joint_that_is_held_by_constraint_loads_the_others_as_one_of_the_tree(seed: int) -> None:
    """The forces of closures reach the joint before them as those of the tree do."""
    plain = _system("fixed", ("revolute", "prismatic", "continuous"))
    y = _state(plain, seed)
    parts = [k for k in range(3) if k != 1]
    held = _system("fixed", held={"j2": "prismatic"}, variant={"j2": "free"})
    # The held joint's body where the tree has it, moving as there; both without friction at that joint.
    nq, nv = plain.model.nq, plain.model.nv
    y[nq] = abs(y[nq])
    y[nq + 2] = abs(y[nq + 2])
    alone = Workspace(plain)
    block = plain.element_blocks["frictions"]["j2"]
    from antenna_pin.dynamics import kernels

    alone.program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)["on"] = 0.0
    own = alone.program[block + int(kernels.PARAMETERS) :]
    own[:1].view(np.int64)[0] = 0
    rates = np.zeros(nv + plain.manifold.nx)
    alone.derivative(0.0, y, rates)
    q = pin.neutral(held.model)
    slots = {name: held.mechanism.joint(name) for name in ("j1", "j2", "j3")}
    old = {name: plain.mechanism.joint(name) for name in ("j1", "j2", "j3")}
    v = np.zeros(held.model.nv)
    for name in ("j1", "j3"):
        q[slots[name].q] = y[old[name].q]
        v[slots[name].v] = y[nq:][old[name].v]
    axis = np.array(old["j2"].axis)
    way, speed = y[old["j2"].q][0], y[nq:][old["j2"].v][0]
    q[slots["j2"].q.start : slots["j2"].q.start + 3] = way * axis
    v[slots["j2"].v.start : slots["j2"].v.start + 3] = speed * axis
    other, found = Workspace(held), np.zeros(held.model.nv + held.manifold.nx)
    other.derivative(0.0, held.state(q, v), found)
    for k in parts:
        name = f"j{k + 1}"
        assert found[slots[name].v] == pytest.approx(rates[old[name].v], rel=1e-9)
