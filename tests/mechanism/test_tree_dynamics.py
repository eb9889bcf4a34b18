"""The compiled tree accelerates as Pinocchio says: random trees of all joints, on the ground and free."""

from collections import deque

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import (
    PLACE,
    ROOM,
    JointSlot,
    Mechanism,
    TreeDynamics,
    Urdf,
    body_tree,
    build_mechanism,
)
from antenna_pin.mechanism import tree as tree_module
from antenna_pin.mechanism.dynamics_kernels import aba
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.tree_kernels import bias_accelerations, place_bodies

GRAVITY = (0.7, -1.3, -9.6)
KINDS = ("revolute", "continuous", "prismatic", "floating", "planar")
CLOSE = 1e-11
"""Round-off of a few hundred operations for each body, of sums in which little cancels."""


def vector(numbers):
    return " ".join(f"{number:.6f}" for number in numbers)


def mass_and_inertia(rng, thin=1.0):
    """Of an order of magnitude, principal axes anywhere; or of a rod, thin by so much."""
    mass = 10.0 ** rng.uniform(-0.5, 0.5)
    second = mass * rng.uniform(0.02, 0.1, 3) * [1.0, thin, thin]  # any three second moments make an inertia
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return mass, turn @ np.diag(second.sum() - second) @ turn.T


def inertial(rng):
    mass, moment = mass_and_inertia(rng)
    entries = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
    tensor = " ".join(f'i{name}="{moment[place]:.9f}"' for name, place in entries.items())
    place = f'<origin xyz="{vector(rng.uniform(-0.3, 0.3, 3))}" rpy="{vector(rng.uniform(-3, 3, 3))}"/>'
    return f'<inertial>{place}<mass value="{mass:.6f}"/><inertia {tensor}/></inertial>'


def joint(rng, number, kind, parent, child):
    limit = (
        '<limit lower="-1" upper="1" effort="1" velocity="1"/>' if kind in ("revolute", "prismatic") else ""
    )
    axis = "0 0 1" if kind == "planar" else vector(rng.normal(size=3))
    return (
        f'<joint name="j{number}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{vector(rng.uniform(-1, 1, 3))}" rpy="{vector(rng.uniform(-3, 3, 3))}"/>'
        f'<axis xyz="{axis}"/>{limit}</joint>'
    )


def random_urdf(seed, count, kinds=KINDS, crosses=True):
    """A tree of so many bodies, some of them by way of a massless cross: two hinges on oblique lines."""
    rng = np.random.default_rng(seed)
    links, text = ["l0"], [f'<link name="l0">{inertial(rng)}</link>']
    for number in range(1, count + 1):
        parent, child = links[rng.integers(len(links))], f"l{number}"
        kind = kinds[rng.integers(len(kinds))]
        if crosses and rng.random() < 0.25:
            text.append(f'<link name="x{number}"/>')
            text.append(joint(rng, f"{number}x", "revolute", parent, f"x{number}"))
            parent, kind = f"x{number}", "continuous"
        text.append(f'<link name="{child}">{inertial(rng)}</link>')
        text.append(joint(rng, number, kind, parent, child))
        links.append(child)
    return Urdf.from_text(f'<robot name="tree">{"".join(text)}</robot>', f"tree {seed}")


def random_state(model, seed):
    rng = np.random.default_rng(seed)
    q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
    return q, rng.normal(size=model.nv), 10.0 * rng.normal(size=model.nv)


def deviations(mechanism, seed):
    """Of accelerations, mass matrix, force of gravity and velocities, relative to their largest."""
    model, tree = mechanism.model, TreeDynamics(mechanism)
    data = model.createData()
    q, v, tau = random_state(model, seed)
    mass = np.triu(pin.crba(model, data, q))
    found = (tree.acceleration(q, v, tau), *tree.mass_and_bias(q, v))
    right = (
        pin.aba(model, data, q, v, tau),
        mass + np.triu(mass, 1).T,
        pin.nonLinearEffects(model, data, q, v),
    )
    return [np.abs(a - b).max() / np.abs(b).max() for a, b in zip(found, right, strict=True)]


def change_deviations(mechanism, seed):
    """Of the acceleration's derivatives over the state and over forces, relative to the largest of each.

    A slide alone feels neither its place nor its speed: over the state the acceleration itself counts too.
    """
    model, tree = mechanism.model, TreeDynamics(mechanism)
    q, v, tau = random_state(model, seed)
    data = model.createData()  # what it returns are views on that
    right = pin.computeABADerivatives(model, data, q, v, tau)
    inverse = np.triu(right[2])
    inverse += np.triu(inverse, 1).T
    blocks = np.column_stack([*right[:2], pin.aba(model, data, q, v, tau)]), inverse
    found = tree.acceleration_changes(q, v, tau, np.eye(3 * model.nv))
    found = np.insert(found, 2 * model.nv, tree.acceleration(q, v, tau), axis=1)
    found = np.split(found, [2 * model.nv + 1], axis=1)
    return [np.abs(a - b).max() / np.abs(b).max() for a, b in zip(found, blocks, strict=True)]


@pytest.mark.parametrize("base", ["free", "fixed"])
@pytest.mark.parametrize("seed", range(40))
def test_random_trees_are_pinocchios(base, seed):
    """Of 1 to 12 bodies: hinges, slides, free and planar joints in turned frames, massless crosses.

    The acceleration changes as Pinocchio's along every freedom, and so along any displacement: it is linear.
    """
    mechanism = build_mechanism(random_urdf(seed, 1 + seed % 12), base, GRAVITY)
    assert max(deviations(mechanism, seed)) < CLOSE
    assert max(change_deviations(mechanism, seed)) < CLOSE


def test_among_the_random_trees_is_everything():
    models = [build_mechanism(random_urdf(seed, 1 + seed % 12), "fixed") for seed in range(40)]
    assert {slot.kind for mechanism in models for slot in mechanism.joints.values()} == set(KINDS)
    assert sum(body.mass == 0.0 for mechanism in models for body in list(mechanism.model.inertias)[1:]) > 20


@pytest.mark.parametrize("base", ["free", "fixed"])
@pytest.mark.parametrize("kind", ["ideal", "free", "planar"])
@pytest.mark.parametrize("name", ["wrist", "swivel"])
def test_joints_with_play_are_pinocchios(crooked, name, kind, base):
    mechanism = build_mechanism(crooked.variant(joints={name: kind}), base, GRAVITY)
    assert max(deviations(mechanism, 1)) < CLOSE


def by_hand(rng, thin=1.0):
    """Spherical joints between all others, which no URDF has, in a model put together joint by joint."""
    model, slots = pin.Model(), {}
    model.gravity = pin.Motion(np.array(GRAVITY), np.zeros(3))
    for number in range(1, 9):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        joints = {
            "spherical": pin.JointModelSpherical(),
            "planar": pin.JointModelPlanar(),
            "floating": pin.JointModelFreeFlyer(),
            "revolute": pin.JointModelRevoluteUnaligned(axis),
            "prismatic": pin.JointModelPrismaticUnaligned(axis),
        }
        kind = "spherical" if number % 2 else str(rng.choice(list(joints)))
        place = pin.SE3(pin.Quaternion(*rng.normal(size=4)).normalized().matrix(), rng.normal(size=3))
        # On the last joint or one that carries it: Pinocchio's mass matrix wants branches one after another.
        carriers = [0] if number == 1 else [number - 1, *list(model.supports[number - 1])[:-1]]
        at = model.addJoint(int(rng.choice(carriers)), joints[kind], place, f"j{number}")
        mass, moment = mass_and_inertia(rng, thin)
        model.appendBodyToJoint(at, pin.Inertia(mass, 0.3 * rng.normal(size=3), moment), pin.SE3.Identity())
        q, v = (slice(start[at], start[at] + size[at]) for start, size in spans(model))
        slots[f"j{number}"] = JointSlot(
            name=f"j{number}", kind=kind, joint_id=at, q=q, v=v, axis=axis, frame_rotation=np.eye(3)
        )
    return Mechanism(
        name="by hand", model=model, urdf=None, base="fixed", joints=slots, base_body="", bodies=()
    )


def spans(model):
    """Starts and sizes of the joints in q and in v."""
    return (model.idx_qs, model.nqs), (model.idx_vs, model.nvs)


@pytest.mark.parametrize("seed", range(8))
def test_joints_that_no_urdf_has_are_pinocchios(seed):
    mechanism = by_hand(np.random.default_rng(seed))
    assert max(deviations(mechanism, seed)) < CLOSE
    assert max(change_deviations(mechanism, seed)) < CLOSE


@pytest.mark.parametrize("seed", range(4))
def test_thin_rods_on_ball_joints_are_taken(seed):
    """About its own axis a rod's acceleration is round-off of the moments over next to no inertia."""
    mechanism = by_hand(np.random.default_rng(seed), thin=1e-8)
    TreeDynamics(mechanism)
    assert max(deviations(mechanism, seed)[1:]) < CLOSE


def test_a_light_link_between_heavy_ones_is_taken():
    """``pin.aba`` is off by 4.9e-11 of the forces there; what they take is known to round-off."""
    masses = ((1893.0, 0.3), (0.3, 0.02), (377.0, 0.4))
    links = "".join(
        f'<link name="l{k}"><inertial><origin xyz="{size} 0 {-size}"/><mass value="{mass}"/>'
        f'<inertia ixx="{mass * size**2}" iyy="{mass * size**2}" izz="{0.4 * mass * size**2}" '
        'ixy="0" ixz="0" iyz="0"/></inertial></link>'
        for k, (mass, size) in enumerate(masses)
    )
    rng = np.random.default_rng(4)
    joints = "".join(joint(rng, k, "revolute", f"l{k - 1}", f"l{k}") for k in (1, 2))
    urdf = Urdf.from_text(f'<robot name="light">{links}{joints}</robot>', "light")
    mechanism = build_mechanism(urdf.variant({"j1": "free", "j2": "planar"}), "free", GRAVITY)
    TreeDynamics(mechanism)


@pytest.mark.parametrize("base", ["free", "fixed"])
def test_a_long_chain_is_pinocchios(base):
    rng = np.random.default_rng(3)
    text = f'<link name="l0">{inertial(rng)}</link>'
    for number in range(1, 65):
        text += joint(rng, number, KINDS[number % 2], f"l{number - 1}", f"l{number}")
        text += f'<link name="l{number}">{inertial(rng)}</link>'
    urdf = Urdf.from_text(f'<robot name="chain">{text}</robot>', "chain")
    assert max(deviations(build_mechanism(urdf, base, GRAVITY), 3)) < CLOSE


def test_room_is_not_taken_for_a_place():
    """Numba lets a record stand in for one that it begins as, and warns: where nothing is cached."""
    begins = [[(name, *record.fields[name]) for name in record.names] for record in (ROOM, PLACE)]
    assert not set(begins[0]) >= set(begins[1])


def test_nothing_stays_in_the_room():
    """The same numbers bit for bit, whatever was computed in it before."""
    mechanism = build_mechanism(random_urdf(8, 12), "free", GRAVITY)
    tree, nq, nv = TreeDynamics(mechanism), mechanism.model.nq, mechanism.model.nv
    room, places, found = tree.room(), np.zeros(len(tree.tree) + 1, PLACE), np.zeros((2, nv))
    mass, bias = np.zeros((2, nv, nv)), np.zeros((2, nv))
    for seed in (1, 2, 1):
        q, v, tau = random_state(mechanism.model, seed)
        y, k = np.concatenate([q, v]), 0 if seed == 2 else 1
        aba(y, nq, tree.tree, tree.gravity, tau, room, found[k])
        place_bodies(y, nq, tree.tree, places)
        bias_accelerations(tree.tree, places)
        mass_and_bias(tree.tree, places, tree.gravity, room, mass[k], bias[k])
    assert np.array_equal(found[1], tree.acceleration(q, v, tau))
    fresh_mass, fresh_bias = tree.mass_and_bias(q, v)
    assert np.array_equal(mass[1], fresh_mass)
    assert np.array_equal(bias[1], fresh_bias)


@pytest.mark.parametrize("factor", [1.0 + 1e-7, np.nan])
@pytest.mark.parametrize("field", ["mass", "centre", "inertia", "position", "rotation", "axis"])
def test_a_tree_that_is_not_pinocchios_is_refused(crooked, monkeypatch, field, factor):
    """One number of one body off by 1e-7 of itself is seen, and the message says how far off it is."""

    def wrong(mechanism):
        tree = body_tree(mechanism)
        tree[field][2] *= factor
        return tree

    monkeypatch.setattr(tree_module, "body_tree", wrong)
    rule = r"'crooked': .* must be Pinocchio's to 1e-11 .* deviation of (\d|nan)"
    with pytest.raises(MechanismError, match=rule):
        TreeDynamics(build_mechanism(crooked, "free", GRAVITY))


def test_runs_of_one_model_compare_it_once(crooked, monkeypatch):
    """Another model with the same bodies, and other bodies of one model, are compared themselves."""

    def heavy(mechanism):
        tree = body_tree(mechanism)
        tree["mass"][1] *= 2.0
        return tree

    compared, own = [], TreeDynamics._deviations

    def counted(self, model):
        compared.append(model)
        return own(self, model)

    monkeypatch.setattr(TreeDynamics, "_deviations", counted)
    monkeypatch.setattr(tree_module, "_compared", deque(maxlen=4))
    for gravity in (GRAVITY, GRAVITY, (0.0, 0.0, 1.0)):
        TreeDynamics(build_mechanism(crooked, "free", gravity))
    assert [model.gravity.linear[2] for model in compared] == [GRAVITY[2], 1.0]
    monkeypatch.setattr(tree_module, "body_tree", heavy)
    with pytest.raises(MechanismError, match="must be Pinocchio's"):
        TreeDynamics(build_mechanism(crooked, "free", GRAVITY))
