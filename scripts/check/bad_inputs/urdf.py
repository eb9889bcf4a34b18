"""Bad inputs: URDF files and the meshes they name."""

from __future__ import annotations

from collections.abc import Iterator

from bad_inputs.case import FILES, MECHANISM, Case, changed

_COMMAND = ("urdf", "scenario.toml", "--out", "out.urdf")

_KIND = "must be revolute or continuous"
_MASS = '<mass value="2"/>'
_INERTIA = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
_BOX = '<box size="0.1 0.1 0.4"/>'
_AXIS = '<axis xyz="0 1 0"/>'
_PARENT = '<parent link="stand"/>'
_CHILD = '<child link="bar"/>'
_ORIGIN = '<origin xyz="0 0 0" rpy="0 0 0"/>'
_LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
_JOINT = MECHANISM[MECHANISM.index("  <joint") : MECHANISM.index('  <link name="bar">')]

# What is wrong: what is replaced, by what, and what must be said.
_CHANGES: tuple[tuple[str, str, str, str], ...] = (
    ("unclosed tag", "</robot>", "", "not well-formed XML"),
    ("text behind the root", "</robot>", "</robot>x", "not well-formed XML"),
    ("an entity that is unknown", 'name="pair"', 'name="&pair;"', "not well-formed XML"),
    ("an attribute twice", _MASS, '<mass value="2" value="3"/>', "not well-formed XML"),
    ("another root", "<robot name", "<model name", "not well-formed XML"),
    ("blank name", '<link name="bar">', '<link name=" ">', "must have a name"),
    ("link without name", '<link name="bar">', "<link>", "must have a name"),
    ("link twice", '<link name="bar">', '<link name="stand">', "must be unique"),
    ("joint twice", "  <joint", _JOINT + "  <joint", "must be unique"),
    ("Pinocchio's own name of a link", '<link name="stand">', '<link name="universe">', "Pinocchio's own"),
    ("Pinocchio's own name of a joint", 'name="hinge"', 'name="root_joint"', "known: root_joint"),
    ("a link that is not there", _PARENT, '<parent link="stan"/>', "did you mean stand"),
    ("a child that is not there", _CHILD, '<child link="baz"/>', "baz"),
    ("a joint of a link to itself", _CHILD, '<child link="stand"/>', "link"),
    ("no parent", _PARENT, "", "must have a <parent>"),
    ("no child", _CHILD, "", "must have a <child>"),
    ("parent without link", _PARENT, "<parent/>", "must have a link"),
    ("a child of two joints", "  <joint", changed(_JOINT, "hinge", "other") + "  <joint", "child of one"),
    ("two roots", "</robot>", '<link name="x"/></robot>', "exactly one link must be nobody's child"),
    ("kind of joint unknown", 'type="revolute"', 'type="revolut"', _KIND),
    ("kind of joint in capitals", 'type="revolute"', 'type="Revolute"', _KIND),
    ("no kind of joint", ' type="revolute"', "", _KIND),
    ("axis of no length", _AXIS, '<axis xyz="0 0 0"/>', "axis must be nonzero"),
    ("axis of two", _AXIS, '<axis xyz="0 1"/>', "3 finite number"),
    ("axis without numbers", _AXIS, "<axis/>", "<axis> xyz"),
    ("axis infinite", _AXIS, '<axis xyz="0 inf 0"/>', "3 finite number"),
    ("axis with commas", _AXIS, '<axis xyz="0,1,0"/>', "3 finite number"),
    ("origin of four", _ORIGIN, '<origin xyz="0 0 0 0"/>', "<origin> xyz"),
    ("origin nan", _ORIGIN, '<origin xyz="nan 0 0"/>', "<origin> xyz"),
    ("origin rpy of two", _ORIGIN, '<origin rpy="0 0"/>', "<origin> rpy"),
    ("origin overflows", _ORIGIN, '<origin xyz="1e999 0 0"/>', "<origin> xyz"),
    ("mimic of nobody", _LIMIT, _LIMIT + '<mimic joint="hing"/>', "did you mean hinge"),
    ("mimic without a joint", _LIMIT, _LIMIT + "<mimic/>", "<mimic> must have a joint"),
    ("mimic with a comma", _LIMIT, _LIMIT + '<mimic joint="k" offset="1,5"/>', "<mimic> offset"),
    ("damping in words", _LIMIT, _LIMIT + '<dynamics damping="some"/>', "<dynamics> damping"),
    ("damping below zero", _LIMIT, _LIMIT + '<dynamics damping="-1"/>', "<dynamics> damping must be zero"),
    ("friction nan", _LIMIT, _LIMIT + '<dynamics friction="nan"/>', "<dynamics> friction"),
    ("two masses", _MASS, _MASS + '<mass value="3"/>', "one <mass>"),
    ("two inertias", _INERTIA, _INERTIA + _INERTIA, "one <inertia>"),
    ("two inertials", "<inertial>", f"<inertial>{_MASS}{_INERTIA}</inertial><inertial>", "one <inertial>"),
    ("two origins of a joint", _ORIGIN, _ORIGIN + _ORIGIN, "one <origin>"),
    ("two origins of an inertial", ' -0.2"/>', ' -0.2"/><origin/>', "one <origin>"),
    ("two axes", _AXIS, _AXIS + '<axis xyz="1 0 0"/>', "one <axis>"),
    ("two parents", _PARENT, _PARENT + '<parent link="bar"/>', "one <parent>"),
    ("two children", _CHILD, _CHILD + '<child link="stand"/>', "one <child>"),
    ("two dynamics", _LIMIT, _LIMIT + "<dynamics/><dynamics/>", "one <dynamics>"),
    ("two mimics", _LIMIT, _LIMIT + '<mimic joint="a"/><mimic joint="b"/>', "mimic"),
    ("no mass", _MASS, "", "must have a <mass>"),
    ("no mass but a density", _MASS + _INERTIA, '<density value="1"/>', "must have a <mass>"),
    ("mass without value", _MASS, "<mass/>", "<mass> value"),
    ("negative mass", _MASS, '<mass value="-2"/>', "mass must be zero or more"),
    ("mass nan", _MASS, '<mass value="nan"/>', "<mass> value"),
    ("mass with unit", _MASS, '<mass value="2 kg"/>', "<mass> value"),
    ("mass with underscore", _MASS, '<mass value="1_0"/>', "<mass> value"),
    ("mass in other digits", _MASS, '<mass value="\u0662"/>', "<mass> value"),
    ("mass of 5,000 digits", _MASS, f'<mass value="{"9" * 5000}"/>', "<mass> value"),
    ("mass too large", _MASS, '<mass value="1e300"/>', "<mass> value must be at most"),
    ("no moment", ' iyy="1"', "", "<inertia> iyy"),
    ("moment nan", 'ixx="1"', 'ixx="nan"', "<inertia> ixx"),
    ("moment too large", _INERTIA, _INERTIA.replace('"1"', '"1e308"'), "<inertia> ixx must be at most"),
    ("geometry mistyped", _BOX, "<bax/>", "did you mean <box>"),
    ("origin mistyped", _ORIGIN, '<orgin xyz="0 0 1"/>', "did you mean <origin>"),
    ("xyz mistyped", _ORIGIN, '<origin xzy="0 0 1"/>', "did you mean the attribute xyz"),
    ("inertia in capitals", "<inertia ", "<Inertia ", "did you mean <inertia>"),
    ("axis as text", _AXIS, "<axis>0 1 0</axis>", "must hold no text"),
    ("bounds as elements", _LIMIT, "<limit><lower>1</lower></limit>", "did you mean the attribute lower"),
    ("a xacro macro", 'pair">', 'pair" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:if/>', "xacro"),
)

_TENFOLD = "".join(f'<!ENTITY {new} "{f"&{old};" * 10}">' for old, new in ("ab", "bc", "cd"))
# Whole files.
_FILES: tuple[tuple[str, str | bytes, str], ...] = (
    ("empty file", "", "not well-formed XML"),
    ("white space only", "  \n ", "not well-formed XML"),
    ("no XML", "hello", "not well-formed XML"),
    ("zeros", bytes(100), ""),
    ("UTF-16 without a mark", MECHANISM.encode("utf-16-le"), ""),
    ("cut off", MECHANISM[: len(MECHANISM) // 2], "not well-formed XML"),
    ("an SDF", '<sdf version="1.6"><model name="a"/></sdf>', "must be <robot>"),
    ("no links at all", '<robot name="a"/>', "at least one <link>"),
    ("nested 10,000 deep", '<robot name="a">' + "<a>" * 10000 + "</a>" * 10000 + "</robot>", "XML"),
    ("entities that grow", f'<!DOCTYPE r [<!ENTITY a "{"a" * 10}">{_TENFOLD}]><robot name="&d;&d;"/>', ""),
    ("a name of 100,000 letters", MECHANISM.replace('"bar"', f'"{"b" * 100_000}"'), "letters"),
    ("a value of 100,000 letters", MECHANISM.replace("revolute", "b" * 100_000), _KIND),
    ("control characters", MECHANISM.replace("pair", "pa\x1bir"), "not well-formed XML"),
)


def cases() -> Iterator[Case]:
    """Yield all of them."""
    for name, old, new, says in _CHANGES:
        yield Case("urdf", name, says, _COMMAND, FILES | {"pair.urdf": changed(MECHANISM, old, new)})
    for name, text, says in _FILES:
        yield Case("urdf", name, says, _COMMAND, FILES | {"pair.urdf": text})
    missing = FILES | {"pair.urdf": changed(MECHANISM, _BOX, '<mesh filename="no.stl"/>')}
    yield Case("urdf", "a mesh to be copied is missing", "no.stl", (*_COMMAND, "--copy-meshes"), missing)
