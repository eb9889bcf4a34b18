"""What a URDF may hold beside its mechanics, and that its mechanics is judged after all changes."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.mechanism import JointChange, LinkChange, Urdf, WrittenUrdf, build_mechanism

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "check"))
import hand_generator
import urdf_generator
from robust import odd_urdfs

BODY = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def pair(joint, child=BODY, more=""):
    ends = '<parent link="a"/><child link="b"/>'
    return (
        f'<robot name="pair">\n<link name="a">{BODY}</link>\n<link name="b">{child}</link>\n'
        f"{joint.format(ends)}\n{more}</robot>"
    )


@pytest.mark.parametrize("number", range(0, 60, 2))
def test_what_exporters_add_changes_no_bit_of_the_mechanics(number, tmp_path, capfd):
    """Mass matrix and nonlinear effects of a random URDF full of oddities are those of its plain twin.

    Pinocchio reads the twin from its text as it is; what it is given of the odd one has the same digits.
    """
    drawn = urdf_generator.draw_urdf(29, number)
    path = tmp_path / f"{drawn.name}.urdf"
    path.write_bytes(drawn.odd)
    assert odd_urdfs.problem_of(drawn, path) is None, drawn.oddities
    assert capfd.readouterr().err == ""  # the parsers had nothing to say


def test_a_written_variant_of_an_odd_file_is_read_by_other_parsers(tmp_path):
    """It keeps comments and what is other tools'; what is not well-formed in it is mended."""
    for number in range(0, 60, 7):
        drawn = urdf_generator.draw_urdf(29, number)
        path = tmp_path / f"{drawn.name}.urdf"
        path.write_bytes(drawn.odd)
        (written,) = Urdf.load(path).variant(links={"link0": LinkChange(mass=2.0)}).write(tmp_path / "v.urdf")
        again = Urdf.load(written)
        assert again.link("link0").inertial.mass == 2.0
        text = written.read_text(encoding="utf-8")
        assert ("<gazebo" in text) == ("gazebo" in drawn.oddities)
        assert ("note" in text) == ("comments" in drawn.oddities)


def test_what_is_passed_over_is_counted_and_placed():
    text = pair(
        '<joint name="j" type="fixed">{}<axis xyz="0 0 0"/></joint>',
        BODY + "<visual><geometry><capsule/></geometry></visual><visual><geometry><sphere radius='1'/>"
        "</geometry><material name=''><color rgba='1 0 0'/></material></visual>",
        "<gazebo><material>Gazebo/Black</material></gazebo>\n<gazebo/>\n<sensor/>",
    )
    written = WrittenUrdf(text=text, where="u.urdf")
    assert dict(written.passed_over) == {
        "<axis> of a fixed joint": (4,),
        "<color> of three numbers": (3,),
        "<gazebo>": (5, 6),
        "<material> without a name": (3,),
        "<sensor>": (7,),
        "<visual> that cannot be drawn": (3,),
    }
    assert written.said_of_passed_over() == (
        "u.urdf: passed over 7 things that mean nothing to the mechanics (2 <gazebo>, 1 <axis> of a fixed "
        "joint, 1 <color> of three numbers, 1 <material> without a name and 2 kinds more); "
        "`antenna-pin urdf FILE --check` lists them"
    )
    urdf = written.variant()
    assert urdf.undrawn == (("b", "a shape of <capsule>"),)
    assert urdf.link("b").visuals[0].material.color.rgba.tolist() == [1.0, 0.0, 0.0, 1.0]
    plain = WrittenUrdf(text=pair('<joint name="j" type="fixed">{}</joint>'), where="u.urdf")
    assert plain.passed_over == () and plain.said_of_passed_over() is None


def test_odd_files_are_told(tmp_path):
    """A file without a name bears its own; xacro says what to run; mass comes first."""
    path = tmp_path / "arm.urdf"
    path.write_text(pair('<joint name="j" type="continuous">{}</joint>').replace(' name="pair"', ""))
    assert Urdf.load(path).name == "arm"
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(pair(REVOLUTE.format("")))
    with pytest.raises(
        MechanismError, match=re.escape("arm.urdf.xacro: a xacro file is not URDF yet; expand it")
    ):
        Urdf.load(path)
    for inertial in (BODY.replace('<mass value="1"/>', ""), '<inertial><density value="1"/></inertial>'):
        with pytest.raises(MechanismError, match="link 'b': <inertial> must have a <mass>, got none"):
            Urdf.from_text(pair(REVOLUTE.format(""), inertial), "u.urdf")


REVOLUTE = '<joint name="j" type="revolute">{{}}{}</joint>'


@pytest.mark.parametrize(
    ("limit", "bounds"),
    [
        ("", None),
        ('<limit effort="1" velocity="2"/>', None),
        ('<limit lower="0" upper="0" effort="0" velocity="0"/>', None),
        ('<limit lower="-inf" upper="inf" effort="1" velocity="1"/>', None),
        ('<limit lower="1" upper="-1" effort="1" velocity="1"/>', None),
        ('<limit upper="1" effort="1" velocity="1"/>', (0.0, 1.0)),
        ('<limit lower="-1" upper="2"/>', (-1.0, 2.0)),
        ('<limit lower="-1" upper="inf" effort="much" velocity="-2"/>', (-1.0, np.inf)),
    ],
)
def test_bounds_are_those_that_leave_a_way(limit, bounds):
    """URDF takes one bound that is missing for 0; none, or none between which a joint can move, are none."""
    urdf = Urdf.from_text(pair(REVOLUTE.format(limit)), "u.urdf")
    assert urdf.unbounded == (("j",) if bounds is None else ())
    read = urdf.joint("j").limit
    assert bounds == (None if read is None or read.lower is None else (read.lower, read.upper))
    assert build_mechanism(urdf, "fixed").model.nv == 1


POINT = '<inertial><origin xyz="0 0.3 0"/><mass value="2"/></inertial>'
ZEROS = '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial>'


def test_a_mass_without_moments_is_a_point_and_said():
    """The format takes moments that are left out for zero; Pinocchio's parser drops the mass too."""
    text = pair(REVOLUTE.format(""), POINT)
    alone = Urdf.from_text(text, "u.urdf")
    whole = Urdf.from_text(pair(REVOLUTE.format(""), POINT.replace("</inertial>", ZEROS)), "u.urdf")
    assert (alone.points, whole.points) == (("b",), ())
    assert alone.points == WrittenUrdf(text=text, where="u.urdf").variant().points
    for base in ("free", "fixed"):
        first, second = (build_mechanism(one, base) for one in (alone, whole))
        assert first.model == second.model and first.model.inertias[-1].mass == 2.0
    assert alone.variant(links={"b": LinkChange(inertia=(1.0, 1.0, 1.0))}).points == ()
    on_axis = Urdf.from_text(text.replace('xyz="0 0.3 0"', 'xyz="0.3 0 0"'), "u.urdf")
    with pytest.raises(MechanismError, match="can turn link 'b' without any inertia: it has 2 kg"):
        build_mechanism(on_axis, "fixed")


@pytest.mark.parametrize("nothing", ["<inertial/>", "<inertial><origin/></inertial>", f"<inertial>{ZEROS}"])
def test_an_inertial_of_nothing_is_a_frame(nothing):
    frame = f'<link name="f">{nothing}</link>'
    weld = '<joint name="w" type="fixed"><parent link="b"/><child link="f"/></joint>'
    written = WrittenUrdf(text=pair(REVOLUTE.format(""), more=frame + weld), where="u.urdf")
    assert [kind.what for kind in written.passed_over] == ["<inertial> of zeros"]
    assert (written.variant().link("f").inertial, written.variant().points) == (None, ())


MENDED = {
    "inertia given": (
        pair(REVOLUTE.format(""), '<inertial><mass value="much"/><inertia ixx="1"/></inertial>'),
        {"links": {"b": LinkChange(mass=1.0, inertia=(1.0, 1.0, 1.0))}},
    ),
    "axis given": (
        pair(REVOLUTE.format('<axis xyz="0 0 0"/>')),
        {"origins": {"j": JointChange(axis=(0.0, 1.0, 0.0))}},
    ),
    "locked, of no axis": (pair(REVOLUTE.format('<axis xyz="x"/>')), {"joints": {"j": "locked"}}),
    "locked, of an unknown type": (
        pair('<joint name="j" type="screw">{}</joint>'),
        {"joints": {"j": "locked"}},
    ),
    "locked, a gear": (
        pair(REVOLUTE.format('<mimic joint="k" multiplier="2"/>')),
        {"joints": {"j": "locked"}},
    ),
    "bounds given": (
        pair(REVOLUTE.format('<limit lower="low" upper="1" effort="1" velocity="1"/>')),
        {"origins": {"j": JointChange(lower=-0.5, upper=0.5)}},
    ),
    "place given": (
        pair(REVOLUTE.format('<origin xyz="here" rpy="0 0 0"/>')),
        {"origins": {"j": JointChange(origin_xyz=(0.0, 0.0, 1.0))}},
    ),
}


@pytest.mark.parametrize(("text", "changes"), MENDED.values(), ids=MENDED.keys())
def test_a_changed_mechanism_is_judged_not_the_file(text, changes):
    if "<mimic" not in text:
        with pytest.raises(MechanismError):
            Urdf.from_text(text, "u.urdf")
    made = WrittenUrdf(text=text, where="u.urdf").variant(**changes)
    assert made.link("b").inertial.inertia.tolist() == np.eye(3).tolist()
    build_mechanism(made, "free")


def test_what_a_change_does_not_mend_is_refused_with_the_line_of_the_file():
    text = '<?xml version="1.0"?>\n' + pair(REVOLUTE.format('<axis xyz="0 0 0"/>'))
    written = WrittenUrdf(text=text, where="u.urdf")
    with pytest.raises(MechanismError, match="u.urdf, line 5: joint 'j': axis must be nonzero, got '0 0 0'"):
        written.variant(links={"a": LinkChange(mass=2.0)})
    with pytest.raises(UnknownNameError, match="joint 'k' is unknown; .*known: j"):
        written.variant(joints={"k": "locked"})


def test_bounds_are_changed_and_those_that_are_none_refused():
    urdf = Urdf.from_text(pair(REVOLUTE.format('<limit effort="1" velocity="2"/>')), "u.urdf")
    made = urdf.variant(origins={"j": JointChange(lower=-1.0, upper=2.0)})
    limit = made.joint("j").limit
    assert (limit.lower, limit.upper, limit.effort, made.unbounded) == (-1.0, 2.0, 1.0, ())
    assert made.variant(origins={"j": JointChange(upper=3.0)}).joint("j").limit.upper == 3.0
    for change, says in (
        (JointChange(lower=0.0), "has no other bound: lower and upper must be given together"),
        (JointChange(lower=1.0, upper=1.0), "lower must be below upper, got 1 and 1"),
    ):
        with pytest.raises(MechanismError, match=says):
            urdf.variant(origins={"j": change})
    turning = Urdf.from_text(pair('<joint name="j" type="continuous">{}</joint>'), "u.urdf")
    with pytest.raises(MechanismError, match="'j' is continuous and has no bounds to change"):
        turning.variant(origins={"j": JointChange(lower=-1.0, upper=1.0)})


def test_meshes_of_packages_are_found(tmp_path, monkeypatch):
    """Below given folders, those of ROS_PACKAGE_PATH, and where the URDF is in its package."""
    for root in ("given", "listed", "above"):
        mesh = tmp_path / root / "arm" / "meshes" / "part.stl"
        mesh.parent.mkdir(parents=True)
        mesh.write_text(f"solid {root}")
    inside = tmp_path / "above" / "arm" / "urdf"
    inside.mkdir()
    mesh = "<visual><geometry><mesh filename='package://arm/meshes/part.stl'/></geometry></visual>"
    text = pair(REVOLUTE.format(""), BODY + mesh)

    def found(**options):
        return Urdf.from_text(text, "u.urdf", **options).mesh_file("package://arm/meshes/part.stl")

    assert found(folder=tmp_path) is None
    assert found(folder=inside) == tmp_path / "above/arm/meshes/part.stl"
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{tmp_path / 'listed'}")
    assert found(folder=inside) == tmp_path / "listed/arm/meshes/part.stl"
    for root in ("given", "given/arm"):
        options = {"folder": inside, "package_path": [tmp_path / root]}
        assert found(**options) == tmp_path / "given/arm/meshes/part.stl"
    (tmp_path / "target").mkdir()
    urdf = Urdf.from_text(text, "u.urdf", **options)
    assert len(urdf.write(tmp_path / "target" / "u.urdf", copy_meshes=True)) == 2
    assert (tmp_path / "target/arm/meshes/part.stl").read_text() == "solid given"


@pytest.mark.parametrize("number", range(0, 120, 6))
def test_hands_load_and_move_from_their_zero_pose(number):
    """But for those that are no mechanism: 97.5 % of what Pinocchio loads."""
    drawn = hand_generator.draw_hand(7, number)
    problem = odd_urdfs.problem_of_hand(drawn)
    assert drawn.moves == (problem is None), problem
    if not drawn.moves:
        assert "'dead" in problem


@pytest.mark.parametrize("none", ["1e16", "1.7976931348623157e308", "1e30", "inf"])
def test_bounds_that_programs_write_for_none_are_none(none):
    text = pair(f'<joint name="j" type="prismatic">{{}}<limit lower="-{none}" upper="{none}"/></joint>')
    urdf = Urdf.from_text(text, "r.urdf")
    assert urdf.unbounded == ("j",)
    half = Urdf.from_text(text.replace(f'lower="-{none}"', 'lower="-2"'), "r.urdf")
    assert half.unbounded == ()
    assert (half.joint("j").limit.lower, half.joint("j").limit.upper) == (-2.0, np.inf)


def test_bounds_of_continuous_joints_are_said():
    text = pair('<joint name="j" type="continuous">{}<limit lower="-0.5" upper="0.5"/></joint>')
    assert Urdf.from_text(text, "r.urdf").unlimited == (("j", "-0.5 to 0.5 rad"),)
    assert Urdf.from_text(text.replace("0.5", "0"), "r.urdf").unlimited == ()
