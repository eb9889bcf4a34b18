"""From a scenario to a system: placements, laws, and what is refused before any work."""

import html
import json

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import AntennaPinError, load_scenario, simulate
from antenna_pin.base.records import POSE
from antenna_pin.contact import MATERIALS, hertz_stiffness
from antenna_pin.dynamics import JointMotion
from antenna_pin.errors import MechanismError, NotSimulatedWarning
from antenna_pin.joints.layout_kernels import joint_at
from antenna_pin.joints.pose_kernels import place_journal, wrapped_angle
from antenna_pin.scenario.assemble import build_system, initial_state
from antenna_pin.scenario.assemble.build import frictions_of


def scenario(*overrides, case="case3"):
    return load_scenario("bai2020", case=case, overrides=overrides)


CONSTANT = "drives.own={kind='constant', joint='azimuth', value='1 N*m'}"
HOLD = "controllers.hold={{kind='pid', acts_on='own', period=0.01, measures='{}', kp=1}}"

REFUSALS = {
    "unknown joint of a drive": (
        ["drives.azimuth.joint=azimut"],
        ["drives.azimuth.joint", "'azimut'", "did you mean azimuth"],
    ),
    "unknown link": (["mechanism.links.reflektor.mass=1"], ["mechanism.links", "did you mean reflector"]),
    "unit of a sliding joint at a turning one": (
        ["drives.azimuth.amplitude=10 N"],
        ["drives.azimuth", "rotation", "translation"],
    ),
    "deep penetration at the start": (
        ["initial.joints.elevation.journal_position=[0.5e-3, 0, 0]"],
        ["penetration of elevation.radial", "maximum_depth = 0.0001 m", "0.0003"],
    ),
    **{
        f"{key} beside {journal}": (
            [f"initial.joints.elevation={{{key}=0, {journal}=[0, 0, 0.1]}}"],
            [f"elevation.{key}: must be left out with {journal}[2]", "got 0 and 0.1", f"leave out {key}"],
        )
        for key, journal in (
            ("rate", "journal_angular_velocity"),
            ("velocity", "journal_angular_velocity"),
            ("angle", "journal_tilt"),
            ("position", "journal_tilt"),
        )
    },
    "stiffness of another exponent without a number": (
        ["clearance.elevation.normal.exponent=1.2"],
        ["clearance.elevation.normal.stiffness", "1.2"],
    ),
    "unknown joint of a controller": (
        [CONSTANT, HOLD.format("angle azimut")],
        ["controllers.hold.measures: moving joint 'azimut'", "did you mean azimuth"],
    ),
    "unknown joint of an event": (
        ["events.turned={kind='angle', joint='azimut', value='1 deg', action='stop'}"],
        ["events.turned.joint: moving joint 'azimut'", "did you mean azimuth"],
    ),
    "impossible inertia where none may be": (
        ["mechanism.links.body.inertia=[1000, 100, 100]", "mechanism.strict=true"],
        ["'body'", "allow_impossible_inertia"],
    ),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_bad_input_is_refused_in_one_line_before_any_step(name):
    overrides, parts = REFUSALS[name]
    with pytest.raises(AntennaPinError) as caught:
        simulate(scenario(*overrides), duration=0.01)
    message = str(caught.value)
    assert "\n" not in message
    for part in parts:
        assert part in message, message


def test_a_clearance_joint_must_be_a_hinge(tmp_path):
    text = scenario().urdf_text.replace('type="revolute"', 'type="prismatic"')
    other = scenario().model_copy(update={"urdf_text": text})
    with pytest.raises(AntennaPinError, match=r"clearance\.elevation.*revolute or continuous.*prismatic"):
        build_system(other)


def test_a_torque_table_must_cover_the_run(tmp_path):
    (tmp_path / "torque.csv").write_text("time,torque\n0,0\n0.05,1\n")
    table = 'drives.azimuth={kind="table", replace=true, file="%s"}' % (tmp_path / "torque.csv")
    with pytest.raises(AntennaPinError, match=r"drive 'azimuth'.*covers the run from 0 to 0\.1 s"):
        simulate(scenario(table), duration=0.1)
    assert simulate(scenario(table), duration=0.05).completed


def test_stiffness_follows_from_materials_and_radii_unless_given():
    joint = build_system(scenario()).clearances[0]
    steel = MATERIALS["steel"]
    assert joint.radial.stiffness == pytest.approx(
        hertz_stiffness(0.01, 0.0098, steel, steel), rel=1e-12, abs=0.0
    )
    assert joint.radial.stiffness == pytest.approx(
        1.0615e11, rel=1e-4, abs=0.0
    )  # papers' constants, internal form
    assert joint.axial.stiffness == joint.radial.stiffness  # assumed, named in the model's README
    given = build_system(scenario("clearance.elevation.axial.stiffness=2e10")).clearances[0]
    assert given.axial.stiffness == 2e10
    assert given.radial.stiffness == joint.radial.stiffness


@pytest.mark.parametrize("bearing_on", ["parent", "child"])
def test_initial_state_of_a_journal_is_what_was_asked_in_bearing_axes(bearing_on):
    """Position, tilt and velocities come back from the contact kernel's pose; the angle is the joint's."""
    offset, sign = 7e-3, 1.0 if bearing_on == "parent" else -1.0
    asked = scenario(
        "initial.joints.elevation={angle=0.7, rate=0.3, journal_position=[1e-4, -5e-5, 8e-5],"
        " journal_tilt=[1e-3, 2e-3, 0], journal_velocity=[1e-3, 2e-3, -3e-3],"
        " journal_angular_velocity=[0.01, -0.02, 0]}",
        f"clearance.elevation.offset={offset}",
        f"clearance.elevation.bearing_on={bearing_on}",
    )
    system = build_system(asked)
    q, v = initial_state(asked, system)
    pose = np.zeros(1, POSE)
    block = system.clearance_blocks["elevation"]
    place_journal(system.program, block, np.concatenate([q, v]), system.model.nq, pose)
    assert pose["centre"][0] == pytest.approx([1e-4, -5e-5, 8e-5], abs=1e-17)  # round-off of 7 mm
    tilt = pin.exp3(np.array([1e-3, 2e-3, 0.0]))
    assert pose["axis"][0] == pytest.approx(tilt[:, 2], abs=1e-15)
    assert pose["velocity"][0] == pytest.approx([1e-3, 2e-3, -3e-3], abs=1e-16)
    assert pose["spin"][0] == pytest.approx([0.01, -0.02, sign * 0.3], abs=1e-15)
    angle, _, _ = wrapped_angle(joint_at(system.program, block), q)
    # Swing-twist: the tilt about a transverse axis adds no twist to a turn about the axis.
    assert angle == pytest.approx(0.7, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "joint", "overrides", "motion"),
    [
        ("bai2020", "elevation", ["clearance.elevation.model=planar"], "angle=0.7, rate=0.3"),
        ("slider", "slide", [], "position='20 mm', velocity='0.3 m/s'"),
    ],
)
@pytest.mark.parametrize("bearing_on", ["parent", "child"])
def test_initial_state_across_the_axis_is_the_journals_and_along_it_the_joints(
    name, joint, overrides, motion, bearing_on
):
    """In a plane and in a guide; a joint's angle or position is its child's, wherever the bearing is."""
    journal = "journal_position=[1e-4, -5e-5, 0], journal_velocity=[1e-3, 2e-3, 0]"
    asked = load_scenario(
        name,
        overrides=[
            *overrides,
            f"clearance.{joint}.bearing_on={bearing_on}",
            f"initial.joints.{joint}={{{motion}, {journal}}}",
        ],
    )
    system, sign = build_system(asked), 1.0 if bearing_on == "parent" else -1.0
    q, v = initial_state(asked, system)
    y = system.state(q, v)
    pose = np.zeros(1, POSE)
    place_journal(system.program, system.clearance_blocks[joint], y, system.model.nq, pose)
    # Round-off.
    along = [0.02, 0.3] if name == "slider" else [0.0, 0.0]
    assert pose["centre"][0] == pytest.approx([1e-4, -5e-5, sign * along[0]], abs=1e-17)
    assert pose["velocity"][0] == pytest.approx([1e-3, 2e-3, sign * along[1]], abs=1e-16)
    assert pose["axis"][0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-15)
    wanted = (0.02, 0.3) if name == "slider" else (0.7, 0.3)
    assert JointMotion(system, joint)(y) == pytest.approx(wanted, rel=1e-14)


def test_several_clearance_joints_in_one_mechanism():
    """Both joints with play: contacts of their own, momentum and energy kept."""
    both = scenario(
        "clearance.azimuth={model='contact', bearing_radius=0.02, radial_clearance=1e-4, bearing_length=0.04,"
        " axial_clearance=1e-4, bearing_outer_radius=0.025, flange_radius=0.024, geometry='closed-form',"
        " normal={law='lankarani-nikravesh', restitution=0.8}, journal_material='steel',"
        " bearing_material='steel'}",
        "clearance.elevation.geometry=coal",
    )
    run = simulate(both, duration=0.1)
    assert run.completed, run.message
    assert run.data.sizes["contact"] == 8
    summary = run.summary()
    touched = {name.split(".")[0] for name, contact in summary["contacts"].items() if contact["episodes"]}
    assert touched == {"azimuth", "elevation"}
    assert summary["conservation"]["linear_momentum_drift_relative"] < 1e-8
    assert summary["conservation"]["angular_momentum_drift_relative"] < 1e-8
    assert abs(summary["conservation"]["energy_error_relative"]) < 1e-6


def test_a_law_leaves_its_effective_mass_to_each_contact_unless_given():
    overrides = ["clearance.elevation.normal={law='tsuji', restitution=0.8, replace=true}"]
    joint = build_system(scenario(*overrides)).clearances[0]
    assert joint.radial.effective_mass is None and joint.axial.effective_mass is None
    given = build_system(scenario(overrides[0].replace("0.8", "0.8, effective_mass='2 kg'")))
    assert given.clearances[0].radial.effective_mass == 2.0


@pytest.mark.parametrize(
    ("kind", "limit", "creep", "way_out"),
    [
        ("revolute", "0.251 N m", "0.713 mrad/s", "mechanism.joints.elevation.sticks = true holds it"),
        ("planar", "0.251 N m", "0.713 mrad/s", "only a joint without play can stick"),
    ],
)
def test_friction_that_is_rounded_off_says_how_fast_it_creeps(kind, limit, creep, way_out):
    """Under half its torque a joint creeps at w_r / sqrt(3): at 1.2345 mrad/s 0.71274, in three digits."""
    case = {"revolute": "case1", "planar": "case2-planar"}[kind]
    friction = "mechanism.joints.elevation={friction=0.25149, regularisation_speed=1.2345e-3}"
    found = frictions_of(one := scenario(friction, case=case), build_system(one).mechanism, ())
    assert [*found.smooth] == ["elevation.dynamics"] and not found.sticking
    (said,) = (" ".join(text.split()) for text in found.assumed)
    assert said.startswith(f"elevation: its friction of {limit} is rounded off at rest")
    assert f"under half that load it creeps at {creep}; {way_out}" in said


ODD = """<robot name="odd"><link name="a"/><joint name="j" type="continuous"><parent link="a"/>
<child link="b"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="5" ixy="0" ixz="0" iyz="0"/>
</inertial></link></robot>"""


def test_inertia_that_no_body_has_is_said_kept_and_refused_only_if_strict(tmp_path):
    (tmp_path / "odd.urdf").write_text(ODD)
    path = tmp_path / "odd.toml"
    path.write_text('format = 1\nduration = 0.01\nmechanism = { urdf = "odd.urdf", base = "fixed" }\n')
    said = "link 'b': the largest principal moment of inertia exceeds the sum of the other two: 1, 1, 5 kg m"
    with pytest.warns(NotSimulatedWarning) as told:
        run = simulate(load_scenario(path))
    assert any(said in str(one.message) for one in told)
    kept = json.loads(run.data.attrs["mechanism"])["impossible_inertia"]
    assert len(kept) == 1 and said in kept[0]
    run.report(tmp_path / "r.html")
    assert said in html.unescape((tmp_path / "r.html").read_text())
    with pytest.raises(MechanismError, match="exceeds the sum .* or leave out mechanism.strict"):
        build_system(load_scenario(path, overrides=["mechanism.strict=true"]))
    allowed = ["mechanism.strict=true", "mechanism.allow_impossible_inertia=['b']"]
    assert build_system(load_scenario(path, overrides=allowed)).mechanism.impossible == ()
    with pytest.raises(AntennaPinError, match="continuous joints have none, even if the file gives them: j"):
        load_scenario(path, overrides=["stops=true"])


TWO_WHEELS = """<robot name="two"><link name="base"/>
  <link name="a"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="b"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="lead" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
  <joint name="follow" type="continuous"><parent link="base"/><child link="b"/><axis xyz="0 0 1"/></joint>
</robot>"""


@pytest.mark.parametrize(
    ("more", "coupled"),
    [
        ([], True),
        (["mechanism.joints.follow.kind=locked"], False),
        (["mechanism.joints.lead.kind=ideal"], True),
    ],
)
def test_a_coupling_whose_follower_is_locked_is_left_out(tmp_path, more, coupled):
    (tmp_path / "two.urdf").write_text(TWO_WHEELS)
    (tmp_path / "scenario.toml").write_text(
        'format = 1\nduration = "1 s"\ndefault_case = "all"\n[mechanism]\nurdf = "two.urdf"\nbase = "fixed"\n'
        '[couplings.mesh]\nleader = "lead"\nfollower = "follow"\nmultiplier = -2\n[cases.all]\n'
    )
    system = build_system(load_scenario(tmp_path / "scenario.toml", overrides=more))
    assert set(system.couplings) == ({"mesh"} if coupled else set())
    assert len(system.mechanism.joints) == (2 if coupled else 1)
