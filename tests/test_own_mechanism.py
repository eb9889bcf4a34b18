"""A mechanism that is not shipped, with awkward names and parts, through the commands that read its run."""

from urllib.parse import quote

import pytest

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.show.plot import figure_energy

# Letters that the font of figures lacks, and dollars that enclose no formula.
JOINT = r"Bolzen.2 β$\alpha{$"

URDF = """<?xml version="1.0"?>
<robot name="Kran &amp; Söhne">
  <link name="bus 1">
    <inertial><origin xyz="0.02 0 0"/><mass value="30"/>
      <inertia ixx="0.6" iyy="0.7" izz="0.8" ixy="0.02" ixz="0" iyz="0.01"/></inertial>
  </link>
  <joint name="Kugel" type="floating">
    <parent link="bus 1"/><child link="Arm.α"/>
    <origin xyz="0.3 0.1 0" rpy="0 0.5 0.3"/><axis xyz="0 0 1"/>
  </joint>
  <link name="Arm.α">
    <inertial><origin xyz="0.2 0 0"/><mass value="5"/>
      <inertia ixx="0.01" iyy="0.08" izz="0.08" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://kran/haken.stl"/></geometry></visual>
    <visual name="rod"><origin xyz="0.2 0 0" rpy="0 1.5707963 0"/>
      <geometry><cylinder radius="0.03" length="0.4"/></geometry></visual>
  </link>
  <joint name="Bolzen.2 β$\\alpha{$" type="continuous">
    <parent link="Arm.α"/><child link="dish"/>
    <origin xyz="0.4 0 0"/><axis xyz="1 2 3"/>
  </joint>
  <link name="dish">
    <inertial><origin xyz="0.1 0.05 0.1"/><mass value="2"/>
      <inertia ixx="0.02" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
</robot>
"""

SCENARIO = """
format = 1
title = "Crane <2 parts> & a ball"
duration = "80 ms"
default_case = "关节 with play"
[mechanism]
urdf = "crane.urdf"
base = "fixed"
gravity = [0.0, 0.0, -9.80665]
[clearance.Kugel]
model = "spherical"
bearing_radius = "20 mm"
radial_clearance = "0.1 mm"
geometry = "closed-form"
journal_material = "steel"
bearing_material = "steel"
normal = { law = "gonthier", restitution = 0.5 }
[clearance.'Bolzen.2 β$\\alpha{$']
model = "contact"
bearing_radius = "10 mm"
radial_clearance = "0.1 mm"
bearing_length = "40 mm"
axial_clearance = "0.2 mm"
bearing_outer_radius = "14 mm"
flange_radius = "13 mm"
offset = "-12 mm"
geometry = "closed-form"
journal_material = "steel"
bearing_material = "steel"
normal = { law = "hunt-crossley", restitution = 0.8 }
[pointing]
body = "dish"
boresight = [1, 1, 0]
[cases."关节 with play"]
[cases."a/b"]
"""
FIGURES = ("--case", "关节 with play", "--format", "png", "--no-progress")


@pytest.fixture(scope="module")
def crane(tmp_path_factory):
    folder = tmp_path_factory.mktemp("crane")
    (folder / "crane.urdf").write_text(URDF, encoding="utf-8")
    (folder / "scenario.toml").write_text(SCENARIO, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def result(crane, tmp_path_factory):
    """The file of its run, under a name with spaces."""
    scenario = load_scenario(crane, case="关节 with play")
    return simulate(scenario).save(tmp_path_factory.mktemp("run") / "关节 with play.nc")


@pytest.fixture(scope="module")
def drawn(crane, tmp_path_factory):
    """What ``antenna-pin figures`` makes of it, and the folder."""
    from antenna_pin.apps.cli import app

    out = tmp_path_factory.mktemp("drawn")
    with pytest.raises(SystemExit) as ended:
        app(["figures", str(crane), "--out", str(out), *FIGURES])
    assert not ended.value.code
    return out


@pytest.mark.slow
def test_figures_are_the_same_set_from_a_fresh_run_and_from_its_file(drawn, crane, cli, caplog):
    first = {path.name for path in drawn.glob("*.png")}
    assert {"pointing.png", "energy.png", "spectrogram-Kugel.png", "contact_forces-Kugel.png"} <= first
    said = cli("figures", crane, "--out", drawn, *FIGURES)
    assert "using" in said.err and "is not drawn" not in said.err
    assert {path.name for path in drawn.glob("*.png")} == first
    # Letters that the font lacks are no noise.
    assert len(said.err.splitlines()) == 1 and not caplog.records


@pytest.mark.slow
def test_the_index_links_to_results_whose_names_have_spaces(drawn):
    (result,) = (drawn / "runs").glob("*.nc")
    assert " " in result.name
    assert f"](runs/{quote(result.name)})" in (drawn / "index.md").read_text(encoding="utf-8")


def test_energy_of_gravity_is_drawn_from_its_start(result):
    # 5 kg at 0.2 m and 2 kg at 0.4 m from a base at the origin: joules, far above the motion's.
    panels = figure_energy(Trajectory.load(result)).axes
    (line,) = (line for axes in panels for line in axes.lines if "gravity" in str(line.get_label()))
    assert line.get_ydata()[0] == 0.0


def test_every_reader_takes_it(result, cli):
    for command in (
        ("info", result),
        ("analyse", result),
        ("impacts", result, "--joint", JOINT),
        ("pointing", result, "--direction", "0,0,1"),
        ("record", result, "--out", "m.html"),
        ("record", result, "--out", "j.html", "--view", "joint", "--joint", JOINT),
    ):
        said = cli(*command)
        assert (said.code, said.err) == (0, ""), command
    assert "package://kran/haken.stl" in cli("record", result, "--out", "m.html").out


def test_a_run_with_contacts_is_no_ideal_one(result, cli):
    said = cli("analyse", result, "--ideal", result)
    assert said.code == 2
    assert f"with play in Kugel, {JOINT}" in said.err.replace("\\\\", "\\")


def test_a_report_takes_a_window_with_and_without_a_unit(result, cli):
    for window in ("0.01", "10 ms"):
        said = cli("report", result, "--out", "r.html", "--no-figures", "--no-recordings", "--window", window)
        assert (said.code, said.err) == (0, "")


def test_a_case_named_like_a_folder_gets_a_file_of_its_own(crane, cli, tmp_path):
    assert cli("run", crane, "--case", "a/b", "--duration", "1 ms", "-q").code == 0
    assert [path.name for path in tmp_path.glob("*.nc")] == [f"{crane.name}-a-b.nc"]
