"""Contact too stiff for explicit steps, by the implicit method: the same runs, at a fraction of the steps."""

import json

import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.errors import StiffRunWarning
from antenna_pin.trajectory import Outcome

LUGRE = (
    '{replace=true, law="lugre", static=0.2, dynamic=0.15, stribeck_speed=0.01, bristle_stiffness=1e6, '
    "bristle_damping=1e3}"
)
STEEP = '{replace=true, law="tanh", coefficient_of_friction=0.15, transition_speed=1e-5}'


def damped(damping):
    return f'{{replace=true, law="kelvin-voigt", stiffness=1e8, damping={damping}}}'


def hanging(case, method, engine="pinocchio", *, friction=STEEP, damping=1e5, rtol=1e-6, limit=1e9):
    """The bar laid into the bore at 10 degrees: it sinks in, and begins to swing down against friction."""
    changes = {
        "clearance.hinge.geometry": "closed-form",
        "clearance.hinge.normal": damped(damping),
        "clearance.hinge.friction": friction,
        "initial.joints.hinge.angle": "10 deg",
        "integrator.engine": engine,
        "integrator.method": method,
        "integrator.rtol": rtol,
        "integrator.max_steps": int(limit),
    }
    sets = [f"{key}={value}" for key, value in changes.items()]
    return simulate(load_scenario("pendulum", case=case, overrides=sets), duration=0.02)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("friction", [LUGRE, STEEP], ids=["bristles", "steep"])
@pytest.mark.parametrize("case", ["planar-rest", "rest"])
def test_stiff_contact_as_by_explicit_steps(case, friction, engine):
    """Rates of decay of 5e4 to 3e5 /s, where explicit steps still get through."""
    stiff = hanging(case, "radau5", engine, friction=friction)
    plain = hanging(case, "dormand-prince-54", friction=friction, rtol=1e-9)
    assert stiff.completed and plain.completed
    ours, theirs = (run.data for run in (stiff, plain))
    # The tolerance, 1e-6 of 1 rad and of a play of 0.1 mm, over a motion of 1e-3 rad.
    assert ours.motion_angle.values[-1] == pytest.approx(theirs.motion_angle.values[-1], abs=1e-10)
    assert ours.q.values[-1] == pytest.approx(theirs.q.values[-1], abs=1e-10)
    assert ours.normal_impulse.values[-1] == pytest.approx(theirs.normal_impulse.values[-1], rel=1e-6)
    assert 6 * stiff.counts.accepted < plain.counts.accepted
    kept = json.loads(ours.attrs["conservation"])
    assert kept["energy_error"] < 1e-9  # [J]; 1e-6 of what the bar has swung down by


def test_contact_so_stiff_that_explicit_steps_collapse():
    """A damping of 1e9 N s/m on 2 kg: a rate of 5e8 /s. What is left is a crawl, of 0.3 s time constant."""
    stiff = hanging("rest", "radau5", damping=1e9)
    assert stiff.completed and stiff.counts.evaluations < 10_000
    finer = hanging("rest", "radau5", damping=1e9, rtol=1e-8)
    assert stiff.data.q.values[-1] == pytest.approx(finer.data.q.values[-1], abs=1e-8)
    with pytest.warns(StiffRunWarning, match="joint 'hinge' under contact hinge.radial"):
        # Looks go by the clock at first: on a machine that is busy the second comes after 1500 steps.
        collapsed = hanging("rest", "dormand-prince-853", damping=1e9, limit=6000)
    assert collapsed.outcome is Outcome.STEP_LIMIT
    assert collapsed.data.time.values[-1] < 4e-4


def test_what_collapses_is_told_of_the_implicit_method():
    for outcome in (Outcome.STEP_TOO_SMALL, Outcome.NO_PROGRESS):
        assert "integrator.method = 'radau5'" in outcome.value


@pytest.mark.parametrize(("case", "duration"), [("ideal", 0.012), ("planar", 0.002)])
def test_closed_loops_by_implicit_steps(case, duration):
    """The loop is brought onto its closures at each step's end, as with the other methods."""
    runs = []
    for method, engine in (
        ("radau5", "compiled"),
        ("radau5", "pinocchio"),
        ("dormand-prince-853", "pinocchio"),
    ):
        sets = [f"integrator.method={method}", f"integrator.engine={engine}"]
        if case != "ideal":
            sets.append("clearance.pin.geometry=closed-form")
        runs.append(simulate(load_scenario("slider_crank", case=case, overrides=sets), duration=duration))
    compiled, ours, theirs = runs
    assert compiled.data.q.values[-1] == pytest.approx(ours.data.q.values[-1], abs=1e-10)
    assert ours.data.q.values[-1] == pytest.approx(theirs.data.q.values[-1], abs=1e-7)
    for run in (compiled, ours):
        assert run.constraints["position_residual"] < 1e-13
