"""Rotors of motors against closed forms: reflected inertia, a free base, gyroscopic torque."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from antenna_pin import RunSettings, System, Urdf, build_mechanism, build_system, load_scenario, simulate
from antenna_pin.dynamics import assembled
from antenna_pin.elements import ConstantDrive
from antenna_pin.errors import AntennaPinError
from antenna_pin.mechanism import Rotor, with_rotor

TEXT = """<robot name="r"><link name="base"><inertial><mass value="2"/>
<inertia ixx="0.2" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><origin xyz="{at}" rpy="{turned}"/>
<axis xyz="0 0.6 0.8"/></joint>
<link name="arm"><inertial><mass value="1"/>
<inertia ixx="0.05" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
#: Moments of inertia of base, arm and rotor [kg m^2], and the ratio.
BASE, ARM, ROTOR, RATIO = 0.2, 0.05, 1e-3, 30.0
AXIS = np.array([0.0, 0.6, 0.8])


def _system(base: str, at: str = "0 0 0", turned: str = "0 0 0", *, torque: float = 0.0, **more) -> System:
    urdf = Urdf.from_text(TEXT.format(at=at, turned=turned), "r.urdf")
    rotor = Rotor(**{"joint": "j", "inertia": ROTOR, "ratio": RATIO, **more})
    drives = {"motor": ConstantDrive(joint="j", value=torque)} if torque else {}
    return System(build_mechanism(with_rotor(urdf, "m", rotor), base, (0, 0, 0)), drives=drives)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@pytest.mark.parametrize(("carrier", "turns"), [("parent", RATIO), ("child", RATIO + 1.0)])
def test_on_a_fixed_base_a_joint_feels_ratio_squared(engine: str, carrier: str, turns: float) -> None:
    """tau = (I + r^2 J) q'': on the child the rotor turns by one more."""
    system, torque = _system("fixed", torque=0.7, carrier=carrier), 0.7
    run = simulate(system, duration=0.5, settings=RunSettings(rtol=1e-11, engine=engine))
    expected = torque / (ARM + turns**2 * ROTOR)
    assert run.data.a.values[:, 0] == pytest.approx(expected, rel=1e-12)
    assert np.abs(run.data.energy_error).max() < 1e-12


@pytest.mark.parametrize("ratio", [RATIO, -RATIO])
def test_a_free_base_turns_back_by_the_ratio(ratio: float) -> None:
    """(B + I + J) w + (I + r J) q' = 0 about the axis: a rotor that turns back may turn the base forward."""
    run = simulate(_system("free", torque=0.3, ratio=ratio), duration=1.0, settings=RunSettings(rtol=1e-12))
    rate, spin = run.data.v.values[-1, 6], run.data.v.values[-1, 3:6]
    expected = -(ARM + ratio * ROTOR) / (BASE + ARM + ROTOR) * rate
    assert spin == pytest.approx(expected * AXIS, rel=1e-10, abs=1e-12)
    # The torque of the joint works on all: the reduced inertia.
    whole = ARM + ratio**2 * ROTOR - (ARM + ratio * ROTOR) ** 2 / (BASE + ARM + ROTOR)
    assert rate == pytest.approx(0.3 / whole, rel=1e-10)
    assert np.abs(run.data.angular_momentum).max() < 1e-11


def test_a_base_with_a_spun_rotor_precesses() -> None:
    """A body of equal moments, and the rotor's spin: w across the axis turns at a constant rate.

    With h along the axis a and C across, in the base: C w' = (h - C w_a) a x w.
    """
    system = _system("free")
    q, across = system.neutral(), np.array([0.3, 0.0, 0.0])
    start = np.zeros(system.model.nv)
    start[3:6] = across + 0.2 * AXIS
    # The joint is held by what it is geared to only: spun with the arm, all about the same axis.
    start[6] = 2.0
    q, v = assembled(system, q, start, held=("base", "j"))
    run = simulate(system, q=q, v=v, duration=3.0, settings=RunSettings(rtol=1e-12, output_rate=20.0))
    across_moment = BASE + ARM
    spin = ARM * (0.2 + 2.0) + ROTOR * (0.2 + RATIO * 2.0) + BASE * 0.2 - across_moment * 0.2
    # Both moments across are equal: w_perp turns about the axis at spin / C, seen from the base.
    turn = spin / across_moment
    t, w = run.data.time.values, run.data.v.values[:, 3:6]
    other = np.cross(AXIS, across)
    expected = np.outer(np.cos(turn * t), across) - np.outer(np.sin(turn * t), -other) + 0.2 * AXIS
    assert np.abs(w - expected).max() < 1e-9
    momentum = run.data.angular_momentum.values
    assert np.abs(momentum - momentum[0]).max() < 1e-10 * np.abs(momentum).max()


@pytest.mark.parametrize("carrier", ["parent", "child"])
def test_engines_agree_and_keep_momentum(carrier: str) -> None:
    """Off the centre, the axis turned, tumbling."""
    system = _system("free", "0.3 0.1 0", "0.3 -0.4 1", torque=0.2, carrier=carrier, ratio=-20.0)
    start = np.array([0.1, 0.0, 0.2, 0.5, -0.4, 0.8, 1.5, 0.0])
    q, v = assembled(system, system.neutral(), start, held=("base", "j"))
    runs = [
        simulate(system, q=q, v=v, duration=2.0, settings=RunSettings(rtol=1e-11, engine=engine))
        for engine in ("compiled", "pinocchio")
    ]
    for run in runs:
        for what in ("linear", "angular"):
            momentum = run.data[f"{what}_momentum"].values
            assert np.abs(momentum - momentum[0]).max() < 1e-9 * np.abs(momentum).max()
        assert np.abs(run.data.energy_error).max() < 1e-9
        assert run.data.v.values[:, 7] == pytest.approx(-20.0 * run.data.v.values[:, 6], rel=1e-11)
    assert runs[0].data.q.values[-1] == pytest.approx(runs[1].data.q.values[-1], abs=1e-9)


def test_rotors_of_a_scenario(tmp_path: Path) -> None:
    """A table named after its joint; refusals in a line."""
    (tmp_path / "r.urdf").write_text(TEXT.format(at="0 0 0", turned="0 0 0"))
    (tmp_path / "scenario.toml").write_text(
        'format = 1\nduration = "0.1 s"\ndefault_case = "all"\n[mechanism]\nurdf = "r.urdf"\nbase = "fixed"\n'
        '[rotors.j]\ninertia = "10 g*m^2"\nratio = 30\n'
        '[drives.j]\nkind = "constant"\nvalue = 2\n[cases.all]\n'
    )
    scenario = load_scenario(tmp_path / "scenario.toml", overrides=["rotors.j.inertia=1e-3"])
    run = simulate(scenario)
    assert run.data.a.values[-1, 0] == pytest.approx(2.0 / (ARM + RATIO**2 * ROTOR), rel=1e-10)
    assert set(build_system(scenario).couplings) == {"j_rotor"}
    for more, says in (
        ("rotors.j.joint=k", "rotors.j.joint.*'k'"),
        ("rotors.j.inertia=0", "inertia must be positive"),
        ("mechanism.joints.j.kind=locked", "must be revolute or continuous, without play, got fixed"),
    ):
        with pytest.raises(AntennaPinError, match=says):
            build_system(load_scenario(tmp_path / "scenario.toml", overrides=[more]))
    assert math.isclose(scenario.rotors["j"].ratio, 30.0)
    plain = ["rotors.j.inertia=1e-3", "rotors.j.kind=armature"]
    system = build_system(load_scenario(tmp_path / "scenario.toml", overrides=plain))
    assert not system.couplings
    assert system.model.armature == pytest.approx([RATIO**2 * ROTOR], rel=1e-14)
    with pytest.raises(AntennaPinError, match="carrier must be parent for armature, got 'child'"):
        load_scenario(tmp_path / "scenario.toml", overrides=[*plain, "rotors.j.carrier=child"])


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_armature_is_felt_by_the_joint_alone(engine: str) -> None:
    """tau = (I + r^2 J) q'' at rest of the base; free, the base turns as if there were no rotor at all."""
    reflected, torque = RATIO**2 * ROTOR, 0.7
    urdf = Urdf.from_text(TEXT.format(at="0 0 0", turned="0 0 0"), "r.urdf")
    drives = {"motor": ConstantDrive(joint="j", value=torque)}
    settings = RunSettings(rtol=1e-11, engine=engine)
    fixed = System(build_mechanism(urdf, "fixed", armature={"j": reflected}), drives=drives)
    run = simulate(fixed, duration=0.5, settings=settings)
    assert run.data.a.values[:, 0] == pytest.approx(torque / (ARM + reflected), rel=1e-12)
    exact = simulate(_system("fixed", torque=torque), duration=0.5, settings=settings)
    # On a base that stands still both are one; round-off of the correction of the rotor's angle.
    assert run.data.motion_angle.values[:, 0] == pytest.approx(
        exact.data.motion_angle.values[:, 0], rel=1e-11
    )
    assert float(run.data.kinetic_energy[-1]) == pytest.approx(
        float(exact.data.kinetic_energy[-1]), rel=1e-11
    )
    assert np.abs(run.data.energy_error).max() < 1e-12
    free = System(build_mechanism(urdf, "free", armature={"j": reflected}), drives=drives)
    run = simulate(free, duration=0.5, settings=settings)
    # (B + I) w + I q' = 0 and I (w + q') + r^2 J q' = tau t about the axis.
    rate, spin = run.data.v.values[-1, 6], run.data.v.values[-1, 3:6]
    assert rate == pytest.approx(0.5 * torque / (ARM + reflected - ARM**2 / (BASE + ARM)), rel=1e-10)
    assert spin == pytest.approx(-ARM / (BASE + ARM) * rate * AXIS, rel=1e-10, abs=1e-12)
    # What is kept is the links' momentum; the rotor has none.
    assert np.abs(run.data.angular_momentum).max() < 1e-11
    assert np.abs(run.data.energy_error).max() < 1e-10


@pytest.mark.parametrize(("name", "value", "says"), [("k", 1.0, "'k'|k"), ("j", -1.0, "zero or more.*-1")])
def test_bad_armature_is_refused(name: str, value: float, says: str) -> None:
    urdf = Urdf.from_text(TEXT.format(at="0 0 0", turned="0 0 0"), "r.urdf")
    with pytest.raises(AntennaPinError, match=says):
        build_mechanism(urdf, "fixed", armature={name: value})
