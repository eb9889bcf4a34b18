"""What a URDF must be to be a mechanism, and what a variant of it keeps."""

import copy
import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy
from lxml import etree

from antenna_pin.errors import AntennaPinError, MechanismError, OutputError, UnknownNameError
from antenna_pin.mechanism import JointChange, LinkChange, ShapeChange, Urdf, WrittenUrdf, build_mechanism

BODY = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def pair(joint, child=BODY):
    """Two links, a and b, and what is between them."""
    return (
        f'<robot name="pair">\n<link name="a">{BODY}</link>\n<link name="b">{child}</link>\n{joint}\n</robot>'
    )


def hinge(inside="", kind="continuous", name="j"):
    return f'<joint name="{name}" type="{kind}"><parent link="a"/><child link="b"/>{inside}</joint>'


def body(mass="1", moments=("1", "1", "1"), products=("0", "0", "0")):
    values = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), (*moments, *products), strict=True)
    inertia = " ".join(f'{key}="{value}"' for key, value in values)
    return f'<inertial><mass value="{mass}"/><inertia {inertia}/></inertial>'


REFUSED = {
    "not XML": (
        "<robot name='x'><link name='a'></robot>",
        "u.urdf, line 1: not well-formed XML: Opening and ending tag mismatch: link",
    ),
    "SDF": (
        "<sdf version='1.6'/>",
        "u.urdf, line 1: the root of a URDF must be <robot>, got <sdf>: this is SDF, Gazebo's format",
    ),
    "MJCF": (
        "<mujoco model='x'/>",
        "u.urdf, line 1: the root of a URDF must be <robot>, got <mujoco>: this is MJCF, MuJoCo's",
    ),
    "SRDF": (
        "<robot name='x'><group name='arm'/></robot>",
        "u.urdf, line 1: a mechanism must have at least one <link>, got none: this is an SRDF of MoveIt",
    ),
    "xacro": (
        '<robot name="x" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arm/></robot>',
        "u.urdf, line 1: <arm> is a xacro macro, not URDF; expand it first",
    ),
    "xacro in a link": (
        pair(hinge())
        .replace("<robot", "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'")
        .replace("<inertial>", "<xacro:mass/><inertial>", 1),
        "u.urdf, line 2: link 'a': <mass> is a xacro macro, not URDF; expand it first: xacro",
    ),
    "an expression of xacro": (
        pair(hinge('<origin xyz="0 0 ${pi/2}"/>')),
        "u.urdf, line 4: joint 'j': '0 0 ${pi/2}' is an expression of xacro, not URDF; expand it first",
    ),
    "a file to be included": (
        pair(hinge() + '<include filename="arm.urdf"/>'),
        "u.urdf, line 4: <include> is a xacro macro, not URDF; expand it first",
    ),
    "nameless link": ("<robot name='x'><link/></robot>", "u.urdf, line 1: <link> must have a name, got none"),
    "repeated link": (
        pair(hinge()).replace('name="b"', 'name="a"'),
        "u.urdf, line 3: link name 'a' must be unique, first used in line 2; rename one",
    ),
    "repeated joint": (
        pair(hinge() + "\n" + hinge()),
        "u.urdf, line 5: joint name 'j' must be unique, first used in line 4; rename one",
    ),
    "Pinocchio's name": (
        pair(hinge(name="root_joint")),
        "u.urdf, line 4: joint name 'root_joint' is Pinocchio's own; rename it",
    ),
    "unknown parent": (
        pair(hinge()).replace('parent link="a"', 'parent link="base"'),
        "u.urdf: parent of joint 'j': link 'base' is unknown; known: a, b",
    ),
    "two parents": (
        pair(hinge() + hinge(name="k")),
        "u.urdf: link 'b' must be the child of one joint, got 'j' and 'k'; a URDF is a tree, cut the loop",
    ),
    "two roots": (pair(""), "u.urdf: exactly one link must be nobody's child, got a, b; join them by joints"),
    "loop": (
        pair(hinge() + '<joint name="k" type="continuous"><parent link="b"/><child link="a"/></joint>'),
        "u.urdf: links a, b hang in a loop of joints that no root carries; a URDF is a tree, cut the loop",
    ),
    "unknown type": (
        pair(hinge(kind="revolut")),
        "u.urdf, line 4: joint 'j': type must be one of continuous, fixed, floating, planar, prismatic, "
        "revolute, "
        "got 'revolut'; did you mean revolute?",
    ),
    "mimic": (
        pair(hinge('<mimic multiplier="2"/>')),
        "u.urdf, line 4: joint 'j': <mimic> must have a joint, got none",
    ),
    "negative mass": (pair(hinge(), body("-2")), "u.urdf: link 'b': mass must be zero or more, got -2 kg"),
    # Left alone, yourdfpy would take a missing moment as 1 kg m^2.
    "moment left out": (
        pair(hinge(), BODY.replace('iyy="1"', "")),
        "u.urdf, line 3: link 'b': <inertia> iyy must be 1 finite number(s), got none",
    ),
    "two inertials": (
        pair(hinge(), BODY + BODY),
        "u.urdf, line 3: link 'b': <link> must have one <inertial>, got 2, the first in line 3; "
        "remove the others",
    ),
}


@pytest.mark.parametrize(("text", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_is_not_a_mechanism_is_refused_in_one_line(text, message):
    with pytest.raises((MechanismError, UnknownNameError)) as caught:
        Urdf.from_text(text, "u.urdf")
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_nothing_damaged_reaches_pinocchios_parser(crooked_text, capfd):
    """Each element and attribute in turn left out, doubled or spoilt: refused in one line, or harmless.

    Pinocchio's parser prints an error, takes zero for what it could not read and goes on; so it must have
    nothing to print.
    """
    whole = etree.fromstring(crooked_text.encode())
    elements = [element for element in whole.iter(etree.Element) if element is not whole]
    refused = 0
    for index, element in enumerate(elements):
        damages = [lambda e: e.getparent().remove(e), lambda e: e.addnext(copy.deepcopy(e))]
        for key in element.attrib:
            damages.append(lambda e, key=key: e.attrib.pop(key))
            damages += [
                lambda e, key=key, bad=bad: e.set(key, bad) for bad in ("", "-1", "1 2", "1_0", "1e999")
            ]
        for damage in damages:
            root = copy.deepcopy(whole)
            damage([e for e in root.iter(etree.Element) if e is not root][index])
            try:
                build_mechanism(Urdf.from_text(etree.tostring(root, encoding="unicode"), "u.urdf"))
            except AntennaPinError as error:
                assert "\n" not in str(error) and "Pinocchio" not in str(error)
                refused += 1
    assert refused > 300  # the rest changes a name or leaves out what is optional
    assert capfd.readouterr().err == ""


def test_an_inertia_that_no_body_has_is_said_and_may_be_allowed_by_name():
    """The moments of any body are sums of squares: I_1 + I_2 - I_3 = 2 integral of x_3^2 dm >= 0."""
    text = pair(hinge(), body("1000", ("1000", "100", "100")))  # You et al. 2010, spacecraft body
    assert build_mechanism(Urdf.from_text(text, "you2010.urdf")).impossible == (
        "link 'b': the largest principal moment of inertia exceeds the sum of the other two: "
        "100, 100, 1000 kg m^2, by 800",
    )
    allowed = Urdf.from_text(text, "you2010.urdf", allow_impossible_inertia=("b",))
    assert allowed.variant(joints={"j": "free"}).allow_impossible_inertia == ("b",)
    assert build_mechanism(allowed).impossible == ()
    (said,) = build_mechanism(allowed.variant(links={"a": LinkChange(inertia=(3.0, 1.0, 1.0))})).impossible
    assert said.startswith("link 'a': the largest principal moment")
    with pytest.raises(
        UnknownNameError, match="allow_impossible_inertia: link 'c' is unknown; .*known: a, b"
    ):
        Urdf.from_text(text, "you2010.urdf", allow_impossible_inertia=("c",))
    for moments, products in ((("-1", "1", "1"), ("0", "0", "0")), (("1", "1", "1"), ("2", "0", "0"))):
        odd = Urdf.from_text(pair(hinge(), body(moments=moments, products=products)), "u.urdf")
        with pytest.raises(
            MechanismError, match="link 'b': a negative principal moment of inertia: -1, 1, [13] kg"
        ):
            build_mechanism(odd, "free")


def test_names_and_axes_of_a_urdf(crooked):
    """The nearest name is offered; an axis is a direction alone, and x where nothing is said."""
    assert crooked.joint("wrist").child == "hand"
    assert crooked.link("tip").inertial.mass == 0.4
    assert (crooked.name, crooked.root) == ("crooked", "hull")
    with pytest.raises(UnknownNameError, match="crooked.urdf: joint 'wirst' is unknown; did you mean wrist?"):
        crooked.joint("wirst")
    with pytest.raises(UnknownNameError, match="crooked.urdf: link 'wrist' is unknown"):
        crooked.link("wrist")
    assert crooked.axis("swivel") == pytest.approx([1 / 3, 2 / 3, -2 / 3], rel=1e-15)
    assert Urdf.from_text(pair(hinge()), "u.urdf").axis("j").tolist() == [1.0, 0.0, 0.0]
    text = '<robot name="r"><link name="a"/></robot>'
    for names in (["a"], np.array(["a"]), ("a",)):
        urdf = Urdf(text=text, where="r.urdf", allow_impossible_inertia=names)
        assert urdf.allow_impossible_inertia == ("a",)


@pytest.mark.parametrize(
    ("broken", "said", "change"),
    [
        ('<dynamics damping="0,5"/>', "<dynamics> damping='0,5'", JointChange(damping=0.5)),
        ('<dynamics friction="1 2"/>', "<dynamics> friction='1 2'", JointChange(friction=0.5)),
        ('<axis xyz="0 0 x"/>', "<axis> xyz='0 0 x'", JointChange(axis=(0.0, 0.0, 1.0))),
        ('<origin xyz="0 nan 0"/>', "<origin> xyz='0 nan 0'", JointChange(origin_xyz=(0.0, 0.0, 1.0))),
    ],
)
def test_a_broken_number_that_is_given_elsewhere_is_said(broken, said, change):
    """It does not act, and so is not refused; the file is as wrong as before."""
    text = pair(hinge(broken))
    with pytest.raises(MechanismError, match=re.escape(said.partition("=")[0])):
        Urdf.from_text(text, "u.urdf")
    written = WrittenUrdf(text=text, where="u.urdf")
    written.variant(origins={"j": change})  # is accepted
    (line,) = written.not_simulated
    assert re.match(rf"u\.urdf, line \d+: joint 'j': {re.escape(said)} is no number and does not count", line)
    sound = pair(hinge('<limit effort="inf" velocity="1"/>'))
    assert WrittenUrdf(text=sound, where="u.urdf").not_simulated == ()


def test_friction_of_joints_is_read_and_what_has_no_axis_is_said(crooked):
    assert crooked.joint_friction == {} and crooked.not_simulated == ()
    damped = Urdf.from_text(pair(hinge('<dynamics damping="0.5" friction="0"/>')), "u.urdf")
    assert damped.joint_friction == {"j": {"damping": 0.5}} and damped.not_simulated == ()
    changed = damped.variant(origins={"j": JointChange(friction=0.25)})
    assert changed.joint_friction == {"j": {"damping": 0.5, "friction": 0.25}}
    text = pair(hinge('<dynamics damping="0.5" friction="0"/>')).replace('"continuous"', '"floating"')
    free = Urdf.from_text(text, "u.urdf")
    (line,) = free.not_simulated
    assert line.startswith("u.urdf: joint 'j': <dynamics> damping=0.5 is not simulated, for the joint is flo")
    with pytest.raises(MechanismError, match="'j' is floating and has no axis for damping"):
        free.variant(origins={"j": JointChange(damping=0.1)})
    with pytest.raises(MechanismError, match=r"u\.urdf, line \d+.*<dynamics> damping must be zero or more"):
        Urdf.from_text(pair(hinge('<dynamics damping="-1"/>')), "u.urdf")


def test_files_that_cannot_be_read_or_written(tmp_path, crooked, antenna):
    """One line, and nothing is left in the folder."""
    with pytest.raises(MechanismError, match=r"missing\.urdf: cannot be read: No such file or directory"):
        Urdf.load(tmp_path / "missing.urdf")
    with pytest.raises(MechanismError, match="cannot be read: Is a directory"):
        Urdf.load(tmp_path)
    target = tmp_path / "nowhere" / "u.urdf"
    with pytest.raises(
        OutputError, match=rf"{re.escape(str(target))}: cannot be written: No such file or directory"
    ):
        crooked.write(target)
    with pytest.raises(OutputError, match="cannot be written: Is a directory"):
        crooked.write(tmp_path)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(OutputError, match="cannot be written: No such file or directory"):
        antenna.write(tmp_path / "nowhere" / "u.urdf", copy_meshes=True)
    assert list(tmp_path.iterdir()) == []


def test_a_file_is_read_in_the_encoding_that_it_declares(tmp_path):
    text = '<?xml version="1.0" encoding="ISO-8859-1"?>' + pair(hinge(name="größe"))
    (tmp_path / "u.urdf").write_bytes(text.encode("latin-1"))
    read = Urdf.load(tmp_path / "u.urdf")
    assert read.joint("größe").child == "b"
    read.write(tmp_path / "again.urdf")
    assert Urdf.load(tmp_path / "again.urdf").joint("größe").child == "b"
    assert Urdf.from_text(text, "u.urdf").text == read.text


# --- variants ---


def test_a_variant_leaves_its_source_as_it_was(crooked):
    """What else stands in the file stays there."""
    before = crooked.text
    crooked.variant(
        joints={"wrist": "planar", "swivel": "free", "slide": "locked"},
        links={"arm": LinkChange(mass=9.0)},
        origins={"wrist": JointChange(origin_xyz=(1.0, 0.0, 0.0))},
    )
    assert crooked.text == before
    assert crooked.variant().text == before
    variant = crooked.variant(joints={"swivel": "planar", "wrist": "free"})
    assert "<!-- the hull -->" in variant.text
    assert "<!-- weighed -->" in variant.text
    assert '<gazebo reference="hull"><kept_for_other_tools/></gazebo>' in variant.text


def test_a_changed_number_loses_its_source_and_says_what_it_was(crooked):
    """Or a file would claim that an override comes from where the number before it came from."""
    variant = crooked.variant(
        links={"hull": LinkChange(mass=60)},
        origins={"swivel": JointChange(axis=(0, 0, 1), origin_xyz=(0, 0, 1))},
    )
    assert "weighed" not in variant.text and "drawn" not in variant.text
    assert '<mass value="60.0"/> <!-- antenna_pin: was value="50" -->' in variant.text
    assert '<axis xyz="0.0 0.0 1.0"/> <!-- antenna_pin: was xyz="1 2 -2" -->' in variant.text


def test_overrides_change_what_they_name_and_nothing_else(crooked):
    variant = crooked.variant(
        links={
            "arm": LinkChange(
                mass=4.0,
                inertia=(0.3, 0.4, 0.5),
                centre_of_mass=(0.1, 0.2, 0.3),
                shapes={"rod": ShapeChange(radius=0.03), "case": ShapeChange(size=(1.0, 2.0, 3.0))},
            ),
            "tip": LinkChange(inertia=(0.004, 0.005, 0.006, 1e-4, 2e-4, 3e-4)),
        },
        origins={"wrist": JointChange(origin_rpy=(0.1, 0.2, 0.3), axis=(0.0, 2.0, 0.0))},
    )
    arm, before = variant.link("arm"), crooked.link("arm")
    assert (arm.inertial.mass, np.diag(arm.inertial.inertia).tolist()) == (4.0, [0.3, 0.4, 0.5])
    assert np.array_equal(arm.inertial.inertia, np.diag([0.3, 0.4, 0.5]))  # three numbers: no products
    assert arm.inertial.origin[:3, 3].tolist() == [0.1, 0.2, 0.3]
    assert np.array_equal(arm.inertial.origin[:3, :3], before.inertial.origin[:3, :3])
    rods = [shape.geometry.cylinder for shape in (*arm.visuals, *arm.collisions) if shape.name == "rod"]
    assert [(rod.radius, rod.length) for rod in rods] == [(0.03, 0.6)] * 2
    assert arm.visuals[1].geometry.box.size.tolist() == [1.0, 2.0, 3.0]
    assert variant.link("tip").inertial.inertia.tolist() == [
        [0.004, 1e-4, 2e-4],
        [1e-4, 0.005, 3e-4],
        [2e-4, 3e-4, 0.006],
    ]
    assert variant.axis("wrist").tolist() == [0.0, 1.0, 0.0]
    assert variant.placement("wrist")[:3, 3].tolist() == [0.0, 0.6, 0.0]
    untouched = ("hull", "hand", "camera", "weight")
    for name in untouched:
        one, other = variant.link(name), crooked.link(name)
        assert (repr(one), one.visuals, one.collisions) == (repr(other), other.visuals, other.collisions)
    assert all(repr(variant.joint(name)) == repr(crooked.joint(name)) for name in ("swivel", "weld", "slide"))


def test_an_override_may_give_a_frame_its_inertial(crooked):
    variant = crooked.variant(links={"camera": LinkChange(mass=0.2, inertia=(1e-4, 1e-4, 1e-4))})
    assert variant.link("camera").inertial.mass == 0.2
    with pytest.raises(
        MechanismError, match="link 'camera' has no <inertial>: an override must give both mass and inertia"
    ):
        crooked.variant(links={"camera": LinkChange(mass=0.2)})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"joints": {"wirst": "free"}}, "crooked.urdf: joint 'wirst' is unknown; did you mean wrist?"),
        (
            {"joints": {"wrist": "fre"}},
            "crooked.urdf: joint 'wrist': kind 'fre' is unknown; did you mean free?",
        ),
        (
            {"joints": {"slide": "planar"}},
            "crooked.urdf: joint 'slide' is prismatic; only a revolute or continuous joint can become planar",
        ),
        (
            {"links": {"arms": LinkChange(mass=1.0)}},
            "crooked.urdf: link 'arms' is unknown; did you mean arm?",
        ),
        (
            {"links": {"arm": LinkChange(shapes={"rd": ShapeChange(radius=1.0)})}},
            "crooked.urdf: link 'arm': shape 'rd' is unknown; did you mean rod? known: case, rod",
        ),
        (
            {"links": {"arm": LinkChange(shapes={"case": ShapeChange(radius=1.0)})}},
            "crooked.urdf: link 'arm': shape 'case': a box has no radius to change; it has size",
        ),
        (
            {"origins": {"weld": JointChange(axis=(1, 0, 0))}},
            "crooked.urdf: joint 'weld' is fixed and has no axis to change",
        ),
    ],
)
def test_changes_that_make_no_sense_are_refused(crooked, change, message):
    with pytest.raises((MechanismError, UnknownNameError)) as caught:
        crooked.variant(**change)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_a_free_joint_has_no_ideal_form_to_go_back_to(crooked):
    for kind, urdf_type in (("free", "floating"), ("planar", "planar")):
        variant = crooked.variant(joints={"wrist": kind})
        with pytest.raises(MechanismError, match=f"joint 'wrist' is {urdf_type} and has no ideal form"):
            variant.variant(joints={"wrist": "ideal"})
        with pytest.raises(
            MechanismError, match=f"joint 'wrist' is {urdf_type}; only a revolute, continuous or prismatic"
        ):
            variant.variant(joints={"wrist": "free"})


def test_names_that_a_planar_joint_needs_must_not_be_taken(crooked_text):
    taken = Urdf.from_text(crooked_text.replace('"camera"', '"wrist_plane"'), "crooked.urdf")
    with pytest.raises(
        MechanismError, match="link name 'wrist_plane' is needed to make a joint planar; rename yours"
    ):
        taken.variant(joints={"wrist": "planar"})


# --- files ---


def test_a_written_variant_reads_back_as_itself(crooked, tmp_path):
    variant = crooked.variant(
        joints={"wrist": "planar", "swivel": "free"}, links={"arm": LinkChange(mass=0.1 + 0.2)}
    )
    variant.write(tmp_path / "variant.urdf")
    assert Urdf.load(tmp_path / "variant.urdf").text == variant.text
    assert [path.name for path in tmp_path.iterdir()] == ["variant.urdf"]


def drawn(path):
    """Names of the shapes that yourdfpy and Pinocchio draw; the latter is told where relative names start."""
    model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    shapes = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.VISUAL, package_dirs=[str(path.parent)])
    return set(yourdfpy.URDF.load(str(path)).scene.geometry), {s.name for s in shapes.geometryObjects}


def mesh_names(path):
    return re.findall(r'<mesh filename="(.*?)"', path.read_text())


def test_a_variant_written_elsewhere_still_finds_its_meshes(antenna, tmp_path):
    """By a relative path."""
    path = tmp_path / "antenna_clearance.urdf"
    assert antenna.variant(joints={"elevation": "free"}).write(path) == (path,)
    for name in mesh_names(path):
        assert not Path(name).is_absolute()
        assert (tmp_path / name).resolve() == (antenna.folder / "dish.obj").resolve()
    scene, shapes = drawn(path)
    assert "dish" in scene and "reflector_0" in shapes
    assert 'filename="dish.obj"' in antenna.to_xml()


def test_a_written_file_read_again_finds_the_same_meshes(antenna, tmp_path):
    """Also by way of a symbolic link, from whose target '..' leads."""
    (tmp_path / "deep" / "er").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "deep" / "er")
    antenna.write(tmp_path / "link" / "a.urdf")
    assert (tmp_path / "link" / mesh_names(tmp_path / "link" / "a.urdf")[0]).is_file()
    Urdf.load(tmp_path / "link" / "a.urdf").write(tmp_path / "b.urdf")
    assert (tmp_path / mesh_names(tmp_path / "b.urdf")[0]).samefile(antenna.folder / "dish.obj")


def test_meshes_are_copied_beside_the_file_once(antenna, tmp_path):
    path = tmp_path / "a.urdf"
    assert antenna.write(path, copy_meshes=True) == (path, tmp_path / "dish.obj")
    assert (tmp_path / "dish.obj").read_bytes() == (antenna.folder / "dish.obj").read_bytes()
    assert set(mesh_names(path)) == {"dish.obj"}
    assert "dish" in drawn(path)[0]
    assert sorted(found.name for found in tmp_path.iterdir()) == ["a.urdf", "dish.obj"]
    # The second time there is nothing to copy.
    assert antenna.write(path, copy_meshes=True) == (path,)


MESH = '<visual><geometry><mesh filename="{}"/></geometry></visual>'


def with_meshes(folder, *filenames):
    """A pair of links with these meshes on top of the tree."""
    shapes = "".join(MESH.format(filename) for filename in filenames)
    text = pair(hinge())
    assert "</link>" in text
    return Urdf.from_text(text.replace("</link>", f"{shapes}</link>", 1), "u.urdf", folder=folder)


def test_what_a_wavefront_mesh_names_is_copied_with_it(tmp_path):
    source, target = tmp_path / "source", tmp_path / "target"
    for file, text in {
        "meshes/part.obj": "mtllib part.mtl missing.mtl\nv 0 0 0\n",
        "meshes/part.mtl": "map_Kd -s 1 1 images/paint.png\nmap_Kd ../outside.png\nmap_Ks part.mtl\n",
        "meshes/images/paint.png": "image",
        "outside.png": "image",
    }.items():
        (source / file).parent.mkdir(parents=True, exist_ok=True)
        (source / file).write_text(text)
    target.mkdir()
    written = with_meshes(source, "meshes/part.obj").write(target / "u.urdf", copy_meshes=True)
    assert [path.relative_to(target).as_posix() for path in written] == [
        "u.urdf",
        "meshes/part.obj",
        "meshes/part.mtl",
        "meshes/images/paint.png",
    ]
    assert mesh_names(target / "u.urdf") == ["meshes/part.obj"]


def test_meshes_from_elsewhere_are_copied_under_their_last_name(tmp_path):
    """Names that are no files stay as they are."""
    for folder in ("models/own", "models/shared", "target"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "models/shared/part.stl").write_text("solid part")
    (tmp_path / "models/other.stl").write_text("solid other")
    urdf = with_meshes(tmp_path / "models/own", "../shared/part.stl", tmp_path / "models/other.stl")
    urdf.write(tmp_path / "target" / "u.urdf", copy_meshes=True)
    assert mesh_names(tmp_path / "target" / "u.urdf") == ["part.stl", "other.stl"]
    assert (tmp_path / "target" / "part.stl").read_text() == "solid part"
    names = ["package://robot/part.stl", "missing.stl"]
    with_meshes(tmp_path, *names).write(tmp_path / "target" / "u.urdf")
    assert mesh_names(tmp_path / "target" / "u.urdf") == names


def test_copies_that_cannot_be_right_are_refused_before_anything_is_written(tmp_path):
    for folder in ("one", "two", "target"):
        (tmp_path / folder).mkdir()
    (tmp_path / "one" / "part.stl").write_text("solid one")
    (tmp_path / "two" / "part.stl").write_text("solid two")
    target = tmp_path / "target"
    for names, error, says in (
        (["missing.stl"], MechanismError, r"u\.urdf: mesh 'missing\.stl' must be a file to be copied"),
        (["package://robot/part.stl"], MechanismError, "'package://robot/part.stl' must be a file"),
        (["part.stl", "../two/part.stl"], OutputError, "would both be copied here; rename one"),
    ):
        with pytest.raises(error, match=says):
            with_meshes(tmp_path / "one", *names).write(target / "u.urdf", copy_meshes=True)
        assert list(target.iterdir()) == []
    (target / "part.stl").write_text("somebody's own")
    with pytest.raises(OutputError, match=r"part\.stl: differs from .*whose copy goes there"):
        with_meshes(tmp_path / "one", "part.stl").write(target / "u.urdf", copy_meshes=True)
    assert (target / "part.stl").read_text() == "somebody's own"
    assert not (target / "u.urdf").exists()
    with pytest.raises(MechanismError, match="must be a file to be copied"):
        with_meshes(None, "part.stl").write(target / "u.urdf", copy_meshes=True)
