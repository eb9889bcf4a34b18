"""Friction of a joint, viscous and Coulomb's: closed forms, the energy ledger, both engines."""

import json
import math

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import System
from antenna_pin.elements import JointFriction
from antenna_pin.errors import AntennaPinError, NotSimulatedWarning, ScenarioError
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.scenario.assemble import build_system

INERTIA, RATE = 0.25, 3.0
ROTOR = """<robot name="rotor">
  <link name="frame"><inertial><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="{kind}"><parent link="frame"/><child link="disc"/>
    <axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <link name="disc"><inertial><mass value="0.25"/>
    <inertia ixx="0.2" iyy="0.2" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""
ENGINES = ("pinocchio", "compiled")
KINDS = ("revolute", "continuous", "prismatic")


def run(duration, kind="revolute", engine="pinocchio", base="fixed", times=(), **numbers):
    system = System(
        build_mechanism(Urdf.from_text(ROTOR.format(kind=kind), "rotor.urdf"), base),
        springs={"rub": JointFriction(joint="hinge", **numbers)},
    )
    v = np.zeros(system.model.nv)
    v[-1] = RATE
    settings = RunSettings(engine=engine, rtol=1e-11, output_rate=20.0, output_times=times)
    return simulate(system, duration=duration, v=v, settings=settings).data


def rate_of(data, kind="revolute"):
    name = {"prismatic": "slide_rate"}.get(kind, "motion_rate")
    return data[name].values[:, 0]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", KINDS)
def test_a_damped_joint_slows_down_exponentially(kind, engine):
    data = run(2.0, kind, engine, damping=0.4)
    expected = RATE * np.exp(-0.4 / INERTIA * data["time"].values)
    assert rate_of(data, kind) == pytest.approx(expected, rel=1e-10, abs=0.0)  # the tolerance of steps


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", KINDS)
def test_coulomb_friction_stops_a_joint_in_the_time_that_its_momentum_takes(kind, engine):
    """I w' = -T w / sqrt(w^2 + a^2), integrated: t = I/T [sqrt(w^2 + a^2) - a asinh(a/w)] from w to w0."""
    torque, a = 0.5, 1e-3
    data = run(1.51, kind, engine, friction=torque)  # I w0 / T is 1.5 s

    def passed(rate):
        return np.hypot(rate, a) - a * np.arcsinh(a / rate)

    time, rate = data["time"].values, rate_of(data, kind)
    moving = rate > 1e-3 * a  # further down round-off of the rate counts
    assert moving.sum() > 28
    expected = INERTIA / torque * (passed(RATE) - passed(rate[moving]))
    assert time[moving] == pytest.approx(expected, abs=1e-8)  # rtol over the least rate, times I a / T
    assert rate[-1] < 1e-4 * RATE and time[-1] > INERTIA * RATE / torque


@pytest.mark.parametrize("engine", ENGINES)
def test_friction_takes_what_is_lost_and_momentum_stays(engine):
    data = run(1.0, engine=engine, base="free", damping=0.1, friction=0.3, regularisation_speed=0.01)
    lost = data["dissipation_damper"].sel(spring="rub").values
    assert (np.diff(lost) > 0.0).all()
    kinetic = data["kinetic_energy"].values
    assert kinetic + lost == pytest.approx(np.full(len(lost), kinetic[0]), rel=1e-9, abs=0.0)
    assert np.abs(data["energy_error"].values).max() < 1e-9 * kinetic[0]
    momentum = data["angular_momentum"].values
    assert np.abs(momentum - momentum[0]).max() < 1e-12


def test_rounding_is_that_of_its_speed():
    """At the regularisation speed friction is 1/sqrt(2) of its limit."""
    data = run(1e-6, friction=0.5, regularisation_speed=RATE)
    assert data["motion_acceleration"].values[0, 0] == pytest.approx(
        -0.5 / INERTIA / math.sqrt(2.0), rel=1e-12, abs=0.0
    )


# --- from a scenario ----------------------------------------------------------------------------------------

TAG = '<dynamics damping="0.05" friction="0.1"/></joint>'


JOINT = "[mechanism.joints.hinge]\n"
MOVING = f"[initial.joints.hinge]\nrate = {RATE}\n"


def scenario(folder, more=MOVING):
    urdf = ROTOR.format(kind="continuous").replace("</joint>", TAG)
    (folder / "rotor.urdf").write_text(urdf)
    (folder / "scenario.toml").write_text(
        f"""format = 1
title = "rotor"
duration = "0.2 s"
[mechanism]
urdf = "rotor.urdf"
base = "fixed"
{more}
"""
    )
    return load_scenario(folder)


SMOOTH = JOINT + "sticks = false\n"


def test_dynamics_of_a_urdf_are_simulated_and_a_scenario_may_change_them(tmp_path):
    plain = simulate(scenario(tmp_path, SMOOTH + MOVING))
    own = plain.data.attrs["joint_friction"]
    assert json.loads(own)["hinge.dynamics"] == {
        "joint": "hinge",
        "damping": 0.05,
        "friction": 0.1,
        "regularisation_speed": 1e-3,
        "on": True,
        "slides": False,
        **dict.fromkeys(("bearing", "at_preload", "preload_exponent", "palmgren_factor")),
    }
    torque = INERTIA * plain.data["motion_acceleration"].values[0, 0]
    assert torque == pytest.approx(-(0.05 * RATE + 0.1), rel=1e-6)
    assert float(plain.data["energy_error"].values[-1]) == pytest.approx(0.0, abs=1e-9)
    changed = scenario(
        tmp_path,
        JOINT + 'friction = "200 mN*m"\nregularisation_speed = "3 rad/s"\n' + MOVING,
    )
    torque = INERTIA * simulate(changed).data["motion_acceleration"].values[0, 0]
    assert torque == pytest.approx(-(0.05 * RATE + 0.2 / math.sqrt(2.0)), rel=1e-9)


PLAY = """[clearance.hinge]
model = "contact"
bearing_radius = "10 mm"
radial_clearance = "5 mm"
bearing_length = "50 mm"
axial_clearance = "5 mm"
bearing_outer_radius = "20 mm"
flange_radius = "21 mm"
normal = { law = "hertz", stiffness = 1e9 }
friction = { law = "none" }
"""


@pytest.mark.parametrize("model", ["contact", "planar", "constraint"])
def test_it_acts_about_the_axis_of_a_joint_with_play_too(tmp_path, model):
    """Nothing touches: the disc turns about its centre and slows down as in the ideal joint."""
    ideal = simulate(scenario(tmp_path)).data
    more = PLAY.replace('"contact"', f'"{model}"')
    if model == "constraint":
        more = '[clearance.hinge]\nmodel = "constraint"\n'
    play = simulate(scenario(tmp_path, more + MOVING)).data
    last = float(ideal["final_rate"].values[0])
    assert last < 0.97 * RATE
    assert float(play["final_rate"].values[0]) == pytest.approx(last, rel=1e-8)


def test_what_has_no_axis_is_said_once_and_what_makes_no_sense_refused(tmp_path):
    free = scenario(tmp_path, JOINT + 'kind = "free"')
    with pytest.warns(NotSimulatedWarning, match="'hinge': its damping and friction are not simulated"):
        build_system(free)
    with pytest.raises(
        AntennaPinError, match="regularisation_speed: must be left out of a joint without fri"
    ):
        build_system(scenario(tmp_path, JOINT + "friction = 0\nregularisation_speed = 1"))
    with pytest.raises(AntennaPinError, match="units must be those of a rotation"):
        build_system(scenario(tmp_path, JOINT + 'friction = "1 N"'))


# --- output times -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ENGINES)
def test_chosen_output_times_are_there_and_change_nothing_else(engine):
    """0.3 s is one at the rate, too, and counts once; what is at all other times is the same bit for bit."""
    times = (0.0, 0.123456789, math.nextafter(0.3, 1.0), 0.31, 1 / 3, 1.0)
    plain = run(1.0, engine=engine, damping=0.1, friction=0.3)
    more = run(1.0, engine=engine, damping=0.1, friction=0.3, times=times)
    assert _same_elsewhere(plain, more, times) == len(plain["time"]) - 1
    assert len(more["time"]) == len(plain["time"]) + 3
    scenario = load_scenario("pendulum").with_overrides(
        {"integrator.engine": engine, "clearance.hinge.geometry": "closed-form"}
    )
    plain, more = (
        simulate(one, duration=0.05).data
        for one in (scenario, scenario.with_overrides({"output.times": ["12.345 ms", 1 / 70, "50 ms"]}))
    )
    assert plain["episode"].size > 3
    assert _same_elsewhere(plain, more, (0.012345, 1 / 70, 0.05)) == len(plain["time"])


def test_output_times_past_the_end_are_refused_by_the_scenario_s_key():
    scenario = load_scenario("pendulum").with_overrides({"output.times": [0.04]})
    with pytest.raises(ScenarioError, match=r"output\.times must be at most 0\.02 s, the end of the run"):
        simulate(scenario, duration=0.02)


def _same_elsewhere(plain, more, times):
    """Check two results, the one with more times than the other, and return how many times both have."""
    assert set(times) <= set(more["time"].values.tolist())
    common = [t for t in plain["time"].values if t in more["time"].values]
    for name in ("q", "v", "a"):
        assert np.array_equal(plain[name].sel(time=common).values, more[name].sel(time=common).values)
    return len(common)
