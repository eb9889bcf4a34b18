"""Springs and friction of a scenario by their kind, and those that start off."""

import numpy as np
import pytest
from wheel import INERTIA, wheel_text, wheel_urdf

from antenna_pin import RunSettings, build_system, load_scenario, simulate
from antenna_pin.dynamics import SineDrive, System, Workspace, audit
from antenna_pin.elements import (
    SPRINGS,
    BoucWen,
    ConstantSpring,
    JointFriction,
    JointSpring,
    MaxwellSlip,
    Motor,
    PointSpring,
    TableSpring,
)
from antenna_pin.errors import AntennaPinError
from antenna_pin.mechanism import build_mechanism
from antenna_pin.studies.linear import modes

STIFFNESS = 2.0
SCENARIO = """format = 1
duration = "1 s"
default_case = "all"
[mechanism]
urdf = "wheel.urdf"
base = "fixed"
[initial.joints.axle]
rate = "1 rad/s"
[integrator]
rtol = 1e-12
[cases.all]
"""


TABLE = {"joint": "axle", "angle": (-0.7, -0.2, 0.1, 0.5), "torque": (3.0, 1.0, -0.5, -4.0)}
CONSERVATIVE = {
    "spring": JointSpring(joint="axle", stiffness=5.0, rest_angle=0.25),
    "constant up to an angle": ConstantSpring(joint="axle", torque=0.5, upper=0.3, ramp=0.25),
    "constant down to an angle": ConstantSpring(joint="axle", torque=-0.5, lower=-0.3, ramp=0.25),
    "constant between angles": ConstantSpring(joint="axle", torque=0.5, lower=-0.6, upper=0.3, ramp=0.25),
    "cogging": Motor(joint="axle", value=0.0, torque_constant=0.5, resistance=2.0, cogging=0.25, cycles=3),
    "Bouc-Wen": BoucWen(joint="axle", alpha=0.25, stiffness=4.0, yield_angle=0.5, rest_angle=0.1),
    "Maxwell slip": MaxwellSlip(joint="axle", stiffness=(2.0, 8.0), slip=(10.0, 20.0)),
} | {
    f"{kind} table, {outside}": TableSpring(interpolation=kind, outside=outside, **TABLE)
    for kind in ("cubic", "linear")
    for outside in ("hold", "extend", "refuse")
}


@pytest.mark.parametrize("name", CONSERVATIVE)
def test_at_rest_a_spring_pulls_with_the_slope_of_its_energy(name):
    """Everywhere: on its table and beyond it, in its ramps, on either side of where it is at rest."""
    mechanism = build_mechanism(wheel_urdf("revolute"), "fixed")
    family = {"cogging": "drives"}.get(name, "springs")
    system = System(mechanism, **{family: {"axle": CONSERVATIVE[name]}})
    workspace, rates, step = Workspace(system), np.zeros(1 + system.manifold.nx), 1e-4
    angles = np.linspace(-1.507, 1.501, 95)  # none within a step of a kink

    def energy(angle):
        return audit(workspace, system.state(np.array([angle]), np.zeros(1))).springs

    torque = np.zeros(len(angles))
    for k, angle in enumerate(angles):
        workspace.apply_elements(0.0, system.state(np.array([angle]), np.zeros(1)), rates)
        torque[k] = workspace.tau[0]
    slope = np.array([energy(angle + step) - energy(angle - step) for angle in angles]) / (2.0 * step)
    assert np.abs(torque).max() > 0.0
    # The differences are off by the step's square.
    np.testing.assert_allclose(torque, -slope, rtol=0, atol=1e-6 * np.abs(torque).max())


@pytest.fixture
def wheel(tmp_path):
    (tmp_path / "wheel.urdf").write_text(wheel_text("revolute"))
    (tmp_path / "scenario.toml").write_text(SCENARIO)

    def made(*overrides):
        return load_scenario(tmp_path / "scenario.toml", overrides=overrides)

    return made


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize(
    "table",
    [
        f"springs.axle={{stiffness={STIFFNESS}, on=false}}",
        "springs.axle={kind='friction', friction=0.2, on=false}",
        "springs.coil={first={link='world', point=[0, 1, 0]}, second={link='wheel', point=[1, 0, 0]},"
        " free_length=0.1, stiffness=3, damping=1, on=false}",
        "drives.axle={kind='sine', amplitude=3, frequency=2, on=false}",
        "drives.axle={kind='pd', kp=3, kd=1, on=false}",
    ],
)
def test_what_is_off_does_nothing(wheel, table, engine):
    run = simulate(wheel(table), settings=RunSettings(engine=engine, rtol=1e-10), duration="0.5 s")
    np.testing.assert_allclose(run.data["motion_rate"], 1.0, rtol=0, atol=1e-15)
    assert modes(wheel(table)).frequency == pytest.approx(0.0, abs=1e-9)  # of no stiffness, nothing swings


def test_every_kind_is_reached_by_its_name(wheel):
    """Those without ends at the joint of their name; ends, without a kind, tell one between points."""
    ends = "first={link='world', point=[0, 1, 0]}, second={link='wheel', point=[1, 0, 0]}, free_length=0.1"
    for kind, given, made in (
        ("spring", "damping=0.3", JointSpring(joint="axle", damping=0.3)),
        ("friction", "damping=0.3", JointFriction(joint="axle", damping=0.3)),
        ("between-points", f"damping=0.3, {ends}", None),
        ("", "damping=0.3", JointSpring(joint="axle", damping=0.3)),
        ("", f"damping=0.3, {ends}", None),
    ):
        named = f"kind='{kind}', " if kind else ""
        spring = build_system(wheel(f"springs.axle={{{named}{given}}}")).springs["axle"]
        assert spring == made if made else isinstance(spring, PointSpring)
    others = {"bouc-wen", "maxwell-slip", "constant-torque", "table", "harness"}
    assert set(SPRINGS) == {"spring", "friction", "between-points", *others}


def test_friction_brings_the_wheel_to_rest(wheel):
    """After I w / T, rounded off at speeds of w_r: the closed form of u / sqrt(1 + u^2) is its root."""
    run = simulate(wheel("springs.axle={kind='friction', friction=0.7, regularisation_speed=1e-2}"))
    time, rate = run.data["time"].values, run.data["motion_rate"].values[:, 0]
    small, decay = 1e-2, 0.7 / INERTIA

    def clock(speed):  # time from there to rest but for the last logarithm's constant
        root = np.sqrt(speed**2 + small**2)
        return (root + small * np.log(speed / (small + root))) / decay

    fast = rate > 0.1  # nearer to rest the rate's own error of 1e-12 counts for more and more time
    np.testing.assert_allclose((clock(1.0) - clock(rate))[fast], time[fast], rtol=0, atol=1e-10)
    assert 0.0 < rate[-1] < 1e-6


@pytest.mark.parametrize(
    ("table", "says"),
    [
        (
            "springs.axle={kind='fricton', friction=1}",
            "must be one of spring, friction, between-points, bouc-wen",
        ),
        ("springs.axle={kind='friction'}", "springs.axle must have a friction or a damping above zero"),
        ("springs.axle={kind='friction', stiffness=1}", "springs.axle.stiffness is unknown"),
        ("springs.axle={stiffness=1, on='maybe'}", "springs.axle.on must be true or false, got 'maybe'"),
        ("springs.axle={kind='spring', stiffness=1, first={link='world'}}", "springs.axle.first is unknown"),
        ("springs.s={kind='between-points', stiffness=1, joint='axle'}", "must be left out with first and"),
        ("drives.axle={kind='motion', rate=1, on=false}", "drives.axle.on is unknown"),
    ],
)
def test_refusals(wheel, table, says):
    with pytest.raises(AntennaPinError, match=says):
        build_system(wheel(table))


def test_a_prescribed_motion_cannot_be_switched_off(wheel):
    """It was held all the same, in silence."""
    off = "events.off={kind='time', time=0.5, action='set', set='drives.axle.on', to=false}"
    with pytest.raises(AntennaPinError, match=r"events.off.set sets 'on', which is unknown"):
        wheel("drives.axle={kind='motion', rate=1}", off)


def test_on_is_true_or_false():
    with pytest.raises(AntennaPinError, match="SineDrive: on must be true or false, got 1"):
        SineDrive(joint="axle", amplitude=1.0, frequency=1.0, on=1)
    with pytest.raises(AntennaPinError, match="JointSpring: shorter_way must be true or false, got 'yes'"):
        JointSpring(joint="axle", stiffness=1.0, shorter_way="yes")
