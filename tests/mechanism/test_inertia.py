"""Inertia is judged where it acts: on what fixed joints make one body, and in what joints can move."""

import itertools
import re

import numpy as np
import pinocchio as pin
import pytest
from numpy.testing import assert_array_equal
from scipy.special import ellipj, ellipk

from antenna_pin import RunSettings, System, simulate
from antenna_pin.base.changes import JointChange, LinkChange
from antenna_pin.elements import ConstantDrive
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import TreeDynamics, Urdf, build_mechanism
from antenna_pin.mechanism.inertia import is_regular_everywhere

NOTHING = '<inertial><mass value="0"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial>'


def words(numbers):
    return " ".join(f"{number:.17g}" for number in numbers)


def link(name, mass, inertia, centre=(0.0, 0.0, 0.0)):
    """A link with the inertia (3, 3) about its mass centre, or three moments."""
    full = np.diag(inertia) if np.ndim(inertia) == 1 else np.asarray(inertia)
    entries = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
    tensor = " ".join(f'i{key}="{full[place]:.17g}"' for key, place in entries.items())
    return (
        f'<link name="{name}"><inertial><origin xyz="{words(centre)}"/><mass value="{mass}"/>'
        f"<inertia {tensor}/></inertial></link>"
    )


def joint(name, parent, child, kind="fixed", axis=(1.0, 0.0, 0.0), xyz=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{words(xyz)}" rpy="{words(rpy)}"/><axis xyz="{words(axis)}"/></joint>'
    )


def robot(*parts, **options):
    return Urdf.from_text(f'<robot name="r">{"".join(parts)}</robot>', "r.urdf", **options)


def accelerations(mechanism, seed):
    model, rng = mechanism.model, np.random.default_rng(seed)
    q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
    v, tau = rng.normal(size=(2, model.nv))
    return pin.aba(model, model.createData(), q, v, tau)


def test_an_inertial_of_zero_is_none(crooked_text):
    """Frames with it are frames: behind a body, before it and as the root; names and motion bit for bit."""
    without = crooked_text.replace('<child link="hand"/>', '<child link="socket"/>').replace(
        '<joint name="weld"',
        '<link name="socket"/><joint name="plug" type="fixed"><parent link="socket"/><child link="hand"/>'
        '<origin xyz="0.1 0 0.2" rpy="0.3 0 1"/></joint><joint name="weld"',
    )
    with_it = without.replace('<link name="camera"/>', f'<link name="camera">{NOTHING}</link>')
    with_it = with_it.replace('<link name="socket"/>', f'<link name="socket">{NOTHING}</link>')
    assert with_it.count(NOTHING) == 2
    for base in ("free", "fixed"):
        for kind in ("ideal", "planar", "free"):
            ours, theirs = (
                build_mechanism(Urdf.from_text(text, "u.urdf").variant(joints={"wrist": kind}), base)
                for text in (with_it, without)
            )
            assert ours.bodies == theirs.bodies and "hand" in ours.bodies
            assert_array_equal(accelerations(ours, 3), accelerations(theirs, 3))
    with pytest.raises(MechanismError, match="link 'camera' must have an <inertial>, got none"):
        Urdf.from_text(with_it, "u.urdf").mass_properties("camera")


@pytest.mark.parametrize("seed", range(3))
def test_points_and_rods_fixed_together_are_the_body_that_they_make(seed):
    """Six weights and a rod on frames turned anyhow, beside the one link that has the moments of the sum."""
    rng = np.random.default_rng(seed)
    parts, pieces = [link("ground", 1, (1, 1, 1))], []
    parts += ['<link name="hub"/>', joint("j", "ground", "hub", "continuous", rng.normal(size=3))]
    for k in range(7):
        place, turn = rng.uniform(-0.3, 0.3, 3), rng.uniform(-3, 3, 3)
        mass = rng.uniform(0.5, 2.0)
        moments = np.diag([0.0, 0.1, 0.1]) if k == 6 else np.zeros((3, 3))
        parts += [link(f"p{k}", mass, moments), joint(f"w{k}", "hub", f"p{k}", xyz=place, rpy=turn)]
        r = pin.rpy.rpyToMatrix(turn)
        pieces.append(pin.Inertia(mass, place, r @ moments @ r.T))
    whole = sum(pieces[1:], pieces[0])
    one = [parts[0], link("hub", whole.mass, whole.inertia, whole.lever), parts[2]]
    for base in ("free", "fixed"):
        mechanisms = [build_mechanism(robot(*some), base) for some in (parts, one)]
        assert [each.impossible for each in mechanisms] == [(), ()]
        ours, theirs = (accelerations(each, seed) for each in mechanisms)
        # Round-off of a hundred operations.
        assert ours == pytest.approx(theirs, rel=1e-11, abs=1e-11 * np.abs(theirs).max())


def test_the_rules_hold_for_the_sum_in_any_axes():
    """A plate, I_3 = I_1 + I_2, and a rod, I_1 = 0, pass in any axes, their digits cut to six.

    Three times what six digits can do wrong, 1e-5 of the largest moment, does not.
    """
    rng = np.random.default_rng(0)

    def impossible(moments, digits):
        r = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        cut = np.vectorize(lambda number: float(f"{number:.{digits}g}"))
        tensor = cut(r @ np.diag(moments) @ r.T)
        parts = link("a", 1, (1, 1, 1)), link("b", 1, tensor), joint("j", "a", "b", "continuous")
        return "".join(build_mechanism(robot(*parts), "fixed").impossible)

    for _ in range(20):
        assert impossible((0.2, 0.3, 0.5), 6) == impossible((0.0, 0.5, 0.5), 6) == ""
        assert re.search("by 1.5[0-9]*e-05$", impossible((0.2, 0.3, 0.5 + 1.5e-5), 12))
        assert re.search("a negative .*: -1.5[0-9]*e-05, 0.5, 0.5 kg", impossible((-1.5e-5, 0.5, 0.5), 12))


FEW_DIGITS = {
    "three numbers, off by half a unit each": (("0.0012", "0.0008", "0.0021"), ("0", "0", "0"), True),
    "more than that": (("0.0012", "0.0008", "0.0022"), ("0", "0", "0"), False),
    "the same with a digit more": (("0.00120", "0.00080", "0.00210"), ("0", "0", "0"), False),
    "a power of ten": (("1.2e-3", "8E-4", "2.1e-3"), ("0.0", "0.00", "0"), True),
    "zeros are exact": (("0.12", "0.08", "0.22"), ("0.0", "0.0", "0.0"), False),
    "whole numbers are exact": (("1", "1", "3"), ("0", "0", "0"), False),
    "products, which count twice": (("1.00", "1.00", "2.03"), ("0.001", "0.01", "-0.01"), True),
    "products of more digits": (("1.00", "1.00", "2.03"), ("0.001", "0.010", "-0.010"), False),
}


@pytest.mark.parametrize(("moments", "products", "taken"), FEW_DIGITS.values(), ids=FEW_DIGITS)
def test_what_the_written_digits_leave_is_no_fault_of_the_body(moments, products, taken):
    """Of a link that moves, of a root that floats, and of one fixed to another."""
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    written = " ".join(f'{key}="{value}"' for key, value in zip(names, moments + products, strict=True))
    text = link("odd", 1, (1, 1, 1))
    odd = text[: text.index("<inertia ")] + f"<inertia {written}/></inertial></link>"
    frame = '<link name="first"/>'
    cases = (
        (odd, link("b", 1, (1, 1, 1)), joint("j", "odd", "b", "continuous")),
        (link("a", 1, (1, 1, 1)), odd, joint("j", "a", "odd", "continuous")),
        (
            link("a", 1, (1, 1, 1)),
            frame,
            odd,
            joint("j", "a", "first", "continuous"),
            joint("w", "first", "odd"),
        ),
    )
    for parts in cases:
        assert len(build_mechanism(robot(*parts), "free").impossible) == (0 if taken else 1)


def test_round_off_of_zeros_is_a_point():
    """Below a radius of gyration of 1 um neither signs nor the triangle rule mean anything."""
    ground, hinge = link("a", 1, (1, 1, 1)), joint("j", "a", "b", "continuous")
    for moments, said in (
        ((-2.4e-35, 8e-67, 2.4e-35), ""),
        ((0.0, 0.0, 0.9 * 0.5e-12), ""),
        ((0.0, 0.0, 1.1 * 0.5e-12), "by 5.5e-13"),
    ):
        urdf = robot(ground, link("b", 0.5, moments, (0.0, 0.1, 0.1)), hinge)
        found = "".join(build_mechanism(urdf, "fixed").impossible)
        assert said in found and bool(said) == bool(found)


def test_what_a_part_lacks_the_rest_of_its_body_may_have():
    """A part that no body is passes where the sum is one; a sum that is none is said with all names."""
    odd, frame = link("b", 1, (1.0, 0.1, 0.1)), joint("w", "b", "c")
    hinge = joint("j", "a", "b", "continuous")
    ground, heavy, light = link("a", 1, (1, 1, 1)), link("c", 1, (1, 2, 2)), link("c", 1, (0.1, 0.1, 0.1))
    assert build_mechanism(robot(ground, odd, hinge, heavy, frame)).impossible == ()
    assert build_mechanism(robot(ground, odd, hinge, light, frame)).impossible == (
        "link 'b' together with 'c', fixed to it: the largest principal moment of inertia exceeds the sum of "
        "the other two: 0.2, 0.2, 1.1 kg m^2, by 0.7",
    )
    for name in ("b", "c"):
        allowed = robot(ground, odd, hinge, light, frame, allow_impossible_inertia=[name])
        assert build_mechanism(allowed).impossible == ()
    negative = allowed.variant(links={"c": LinkChange(inertia=(3.0, -1.0, 1.0))})
    (said,) = build_mechanism(negative, "fixed").impossible  # its hinge turns about x
    assert "a negative principal moment of inertia: -" in said
    across = negative.variant(origins={"j": JointChange(axis=Y)})
    with pytest.raises(MechanismError, match="joint 'j' can turn link 'b' .* moments of inertia -"):
        build_mechanism(across, "fixed")
    with pytest.raises(MechanismError, match="link 'c': mass must be zero or more, got -1 kg"):
        robot(ground, link("b", 3, (1, 1, 1)), hinge, link("c", -1, (0, 0, 0)), frame)


def test_the_inertia_of_a_root_is_judged_where_it_moves():
    """It moves on a free base only: in the ground any number may stand."""
    odd = robot(link("a", 1, (5, 1, 1)), link("b", 1, (1, 1, 1)), joint("j", "a", "b", "continuous"))
    assert build_mechanism(odd, "fixed").model.nv == 1
    assert build_mechanism(odd, "fixed").impossible == ()
    (said,) = build_mechanism(odd, "free").impossible
    assert said.startswith("link 'a': the largest principal moment")


# --- joints that move without inertia ---

GROUND = link("ground", 1, (1, 1, 1))
BOB = link("bob", 2.0, (0, 0, 0), (0.0, 0.0, -0.5))
Y = (0.0, 1.0, 0.0)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_point_on_a_string_swings_as_the_elliptic_functions_say(engine):
    """sin(angle / 2) = k sn(K - omega t, k) from rest at 2 rad; its bob has no moment of inertia at all."""
    mechanism = build_mechanism(
        robot(GROUND, BOB, joint("j", "ground", "bob", "continuous", Y)), "fixed", (0.0, 0.0, -9.81)
    )
    omega, k = np.sqrt(9.81 / 0.5), np.sin(1.0)
    run = simulate(
        System(mechanism),
        duration=1.0,
        q=[np.cos(2.0), np.sin(2.0)],
        settings=RunSettings(engine=engine, rtol=1e-10),
    )
    t = run.data["time"].values
    exact = 2.0 * np.arcsin(k * ellipj(ellipk(k**2) - omega * t, k**2)[0])
    angle = run.data["motion_angle"].sel(joint="j").values
    assert np.abs(angle - exact).max() < 1e-8  # the run's error, about 100 times rtol
    assert np.abs(run.data["energy_error"].values).max() < 1e-8


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_rotor_may_have_a_moment_of_inertia_alone(engine):
    """0.2 N m on 0.1 kg m^2 turn by t^2 rad; its work is its energy, with no mass to scale errors by."""
    rotor = robot(GROUND, link("rotor", 0, (0.1, 0.1, 0.1)), joint("j", "ground", "rotor", "continuous", Y))
    system = System(build_mechanism(rotor, "fixed"), drives={"j": ConstantDrive(joint="j", value=0.2)})
    run = simulate(system, duration=0.5, settings=RunSettings(engine=engine))
    end = run.data.isel(time=-1)
    assert end["motion_angle"].item() == pytest.approx(0.25, rel=1e-12)  # a parabola, exact in any method
    assert abs(end["energy_error"].item()) < 1e-15  # round-off of 0.05 J
    assert end["drive_work"].item() == pytest.approx(0.05, rel=1e-9)


KINDS = ("revolute", "continuous", "prismatic", "floating", "planar")


def odd_tree(seed):
    """Points, rods, rotors without mass, frames and bodies on joints of all kinds."""
    rng = np.random.default_rng(seed)
    names, parts = ["l0"], [link("l0", 1, (1, 1, 1))]
    for number in range(1, 2 + seed % 5):
        name, kind = f"l{number}", KINDS[rng.choice(5, p=[0.3, 0.3, 0.2, 0.1, 0.1])]
        centre = rng.uniform(-0.3, 0.3, 3) * rng.integers(2)
        parts.append(
            [
                link(name, 1.3, (0, 0, 0), centre),
                link(name, 0.7, (0, 0.2, 0.2), centre),
                link(name, 0, (0.1, 0.2, 0.15), centre),
                f'<link name="{name}"/>',
                link(name, 2, (0.3, 0.2, 0.4), centre),
            ][rng.integers(5)]
        )
        # Round numbers, so that axes often coincide and rods lie along them.
        axis = (0, 0, 1) if kind == "planar" else np.eye(3)[rng.integers(3)]
        place = rng.integers(-1, 2, 3) * 0.5
        one = joint(f"j{number}", names[rng.integers(len(names))], name, kind, axis, place)
        limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        parts.append(one.replace("</joint>", limit) if kind in ("revolute", "prismatic") else one)
        names.append(name)
    return robot(*parts)


def least(matrix):
    """The least eigenvalue over the largest, the diagonal scaled to ones where it is not zero."""
    if not len(matrix):
        return 1.0
    diagonal = np.diag(matrix)
    scale = np.where(diagonal > 1e-12, 1.0 / np.sqrt(np.maximum(diagonal, 1e-12)), 1.0)
    values = np.linalg.eigvalsh(scale[:, None] * matrix * scale)
    return values[0] / values[-1] if values[-1] > 0.0 else 0.0


def test_random_trees_are_taken_where_their_mass_matrix_is_regular(monkeypatch):
    """Accelerations are then Pinocchio's, by both formulations; else the joint named is the one that idles.

    Of it with all beyond it the mass matrix is singular, and of all beyond it alone it is not.
    """
    taken = refused = 0
    for seed, base in itertools.product(range(100), ("free", "fixed")):
        urdf = odd_tree(seed)
        try:
            mechanism = build_mechanism(urdf, base, (0.3, 0.2, -9.0))
        except MechanismError as error:
            refused += 1
            words_of_it = str(error)
            assert "without any inertia" in words_of_it
            name = "root_joint" if "the free base can" in words_of_it else words_of_it.split("'")[1]
            with monkeypatch.context() as patch:
                patch.setattr("antenna_pin.mechanism.model.check_regular", lambda *_, **__: None)
                model = build_mechanism(urdf, base).model
            q = pin.integrate(model, pin.neutral(model), np.random.default_rng(seed).normal(size=model.nv))
            mass = np.triu(pin.crba(model, model.createData(), q))
            mass += np.triu(mass, 1).T
            named = model.getJointId(name)
            beyond = [j for j in range(1, model.njoints) if named in list(model.supports[j])[:-1]]
            rows = [
                [model.idx_vs[j] + k for j in joints for k in range(model.nvs[j])]
                for joints in ([named, *beyond], beyond)
            ]
            # Round-off of a sum, against inertias within two orders of magnitude of one another.
            assert least(mass[np.ix_(rows[0], rows[0])]) < 1e-13
            assert least(mass[np.ix_(rows[1], rows[1])]) > 1e-6
            continue
        taken += 1
        tree, model = TreeDynamics(mechanism), mechanism.model
        rng = np.random.default_rng(seed)
        q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
        v, tau = rng.normal(size=(2, model.nv))
        mass, bias = tree.mass_and_bias(q, v)
        right = pin.aba(model, model.createData(), q, v, tau)
        # Of forces, for a rod that turns by next to nothing about its axis has no certain acceleration.
        scale = np.abs(np.concatenate([bias, tau])).max()
        assert np.abs(mass @ (tree.acceleration(q, v, tau) - right)).max() < 1e-9 * scale
        assert np.abs(mass @ right + bias - tau).max() < 1e-9 * scale
    assert taken > 50 and refused > 50


ROD = link("rod", 2.0, (0.0, 0.1, 0.1))
CROSS = ('<link name="cross"/>', joint("one", "ground", "cross", "continuous"))

REFUSED = {
    "point on a free base": (
        robot(link("bus", 3.0, (0, 0, 0))),
        "free",
        "r.urdf: the free base can turn link 'bus' without any inertia: it has 3 kg and principal moments of "
        "inertia 0, 0, 0 kg m^2; give it one (mechanism.links.bus), or take base = 'fixed'",
    ),
    "rod about its axis": (
        robot(GROUND, ROD, joint("j", "ground", "rod", "continuous")),
        "fixed",
        "r.urdf: joint 'j' can turn link 'rod' without any inertia: it has 2 kg and principal moments of "
        "inertia 0, 0.1, 0.1 kg m^2; give it one (mechanism.links.rod), or lock the joint "
        '(mechanism.joints.j.kind = "locked")',
    ),
    "rod with play": (
        robot(GROUND, ROD, joint("j", "ground", "rod", "continuous", Y)).variant(joints={"j": "free"}),
        "fixed",
        "r.urdf: joint 'j' can turn link 'rod' without any inertia: ",
    ),
    "frame": (
        robot(GROUND, '<link name="f"/>', joint("j", "ground", "f", "continuous")),
        "fixed",
        "r.urdf: joint 'j' can turn link 'f' without any inertia: it has no <inertial>; give it one",
    ),
    "frames that sensors turn": (
        robot(
            *(GROUND, BOB, joint("arm", "ground", "bob", "continuous"), CROSS[0].replace("cross", "a")),
            *(joint("pan", "bob", "a", "continuous"), '<link name="b"/>', '<link name="c"/>'),
            *(joint("grip", "bob", "b", "prismatic"), joint("tilt", "a", "c", "continuous")),
        ),
        "fixed",
        "r.urdf: joint 'tilt' can turn link 'c' without any inertia: it has no <inertial>; give it one "
        '(mechanism.links.c), or lock the joint (mechanism.joints.tilt.kind = "locked"), likewise grip, pan',
    ),
    "two hinges on one line": (
        robot(GROUND, *CROSS, BOB, joint("two", "cross", "bob", "continuous")),
        "fixed",
        "r.urdf: joint 'one' can turn link 'cross' without any inertia: it has no <inertial>, and no "
        "locked joint attaches other bodies to it; give it one (mechanism.links.cross), or lock the joint",
    ),
    "shift": (
        robot(
            GROUND,
            '<link name="f"/>',
            joint("j", "ground", "f", "floating"),
            link("b", 1, (1, 1, 1)),
            joint("k", "f", "b", "continuous"),
        ),
        "fixed",
        "r.urdf: joint 'j' can turn link 'f' without any inertia: ",
    ),
}


@pytest.mark.parametrize(("urdf", "base", "message"), REFUSED.values(), ids=REFUSED)
def test_a_joint_that_moves_without_inertia_is_named(urdf, base, message):
    with pytest.raises(MechanismError) as caught:
        build_mechanism(urdf, base)
    assert str(caught.value).startswith(message)


def test_the_way_out_of_frames_that_turn_is_to_lock_them():
    urdf, base, _ = REFUSED["frames that sensors turn"]
    kept = urdf.variant(joints={name: "locked" for name in ("grip", "pan", "tilt")})
    assert list(build_mechanism(kept, base).joints) == ["arm"]


def test_a_pose_in_which_a_joint_idles_is_refused_where_others_are_not():
    """A point on two crossed hinges: along the first axis it is at nobody's hinge."""
    urdf = robot(GROUND, *CROSS, BOB, joint("two", "cross", "bob", "continuous", Y))
    system = System(build_mechanism(urdf, "fixed", (0.0, 0.0, -9.81)))
    simulate(system, duration=0.01, q=[1.0, 0.0, np.cos(1.0), np.sin(1.0)])
    with pytest.raises(MechanismError, match="initial pose: in this pose joint 'one' can turn link 'cross'"):
        simulate(system, duration=0.01, q=[1.0, 0.0, 0.0, 1.0])


def test_next_to_no_mass_is_judged_by_its_size():
    """The square of 4e-166 kg is nothing, which no number may be divided by; a rod so, it is looked at."""
    urdf = robot(
        link("a", 1.0, (0.5, 0.4, 0.8)), link("b", 4e-166, (1e-6, 0.8, 0.8)), joint("j", "a", "b", "floating")
    )
    assert build_mechanism(urdf, "fixed").model.nv == 6


@pytest.mark.parametrize(
    ("arm", "moment", "plain"), [(0.1, 1e-6, True), (100.0, 1e-6, False), (0.1, 1e-12, False)]
)
def test_a_body_of_plenty_is_plenty_beside_all_that_it_carries(arm, moment, plain):
    """A knuckle carries a hand: its own moments against those of the hand at the end of its arm."""
    model = pin.Model()
    knuckle = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "knuckle")
    model.appendBodyToJoint(knuckle, pin.Inertia(1.0, np.zeros(3), moment * np.eye(3)), pin.SE3.Identity())
    hand = model.addJoint(knuckle, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([arm, 0.0, 0.0])), "hand")
    model.appendBodyToJoint(hand, pin.Inertia(1.0, np.zeros(3), 1e-2 * np.eye(3)), pin.SE3.Identity())
    assert is_regular_everywhere(model) is plain
