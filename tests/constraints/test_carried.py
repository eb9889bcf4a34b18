"""What joints carry, and friction by it: against inverse dynamics, and another way to hold a joint."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin.dynamics import System, Workspace
from antenna_pin.elements import StickingFriction
from antenna_pin.elements.sticking_friction_kernels import BACKWARD, FORWARD
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


def _system(base: str, kinds=KINDS, held=None, variant=None) -> System:
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
    return System(mechanism, elements={"frictions": frictions}, held=held or {})


def _state(system: System, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    q = pin.integrate(system.model, pin.neutral(system.model), rng.uniform(-1, 1, system.model.nv))
    return system.state(q, rng.uniform(-1, 1, system.model.nv))


@pytest.mark.parametrize("base", ["fixed", "free"])
@pytest.mark.parametrize("seed", range(5))
def test_friction_is_that_of_the_load_of_inverse_dynamics(base: str, seed: int) -> None:
    """The accelerations that come out give loads, by Pinocchio, that make the friction that went in."""
    system = _system(base)
    y, nq, nv = _state(system, seed), system.model.nq, system.model.nv
    # A moving joint has the direction of its mode.
    for k, direction in enumerate((1.0, -1.0, 1.0)):
        y[nq + nv - 3 + k] = direction * abs(y[nq + nv - 3 + k])
    workspace, rates = Workspace(system), np.zeros(nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    a, v = rates[:nv], y[nq : nq + nv]
    wrenches = transmitted_wrenches(system.mechanism, y[None, :nq], v[None], a[None])[0]
    needed = pin.rnea(system.model, workspace.data, y[:nq], v, a)
    pin.forwardKinematics(system.model, workspace.data, y[:nq])
    losses = 0.0
    for k, law in enumerate(LAWS):
        name = f"j{k + 1}"
        slot, place = system.mechanism.joint(name), list(system.mechanism.joints).index(name)
        axis = workspace.data.oMi[slot.joint_id].rotation @ slot.axis
        force, moment = wrenches[place, :3], wrenches[place, 3:]
        moment = moment - np.cross(law.get("middle", 0.0) * axis, force)
        across = np.linalg.norm(force - (force @ axis) * axis)
        bending = np.linalg.norm(moment - (moment @ axis) * axis)
        if slot.kind == "prismatic":
            load = across + np.linalg.norm(moment) / law["bending_arm"]
        else:
            load = law["radius"] * (across + (bending / law["bending_arm"] if "bending_arm" in law else 0.0))
            load += law.get("axial_radius", 0.0) * abs(force @ axis)
        rate = v[slot.v.start]
        dry = law.get("coulomb", 0.0) + law["coefficient"] * load
        friction = -np.sign(rate) * dry - law.get("viscous", 0.0) * rate
        assert needed[slot.v.start] == pytest.approx(friction, rel=1e-10)  # round-off, of loads of 100 N
        losses -= friction * rate
    assert rates[nv + system.element_x].sum() == pytest.approx(losses, rel=1e-10)


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
