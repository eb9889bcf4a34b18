"""Flanks of gears and strands of belts: located touches; racks; joints with play; who is measured."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from antenna_pin import (
    RunSettings,
    System,
    Trajectory,
    Urdf,
    build_mechanism,
    build_system,
    load_scenario,
    simulate,
)
from antenna_pin.analysis import gear_contacts, gear_impacts, gears_of
from antenna_pin.elements import Belt, Cable, ConstantDrive, Gear, JointSpring, PDController, Rack
from antenna_pin.errors import AntennaPinError, InvalidParameterError

TIGHT = RunSettings(rtol=1e-12, output_rate=400.0)
LINK = (
    '<link name="{0}"><inertial><origin xyz="0 0 0"/><mass value="2"/>'
    '<inertia ixx="{1}" iyy="{1}" izz="{1}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="{2}"><parent link="base"/><child link="{0}_link"/><origin xyz="{1} 0 0"/>'
    '<axis xyz="{3}"/><limit lower="-99" upper="99" effort="1e9" velocity="1e9"/></joint>'
)
#: Moments of inertia of input and output [kg m^2]; what slides [kg].
INPUT, OUTPUT, MASS = 0.01, 0.04, 2.0


def _text(kind: str = "continuous", axis: str = "0 0 1") -> str:
    text = LINK.format("base", 0.5) + JOINT.format("a", 0.1, "continuous", "0 0 1")
    text += JOINT.format("b", -0.2, kind, axis)
    return f'<robot name="pair">{text}{LINK.format("a_link", INPUT)}{LINK.format("b_link", OUTPUT)}</robot>'


def _pair(base: str = "fixed", kind: str = "continuous", axis: str = "0 0 1", **more) -> System:
    """Two balanced bodies on a base: the second turns, or slides."""
    return System(build_mechanism(Urdf.from_text(_text(kind, axis), "pair.urdf"), base, (0, 0, 0)), **more)


def _geared(element: object) -> dict[str, dict[str, object]]:
    return {"gears": {"g": element}}


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_touches_of_flanks_are_those_of_an_oscillator(engine: str) -> None:
    """Touch, turn and release at their closed-form instants, by turns on either flank; impulse and loss."""
    play, k, rate = 0.02, 50.0, 0.3
    gear = Gear(input="a", output="b", stiffness=k, play=play)
    settings = RunSettings(rtol=1e-12, output_rate=100.0, engine=engine)
    run = simulate(_pair(elements=_geared(gear)), v=[rate, 0.0], duration=1.0, settings=settings)
    reduced = INPUT * OUTPUT / (INPUT + OUTPUT)
    swing, across = math.pi * math.sqrt(reduced / k), play / rate
    found = gear_impacts(run)
    n = found.sizes["touch"]
    onset = 0.5 * across + np.arange(n) * (swing + across)
    # The tolerance of the steps.
    assert n >= 8
    assert np.abs(found.onset.values - onset).max() < 1e-9
    assert np.abs(found.release.values - (onset + swing))[np.isfinite(found.release.values)].max() < 1e-9
    assert found.side.values.tolist() == [("plus", "minus")[k % 2] for k in range(n)]
    assert np.abs(found.approach_rate.values - rate).max() < 1e-9
    whole = np.isfinite(found.release.values)
    assert found.impulse.values[whole] == pytest.approx(2.0 * reduced * rate, rel=1e-9)
    assert np.abs(found.loss.values[whole]).max() == 0.0
    # Each touch has a sample where it turns back, at its greatest torque.
    assert found.peak_effort.values[whole] == pytest.approx(math.sqrt(k * reduced) * rate, rel=1e-9)
    turns = [name for name in run.data.event.values if name.endswith("turns")]
    assert turns[:2] == ["gear g: plus: turns", "gear g: minus: turns"]
    spans = gear_contacts(run, "gears.g")
    assert spans.sides.values[:4].tolist() == ["apart", "plus", "apart", "minus"]
    assert gears_of(run) == ("gears.g",)
    expected = run.data.motion_angle.values @ [1.0, -1.0]
    assert np.abs(run.data.element_deflection.values[:, 0] - expected).max() < 1e-15


@pytest.mark.parametrize("damping", [0.0, 0.5])
@pytest.mark.parametrize("beyond", [1e-6, 1e-10])
def test_a_touch_within_one_step_is_not_missed(beyond: float, damping: float) -> None:
    """Pulled back by a constant torque the input just grazes the flank: in and out within one long step."""
    play, torque = 0.02, 0.05
    speed = math.sqrt(2.0 * (0.5 * play + beyond) * torque / INPUT)
    gear = Gear(input="a", output="b", stiffness=1e-3, damping=damping, play=play)
    drive = ConstantDrive(joint="a", value=-torque)
    system = _pair(elements=_geared(gear), drives={"d": drive})
    run = simulate(system, v=[speed, 0.0], duration=0.1, settings=RunSettings(rtol=1e-4, output_rate=10.0))
    found = gear_impacts(run)
    assert found.side.values.tolist() == ["plus"]
    # A spring so soft, and a damper below it, change nothing of the way by more than 1e-9 of it.
    root = math.sqrt(2.0 * beyond * torque / INPUT)
    at = (speed - root) * INPUT / torque, (speed + root) * INPUT / torque
    assert (float(found.onset[0]), float(found.release[0])) == pytest.approx(at, abs=1e-8)


def test_a_damped_touch_loses_what_the_table_says() -> None:
    """The loss of each touch is that of the kinetic energy of the pair's relative motion."""
    gear = Gear(input="a", output="b", stiffness=50.0, damping=0.05, play=0.02)
    run = simulate(_pair(elements=_geared(gear)), v=[0.3, 0.0], duration=1.0, settings=TIGHT)
    found = gear_impacts(run)
    reduced = INPUT * OUTPUT / (INPUT + OUTPUT)
    before, after = found.approach_rate.values, found.rebound_rate.values
    whole = np.isfinite(after)
    lost = 0.5 * reduced * (before**2 - after**2)
    assert found.loss.values[whole] == pytest.approx(lost[whole], rel=1e-8)
    assert float(run.data.total_element_loss[0]) == pytest.approx(found.loss.values[whole].sum(), rel=1e-8)
    assert np.abs(run.data.energy_error).max() < 1e-12


def test_strands_become_taut_and_slack() -> None:
    """A belt with pretension begins with both taut; a cable with slack once its drum has taken that."""
    belt = Belt(input="a", output="b", input_radius=0.1, output_radius=0.1, stiffness=900.0, pretension=4.0)
    run = simulate(_pair(elements=_geared(belt)), v=[6.0, 0.0], duration=0.2, settings=TIGHT)
    spans = gear_contacts(run, "gears.g")
    assert spans.sides.values[:4].tolist() == ["both", "plus", "both", "minus"]
    # Both pull by 900 N/m at 0.1 m until the way is what the pretension has stretched one of them by.
    omega = math.sqrt(2.0 * 900.0 * 0.01 * (1.0 / INPUT + 1.0 / OUTPUT))
    assert float(spans.end[0]) == pytest.approx(math.asin(4.0 / 900.0 * omega / 0.6) / omega, rel=1e-9)
    assert run.data.event.values[0] == "gear g: minus: slack"
    told = run.summary()["gears"]["g"]
    slack = (spans.end - spans.begin).values[spans.sides.values != "both"].sum()
    assert (told["time_apart"], told["time_slack"]) == (0.0, pytest.approx(slack, rel=1e-12))
    cable = Cable(input="a", output="b", input_radius=0.1, output_radius=0.1, stiffness=900.0, slack=0.02)
    run = simulate(_pair(elements=_geared(cable)), v=[2.0, 0.0], duration=0.2, settings=TIGHT)
    assert float(gear_impacts(run).onset[0]) == pytest.approx(0.1, rel=1e-12)
    assert gear_contacts(run, "gears.g").sides.values.tolist() == ["apart", "plus", "apart"]


def test_touches_are_in_a_file_and_go_on_from_a_state(tmp_path: Path) -> None:
    """Two halves, the second beginning in contact, have the touches of one run; a file has them too."""
    gear = Gear(input="a", output="b", stiffness=50.0, damping=0.05, play=0.02)
    system = _pair(elements=_geared(gear))
    whole = simulate(system, v=[0.3, 0.0], duration=0.2, settings=TIGHT)
    first = simulate(system, v=[0.3, 0.0], duration=0.04, settings=TIGHT)  # since 1/30 s in contact
    rest = simulate(system, start=first.end, duration=0.16, settings=TIGHT)
    assert np.array_equal(rest.data.v.values[-1], whole.data.v.values[-1])
    names = [*first.data.event.values, *rest.data.event.values]
    assert names == whole.data.event.values.tolist()
    assert gear_contacts(rest, "gears.g").sides.values[0] == "plus"
    whole.save(tmp_path / "run.nc")
    assert gear_impacts(Trajectory.load(tmp_path / "run.nc")).identical(gear_impacts(whole))


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_rack_moves_by_the_radius_and_takes_the_teeth_s_force(engine: str) -> None:
    """Pinion and rack swing by the reduced mass of r^2 over I and 1 over m; momentum of a free base stays."""
    radius, k, play = -0.05, 2e4, 1e-4
    rack = Rack(input="a", output="b", radius=radius, stiffness=k, play=play)
    settings = RunSettings(rtol=1e-12, output_rate=1000.0, engine=engine)
    system = _pair(kind="prismatic", axis="0 1 0", elements=_geared(rack))
    run = simulate(system, v=[1.0, 0.0], duration=0.2, settings=settings)
    reduced = 1.0 / (radius**2 / INPUT + 1.0 / MASS)
    swing, across = math.pi * math.sqrt(reduced / k), play / abs(radius)
    found = gear_impacts(run)
    onset = 0.5 * across + np.arange(found.sizes["touch"]) * (swing + across)
    assert found.sizes["touch"] >= 6
    assert np.abs(found.onset.values - onset).max() < 1e-9
    assert found.side.values[0] == "minus"  # a negative radius: the pinion runs ahead the other way
    assert np.abs(run.data.energy_error).max() < 1e-10
    # Along with the pinion the rack takes what keeps I w / r + m v.
    carried = INPUT * run.data.motion_rate.values[:, 0] / radius + MASS * run.data.slide_rate.values[:, 0]
    assert np.abs(carried - carried[0]).max() < 1e-11
    free = _pair("free", "prismatic", "0 1 0", elements=_geared(rack))
    run = simulate(free, v=[0, 0, 0, 0.1, 0.2, 0.3, 1.0, 0.0], duration=0.2, settings=settings)
    for name in ("linear_momentum", "angular_momentum"):
        momentum = run.data[name].values
        assert np.abs(momentum - momentum[0]).max() < 1e-11
    assert np.abs(run.data.energy_error).max() < 1e-9


@pytest.mark.parametrize(
    ("cls", "given", "kind", "says"),
    [
        (Rack, {"input": "b", "output": "a", "radius": 0.1}, "prismatic", "input must be a joint that turns"),
        (Rack, {"radius": 0.1}, "revolute", "output must be a joint that slid"),
        (Rack, {"radius": 0.0}, "prismatic", "Rack: radius must be other than zero, got 0"),
        (Gear, {}, "prismatic", 'slides; take kind "rack" from a pinion'),
    ],
)
def test_joints_that_move_otherwise_are_refused(cls, given, kind: str, says: str) -> None:
    with pytest.raises(InvalidParameterError, match=says):
        _pair(kind=kind, elements=_geared(cls(**{"input": "a", "output": "b", "stiffness": 1.0, **given})))


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_controller_that_measures_another_joint(engine: str) -> None:
    """Its torque on a is of b's motion: both are harmonic, and the drive's work is that of a's motion."""
    kp, k = 0.3, 2.0
    drive = PDController(joint="a", measures="b", kp=kp, kd=0.02)
    spring = JointSpring(joint="b", stiffness=k)
    settings = RunSettings(rtol=1e-12, output_rate=100.0, engine=engine)
    run = simulate(
        _pair(drives={"d": drive}, springs={"s": spring}), v=[0.0, 1.0], duration=2.0, settings=settings
    )
    t, omega = run.data.time.values, math.sqrt(k / OUTPUT)
    b, rate = np.sin(omega * t) / omega, np.cos(omega * t)
    torque = -kp * b - 0.02 * rate
    assert np.abs(run.data.drive_torque.values[:, 0] - torque).max() < 1e-10
    assert np.abs(run.data.control_error.values[:, 0] + b).max() < 1e-10
    a_rate = (kp * (np.cos(omega * t) - 1.0) / omega**2 - 0.02 * np.sin(omega * t) / omega) / INPUT
    assert np.abs(run.data.motion_rate.values[:, 0] - a_rate).max() < 1e-9
    assert float(run.data.total_work[0]) == pytest.approx(0.5 * INPUT * a_rate[-1] ** 2, abs=1e-9)
    assert np.abs(run.data.energy_error).max() < 1e-10


SCENARIO = """format = 1
duration = "0.2 s"
default_case = "all"
[mechanism]
urdf = "pair.urdf"
base = "free"
[materials.steel]
young = "207 GPa"
poisson = 0.3
source = "assumed"
[clearance.b]
model = "contact"
bearing_radius = "10 mm"
radial_clearance = "0.1 mm"
bearing_length = "40 mm"
axial_clearance = "0.1 mm"
bearing_outer_radius = "12 mm"
flange_radius = "14 mm"
geometry = "closed-form"
journal_material = "steel"
bearing_material = "steel"
normal = { law = "lankarani-nikravesh", restitution = 0.8 }
friction = { law = "tanh", coefficient_of_friction = 0.1, transition_speed = "1 mm/s" }
[gears.drive]
input = "a"
output = "b"
ratio = -2
stiffness = "50 N*m/rad"
damping = "0.05 N*m*s/rad"
play = "1 mrad"
[drives.motor]
joint = "a"
kind = "pd"
measures = "b"
kp = "0.5 N*m/rad"
kd = "0.05 N*m*s/rad"
angle = "0.2 rad"
[initial.joints.a]
rate = "1 rad/s"
[cases.all]
"""


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_gears_and_controllers_at_joints_with_play(tmp_path: Path, engine: str) -> None:
    """The deflection is that of the motion angle; momentum stays, the ledger closes, through all impacts."""
    (tmp_path / "pair.urdf").write_text(_text("revolute"))
    (tmp_path / "scenario.toml").write_text(SCENARIO)
    scenario = load_scenario(tmp_path / "scenario.toml", overrides=[f"integrator.engine={engine}"])
    run = simulate(scenario)
    assert run.completed, run.message
    assert run.data.sizes["episode"] > 0 and gear_impacts(run).sizes["touch"] > 2
    angle = run.data.motion_angle
    expected = -0.5 * angle.sel(joint="a").values - angle.sel(joint="b").values
    assert np.abs(run.data.element_deflection.values[:, 0] - expected).max() < 1e-15
    for name, scale in (("linear", "momentum_scale"), ("angular", "angular_momentum_scale")):
        momentum = run.data[f"{name}_momentum"].values
        assert np.abs(momentum - momentum[0]).max() < 1e-9 * float(run.data[scale].max())
    # At default tolerances.
    assert np.abs(run.data.energy_error).max() < 1e-5 * float(run.data.kinetic_energy[0])


def test_who_is_measured_is_checked(tmp_path: Path) -> None:
    (tmp_path / "pair.urdf").write_text(_text("prismatic"))
    text = SCENARIO[: SCENARIO.index("[clearance")] + SCENARIO[SCENARIO.index("[drives") :]
    for measures, says in (
        ("c", r"drives\.motor\.measures.*'c'"),
        ("b", "measures must be a joint that turns"),
    ):
        (tmp_path / "scenario.toml").write_text(text.replace('measures = "b"', f'measures = "{measures}"'))
        with pytest.raises(AntennaPinError, match=says) as refusal:
            build_system(load_scenario(tmp_path / "scenario.toml"))
        assert "\n" not in str(refusal.value)
