"""Derivatives of rates under closures, motions, couplings and held joints: as differences of the whole."""

import numpy as np
import pytest
from branches import closed
from coupled import Coupled
from displacements import TIME, ways_of, with_numbers

from antenna_pin import RunSettings, build_system, load_scenario
from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.dynamics import JointSpring, Workspace
from antenna_pin.dynamics.constraints import CLOSURES
from antenna_pin.elements import PrescribedMotion
from antenna_pin.run.engine import Slopes, Tangents
from antenna_pin.studies.nonlinear import flow_of
from antenna_pin.studies.nonlinear.chart import set_modes
from antenna_pin.studies.nonlinear.vector_field import VectorField

STEPS = 10.0 ** np.arange(-1.0, -4.5, -0.5)
CLOSE, NOTHING = 1e-8, 1e-11
"""Of a column's largest and of the largest of all: what differences of the whole, of the best of steps, are
good to."""
MOVED = {
    "drives": {
        "turn": PrescribedMotion(joint="j2", amplitude=0.3, frequency=1.7),
        "slide": PrescribedMotion(joint="j5", amplitude=0.05, frequency=0.9),
    },
    "springs": {"turn": JointSpring(joint="j6", stiffness=50.0, damping=2.0)},
}


def of_whole(field, y, ways):
    """Return derivatives by differences of the whole, each column by the step whose orders agree best."""
    whole = Slopes(field._stepper, field.bristles, WEIGHTS)
    tried = [whole.rates(TIME, y, ways, np.full(ways.shape[1], step)) for step in STEPS]
    out = np.zeros_like(tried[0][0])
    for block in (slice(field.system.model.nv), slice(field.system.model.nv, None)):
        off = [np.abs(one[0, block] - one[1, block]).max(axis=0, initial=0.0) for one in tried]
        for k, best in enumerate(np.argmin(off, axis=0).tolist()):
            out[block, k] = tried[best][0, block, k]
    return out


def judge(system, y, field=None):
    """Return the largest deviation from differences of the whole, over what is asked."""
    field = field or VectorField(system, RunSettings(engine="compiled"))
    assert Tangents.takes(system)
    ways = ways_of(field)
    parts = Tangents(system, field._stepper, np.concatenate(field.units), WEIGHTS)
    both = parts.rates(TIME, y, ways, np.full(ways.shape[1], 1e-4))
    right, worst = of_whole(field, y, ways), 0.0
    for block in (field._weighed, lambda rates: rates[system.model.nv :]):
        wanted = np.abs(block(right))
        asked = CLOSE * wanted.max(axis=0, initial=0.0) + NOTHING * wanted.max(initial=1e-300)
        for found in both:
            worst = max(worst, (np.abs(block(found - right)) / asked).max(initial=0.0))
    return worst


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("to", ["b3", "world"])
@pytest.mark.parametrize("kind", CLOSURES)
def test_loops_change_as_the_whole_does(kind, to, count):
    """Of all closures, on bodies and on the world, alone and twice, of which one is redundant then."""
    assert judge(*closed(kind, 3, to=to, count=count)) < 1.0


@pytest.mark.parametrize("kind", ["spherical", "universal"])
def test_motions_change_as_the_whole_does(kind):
    """Of joints that turn and slide; the works of their drives too."""
    assert judge(*closed(kind, 4, **MOVED)) < 1.0


def test_a_driven_twist_changes_as_the_whole_does():
    """The row of a motion at a joint with play is its twist's gradient: swung far, and touching nothing."""
    drive = {"replace": True, "kind": "motion", "joint": "elevation", "amplitude": 0.3, "frequency": 2.0}
    overrides = {"clearance.elevation.geometry": "closed-form", "drives.elevation": drive}
    system = build_system(load_scenario("bai2020", case="case3", overrides=overrides))
    rng, workspace = np.random.default_rng(0), Workspace(system)
    y = system.state(system.neutral(), rng.normal(size=system.model.nv))
    workspace.retract(y, 0.5 * rng.normal(size=system.model.nv))
    assert judge(system, y) < 1.0


@pytest.mark.parametrize("base", ["free", "fixed"])
@pytest.mark.parametrize("seed", range(3))
def test_couplings_change_as_the_whole_does(seed, base):
    """Their rows are constant: what changes is what the tree does with them."""
    found = Coupled(seed, base, springs={"s": JointSpring(joint="j2", stiffness=7.0, damping=0.3)})
    assert judge(found.system, found.random_state(np.random.default_rng(seed))) < 1.0


def test_both_engines_have_the_same_derivatives():
    """Mass matrix and rows are compiled for both: bit for bit."""
    system, y = closed("universal", 4, **MOVED)
    found = []
    for engine in ("compiled", "pinocchio"):
        field = VectorField(system, RunSettings(engine=engine))
        ways = ways_of(field)
        found.append(field._tangents.rates(TIME, y, ways, np.full(ways.shape[1], 1e-4)))
    assert np.array_equal(*found)


def test_joints_that_are_held_change_as_the_whole_does():
    """Of a wing whose latches hold two of four hinges, and let two go; free, so that all of it moves."""
    overrides = {
        "mechanism.base": "free",
        "initial.joints.root.angle": 0.0,
        "initial.joints.first.angle": -1.5,
        "initial.joints.second.angle": 0.0,
        "initial.joints.third.angle": -1.5,
        **{f"gears.{name}.on": False for name in ("root_first", "first_second", "second_third")},
    }
    flow, start = flow_of(load_scenario("solar_array", case="rigid-latches", overrides=overrides))
    field = VectorField(flow.system, RunSettings(engine="compiled"))
    set_modes(field.workspace, start)
    assert np.count_nonzero([one.holds(field.workspace.program) for one in field.memory.numbers]) == 2
    y, nv = start.y.copy(), flow.system.model.nv
    speeds = np.random.default_rng(0).normal(size=nv)
    speeds[[6, 8]] = 0.0
    y[flow.system.model.nq :][:nv] = speeds
    assert judge(flow.system, y, field) < 1.0


LOOPED = {
    "mechanism.base": "free",
    "mechanism.gravity": [1.0, 2.0, -3.0],
    "mechanism.links.inner.mass": 3.0,
    "mechanism.links.inner.centre_of_mass": [0.1, 0.02, -0.03],
    "mechanism.joints.second.origin_xyz": [0.1, 0.2, 0.3],
    "mechanism.joints.second.origin_rpy": [0.3, 0.1, 0.2],
    "couplings.first": {"leader": "root", "second": "third", "multiplier": -1.7, "second_multiplier": 0.3},
    "closures.tip": {
        "kind": "universal",
        "first": {"link": "world", "point": [0.1, 0.2, 0.3], "axis": [1.0, 2.0, 3.0]},
        "second": {"link": "outer", "point": [0.2, 0.1, 0.3], "axis": [3.0, 0.0, 1.0]},
    },
    "closures.brace": {
        "kind": "planar",
        "first": {"link": "inner", "point": [0.1, 0.3, 0.2], "axis": [1.0, 2.0, 3.0]},
        "second": {"link": "world", "point": [0.3, 0.1, 0.3], "axis": [3.0, 0.0, 1.0]},
    },
    "drives.root": {"kind": "motion", "joint": "root", "amplitude": 0.3, "frequency": 1.3, "rate": 0.2},
}
NUMBERS = [
    "couplings.first.multiplier",
    "couplings.first.second_multiplier",
    "closures.tip.first.point[0]",
    "closures.tip.first.axis[1]",
    "closures.tip.second.point[2]",
    "closures.tip.second.axis[0]",
    "closures.brace.first.point[1]",
    "closures.brace.first.axis[0]",
    "closures.brace.second.point[0]",
    "closures.brace.second.axis[2]",
    "drives.root.amplitude",
    "drives.root.frequency",
    "mechanism.gravity[1]",
    "mechanism.links.inner.mass",
    "mechanism.links.inner.centre_of_mass[2]",
    "mechanism.joints.second.origin_xyz[0]",
    "mechanism.joints.second.origin_rpy[2]",
    "springs.third.stiffness",
]


def test_rates_change_over_numbers_of_constraints_as_the_whole_does():
    """Ratios, frames of closures on bodies and on the world, motions; masses and places in loops."""
    scenario = load_scenario("solar_array", case="uncoupled", overrides=LOOPED)
    system, numbers = with_numbers(scenario, NUMBERS)
    field, rng = VectorField(system, RunSettings(engine="compiled"), numbers), np.random.default_rng(0)
    nv = system.model.nv
    y = system.state(system.neutral(), 0.3 * rng.normal(size=nv))
    field.workspace.retract(y, 0.3 * rng.normal(size=nv))
    system.turn_on(y)
    assert field._by_parts
    ways = np.eye(field.displacement)[:, field.parts[-3]]
    both = field._tangents.rates(TIME, y, ways, np.full(len(NUMBERS), 1e-4))
    nothing = NOTHING * np.abs(both).max()
    for k, way in enumerate(np.eye(len(NUMBERS))):
        tried = [field._near.over_numbers(TIME, y, way, step) for step in STEPS]
        for block in (slice(nv), slice(nv, None)):
            sixth, _ = min(tried, key=lambda two: np.abs(two[0][block] - two[1][block]).max())
            for found in both:
                off = np.abs(found[block, k] - sixth[block]).max()
                assert off < CLOSE * np.abs(sixth[block]).max() + nothing, NUMBERS[k]
