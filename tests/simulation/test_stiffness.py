"""Explicit steps that stability holds short are told of, soon, by name; those that are needed are not."""

import warnings

import pytest

from antenna_pin import Outcome, RunSettings, System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.elements import CallableDrive, ConstantDrive, JointFriction, JointSpring, PDController
from antenna_pin.errors import StiffRunWarning
from antenna_pin.trajectory import Trajectory

FINGER = """<robot name="finger">
<link name="palm"><inertial><mass value="0.5"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="arm" type="continuous"><parent link="palm"/><child link="middle"/><axis xyz="0 1 0"/></joint>
<link name="middle"><inertial><origin xyz="0 0 0.1"/><mass value="0.5"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><origin xyz="0 0 0.2"/>
<parent link="middle"/><child link="finger"/><axis xyz="0 1 0"/></joint>
<link name="finger"><inertial><origin xyz="0 0 0.02"/><mass value="0.03"/>
<inertia ixx="1e-5" iyy="1e-5" izz="5e-6" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def finger(base="free", **elements):
    mechanism = build_mechanism(Urdf.from_text(FINGER, "finger.urdf"), base=base)
    drives = {name: one for name, one in elements.items() if hasattr(one, "axis")}
    return System(mechanism, drives=drives, springs={n: e for n, e in elements.items() if n not in drives})


STIFF = {
    "spring 'hinge'": JointFriction(joint="j", damping=3.0, friction=10.0),
    "spring 'coil'": JointSpring(joint="j", stiffness=1e7, damping=3.0),
    "drive 'servo'": PDController(joint="j", kp=20.0, kd=5.0, angle=0.1),
    "drive 'own'": CallableDrive(joint="j", torque=lambda t, angle, rate: -5.0 * rate),
}


def stiff(what, duration, **settings):
    name = what.split("'")[1]
    push = ConstantDrive(joint="arm", value=0.01)
    system = finger(**{name: STIFF[what], "push": push})
    v = [0.0] * 6 + [0.5, 0.0]
    return simulate(system, duration=duration, v=v, settings=RunSettings(**settings))


@pytest.mark.parametrize("what", STIFF)
@pytest.mark.parametrize(
    ("engine", "method"),
    [
        ("pinocchio", "dormand-prince-853"),
        ("compiled", "dormand-prince-54"),
    ],
)
def test_what_is_stiff_is_told_soon_and_by_name(what, engine, method):
    """Within four batches of steps, which take some tenths of a second; and the advice is good."""
    if engine == "compiled" and what == "drive 'own'":
        engine = "pinocchio"
    with pytest.warns(StiffRunWarning) as told:
        run = stiff(what, 20.0, engine=engine, method=method, max_steps=4096, rtol=1e-6)
    told = [one for one in told if one.category is StiffRunWarning]  # a busy machine is told of besides
    assert len(told) == 1
    assert run.outcome is Outcome.STEP_LIMIT
    for part in (
        f"the motion of joint 'j' under {what}",
        f"steps of {method}",
        "integrator.method = 'radau5'",
    ):
        assert part in str(told[0].message) and part in run.advice and part in run.message
    reached = float(run.data.end_time)
    implicit = stiff(what, reached, engine=engine, method="radau5", rtol=1e-6)
    assert implicit.completed and implicit.counts.evaluations < 0.25 * run.counts.evaluations


def test_a_run_that_comes_to_its_end_all_the_same_keeps_the_advice(tmp_path):
    with pytest.warns(StiffRunWarning):
        run = stiff("spring 'coil'", 0.3, engine="compiled")
    assert run.outcome is Outcome.COMPLETED and run.message == Outcome.COMPLETED.value
    assert Trajectory.load(run.save(tmp_path / "run.nc")).advice == run.advice != ""


def test_what_swings_visibly_needs_its_steps():
    """Undamped, at 2 kHz, for 4000 periods and more: no method is better at that, and nothing is told."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = simulate(
            finger(base="fixed", coil=JointSpring(joint="j", stiffness=3e3)),
            duration=4.0,
            v=[0.0, 1.0],
            settings=RunSettings(engine="compiled", rtol=1e-6, max_steps=20_000),
        )
    assert run.outcome is Outcome.STEP_LIMIT and not run.advice


@pytest.mark.parametrize(
    ("name", "case"),
    [
        ("bai2020", "case3"),
        ("you2010", None),
        ("slider_crank", None),
        ("pendulum", None),
        ("impact_pair", None),
    ],
)
def test_shipped_runs_raise_no_alarm(name, case):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = simulate(load_scenario(name, case=case, overrides=["integrator.max_steps=2500"]))
    assert not run.advice
