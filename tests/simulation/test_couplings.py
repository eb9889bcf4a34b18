"""Coupled joints over time: fewer coordinates, closed forms, what is kept, both engines; from files."""

import json
import math
import pickle
import re

import numpy as np
import pytest
from coupled import Coupled
from scipy.integrate import solve_ivp

from antenna_pin import (
    Coupling,
    RunSettings,
    System,
    Trajectory,
    Urdf,
    build_mechanism,
    load_scenario,
    simulate,
)
from antenna_pin.analysis import coupling_loads, quantity
from antenna_pin.errors import AntennaPinError

ENGINES = ("pinocchio", "compiled")
G = 9.81

PENDULUMS = """<robot name="pendulums"><link name="base"/>
<joint name="lead" type="continuous"><parent link="base"/><child link="long"/><axis xyz="0 1 0"/></joint>
<link name="long"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="follow" type="revolute"><parent link="base"/><child link="short"/><origin xyz="1 0 0"/>
  <axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/>{0}</joint>
<link name="short"><inertial><origin xyz="0 0 -0.2"/><mass value="1"/>
  <inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
# About the hinges: masses times ways to the mass centres, and moments of inertia.
LONG, SHORT = (2.0 * 0.5, 0.1 + 2.0 * 0.5**2), (1.0 * 0.2, 0.02 + 1.0 * 0.2**2)
RATIO, OFFSET = -1.6, 0.3
MIMIC = f'<mimic joint="lead" multiplier="{RATIO}" offset="{OFFSET}"/>'

RACK = """<robot name="rack"><link name="base"/>
<joint name="pinion" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 1 0"/></joint>
<link name="wheel"><inertial><mass value="1"/>
  <inertia ixx="0.01" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="rack" type="prismatic"><parent link="base"/><child link="bar"/><axis xyz="0 0 1"/>
  <limit lower="-99" upper="99" effort="1" velocity="1"/></joint>
<link name="bar"><inertial><mass value="3"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def system_of(text, **parts):
    """A system on a fixed base, gravity down."""
    return System(build_mechanism(Urdf.from_text(text, "my.urdf"), "fixed", (0.0, 0.0, -G)), **parts)


def pendulums():
    """Two pendulums side by side, geared to each other."""
    return system_of(PENDULUMS.format(MIMIC))


def pendulum(t, y):
    """The same with one coordinate: (I + m^2 i) u'' = -g (s sin u + m s' sin(m u + o))."""
    torque = -G * (LONG[0] * math.sin(y[0]) + RATIO * SHORT[0] * math.sin(RATIO * y[0] + OFFSET))
    return y[1], torque / (LONG[1] + RATIO**2 * SHORT[1])


def place(system, **angles):
    """A configuration with joints at positions, each given."""
    q = system.neutral()
    for name, angle in angles.items():
        slot = system.mechanism.joint(name)
        q[slot.q] = (math.cos(angle), math.sin(angle)) if slot.kind == "continuous" else angle
    return q


SCENARIO = """
duration = "{duration}"
[mechanism]
urdf = "my.urdf"
base = "fixed"
{text}
[integrator]
engine = "{engine}"
"""


@pytest.fixture
def run(tmp_path):
    def run(text, urdf=None, engine="compiled", duration="10 ms"):
        (tmp_path / "my.urdf").write_text(urdf or PENDULUMS.format(MIMIC))
        (tmp_path / "my.toml").write_text(SCENARIO.format(text=text, engine=engine, duration=duration))
        return simulate(load_scenario(tmp_path / "my.toml"))

    return run


@pytest.mark.parametrize("engine", ENGINES)
def test_two_coupled_pendulums_are_one_with_the_sum_of_the_inertias(engine):
    """Against the equation of one coordinate at rtol 1e-12; the torque is what the short one's inertia wants.

    What counts as closed is 1e-14 of the faster joint's turn, and round-off comes to it. No energy is taken.
    """
    system = pendulums()
    q = place(system, lead=1.2, follow=RATIO * 1.2 + OFFSET)
    run = simulate(system, duration=5.0, q=q, settings=RunSettings(engine=engine, rtol=1e-12))
    data, time = run.data, run.data.time.values
    lead, follow = (data.motion_angle.sel(joint=name).values for name in ("lead", "follow"))
    one = solve_ivp(pendulum, (0.0, 5.0), (1.2, 0.0), "DOP853", time, rtol=1e-13, atol=1e-14)
    assert np.abs(lead - one.y[0]).max() < 1e-10
    assert np.abs(follow - RATIO * lead - OFFSET).max() < 1e-14 * abs(RATIO) + 1e-15
    acceleration = data.motion_acceleration.sel(joint="follow").values
    wanted = SHORT[1] * acceleration + G * SHORT[0] * np.sin(follow)
    torque = data.coupling_torque.sel(coupling="follow").values
    assert torque == pytest.approx(wanted, abs=1e-12 * np.abs(wanted).max())
    assert np.ptp(data.kinetic_energy.values) > 5.0
    assert float(np.abs(data.energy_error).max()) < 1e-11
    assert float(coupling_loads(run).peak_torque[0]) == np.abs(torque).max()


@pytest.mark.parametrize("multiplier", [0.05, -2.0])
def test_a_rack_and_its_pinion_fall_together(multiplier):
    """x = r phi: (M + J / r^2) x'' = -M g, the rack held up by J / r^2 |x''|; for small and large r."""
    gear = Coupling(follower="rack", leader="pinion", multiplier=multiplier, offset=0.2)
    system = system_of(RACK, couplings={"mesh": gear})
    run = simulate(system, duration=2.0, settings=RunSettings(engine="compiled"))
    mass, inertia, time = 3.0, 0.02 / multiplier**2, run.data.time.values
    fall = -mass * G / (mass + inertia)
    x = run.data.slide_position.sel(sliding_joint="rack").values
    assert x == pytest.approx(0.2 + 0.5 * fall * time**2, abs=1e-9 * abs(fall))
    turned = run.data.motion_angle.sel(joint="pinion").values
    # Closed is 1e-14 of the larger number in the row; corrections end where they do not halve what is left.
    closed = 2e-14 * max(1.0, abs(multiplier)) + 2.0 * np.spacing(np.abs(x).max())
    assert np.abs(multiplier * turned + 0.2 - x).max() < closed
    force = quantity(run, "coupling_torque[mesh]")
    assert force.units == "N"
    assert force.values == pytest.approx(np.full(len(time), -inertia * fall), rel=1e-11)


@pytest.mark.parametrize("seed", range(3))
def test_a_free_tree_with_couplings_keeps_momentum_and_energy(seed):
    """Torques of couplings are between parents and children: to round-off. Both engines go one way."""
    found = Coupled(seed, "free", (0.0, 0.0, 0.0))
    system = found.system
    y = found.random_state(np.random.default_rng(seed))
    nq, nv = system.model.nq, system.model.nv
    angles = {name: float(y[nq + nv + x]) for name, x in system.turn_x.items()}
    ends = []
    for engine in ENGINES:
        settings = RunSettings(engine=engine, rtol=1e-11)
        run = simulate(system, duration=1.0, q=y[:nq], v=y[nq : nq + nv], angles=angles, settings=settings)
        kept = json.loads(run.data.attrs["conservation"])
        assert kept["linear_momentum_drift_relative"] < 1e-11
        assert kept["angular_momentum_drift_relative"] < 1e-11
        assert kept["energy_error"] < 1e-10 * float(run.data.kinetic_energy[0])
        assert run.constraints["rate_residual"] < 1e-13
        ends.append(run.end.y)
    # Round-off of two ways to compute the same, grown over a second of tumbling.
    assert ends[0] == pytest.approx(ends[1], rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_gear_of_a_hundred_follows_after_millions_of_turns(run, engine):
    """At 3e7 rad the last digit is 4e-9 rad, more than what counts as closed: it is no residual."""
    text = (
        '[couplings.rack]\nleader = "pinion"\nmultiplier = 100\noffset = "10 deg"\n'
        "[initial.joints.pinion]\nposition = 3e5\nvelocity = 3\n"
    )
    found = run(text, RACK.replace("prismatic", "continuous"), engine, "1 s")
    assert found.completed
    lead, follow = (found.data.motion_angle.sel(joint=name).values for name in ("pinion", "rack"))
    assert lead[-1] == pytest.approx(3e5 + 3.0, rel=1e-15)
    assert np.abs(follow - 100.0 * lead - math.radians(10.0)).max() <= 4.0 * np.spacing(3e7)


def test_a_run_in_parts_is_the_run_in_one_and_a_file_tells_all(tmp_path):
    system = pickle.loads(pickle.dumps(pendulums()))
    q = place(system, lead=1.2, follow=RATIO * 1.2 + OFFSET)
    whole = simulate(system, duration=1.0, q=q)
    first = simulate(system, duration=0.4, q=q)
    second = simulate(system, duration=0.6, start=first.end)
    assert np.array_equal(second.end.y, whole.end.y)
    read = Trajectory.load(whole.save(tmp_path / "run.nc"))
    assert read.summary()["couplings"]["follow"]["joints"] == ["follow", "lead"]
    assert np.array_equal(read.data.coupling_torque, whole.data.coupling_torque)


@pytest.mark.parametrize(
    ("given", "lead"),
    {
        "nothing": ("", 0.0),
        "leader": ('[initial.joints.lead]\nposition = "40 deg"', math.radians(40.0)),
        "leader, turned": ("[initial.joints.lead]\nposition = 5.5", 5.5),
        "follower": ('[initial.joints.follow]\nposition = "-9 rad"', (-9.0 - OFFSET) / RATIO),
        "a guess": (
            "[initial.joints.lead]\nposition = 0.5\n[initial.joints.follow]\nposition = 7\nguess = true",
            0.5,
        ),
        "motion": ('[drives.lead]\nkind = "motion"\nposition = 7\nrate = 2', 7.0),
        "motion of the follower": ('[drives.follow]\nkind = "motion"\nposition = 1', (1.0 - OFFSET) / RATIO),
        "velocity": ("[initial.joints.lead]\nvelocity = 2", 0.0),
    }.values(),
)
def test_a_run_starts_where_what_is_given_puts_both(run, given, lead):
    found = run(given).data
    start = {name: float(found.motion_angle.sel(joint=name)[0]) for name in ("lead", "follow")}
    assert start == pytest.approx({"lead": lead, "follow": RATIO * lead + OFFSET}, rel=1e-14, abs=1e-15)
    rates = {name: float(found.motion_rate.sel(joint=name)[0]) for name in ("lead", "follow")}
    assert rates["follow"] == pytest.approx(RATIO * rates["lead"], abs=1e-15)
    assert rates["lead"] == pytest.approx(2.0 if "2" in given.split("\n")[-1] and "=" in given else 0.0)


REFUSALS = {
    "both given": (
        "[initial.joints.lead]\nposition = 0.5\n[initial.joints.follow]\nposition = 7",
        "my: initial state: the loops cannot be closed: coupling 'follow' lacks",
    ),
    "both driven": (
        '[drives.lead]\nkind = "motion"\nrate = 1\n'
        '[drives.follow]\nkind = "motion"\nposition = 0.3\nrate = -1.6',
        "my: motions 'lead', 'follow': the closures and couplings leave 1 freedoms, and 2 motions prescribe",
    ),
    "twice": (
        '[couplings.follow]\nleader = "lead"',
        "my: couplings.follow: must have another name; there is a joint with <mimic> 'follow'",
    ),
    "itself": (
        '[couplings.lead]\nleader = "lead"',
        "couplings.lead.leader must be another joint than the follower, got 'lead'",
    ),
    "units of a rack": (
        '[couplings.x]\nfollower = "lead"\nleader = "follow"\nmultiplier = "3 mm/rad"',
        "my: couplings.x.multiplier: must be a number, for 'lead' is continuous and 'follow' revolute, got "
        "units of m/rad",
    ),
    "offset of a slide": (
        '[couplings.x]\nfollower = "lead"\nleader = "follow"\noffset = "3 mm"',
        "my: couplings.x.offset: units must be those of a rotation",
    ),
    "play": (
        '[clearance.follow]\nmodel = "constraint"',
        "<mimic> of joint 'follow': follower 'follow' is floating here, and only a revolute, continuous or "
        "prismatic joint without play can follow another; take the <mimic> out by mimic = false",
    ),
    "mimic is true": (
        "[mechanism.joints.follow]\nmimic = true",
        "joint 'follow': mimic must be false, got true",
    ),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_what_cannot_be_coupled_is_said(run, case):
    text, message = REFUSALS[case]
    with pytest.raises(AntennaPinError, match=re.escape(message)):
        run(text)


def test_mimic_is_switched_off_and_locked_followers_load(run):
    assert run("[mechanism.joints.follow]\nmimic = false").constraints == {}
    locked = run('[mechanism.joints.follow]\nkind = "locked"')
    assert locked.constraints == {}
    assert locked.data.joint.values.tolist() == ["lead"]
    leader = run('[mechanism.joints.lead]\nkind = "locked"').data
    assert leader.motion_angle.sel(joint="follow").values == pytest.approx(OFFSET, abs=1e-15)


def test_units_of_a_rack_and_a_screw(run):
    text = '[couplings.rack]\nleader = "pinion"\nmultiplier = "5 mm/turn"\noffset = "-2 mm"'
    found = run(text, RACK)
    assert found.constraints["couplings"] == 1
    about = found.scenario.couplings["rack"]
    assert (about.multiplier, about.offset) == pytest.approx((0.005 / math.tau, -0.002), rel=1e-15)
    again = found.scenario.with_overrides(
        {"couplings.rack.multiplier": "1 mm/rad", "couplings.rack.offset": "1 mm"}
    )
    assert again.couplings["rack"].multiplier == pytest.approx(0.001)
