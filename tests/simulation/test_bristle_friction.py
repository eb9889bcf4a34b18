"""Friction of joints by the bristle laws of contacts, against closed forms; each law is that of contacts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from antenna_pin import RunSettings, build_system, load_scenario, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    ConstantDrive,
    DahlFriction,
    GonthierFriction,
    LuGreFriction,
    PrescribedMotion,
    StiffnessBearing,
    kernels,
    kind_of,
)
from antenna_pin.errors import AntennaPinError
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.simulation import Event, Set, Time
from antenna_pin.studies.linear import modes
from antenna_pin.trajectory import Trajectory

INERTIA, MASS = 0.5, 2.0
ONE = """<robot name="one"><link name="base"/><joint name="j" type="{type}"><parent link="base"/>
<child link="arm"/><axis xyz="{axis}"/><limit lower="-99" upper="99" effort="1e9" velocity="1e9"/></joint>
<link name="arm"><inertial><mass value="2"/>
<inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
TIGHT = RunSettings(rtol=1e-12, max_step=0.05, output_rate=100.0)
T, SIGMA = 2.0, 40.0
DAHL = DahlFriction(joint="j", coulomb=T, stiffness=SIGMA)
LUGRE = LuGreFriction(
    joint="j", coulomb=T, static=3.0, stribeck_rate=0.2, stiffness=SIGMA, damping=0.6, viscous=0.1
)
GONTHIER = GonthierFriction(
    joint="j", coulomb=T, static=3.0, stribeck_rate=0.2, stiffness=SIGMA, damping=0.6, dwell_time=0.5
)
LAWS = {"dahl": DAHL, "lugre": LUGRE, "gonthier": GONTHIER}


def _one(friction, kind="revolute", axis="0 0 1", gravity=0.0, **more) -> System:
    urdf = Urdf.from_text(ONE.format(type=kind, axis=axis), "one.urdf")
    mechanism = build_mechanism(urdf, "fixed", (0, 0, -gravity))
    return System(mechanism, elements={"frictions": {"j": friction}}, **more)


def _swept(friction, duration, engine="compiled", **motion):
    """The joint follows a motion."""
    system = _one(friction, drives={"m": PrescribedMotion(joint="j", **motion)})
    settings = RunSettings(rtol=1e-12, max_step=0.02, output_rate=100.0, engine=engine)
    begins = motion.get("rate", 0.0) + 2.0 * math.pi * motion.get("frequency", 0.0) * motion.get(
        "amplitude", 0.0
    )
    return simulate(system, v=[begins], duration=duration, settings=settings)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_dahl_s_curve_is_an_exponential_and_its_loop_has_its_area(engine):
    """It goes from -T_m by T - (T + T_m) exp(-way / delta), with T_m = T tanh(X / delta) once settled."""
    reach, swing = T / SIGMA, 0.08
    run = _swept(DAHL, 3.25, engine, amplitude=swing, frequency=1.0)
    time, q = run.data["time"].values, run.data["motion_angle"].values[:, 0]
    torque = -run.data["element_effort"].values[:, 0]
    most = T * math.tanh(swing / reach)
    up = (time > 1.75) & (time < 2.25)  # from the lower turn to the upper one, after one cycle and more
    start = torque[np.argmin(abs(time - 1.75))]
    expected = T - (T - start) * np.exp(-(q[up] + swing) / reach)
    np.testing.assert_allclose(torque[up], expected, rtol=0, atol=1e-8)
    # Each half swing brings the turning torque nearer to its last value by exp(-2 X / delta) = 1/25.
    assert start == pytest.approx(-most, abs=T * math.exp(-2.0 * swing / reach * 3.0))
    work = np.diff(run.data["drive_work"].values[np.searchsorted(time, [2.25 - 1e-9, 3.25 - 1e-9]), 0])[0]
    left = abs(start + most) * 4.0 * swing
    assert work == pytest.approx(4.0 * (T * swing - reach * most), abs=left)
    assert np.abs(run.data["energy_error"]).max() < 1e-9
    bend = run.data["bristle_bend"].values[:, 0]
    np.testing.assert_allclose(T * bend, torque, rtol=0, atol=1e-12)
    np.testing.assert_allclose(run.data["element_energy"].values[:, 0], (T * bend) ** 2 / (2.0 * SIGMA))


@pytest.mark.parametrize("shape", [1.5, 2.0, 3.0])
def test_dahl_s_curve_of_another_shape(shape):
    """From rest 1 - sigma z / T = (1 + (i - 1) way / delta)^(-1 / (i - 1))."""
    run = _swept(DahlFriction(joint="j", coulomb=T, stiffness=SIGMA, shape=shape), 1.0, rate=0.3)
    q = run.data["motion_angle"].values[:, 0]
    left = (1.0 + (shape - 1.0) * q * SIGMA / T) ** (-1.0 / (shape - 1.0))
    np.testing.assert_allclose(-run.data["element_effort"].values[:, 0], T * (1.0 - left), rtol=0, atol=1e-9)


@pytest.mark.parametrize("rate", [0.05, -0.2, 1.0])
def test_lugre_slides_on_the_stribeck_curve_that_it_comes_to_exponentially(rate):
    """At a constant rate z goes to g / sigma with the length g / sigma: sigma_1 counts with its rate."""
    run = _swept(LUGRE, 3.0, rate=rate)
    way = abs(run.data["motion_angle"].values[:, 0])
    level = T + (3.0 - T) * math.exp(-((rate / 0.2) ** 2))
    left = np.exp(-way * SIGMA / level)
    expected = level * (1.0 - left) + 0.6 * abs(rate) * left + 0.1 * abs(rate)
    torque = -run.data["element_effort"].values[:, 0] * np.sign(rate)
    np.testing.assert_allclose(torque, expected, rtol=0, atol=1e-8)
    assert np.abs(run.data["energy_error"]).max() < 1e-9


def test_gonthier_holds_the_more_the_longer_it_has_rested():
    """The dwell grows as 1 - exp(-t / tau) at rest; and friction of fast sliding is that of Coulomb."""
    rested = simulate(_one(GONTHIER), q=[0.0], v=[0.0], duration=1.0, settings=TIGHT)
    time, dwell = rested.data["time"].values, rested.data["bristle_dwell"].values[:, 0]
    np.testing.assert_allclose(dwell, 1.0 - np.exp(-time / 0.5), rtol=0, atol=1e-10)
    run = _swept(GONTHIER, 2.0, rate=2.0)  # ten times the Stribeck rate: s = exp(-100)
    assert float(run.data["element_effort"][-1, 0]) == pytest.approx(-T, rel=1e-9)
    assert np.abs(run.data["energy_error"]).max() < 1e-9


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "continuous"])
@pytest.mark.parametrize("law", list(LAWS))
def test_about_stick_it_is_a_spring_and_a_damper(law, kind):
    """Modes have the stiffness of the bristles; the decrement is that of sigma_1 + b, pulled small."""
    own = LAWS[law]
    inertia = MASS if kind == "prismatic" else INERTIA
    damping = getattr(own, "damping", 0.0) + own.viscous
    found = modes(_one(own, kind), q=[1.0, 0.0] if kind == "continuous" else [0.0])
    assert found.frequency[-1] * 2.0 * math.pi == pytest.approx(math.sqrt(SIGMA / inertia), rel=1e-8)
    assert found.damping_ratio[-1] == pytest.approx(damping / (2.0 * math.sqrt(SIGMA * inertia)), abs=1e-6)


@pytest.mark.parametrize("law", list(LAWS))
def test_it_holds_against_less_than_it_breaks_away_at(law):
    """Under half of Coulomb friction it stands, bent by T / 2 sigma; under twice the static one it goes."""
    own = LAWS[law]
    held = simulate(
        _one(own, drives={"d": ConstantDrive(joint="j", value=0.5 * T)}), duration=40.0,
        settings=RunSettings(rtol=1e-10),
    )  # fmt: skip
    # Dahl's and LuGre's go on by what slips in the first swings; bristles carry all of the torque.
    if law == "dahl":
        assert abs(float(held.data["v"][-1, 0])) < 1.0
    else:
        assert abs(float(held.data["v"][-1, 0])) < 1e-9
        assert float(held.data["bristle_bend"][-1, 0]) == pytest.approx(0.5, abs=1e-8)
    gone = simulate(_one(own, drives={"d": ConstantDrive(joint="j", value=6.0)}), duration=1.0)
    assert float(gone.data["v"][-1, 0]) > 4.0


def test_stiff_bristles_take_implicit_steps():
    """Bristles of 1e7 N m/rad settle within 0.2 us in sliding; ten implicit steps see nothing of it."""
    stiff = LuGreFriction(joint="j", coulomb=T, stiffness=1e7)
    run = simulate(
        _one(stiff), q=[0.0], v=[1.0], duration=0.2, settings=RunSettings(method="radau5", rtol=1e-8)
    )
    assert run.counts.accepted < 2000
    assert float(run.data["v"][-1, 0]) == pytest.approx(1.0 - T / INERTIA * 0.2, abs=1e-5)


def test_under_load_all_grows_alike():
    """A shaft on its thrust bearing, LuGre: T (1 + mu r m g / T) whatever the rate, and where it breaks."""
    mu, radius, g = 0.2, 0.1, 9.81
    more = {"coefficient": mu, "axial_radius": radius}
    own = LuGreFriction(joint="j", coulomb=T, stiffness=SIGMA, **more)
    factor = 1.0 + mu * radius * MASS * g / T
    drives = {"m": PrescribedMotion(joint="j", rate=0.3)}
    run = simulate(_one(own, gravity=g, drives=drives), v=[0.3], duration=2.0, settings=TIGHT)
    way = run.data["motion_angle"].values[:, 0]
    expected = -factor * T * (1.0 - np.exp(-way * SIGMA / T))
    np.testing.assert_allclose(run.data["element_effort"].values[:, 0], expected, rtol=0, atol=1e-8)
    assert np.abs(run.data["energy_error"]).max() < 1e-9
    free = simulate(_one(own, gravity=g), q=[0.0], v=[3.0], duration=0.5, settings=TIGHT)
    assert np.abs(free.data["energy_error"]).max() < 1e-9
    same = LuGreFriction(joint="j", coulomb=factor * T, stiffness=factor * SIGMA)
    other = simulate(_one(same), q=[0.0], v=[3.0], duration=0.5, settings=TIGHT)
    assert float(free.data["v"][-1, 0]) == pytest.approx(float(other.data["v"][-1, 0]), rel=1e-10)


def test_switched_off_it_keeps_its_bristles(tmp_path):
    """Off it has neither torque, nor that of its load; a result with it is read back."""
    own = DahlFriction(joint="j", coulomb=T, stiffness=SIGMA, coefficient=0.2, axial_radius=0.1)
    events = [Event(name="off", when=Time(0.2), action=Set("frictions.j.on", False))]
    run = simulate(_one(own, gravity=9.81), v=[3.0], duration=1.0, settings=TIGHT, events=events)
    time, rate = run.data["time"].values, run.data["v"].values[:, 0]
    assert np.ptp(rate[time > 0.2]) < 1e-13
    assert np.ptp(run.data["bristle_bend"].values[time > 0.2, 0]) == 0.0
    assert np.abs(run.data["energy_error"]).max() < 1e-9
    run.save(tmp_path / "run.nc")
    assert list(Trajectory.load(tmp_path / "run.nc").data["bristle"].values) == ["frictions.j"]


SCENARIO = """format = 1
duration = "0.5 s"
[mechanism]
urdf = "one.urdf"
base = "fixed"
[frictions.j]
"""
TABLES = {
    "dahl": 'kind = "dahl"\ncoulomb = "2 N*m"\nstiffness = "40 N*m/rad"\n',
    "lugre": 'kind = "lugre"\ncoulomb = "2 N*m"\nstatic = "3 N*m"\nstribeck_rate = "0.2 rad/s"\n'
    'stiffness = "40 N*m/rad"\ndamping = "0.6 N*m*s/rad"\nviscous = "0.1 N*m*s/rad"\n',
    "gonthier": 'kind = "gonthier-bristle"\ncoulomb = "2 N*m"\nstatic = "3 N*m"\n'
    'stribeck_rate = "0.2 rad/s"\nstiffness = "40 N*m/rad"\ndamping = "0.6 N*m*s/rad"\n'
    'dwell_time = "0.5 s"\n',
}


def _written(folder, law):
    (folder / "one.urdf").write_text(ONE.format(type="revolute", axis="0 0 1"))
    (folder / "scenario.toml").write_text(SCENARIO + TABLES[law])
    return folder / "scenario.toml"


@pytest.mark.parametrize("law", list(LAWS))
def test_a_scenario_has_them(tmp_path, law):
    assert build_system(load_scenario(_written(tmp_path, law))).families["frictions"]["j"] == LAWS[law]


@pytest.mark.parametrize("law", list(LAWS))
def test_it_is_the_law_of_contacts(law):
    """Its steady torque is the coefficient that the contact's law has, with torques in its place."""
    own = LAWS[law]
    run = _swept(own, 3.0, rate=0.5)
    steady = own.law.coefficient(0.5) + own.viscous * 0.5
    assert -float(run.data["element_effort"][-1, 0]) == pytest.approx(steady, rel=1e-9)
    words = own.words_of_kernel()
    assert kernels.stored_of(kind_of(type(own)), words, 0, 0.0, (np.array([0.0, 0.5, 0.0]), 0)) == (
        pytest.approx(0.125 * T * T / SIGMA, rel=1e-14)
    )


@pytest.mark.parametrize(
    ("cls", "given", "said"),
    [
        (DahlFriction, {"start": 1.5}, "start must be at most 1 in size, where bristles slip, got 1.5"),
        (DahlFriction, {"shape": 0.5}, "shape must be 1 or more, got 0.5"),
        (LuGreFriction, {"static": 1.0}, "static must be at least coulomb = 2, or left out, got 1.0"),
        (LuGreFriction, {"static": 3.0}, "stribeck_rate must be given with static above coulomb = 2"),
        (DahlFriction, {"radius": 0.1}, "radius must be left out without a coefficient"),
        (DahlFriction, {"coefficient": 0.1}, "radius must be given, or axial_radius: joint 'j' turns"),
    ],
)
def test_what_cannot_be_is_refused(cls, given, said):
    with pytest.raises(AntennaPinError, match=said):
        _one(cls(joint="j", coulomb=T, stiffness=SIGMA, **given))


def test_modes_know_no_bristles_under_load():
    own = DahlFriction(joint="j", coulomb=T, stiffness=SIGMA, coefficient=0.2, axial_radius=0.1)
    with pytest.raises(AntennaPinError, match="friction with bristles by a joint's own load is not linear"):
        modes(_one(own), q=[0.0])


def test_a_joint_on_bearings_has_no_load_that_a_row_tells():
    urdf = Urdf.from_text(ONE.format(type="revolute", axis="0 0 1"), "one.urdf").variant(joints={"j": "free"})
    own = DahlFriction(joint="j", coulomb=T, stiffness=SIGMA, coefficient=0.2, axial_radius=0.1)
    with pytest.raises(AntennaPinError, match="tells its own load; take play off it, or friction that no"):
        System(
            build_mechanism(urdf, "fixed"),
            elements={
                "bearings": {"j": StiffnessBearing(joint="j", radial=2e3, axial=1e3, tilt=5.0)},
                "frictions": {"j": own},
            },
        )
