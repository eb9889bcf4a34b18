"""A Pinocchio model has the masses, places and motions that its URDF says."""

import io
import math
import re

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy

from antenna_pin.dynamics.constraints import Anchor, on_body
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.mechanism import (
    JointChange,
    LinkChange,
    Urdf,
    WrittenUrdf,
    build_mechanism,
    frame_aligning_z,
)

KINDS = ("ideal", "free", "planar", "locked")
CASES = [("crooked", "wrist"), ("crooked", "swivel"), ("antenna", "elevation"), ("antenna", "azimuth")]


@pytest.fixture
def urdf(request) -> Urdf:
    return request.getfixturevalue(request.param)


each_hinge = pytest.mark.parametrize(("urdf", "joint"), CASES, indirect=["urdf"], ids=[c[1] for c in CASES])


def random_state(model, seed):
    rng = np.random.default_rng(seed)
    q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
    return q, rng.normal(size=model.nv), rng.normal(size=model.nv)


def link_placements(mechanism, q):
    """World placements (4, 4) of all links of the URDF."""
    data = mechanism.model.createData()
    pin.framesForwardKinematics(mechanism.model, data, q)
    return {
        link.name: data.oMf[mechanism.frame(link.name)].homogeneous for link in mechanism.urdf.robot.links
    }


def merged_inertia(urdf, first):
    """Mass, first moment and inertia about the frame of ``first``, with all that fixed joints weld to it."""
    mass, moment, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    todo = [(first, np.eye(4))]
    while todo:
        name, x = todo.pop()
        own = urdf.link(name).inertial
        if own is not None:
            y = x @ (np.eye(4) if own.origin is None else own.origin)
            c = y[:3, 3]
            mass += own.mass
            moment += own.mass * c
            inertia += y[:3, :3] @ own.inertia @ y[:3, :3].T + own.mass * (c @ c * np.eye(3) - np.outer(c, c))
        todo += [
            (j.child, x @ urdf.placement(j.name))
            for j in urdf.robot.joints
            if j.parent == name and j.type == "fixed"
        ]
    return mass, moment, inertia


@pytest.mark.parametrize("base", ["free", "fixed"])
@pytest.mark.parametrize("urdf", ["crooked", "antenna"], indirect=True)
def test_bodies_have_the_mass_and_inertia_that_their_links_add_up_to(urdf, base):
    """Parallel axes and turned inertial frames, worked out here from yourdfpy's numbers."""
    mechanism = build_mechanism(urdf, base)
    model = mechanism.model
    first_links = {joint.name: joint.child for joint in urdf.robot.joints} | {"root_joint": urdf.root}
    for joint_id, name in list(enumerate(model.names))[1:]:
        mass, moment, inertia = merged_inertia(urdf, first_links[name])
        body = model.inertias[joint_id]
        about_origin = body.matrix()[3:, 3:]
        assert body.mass == pytest.approx(mass, rel=1e-14)
        # Sums of a handful of products, each to round-off of the largest.
        assert np.abs(body.mass * body.lever - moment).max() < 1e-14 * max(1.0, mass)
        assert np.abs(about_origin - inertia).max() < 1e-14 * inertia.max()
    total = sum(link.inertial.mass for link in urdf.robot.links if link.inertial is not None)
    assert sum(body.mass for body in model.inertias) == pytest.approx(total, rel=1e-14)


@pytest.mark.parametrize("urdf", ["crooked", "antenna"], indirect=True)
def test_links_are_where_yourdfpy_puts_them(urdf):
    """At random angles of every joint; a turned axis or a wrong order of rpy shows."""
    mechanism = build_mechanism(urdf, "fixed")
    robot = yourdfpy.URDF.load(io.BytesIO(urdf.to_xml().encode()), load_meshes=False)
    rng = np.random.default_rng(1)
    for _ in range(5):
        angles = dict(zip(mechanism.joints, rng.uniform(-2.0, 2.0, len(mechanism.joints)), strict=True))
        robot.update_cfg(angles)
        q = pin.neutral(mechanism.model)
        for name, slot in mechanism.joints.items():
            # yourdfpy takes the length of a prismatic axis into the motion; URDF has it of unit length.
            q[slot.q] = joint_position(
                slot,
                angles[name] * (np.linalg.norm(urdf.joint(name).axis) if slot.kind == "prismatic" else 1.0),
            )
        for link, placement in link_placements(mechanism, q).items():
            assert np.abs(placement - robot.get_transform(link)).max() < 1e-14  # round-off of metres


def joint_position(slot, angle):
    """The configuration of a hinge at an angle about its axis, whatever the joint has been made."""
    if slot.kind == "continuous":
        return [math.cos(angle), math.sin(angle)]
    if slot.kind == "planar":
        return [0.0, 0.0, math.cos(angle), math.sin(angle)]
    if slot.kind == "floating":
        return [0.0, 0.0, 0.0, *(math.sin(angle / 2) * slot.axis), math.cos(angle / 2)]
    return [angle]


def hinge_column(slot):
    """The generalized velocity of turning about the axis at 1 rad/s."""
    if slot.kind == "planar":
        return np.array([0.0, 0.0, 1.0])
    if slot.kind == "floating":
        return np.concatenate([np.zeros(3), slot.axis])
    return np.ones(1)


def embed(mechanism, ideal, q, *vectors):
    """Carry a state of the ideal mechanism over to a variant, by joint name."""
    q_new, new = pin.neutral(mechanism.model), [np.zeros(mechanism.model.nv) for _ in vectors]
    q_new[mechanism.base_q] = q[ideal.base_q]
    for array, vector in zip(new, vectors, strict=True):
        array[mechanism.base_v] = vector[ideal.base_v]
    for name, slot in mechanism.joints.items():
        source = ideal.joint(name)
        if slot.kind == source.kind:
            q_new[slot.q] = q[source.q]
        else:
            own = q[source.q]
            q_new[slot.q] = joint_position(
                slot, float(own[0]) if len(own) == 1 else math.atan2(own[1], own[0])
            )
        for array, vector in zip(new, vectors, strict=True):
            column = np.ones(1) if slot.kind == source.kind else hinge_column(slot)
            array[slot.v] = column * vector[source.v]
    return (q_new, *new)


@each_hinge
@pytest.mark.parametrize("kind", ["free", "planar", "locked"])
def test_a_variant_in_its_centred_pose_is_the_ideal_mechanism(urdf, joint, kind):
    """Every link is where it is in the ideal mechanism; and mass is neither made nor lost."""
    ideal, variant = build_mechanism(urdf), build_mechanism(urdf.variant(joints={joint: kind}))
    expected = link_placements(ideal, pin.neutral(ideal.model))
    placements = link_placements(variant, pin.neutral(variant.model))
    for link, placement in expected.items():
        assert np.abs(placements[link] - placement).max() < 1e-14
    assert pin.computeTotalMass(variant.model) == pytest.approx(pin.computeTotalMass(ideal.model), rel=1e-14)
    freedoms = {"free": 5, "planar": 2, "locked": -1}[kind]
    assert variant.model.nv == ideal.model.nv + freedoms


@each_hinge
@pytest.mark.parametrize("kind", ["free", "planar"])
def test_a_variant_that_turns_as_the_hinge_does_needs_the_same_torque(urdf, joint, kind):
    """D'Alembert: the forces of a constraint do no work.

    So along the ideal motion the hinge's torque is the variant's generalized force in the direction of the
    axis, and the forces at all other joints are the same.
    """
    ideal, variant = build_mechanism(urdf), build_mechanism(urdf.variant(joints={joint: kind}))
    for seed in range(5):
        q, v, a = random_state(ideal.model, seed)
        tau = pin.rnea(ideal.model, ideal.model.createData(), q, v, a)
        tau_variant = pin.rnea(variant.model, variant.model.createData(), *embed(variant, ideal, q, v, a))
        round_off = 1e-13 * np.abs(tau).max()
        assert np.abs(tau_variant[variant.base_v] - tau[ideal.base_v]).max() < round_off
        for name, slot in variant.joints.items():
            column = hinge_column(slot) if name == joint else np.ones(1)
            assert column @ tau_variant[slot.v] == pytest.approx(
                float(tau[ideal.joint(name).v][0]), abs=round_off
            )


@each_hinge
def test_a_planar_joint_moves_in_the_plane_normal_to_its_axis(urdf, joint):
    """Its x and y are the first two columns of ``frame_rotation``, and nothing moves along the axis."""
    mechanism = build_mechanism(urdf.variant(joints={joint: "planar"}), "fixed")
    slot = mechanism.joint(joint)
    child = urdf.joint(joint).child
    q = pin.neutral(mechanism.model)
    start = link_placements(mechanism, q)[child]
    q[slot.q] = [0.3, -0.2, math.cos(0.7), math.sin(0.7)]
    end = link_placements(mechanism, q)[child]
    shift = start[:3, :3].T @ (end[:3, 3] - start[:3, 3])  # in the URDF frame of the joint
    assert np.abs(shift - slot.frame_rotation @ [0.3, -0.2, 0.0]).max() < 1e-14
    assert abs(shift @ slot.axis) < 1e-14
    turn = start[:3, :3].T @ end[:3, :3]
    assert np.abs(turn - pin.exp3(0.7 * slot.axis)).max() < 1e-14


@each_hinge
@pytest.mark.parametrize("kind", KINDS)
def test_a_variant_written_out_and_read_again_moves_in_the_same_way(urdf, joint, kind, tmp_path):
    """Accelerations at random states, bit for bit: the file is all there is to a variant."""
    variant = urdf.variant(joints={joint: kind})
    variant.write(tmp_path / "v.urdf")
    ours, theirs = build_mechanism(variant), build_mechanism(Urdf.load(tmp_path / "v.urdf"))
    assert list(ours.joints) == list(theirs.joints)
    for name, slot in ours.joints.items():
        again = theirs.joint(name)
        assert (slot.kind, slot.joint_id, slot.q, slot.v) == (again.kind, again.joint_id, again.q, again.v)
        assert np.array_equal(slot.axis, again.axis) and np.array_equal(
            slot.frame_rotation, again.frame_rotation
        )
    for seed in range(5):
        q, v, tau = random_state(ours.model, seed)
        accelerations = [pin.aba(m.model, m.model.createData(), q, v, tau) for m in (ours, theirs)]
        assert np.array_equal(*accelerations)


@pytest.mark.parametrize(
    "axis", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 1e-7, 1e-9), (-1e-9, 0.0, -1.0)]
)
def test_a_planar_joint_about_awkward_axes_keeps_its_child_in_place(crooked_text, axis):
    """Axes along x put the pitch of the turned frame at 90 degrees, where URDF's angles are singular."""
    text = crooked_text.replace('xyz="-0.3 0.1 -0.9"', f'xyz="{axis[0]} {axis[1]} {axis[2]}"')
    text = text.replace('xyz="0 0.6 0" rpy="-0.7 1.1 0.4"', 'xyz="0 0.6 0" rpy="0 0 0.3"')
    urdf = Urdf.from_text(text, "crooked.urdf")
    ideal, planar = build_mechanism(urdf), build_mechanism(urdf.variant(joints={"wrist": "planar"}))
    expected = link_placements(ideal, pin.neutral(ideal.model))["hand"]
    assert np.abs(link_placements(planar, pin.neutral(planar.model))["hand"] - expected).max() < 1e-14


def test_slots_say_what_a_joint_is_and_where_it_is_in_the_state(crooked):
    mechanism = build_mechanism(crooked.variant(joints={"wrist": "planar", "swivel": "free"}))
    assert {name: slot.kind for name, slot in mechanism.joints.items()} == {
        "slide": "prismatic",
        "swivel": "floating",
        "wrist": "planar",
    }
    sizes = {
        name: (slot.q.stop - slot.q.start, slot.v.stop - slot.v.start)
        for name, slot in mechanism.joints.items()
    }
    assert sizes == {"slide": (1, 1), "swivel": (7, 6), "wrist": (4, 3)}
    # Together with the base they tile the state.
    taken_q = sorted(
        i
        for s in (mechanism.base_q, *(s.q for s in mechanism.joints.values()))
        for i in range(s.start, s.stop)
    )
    taken_v = sorted(
        i
        for s in (mechanism.base_v, *(s.v for s in mechanism.joints.values()))
        for i in range(s.start, s.stop)
    )
    assert taken_q == list(range(mechanism.model.nq)) and taken_v == list(range(mechanism.model.nv))
    for name in ("swivel", "wrist"):
        slot = mechanism.joint(name)
        assert np.array_equal(slot.axis, crooked.axis(name))
        assert mechanism.model.names[slot.joint_id] == name
        with pytest.raises(ValueError, match="read-only"):
            slot.axis[0] = 0.0
    assert np.array_equal(mechanism.joint("swivel").frame_rotation, np.eye(3))
    assert np.array_equal(mechanism.joint("wrist").frame_rotation, frame_aligning_z(crooked.axis("wrist")))
    assert build_mechanism(crooked).joint("swivel").kind == "continuous"


@pytest.mark.parametrize(
    "axis", [None, (0.0, 1.0, 0.0), (0.0, 0.0, -2.0), (0.3, -0.5, 0.8), (0.0, 0.0, 3.0), (1.0, 1e-7, 1e-9)]
)
def test_a_planar_joint_lies_in_the_plane_normal_to_its_axis(crooked_text, axis, tmp_path):
    """Against Pinocchio's joint, whose normal is z, put by hand where URDF says; x where there is no axis."""
    written = "" if axis is None else '<axis xyz="{} {} {}"/>'.format(*axis)
    normal = (1.0, 0.0, 0.0) if axis is None else axis
    (inertial, *_) = re.findall("<inertial>.*?</inertial>", crooked_text, re.DOTALL)
    urdf = Urdf.from_text(
        f'<robot name="p"><link name="a"/><link name="b">{inertial}</link><link name="c">{inertial}</link>'
        '<joint name="j" type="planar"><parent link="a"/><child link="b"/><origin xyz="1 2 3" rpy="1 2 3"/>'
        f'{written}</joint><joint name="k" type="revolute"><parent link="b"/><child link="c"/>'
        '<origin xyz="0 1 0" rpy="0.1 0.2 0.3"/><axis xyz="1 0 0"/>'
        '<limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>',
        "p.urdf",
    )
    mechanism = build_mechanism(urdf, "fixed", (0.1, 0.2, -9.0))
    (path,) = urdf.write(tmp_path / "p.urdf")
    alone = pin.buildModelFromUrdf(str(path))
    alone.gravity = mechanism.model.gravity
    slot = mechanism.joint("j")
    assert (slot.kind, urdf.link("b").name) == ("planar", mechanism.bodies[0])
    assert slot.axis == pytest.approx(np.array(normal) / np.linalg.norm(normal), rel=1e-15)
    assert np.array_equal(slot.frame_rotation, frame_aligning_z(slot.axis))
    turn = pin.SE3(frame_aligning_z(normal), np.zeros(3))
    place = pin.SE3(pin.rpy.rpyToMatrix(1.0, 2.0, 3.0), np.array([1.0, 2.0, 3.0]))
    elbow = pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), np.array([0.0, 1.0, 0.0]))
    own = urdf.mass_properties("c")
    body = pin.Inertia(own.mass, own.centre, own.inertia)
    hand = pin.Model()
    first = hand.addJoint(0, pin.JointModelPlanar(), place * turn, "j")
    hand.appendBodyToJoint(first, body, turn.inverse())
    second = hand.addJoint(first, pin.JointModelRX(), turn.inverse() * elbow, "k")
    hand.appendBodyToJoint(second, body, pin.SE3.Identity())
    hand.gravity = mechanism.model.gravity
    for seed in range(3):
        state = random_state(hand, seed)
        ours, theirs, read = (pin.aba(m, m.createData(), *state) for m in (mechanism.model, hand, alone))
        assert np.abs(ours - theirs).max() < 1e-12 * np.abs(theirs).max()  # round-off
        assert np.array_equal(ours, read)


def test_the_normal_of_a_planar_joint_is_changed_like_any_axis(crooked_text):
    text = crooked_text.replace('type="prismatic"', 'type="planar"')
    changes = {"slide": JointChange(axis=(1.0, 2.0, 3.0), origin_rpy=(0.1, 0.2, 0.3))}
    urdf = Urdf.from_text(text, "u.urdf").variant(origins=changes)
    direct = text.replace('<axis xyz="0 1 1"/>', '<axis xyz="1 2 3"/>').replace(
        'rpy="0 0.8 0"', 'rpy="0.1 0.2 0.3"'
    )
    ours, theirs = (build_mechanism(one, "free") for one in (urdf, Urdf.from_text(direct, "u.urdf")))
    state = random_state(ours.model, 3)
    assert np.array_equal(*(pin.aba(one.model, one.model.createData(), *state) for one in (ours, theirs)))


def test_bodies_bear_the_names_of_the_links_that_have_mass(crooked):
    """Not of the massless link that a planar joint puts first, nor of links that are welded on."""
    for kind in ("ideal", "free", "planar"):
        free = build_mechanism(crooked.variant(joints={"wrist": kind}))
        assert (free.base_body, free.bodies[0]) == ("hull", "hull")
        assert set(free.bodies) == {"hull", "arm", "hand", "weight"}
        for index, body in enumerate(free.bodies, start=1):
            assert free.model.frames[free.frame(body)].parentJoint == index
        assert free.model.frames[free.frame("camera")].parentJoint == free.joint("wrist").joint_id
        fixed = build_mechanism(crooked.variant(joints={"wrist": kind}), "fixed")
        assert (fixed.base_body, set(fixed.bodies)) == ("hull", {"arm", "hand", "weight"})
    locked = build_mechanism(crooked.variant(joints={"swivel": "locked"}))
    assert set(locked.bodies) == {"hull", "hand", "weight"}


def on_the_world(text, fixed=False):
    """Return crooked's text with a root ``world`` before its hull, or with a hull of that name."""
    if not fixed:
        return text.replace('"hull"', '"world"')
    weld = '<joint name="stand" type="fixed"><parent link="world"/><child link="hull"/></joint>'
    return text.replace("</robot>", f'<link name="world"/>{weld}</robot>')


@pytest.mark.parametrize("fixed", [False, True])
def test_a_link_called_the_world_is_the_world(crooked_text, fixed):
    """As the root on a fixed base it is what closures and springs to ``world`` mean; else it is refused."""
    urdf = Urdf.from_text(on_the_world(crooked_text, fixed), "u.urdf")
    mechanism, plain = (
        build_mechanism(one, "fixed") for one in (urdf, Urdf.from_text(crooked_text, "u.urdf"))
    )
    q, v, tau = random_state(plain.model, 4)
    ours, theirs = (pin.aba(one.model, one.model.createData(), q, v, tau) for one in (mechanism, plain))
    assert np.array_equal(ours, theirs)
    place = Anchor.at("world", (1.0, 2.0, 3.0), (0.0, 1.0, 0.0))
    (body, frame), (none, same) = (on_body(one, "here", place) for one in (mechanism, plain))
    assert body == none == -1 and np.array_equal(frame, same)
    assert np.array_equal(mechanism.model.frames[mechanism.frame("world")].placement.homogeneous, np.eye(4))
    with pytest.raises(MechanismError) as caught:
        build_mechanism(urdf, "free")
    assert str(caught.value) == (
        "u.urdf: link 'world' must be the root on a fixed base, for its name means what does not move, got a "
        "free base; take base = 'fixed', or rename it"
    )


def test_another_link_called_the_world_is_refused(crooked_text):
    for name in ("camera", "hand"):
        with pytest.raises(MechanismError, match="does not move, got another link; rename it"):
            build_mechanism(Urdf.from_text(crooked_text.replace(f'"{name}"', '"world"'), "u.urdf"), "fixed")


def test_gravity_pulls_the_whole_mass(crooked):
    """The force that holds a mechanism up is its weight, through its mass centre."""
    gravity = np.array([1.0, -2.0, -9.0])
    mechanism = build_mechanism(crooked, gravity=gravity)
    model, data = mechanism.model, mechanism.model.createData()
    q = pin.neutral(model)
    holding = pin.computeGeneralizedGravity(model, data, q)[mechanism.base_v]
    mass, centre = pin.computeTotalMass(model), pin.centerOfMass(model, data, q)
    assert np.abs(holding[:3] + mass * gravity).max() < 1e-12  # round-off of 500 N
    assert np.abs(holding[3:] + mass * np.cross(centre, gravity)).max() < 1e-12
    assert np.array_equal(build_mechanism(crooked).model.gravity.vector, np.zeros(6))


# --- refusals ---


def test_refusals(crooked):
    with pytest.raises(InvalidParameterError, match="base must be 'free' or 'fixed', got 'floating'"):
        build_mechanism(crooked, "floating")
    with pytest.raises(InvalidParameterError, match="gravity must be three finite numbers"):
        build_mechanism(crooked, gravity=(0.0, -9.81))
    with pytest.raises(
        UnknownNameError, match="mechanism 'crooked': moving joint 'wirst' is unknown; did you mean wrist?"
    ):
        build_mechanism(crooked).joint("wirst")
    with pytest.raises(UnknownNameError, match="moving joint 'weld' is unknown"):
        build_mechanism(crooked).joint("weld")
    with pytest.raises(UnknownNameError, match="link 'wrist' is unknown"):
        build_mechanism(crooked).frame("wrist")
    locked = crooked.variant(joints=dict.fromkeys(("wrist", "swivel", "slide"), "locked"))
    with pytest.raises(
        MechanismError, match="crooked.urdf: nothing moves: the base is fixed and so is every joint"
    ):
        build_mechanism(locked, "fixed")
    assert build_mechanism(locked).model.nv == 6


def test_a_root_that_floats_must_have_mass_but_a_fixed_one_need_not():
    text = (
        '<robot name="pole"><link name="ground"/><link name="pole"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="hinge" type="continuous"><parent link="ground"/><child link="pole"/></joint></robot>'
    )
    urdf = Urdf.from_text(text, "pole.urdf")
    with pytest.raises(
        MechanismError, match="pole.urdf: the free base can turn link 'ground' without any inertia: it has no"
    ):
        build_mechanism(urdf)
    mechanism = build_mechanism(urdf, "fixed")
    assert (mechanism.base_body, mechanism.bodies) == ("ground", ("pole",))


def cross():
    """A rod on a universal joint: a hinge, a cross without mass, a hinge."""
    return Urdf.from_text(
        """<robot name="pole"><link name="ground"/><link name="cross"/>
        <link name="rod"><inertial><origin xyz="0 0 0.5"/><mass value="3"/>
        <inertia ixx="2" iyy="2.5" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="one" type="continuous"><parent link="ground"/><child link="cross"/>
        <axis xyz="1 0 0"/></joint>
        <joint name="two" type="continuous"><parent link="cross"/><child link="rod"/>
        <axis xyz="0 1 0"/></joint>
        </robot>""",
        "pole.urdf",
    )


def test_the_cross_of_a_universal_joint_needs_no_mass():
    """What it carries gives both hinges their inertia: at zero angles that of the rod about its end."""
    mechanism = build_mechanism(cross(), "fixed")
    assert mechanism.bodies == ("cross", "rod")
    matrix = pin.crba(mechanism.model, mechanism.model.createData(), pin.neutral(mechanism.model))
    # m l^2 = 0.75 kg m^2 more than about the mass centre; sums of a few decimal numbers.
    assert np.triu(matrix) == pytest.approx(np.diag([2.75, 3.25]), abs=1e-14)


def test_a_model_that_somebody_alters_is_nobody_elses(crooked_text):
    written = WrittenUrdf(text=crooked_text, where="crooked")
    first, second = (build_mechanism(written.variant({"wrist": "free"})) for _ in range(2))
    assert first.urdf is second.urdf  # what has been read and judged is not again
    assert first.model == second.model and first.model is not second.model
    first.model.gravity.linear = np.array([0.0, 0.0, -9.81])
    first.model.inertias[1] = pin.Inertia.Zero()
    again = build_mechanism(written.variant({"wrist": "free"}))
    assert again.model == second.model


def test_the_last_digit_of_a_change_makes_another_variant(crooked_text):
    written = WrittenUrdf(text=crooked_text, where="crooked")
    link = next(one for one in written.variant().robot.links if one.inertial is not None)
    mass = link.inertial.mass
    found = []
    for one in (mass, math.nextafter(mass, 2.0 * mass)):
        changed = written.variant(links={link.name: LinkChange(mass=one)})
        found.append(changed.link(link.name).inertial.mass)
    assert found == [mass, math.nextafter(mass, 2.0 * mass)]
