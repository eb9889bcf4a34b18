"""What `antenna-pin urdf --check`, `info` and `run` say of URDFs that hold more than mechanics."""

import json
import sys
import warnings
from pathlib import Path

import pytest
from typer.testing import CliRunner

from antenna_pin import load_scenario, simulate
from antenna_pin.apps.cli import app
from antenna_pin.errors import NotSimulatedWarning

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "check"))
import urdf_generator

BODY = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
ARM = f"""<robot name="arm">
<link name="base">{BODY}</link><link name="arm">{BODY}</link>
<joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit effort="1" velocity="20"/></joint>
<gazebo reference="arm"><material>Gazebo/Black</material></gazebo>
</robot>
"""
SCENARIO = """format = 1
duration = "0.1 s"
[mechanism]
urdf = "arm.urdf"
base = "fixed"
[drives.hinge]
kind = "motion"
rate = 1
"""


def said(*words):
    with warnings.catch_warnings():
        warnings.simplefilter("default")  # a note is printed, as where nobody makes errors of them
        result = CliRunner().invoke(app, [*map(str, words)])
    return result.exit_code, result.stdout.splitlines(), result.stderr


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "scenario.toml").write_text(SCENARIO)
    return tmp_path


def test_a_motion_of_a_joint_whose_limit_has_no_bounds_runs_and_is_said(folder):
    """1 rad/s for 0.1 s."""
    with pytest.warns(NotSimulatedWarning) as caught:
        run = simulate(load_scenario(folder / "scenario.toml"))
    assert run.data["motion_angle"].values[-1, 0] == pytest.approx(0.1, rel=1e-12)
    first, second = (str(one.message) for one in caught)
    assert "passed over 1 thing that means nothing to the mechanics (1 <gazebo>)" in first
    assert second.endswith("no bounds in the <limit> of joints, which are unlimited: hinge")


def test_bounds_of_the_scenario_are_those_that_a_motion_must_stay_in(folder):
    bounded = SCENARIO + '[mechanism.joints.hinge]\nlower = "-1 deg"\nupper = "2 deg"\n'
    (folder / "scenario.toml").write_text(bounded)
    code, _, error = said("run", folder / "scenario.toml")
    assert code == 2 and "0.03491 rad by its <limit>" in error
    (folder / "scenario.toml").write_text(bounded.replace("deg", "mm"))
    code, _, error = said("run", folder / "scenario.toml")
    assert code == 2 and "mechanism.joints.hinge: units must be those of a rotation" in error


def test_info_lists_what_was_passed_over(folder):
    code, lines, error = said("info", folder / "scenario.toml")
    assert code == 0 and "passed over 1 thing" in error
    assert "  passed over in the URDF: 1 <gazebo>, line 5" in lines
    assert "  without bounds in the URDF: hinge" in lines
    facts = json.loads(said("info", folder / "scenario.toml", "--json")[1][0])
    assert (facts["passed_over"], facts["unbounded"]) == ({"<gazebo>": [5]}, ["hinge"])


def test_a_mass_without_moments_is_said_by_all(folder):
    arm = BODY.replace("<inertial>", '<inertial><origin xyz="1 0 0"/>').replace("<inertia ", "<!-- ")
    (folder / "arm.urdf").write_text(ARM.replace(BODY, arm.replace('iyz="0"/>', "-->")))
    code, lines, error = said("info", folder / "scenario.toml")
    assert (
        code == 0
        and "arm.urdf: a <mass> without <inertia> in links, which become point masses: base, arm" in error
    )
    assert "  point masses, without moments of inertia in the URDF: base, arm" in lines
    assert json.loads(said("info", folder / "scenario.toml", "--json")[1][0])["points"] == ["base", "arm"]
    assert f"{folder}/arm.urdf: point masses: base, arm" in said("urdf", folder / "arm.urdf", "--check")[1]


def test_check_says_of_each_file_what_is_read_and_counts(folder):
    (folder / "below").mkdir()
    (folder / "below" / "bad.urdf").write_text(ARM.replace("0 1 0", "0 0 0"))
    (folder / "below" / "slip.urdf").write_text(ARM.replace("<axis xyz", "<axis xzy"))
    (folder / "arm.sdf").write_text('<sdf version="1.6"/>')
    code, lines, _ = said("urdf", folder, folder / "arm.sdf", folder / "scenario.toml", "--check")
    below = folder / "below" / "bad.urdf"
    assert code == 2 and lines == [
        f"{folder}/arm.urdf: loads: 7 freedoms on a free base",
        f"{folder}/arm.urdf: passed over: 1 <gazebo>, line 5",
        f"{folder}/arm.urdf: without bounds: hinge",
        f"{below}: refused: bad.urdf, line 3: joint 'hinge': axis must be nonzero, got '0 0 0'",
        f"{below}: passed over: 1 <gazebo>, line 5",
        f"{folder}/below/slip.urdf: refused: slip.urdf, line 3: joint 'hinge': attribute xzy of <axis> is "
        "unknown; did you mean the attribute xyz?",
        f"{folder}/arm.sdf: refused: arm.sdf, line 1: the root of a URDF must be <robot>, got <sdf>: this is "
        "SDF, Gazebo's format; convert it to URDF, or use its original URDF or xacro",
        f"{folder}/scenario.toml: loads: 1 freedom on a fixed base",
        f"{folder}/scenario.toml: passed over: 1 <gazebo>, line 5",
        f"{folder}/scenario.toml: without bounds: hinge",
        "2 of 5 load",
    ]
    code, lines, _ = said("urdf", folder / "arm.urdf", "--check", "--out", folder / "said.txt")
    assert (code, lines) == (0, ["1 of 1 load", f"saved {folder}/said.txt"])
    assert (folder / "said.txt").read_text().endswith("hinge\n1 of 1 load\n")


def test_check_of_a_scenario_judges_the_changed_mechanism(folder):
    (folder / "arm.urdf").write_text(ARM.replace("0 1 0", "0 0 0"))
    assert said("urdf", folder / "arm.urdf", "--check")[0] == 2
    change = "mechanism.joints.hinge.axis=[0, 1, 0]"
    assert said("urdf", folder / "scenario.toml", "--check", "--set", change)[0] == 0


def test_all_files_of_the_generator_load(tmp_path):
    """The count that the project goes by: of what exporters write, all of it."""
    for number in range(30):
        drawn = urdf_generator.draw_urdf(30, number)
        (tmp_path / f"{drawn.name}.urdf").write_bytes(drawn.odd)
    code, lines, _ = said("urdf", tmp_path, "--check")
    assert (code, lines[-1]) == (0, "30 of 30 load")


def test_a_urdf_file_alone_is_not_written(folder):
    code, _, error = said("urdf", folder / "arm.urdf")
    assert (
        code == 2 and "must be given one SCENARIO to write its URDF" in error and "--check reports" in error
    )
