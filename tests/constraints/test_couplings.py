"""A coupling is what fewer coordinates say it is: accelerations, torques, start, whole turns, refusals."""

import math
import re

import numpy as np
import pinocchio as pin
import pytest
from coupled import Coupled
from observed_once import observed_once

from antenna_pin import Coupling, System, Urdf, build_mechanism
from antenna_pin.base.changes import JointChange
from antenna_pin.dynamics import ConstantDrive, JointSpring, Workspace, constraint_counts
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError

LINK = (
    '<link name="{}"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{}" type="{}"><parent link="base"/><child link="{}"/><axis xyz="0 1 0"/>'
    '<limit lower="-9" upper="9" effort="1" velocity="1"/>{}</joint>'
)


def urdf_of(*joints):
    """A URDF of joints on one base: name, type, what stands in it."""
    parts = [LINK.format("base"), *(LINK.format(f"of_{name}") for name, *_ in joints)]
    parts += [JOINT.format(name, kind, f"of_{name}", more) for name, kind, more in joints]
    return Urdf.from_text(f'<robot name="r">{"".join(parts)}</robot>', "r.urdf")


def system_of(*joints, **parts):
    """A system of such joints on a fixed base."""
    return System(build_mechanism(urdf_of(*joints), "fixed"), **parts)


def mimic(leader, multiplier=1, offset=0):
    """The tag."""
    return f'<mimic joint="{leader}" multiplier="{multiplier}" offset="{offset}"/>'


@pytest.mark.parametrize("base", ["free", "fixed"])
@pytest.mark.parametrize("seed", range(8))
def test_accelerations_and_torques_are_those_of_fewer_coordinates(seed, base):
    """v = G w: G^T M G w' = G^T (tau - h); the couplings' torques are what inverse dynamics lacks.

    Each follower's torque acts on its leader times minus the multiplier, and reaches no other joint: the base
    of a free tree feels nothing of it. Numbers of order 10 of matrices with conditions up to 1e4.
    """
    found = Coupled(seed, base, springs={"s": JointSpring(joint="j2", stiffness=7.0, damping=0.3)})
    system, model = found.system, found.system.model
    rng = np.random.default_rng(seed)
    data, workspace, g = model.createData(), Workspace(system), found.directions
    for _ in range(4):
        y = found.random_state(rng)
        q, v = y[: model.nq], y[model.nq : model.nq + model.nv]
        rates = np.zeros(model.nv + system.manifold.nx)
        workspace.derivative(0.0, y, rates)
        assert workspace.constraints.solution.gap == workspace.constraints.solution.turn == 0.0
        tau = workspace.tau.copy()
        mass = pin.crba(model, data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pin.nonLinearEffects(model, data, q, v)
        expected = g @ np.linalg.solve(g.T @ mass @ g, g.T @ (tau - bias))
        scale = np.abs(expected).max()
        assert rates[: model.nv] == pytest.approx(expected, rel=1e-10, abs=1e-11 * scale)
        (torques,) = observed_once(system, 0.0, y).coupling
        lack = pin.rnea(model, data, q, v, rates[: model.nv]) - tau
        put = np.zeros(model.nv)
        for torque, one in zip(torques, system.couplings.values(), strict=True):
            put[system.mechanism.joint(one.follower).v] += torque
            put[system.mechanism.joint(one.leader).v] -= one.multiplier * torque
        assert put == pytest.approx(lack, rel=1e-9, abs=1e-10 * np.abs(tau - bias).max())


def test_a_chain_starts_where_its_first_leader_puts_it():
    system = system_of(
        ("a", "revolute", mimic("b", -2, 0.5)), ("b", "continuous", mimic("c", 3, 1)), ("c", "prismatic", "")
    )
    y = system.state(system.neutral(), np.zeros(3))
    assert system.neutral() == pytest.approx([-1.5, math.cos(1.0), math.sin(1.0), 0.0], rel=1e-15)
    assert constraint_counts(system, y)["freedoms_left"] == 1


@pytest.mark.parametrize(
    "angles",
    [{"lead": 4.0}, {"follow": 101.5}, {"lead": 4.0, "follow": 101.5}],
    ids=["leader", "follower", "both"],
)
def test_whole_turns_are_those_that_the_coupling_wants(angles):
    """q knows an angle but for whole turns: 25 * 4 + 1.5 is 16 turns and a bit."""
    system = system_of(("lead", "continuous", ""), ("follow", "continuous", mimic("lead", 25, 1.5)))
    q = system.neutral()
    for name, angle in (("lead", 4.0), ("follow", 101.5)):
        q[system.mechanism.joint(name).q] = math.cos(angle), math.sin(angle)
    y = system.state(q, np.zeros(2), angles)
    turned = y[6:][[system.turn_x["lead"], system.turn_x["follow"]]]
    assert turned == pytest.approx([4.0, 101.5], rel=1e-15)
    workspace = Workspace(system)
    # The round-off of 100 rad is no residual.
    assert workspace.constraints.residuals(0.0, y, workspace.program).turn == 0.0


def test_a_leader_of_a_rack_has_the_turns_that_its_place_tells():
    system = system_of(("pinion", "continuous", ""), ("rack", "prismatic", mimic("pinion", 0.01)))
    y = system.state([math.cos(100.0), math.sin(100.0), 1.0], np.zeros(2))
    assert y[5] == pytest.approx(100.0, rel=1e-14)


def test_a_fixed_leader_is_at_zero_and_a_fixed_follower_follows_nothing():
    urdf = urdf_of(
        ("a", "revolute", mimic("b", 2, 0.25)), ("b", "revolute", mimic("c")), ("c", "revolute", "")
    )
    system = System(build_mechanism(urdf.variant(joints={"b": "locked"}), "fixed"))
    assert list(system.couplings) == ["a"]
    assert system.neutral() == pytest.approx([0.25, 0.0])
    workspace, y = Workspace(system), system.state(system.neutral(), [0, 0])
    assert workspace.constraints.closed_at(0.0, y, workspace.program)
    assert constraint_counts(system, y)["freedoms_left"] == 1
    free = urdf.variant(origins={"a": JointChange(mimic=False)})
    assert list(System(build_mechanism(free, "fixed")).couplings) == ["b"]
    with pytest.raises(UnknownNameError, match="<mimic> of joint 'a': joint 'nobody' is unknown"):
        urdf_of(("a", "revolute", mimic("nobody")))


def test_the_last_digit_of_a_fast_follower_is_no_residual():
    """A row counts by its larger number: of a follower a thousand times as fast the leader's turn."""
    system = system_of(("a", "revolute", ""), ("b", "revolute", mimic("a", 1000)))
    workspace, y = Workspace(system), system.state([0.3, 300.0], [0.7, np.nextafter(700.0, 701.0)])
    assert workspace.constraints.closed_at(0.0, y, workspace.program)
    y[3] = 700.0 + 1e-10
    assert not workspace.constraints.closed_at(0.0, y, workspace.program)


def test_a_coupling_twice_is_one_equation_and_one_torque():
    """Of redundant rows the least: half of the torque each; the count tells that there are two."""
    joints = (("a", "revolute", ""), ("b", "revolute", mimic("a", 2)))
    again = Coupling(follower="b", leader="a", multiplier=2)
    drives = {"motor": ConstantDrive(joint="a", value=1.0)}
    twice = system_of(*joints, couplings={"again": again}, drives=drives)
    torques = []
    for system in (system_of(*joints, drives=drives), twice):
        y = system.state([0.0, 0.0], [0.0, 0.0])
        torques.append(observed_once(system, 0.0, y).coupling[0])
    assert torques[1] == pytest.approx([0.5 * torques[0][0]] * 2, rel=1e-12)
    counts = constraint_counts(twice, y)
    assert (counts["closure_equations"], counts["couplings"], counts["closure_rank"]) == (2, 2, 1)
    assert counts["redundant"]["again"] == {"equations": 1, "among": ["the coupling"]}


REFUSALS = {
    "unknown leader": (
        [("a", "revolute", mimic("nix"))],
        {},
        "r.urdf: <mimic> of joint 'a': joint 'nix' is unknown; known: a",
    ),
    "itself": ([("a", "revolute", mimic("a"))], {}, "<mimic> of joint 'a': must name another joint"),
    "circle": (
        [("a", "revolute", mimic("b")), ("b", "revolute", mimic("c")), ("c", "revolute", mimic("a"))],
        {},
        "couplings: a joint must not follow itself, got 'a' follows 'b' follows 'c' follows 'a'",
    ),
    "circle of both": (
        [("a", "revolute", mimic("b")), ("b", "revolute", "")],
        {"x": Coupling(follower="b", leader="a")},
        "couplings: a joint must not follow itself, got 'a' follows 'b' follows 'a'",
    ),
    "no axis": (
        [("a", "floating", mimic("b")), ("b", "revolute", "")],
        {},
        "follower 'a' is floating here, and only a revolute, continuous or prismatic joint without play",
    ),
    "leader without axis": (
        [("a", "revolute", ""), ("b", "floating", "")],
        {"x": Coupling(follower="a", leader="b")},
        "coupling 'x': leader 'b' is floating here",
    ),
    "fixed follower": (
        [("a", "fixed", ""), ("b", "revolute", "")],
        {"x": Coupling(follower="a", leader="b")},
        "coupling 'x': follower 'a' is fixed here",
    ),
    "name": (
        [("a", "revolute", mimic("b")), ("b", "revolute", "")],
        {"a": Coupling(follower="a", leader="b")},
        "couplings['a'] must be of another name than a joint with <mimic>",
    ),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_couplings_that_cannot_be(case):
    joints, couplings, message = REFUSALS[case]
    with pytest.raises(AntennaPinError, match=re.escape(message)):
        system_of(*joints, couplings=couplings)


def test_a_coupling_refuses_what_is_none():
    with pytest.raises(InvalidParameterError, match="leader must be another joint than the follower"):
        Coupling(follower="a", leader="a")
    with pytest.raises(InvalidParameterError, match="multiplier must be finite"):
        Coupling(follower="a", leader="b", multiplier=math.inf)
    with pytest.raises(AntennaPinError, match="joint 'a': mimic must be left out, because there is none"):
        urdf_of(("a", "revolute", "")).variant(origins={"a": JointChange(mimic=False)})
    with pytest.raises(
        AntennaPinError, match=r"line 1: joint 'a': <mimic> multiplier must be 1 finite number"
    ):
        urdf_of(("a", "revolute", mimic("b", "two")))
