"""Forces as tables of a scenario: keys, units, frames, events, refusals of one line; modes beside them."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario.assemble import build_system
from antenna_pin.studies.linear import modes

TOML = """
duration = 0.4
[mechanism]
urdf = "craft.urdf"
base = "{base}"
[initial.joints.hinge]
rate = "{rate}"
[integrator]
engine = "compiled"
rtol = 1e-10
{more}
"""
URDF = """<robot name="craft">
  <link name="hull"><inertial><mass value="4"/>
    <inertia ixx="0.5" iyy="0.6" izz="0.7" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="hull"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <link name="arm"><inertial><origin xyz="0.4 0 0"/><mass value="1.5"/>
    <inertia ixx="0.01" iyy="0.2" izz="0.21" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="tip"/>
    <origin xyz="0.8 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <link name="tip"/>
</robot>"""
ALL = """
[forces.drag]
kind = "force"
at = {link = "arm", point = ["40 cm", 0, 0]}
force = ["-20 mN", 0, 0]
torque = [0, 0, "1 mN m"]
axes = "world"
[forces.gust]
kind = "force"
at = {frame = "tip"}
force = [0, 1, 0]
file = "gust.csv"
interpolation = "cubic"
[forces.hum]
kind = "force"
at = {link = "hull", point = [0, 0, 0]}
torque = [0, 0, 0.2]
frequency = "8 Hz"
[forces.jet]
kind = "thruster"
at = {frame = "mount"}
direction = [1, 0, 0]
thrust = "500 mN"
starts = [0, "200 ms"]
durations = ["50 ms"]
minimum_on_time = "10 ms"
misalignment = "1 deg"
azimuth = "90 deg"
[forces.spare]
kind = "thruster"
at = {frame = "tip"}
direction = [1, 0, 0]
thrust = 1
[events.open]
kind = "time"
time = "0.1 s"
action = "set"
set = "forces.spare.throttle"
to = 0.5
"""
PUSH = "[forces.it]\nkind='force'\nat={link='arm', point=[0,0,0]}\n"


@pytest.fixture
def written(tmp_path):
    (tmp_path / "craft.urdf").write_text(URDF)
    (tmp_path / "gust.csv").write_text("time,factors\n0,0\n0.1,1\n0.5,0\n")

    def write(more="", base="free", rate="0.3 rad/s"):
        path = tmp_path / "scenario.toml"
        path.write_text(TOML.format(more=more, base=base, rate=rate))
        return load_scenario(path)

    return write


def test_every_key_comes_through(written):
    """Units, frames whose axes are their link's, a table's file, pulses, an event that opens a throttle."""
    scenario = written(ALL)
    system = build_system(scenario)
    drag, gust, hum, jet, _ = system.forces.values()
    assert (drag.at, drag.force, drag.axes) == (("arm", (0.4, 0.0, 0.0)), (-0.02, 0.0, 0.0), "world")
    assert (gust.at[0], gust.factors) == ("tip", (0.0, 1.0, 0.0))
    assert hum.frequency == 8.0
    assert jet.pulses == ((0.0, 0.05), (0.2, 0.2 + 0.05))
    assert jet.misalignment == pytest.approx(np.deg2rad(1.0), rel=1e-15)
    run = simulate(scenario)
    assert run.completed
    kept = run.summary()["conservation"]
    # The run's tolerance.
    assert kept["energy_error_relative"] < 1e-8
    assert kept["angular_momentum_drift_relative"] < 1e-8
    data = run.data
    spare = np.linalg.norm(data["applied_force"].sel(force_place="spare").values, axis=1)
    # A unit vector turned with its link: round-off.
    np.testing.assert_allclose(spare, np.where(data["time"].values < 0.1, 0.0, 0.5), rtol=1e-14)
    assert run.summary()["forces"]["drag"]["impulse"] == pytest.approx(0.02 * 0.4, rel=1e-12)
    again = load_scenario(scenario.folder / "scenario.toml", overrides=["forces.jet.thrust='2 N'"])
    assert build_system(again).forces["jet"].thrust == 2.0


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("[forces.it]\nkind='force'\nat={link='amr', point=[0,0,0]}\nforce=[1,0,0]", "did you mean arm"),
        (f"{PUSH}force=['1 m',0,0]", "'1 m'"),
        (PUSH, "forces.it.force must be other than zero"),
        (
            "[forces.it]\nkind='thruster'\nat={frame='tip'}\ndirection=[0,0,0]\nthrust=1",
            "forces.it.direction must be three finite numbers, not all zero",
        ),
        (
            "[forces.it]\nkind='thruster'\nat={frame='tip'}\ndirection=[1,0,0]\nthrust=1\nstarts=[0.1]\n"
            "durations=['1 ms']\nminimum_on_time='2 ms'",
            r"forces.it.durations\[0\] must be 0.002 s or more",
        ),
        ("[forces.it]\nkind='gravity-gradient'", "forces.it.rate must be given, or mu and radius"),
        (
            "[forces.it]\nkind='thruster'\nat={frame='tip'}\ndirection=[1,0,0]\nthrust=1\nfiring=1",
            "forces.it.firing is unknown",
        ),
    ],
)  # fmt: skip
def test_bad_tables_are_refused_in_one_line(written, more, said):
    with pytest.raises(AntennaPinError, match=said) as refused:
        build_system(written(more))
        simulate(written(more), duration=1e-3)
    assert "\n" not in str(refused.value)


def test_a_table_must_cover_the_run(written):
    with pytest.raises(AntennaPinError, match="force 'gust': time must be a table that covers the run"):
        simulate(written(ALL), duration=0.6)


def test_modes_under_a_constant_force(written):
    """An arm at rest under a force in the world's axes is a pendulum; in its own there is no stiffness."""
    spring = "[springs.hinge]\nstiffness = 2.0\n"
    pull = "[forces.pull]\nkind='force'\nat={link='arm', point=[0.8,0,0]}\nforce=[3,0,0]\naxes='%s'\n"
    moment = 0.21 + 1.5 * 0.4**2
    for axes, stiffness in (("world", 2.0 + 3.0 * 0.8), ("link", 2.0)):
        found = modes(written(spring + pull % axes, base="fixed", rate="0 rad/s"))
        # Differences of the forces are good to some nine digits.
        assert found.data["frequency"].values[0] == pytest.approx(
            np.sqrt(stiffness / moment) / (2.0 * np.pi), rel=1e-7
        )


FOLLOWS = """
[forces.shaker]
kind = "force"
at = {link = "hull", point = [0, 0, 0]}
force = [0, 0, "2 N"]
follows = "sweep"
[references.sweep]
kind = "chirp"
amplitude = 0.5
first = "1 Hz"
last = "20 Hz"
duration = "300 ms"
"""


def test_a_force_follows_a_reference_by_name(tmp_path):
    from antenna_pin.elements import Chirp

    (tmp_path / "craft.urdf").write_text(URDF)
    path = tmp_path / "scenario.toml"
    path.write_text(TOML.format(base="free", rate="0 rad/s", more=FOLLOWS))
    shaker = build_system(load_scenario(path)).families["forces"]["shaker"]
    assert shaker.follows == Chirp(amplitude=0.5, first=1.0, last=20.0, duration=0.3)
    for override, said in (
        ("forces.shaker.follows=swep", "reference 'swep' is unknown; did you mean sweep"),
        ("references.sweep.amplitude='1 deg'", "references.sweep: values must be pure numbers"),
        ("forces.shaker.frequency=3", "frequency must be omitted if follows is given"),
    ):
        with pytest.raises(AntennaPinError, match=said) as refused:
            build_system(load_scenario(path, overrides=[override]))
        assert "\n" not in str(refused.value)
