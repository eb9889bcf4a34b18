"""Names that are almost ones of the format are refused; those of other tools are passed over and listed."""

import re
import sys
from pathlib import Path

import pytest

from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import Urdf, WrittenUrdf

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "check"))
import urdf_generator
from robust import odd_urdfs

MOMENTS = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
URDF = f"""<robot name="pair">
<link name="a"/>
<link name="b"><inertial><origin xyz="0 0 1"/><mass value="1"/>{MOMENTS}</inertial>
<visual><origin xyz="0 0 1"/><geometry><box size="1 1 1"/></geometry><material name="m"/></visual></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 1" rpy="0 0 0"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/><dynamics damping="1" friction="1"/>
<mimic joint="k" multiplier="2"/></joint>
<link name="c"/><joint name="k" type="continuous"><parent link="a"/><child link="c"/></joint>
</robot>
"""


def changed(old, new):
    assert old in URDF
    return URDF.replace(old, new, 1)


# What is replaced, by what, and what is said.
SLIPS = [
    (
        '<origin xyz="0 0 1" rpy',
        '<origin xzy="0 0 1" rpy',
        "line 5: joint 'j': attribute xzy of <origin>",
        "xyz",
    ),
    ('<origin xyz="0 0 1" rpy', '<origin XYZ="0 0 1" rpy', "attribute XYZ of <origin>", "xyz"),
    (
        '<origin xyz="0 0 1" rpy',
        '<orgin xyz="0 0 1" rpy',
        "line 5: joint 'j': <orgin> in <joint>",
        "<origin>",
    ),
    (
        '<origin xyz="0 0 1"/><mass',
        '<orign xyz="0 0 1"/><mass',
        "link 'b': <orign> in <inertial>",
        "<origin>",
    ),
    ('<origin xyz="0 0 1"/><geo', '<Origin xyz="0 0 1"/><geo', "<Origin> in <visual>", "<origin>"),
    ("<axis ", "<axes ", "<axes> in <joint>", "<axis>"),
    ('<mass value="1"', '<mass vaule="1"', "attribute vaule of <mass>", "value"),
    ('<mass value="1"/>', '<mas value="1"/>', "<mas> in <inertial>", "<mass>"),
    ("<inertia ", "<Inertia ", "<Inertia> in <inertial>", "<inertia>"),
    ("<inertia ", "<inertial ", "<inertial> in <inertial>", "<inertia>"),
    ('ixy="0"', 'iyx="0"', "attribute iyx of <inertia>", "ixy"),
    ('ixy="0"', 'ixy="0" iyx="1"', "attribute iyx of <inertia>", "ixy"),
    ('<limit lower="-1"', '<limit low="-1"', "attribute low of <limit>", "lower"),
    ('<dynamics damping="1"', '<dynamics dampng="1"', "attribute dampng of <dynamics>", "damping"),
    ("<dynamics ", "<dynamic ", "<dynamic> in <joint>", "<dynamics>"),
    ('multiplier="2"', 'multiplyer="2"', "attribute multiplyer of <mimic>", "multiplier"),
    ("<mimic ", "<mimick ", "<mimick> in <joint>", "<mimic>"),
    ('<parent link="a"', '<parent lnik="a"', "attribute lnik of <parent>", "link"),
    ("<child ", "<chlid ", "<chlid> in <joint>", "<child>"),
    ("<geometry><box", "<geometry><bxo", "<bxo> in <geometry>", "<box>"),
    ("<geometry><box size", "<geometry><box sise", "attribute sise of <box>", "size"),
    ("<geometry><box", "<geometri/><geometry><box", "<geometri> in <visual>", "<geometry>"),
    ('<link name="a"/>', '<link nmae="a"/>', "attribute nmae of <link>", "name"),
    ('<link name="a"/>', '<lnik name="a"/>', "line 2: <lnik> in <robot>", "<link>"),
    # As an element what is an attribute, and the other way round.
    ("<axis ", "<axis><xyz>0 0 1</xyz></axis><axis ", "<xyz> in <axis>", "xyz"),
    ('type="revolute"', 'type="revolute" axis="0 0 1"', "attribute axis of <joint>", "<axis>"),
    ("<inertial>", '<inertial mass="3">', "attribute mass of <inertial>", "<mass>"),
]


@pytest.mark.parametrize(("old", "new", "place", "meant"), SLIPS, ids=[slip[1] for slip in SLIPS])
def test_a_slip_in_a_name_is_refused_in_one_line_that_names_both(old, new, place, meant):
    with pytest.raises(MechanismError) as caught:
        Urdf.from_text(changed(old, new), "u.urdf")
    said = str(caught.value)
    assert said.startswith("u.urdf, line") and "\n" not in said
    assert place in said and re.search(
        rf"is unknown; did you mean (the attribute )?{re.escape(meant)}\?$", said
    )


# Of exporters, simulators and older formats, at places where mechanics is read.
OTHERS = {
    "robot": "transmission gazebo sensor ros2_control mujoco loop_joint group plugin motor frame deformable "
    "constraint actuator",
    "link": "contact collision_checking self_collision_checking self_filter surface gravity kinematic sensor "
    "origin spatial",
    "inertial": "density fluid_added_mass",
    "joint": "calibration safety_controller hardwareInterface joint_properties transmission sensor gearbox "
    "axis2 limited physics",
    "visual": "meta highlight",
    "geometry": "capsule plane cdf ellipsoid cone",
    "origin": "quat_xyzw units",
    "inertia": "com",
    "axis": "rpy expressed_in",
    "limit": "acceleration jerk soft_lower_limit k_position k_velocity power gear_velocity "
    "current twist command_effort",
    "dynamics": "spring_stiffness spring_reference mu_coulomb mu_viscous D K stiffness armature frictionloss "
    "implicitSpringDamper",
    "mimic": "source",
    "mass": "unit",
}
ELEMENTS = ("robot", "link", "inertial", "joint", "visual", "geometry")


@pytest.mark.parametrize("tag", OTHERS)
def test_names_of_other_tools_are_passed_over_and_listed(tag):
    """Attributes and elements that real files hold, and one with a prefix that is almost one of ours."""
    names = OTHERS[tag].split()
    if tag in ELEMENTS:
        added = "".join(f"<{name}/>" for name in [*names, "drake:orgin"])
        text = (
            re.sub(rf"(<{tag}( [^>]*)?>)", rf"\1{added}", URDF, count=1)
            if tag != "link"
            else changed('<link name="b">', f'<link name="b">{added}')
        )
        kinds = {f"<{name}>" for name in [*names, "drake:orgin"]}
    else:
        added = "".join(f'{name}="5" ' for name in [*names, "drake:lowr"])
        text = changed(f"<{tag} ", f"<{tag} {added}")
        kinds = {f"<{tag} {name}>" for name in [*names, "drake:lowr"]}
    written = WrittenUrdf(text=text, where="u.urdf")
    assert {kind.what for kind in written.passed_over} == kinds
    made = written.variant()
    assert made.joint_friction == {"j": {"damping": 1.0, "friction": 1.0}}
    assert (made.simulated, made.undrawn) == (Urdf.from_text(URDF, "u.urdf").simulated, ())


def test_names_and_text_that_are_passed_over():
    """Slips in looks and in what other tools read are theirs; a moment may be given twice."""
    text = changed('<material name="m"/>', '<materal/><material name="m"><colour rgb="1 0 0"/></material>')
    text = text.replace("</robot>", "<gazebo><orgin/></gazebo></robot>")
    passed = {kind.what for kind in WrittenUrdf(text=text, where="u.urdf").passed_over}
    assert passed == {"<materal>", "<colour>", "<gazebo>"}
    Urdf.from_text(text, "u.urdf")
    text = changed('ixy="0"', 'ixy="0.10" iyx="0.1"')
    assert Urdf.from_text(text, "u.urdf").link("b").inertial.inertia[1, 0] == 0.1
    with pytest.raises(MechanismError) as caught:
        Urdf.from_text(changed('<axis xyz="0 1 0"/>', "<axis>0 1<!-- y --> 0</axis>"), "u.urdf")
    assert str(caught.value) == (
        "u.urdf, line 6: joint 'j': <axis> must hold no text, got '0 1  0'; write it as attributes (xyz)"
    )
    written = WrittenUrdf(text=changed("<inertial>", "<inertial>about 1 kg"), where="u.urdf")
    assert [kind.text() for kind in written.passed_over] == ["1 text in <inertial>, line 3"]


NUMBERS = (
    "1,0 0 0",
    "0 0",
    "0 0 0 0",
    "nan 0 0",
    "0 inf 0",
    "0x1 0 0",
    "1e400 0 0",
    "\u0661 0 0",
    "1_0 0 0",
    "",
    "a",
)


@pytest.mark.parametrize("number", NUMBERS)
def test_numbers_that_are_none_are_refused_in_one_line(number):
    """Three for a place or an axis; one elsewhere, for which the word of three that is none stands."""
    (first,) = [word for word in number.split() if word != "0"] or [number]
    for old in ('<origin xyz="0 0 1" rpy', '<origin xyz="0 0 1"/><mass', '<axis xyz="0 1 0"'):
        new = re.sub('xyz="[^"]*"', f'xyz="{number}"', old)
        with pytest.raises(MechanismError, match=r"^u\.urdf, line \d+: .* must be 3 finite number"):
            Urdf.from_text(changed(old, new), "u.urdf")
    for old in ('value="1"', 'ixx="1"', 'damping="1"', 'multiplier="2"', 'lower="-1"'):
        if old.startswith("lower") and first in ("inf", "1e400"):
            continue  # a bound may be infinite
        new = re.sub('"[^"]*"', f'"{first}"', old)
        with pytest.raises(MechanismError, match=r"^u\.urdf, line \d+: .* must be 1 finite number"):
            Urdf.from_text(changed(old, new), "u.urdf")
    undrawn = Urdf.from_text(changed('size="1 1 1"', f'size="{number}"'), "u.urdf").undrawn
    assert [link for link, _ in undrawn] == ["b"]


def test_random_slips_are_refused():
    """In turn of each element and attribute that is read, of one or two letters or in case."""
    for number in range(150):
        drawn = urdf_generator.draw_slip(17, number)
        assert odd_urdfs.problem_of_slip(drawn) is None, (drawn.written, drawn.meant)
