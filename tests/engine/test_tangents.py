"""Derivatives of the rates put together from those of parts: as differences of the whole, and better."""

import importlib
from pathlib import Path

import numpy as np
import pytest
from displacements import TIME, anywhere, press, ways_of, with_numbers

from antenna_pin import RunSettings, build_system, load_scenario
from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.run.engine import Slopes, Tangents
from antenna_pin.studies.nonlinear.vector_field import VectorField

ROOT = Path(__file__).parents[2]
STEPS = 10.0 ** np.arange(-2.0, -6.5, -0.5)
"""Of differences; at finer ones the two orders agree by chance on what is round-off."""
CLOSE, NOTHING = 1e-7, 1e-9
"""Of its column and of the largest of all, in units: what differences of the whole, of the best of steps, are
good to where a contact is a millionth of a metre deep and the round-off of places 1e-17 m."""


def built(model, case, **overrides):
    return build_system(load_scenario(model, case=case, overrides=overrides))


def judge(system, seed, tilt=1.0):
    """Compare both kinds of derivatives in a state; return the largest deviation over what is asked."""
    field, y = anywhere(system, seed, tilt)
    ways = ways_of(field)
    units = np.concatenate(field.units)
    stepper = field._stepper
    whole = Slopes(stepper, field.bristles, WEIGHTS)
    parts = Tangents(system, stepper, units, WEIGHTS)
    found = parts.rates(TIME, y, ways, np.full(ways.shape[1], 1e-4))[0]
    few = [parts.rates(TIME, y, ways[:, [k]], np.full(1, 1e-4))[0, :, 0] for k in range(ways.shape[1])]
    blocks = field._weighed, lambda rates: rates[system.model.nv :]
    right = [np.zeros_like(block(found)) for block in blocks]
    least = np.full((2, ways.shape[1]), np.inf)
    for step in STEPS:
        sixth, fourth = whole.rates(TIME, y, ways, np.full(ways.shape[1], step))
        for block, wanted, best in zip(blocks, right, least, strict=True):
            off = np.abs(block(sixth - fourth)).max(axis=0, initial=0.0)
            better = off < best
            wanted[:, better], best[better] = block(sixth)[:, better], off[better]
    worst = 0.0
    for block, wanted in zip(blocks, right, strict=True):
        asked = CLOSE * np.abs(wanted).max(axis=0, initial=0.0) + NOTHING * np.abs(wanted).max(initial=1e-300)
        for one in (found, np.column_stack(few)):
            worst = max(worst, (np.abs(block(one) - wanted) / asked).max(initial=0.0))
    return worst


@pytest.mark.parametrize("number", range(8))
def test_joints_with_play_change_as_the_whole_does(number, monkeypatch):
    """Revolute, planar and spherical ones in random trees, of all laws, with drives and springs."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "check"))
    scenario = importlib.import_module("scenario_generator").draw_scenario(3, number)
    plain = {f"clearance.{name}.geometry": "closed-form" for name in scenario.clearance}
    plain |= {f"clearance.{n}.load": "point" for n, one in scenario.clearance.items() if hasattr(one, "load")}
    assert judge(build_system(scenario.with_overrides(plain)), number) < 1.0


@pytest.mark.parametrize("number", [0, 1, 9, 11, 27, 28, 33, 41, 45])
def test_elements_change_as_the_whole_does(number, monkeypatch):
    """Those of trees without rows: springs, stops, latches, bearings, bristles, gears, motors."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "check"))
    system = importlib.import_module("random_trees").drawn(0, number).system
    assert judge(system, number) < 1.0


@pytest.mark.parametrize("radius", ["14 mm", "11 mm"], ids=["covers", "within"])
@pytest.mark.parametrize("seed", [3, 5])
def test_a_flange_pressed_flat_changes_as_the_whole_does(radius, seed):
    """Its force's point goes with tilt over depth, which both are small."""
    system = built(
        "impact_pair",
        "flange",
        **{"clearance.bore.geometry": "closed-form", "clearance.bore.flange_radius": radius},
    )
    field, y = anywhere(system, seed, tilt=0.02)
    field._stepper.rates(TIME, y)
    assert field._stepper.numbers.own["arm"].any()  # the annulus presses as a whole
    assert judge(system, seed, tilt=0.02) < 1.0


def test_a_drive_at_a_joint_with_play_changes_as_the_whole_does():
    """It sees the joint's angle, and turns about an axis that the parts carry along."""
    closed = {"clearance.elevation.geometry": "closed-form"}
    assert judge(built("bai2020", "case3", **closed, **HEAVY), 1) < 1.0


@pytest.mark.parametrize("side", ["parent", "child"])
@pytest.mark.parametrize("axis", ["bearing", "journal"])
@pytest.mark.parametrize("model", ["bai2020", "slider"])
def test_what_acts_along_a_joint_with_play_changes_as_the_whole_does(model, axis, side):
    """Whichever axis it acts along, of turning and of sliding joints: axes and arms go with either part."""
    case, joint = ("case3", "elevation") if model == "bai2020" else ("rest", "slide")
    drive = {"kind": "sine", "amplitude": 3.0, "frequency": 50.0, "phase": 0.3, "axis": axis}
    spring = {"kind": "spring", "stiffness": 30.0, "damping": 0.2, "rest_angle": 0.3}
    overrides = {f"clearance.{joint}.bearing_on": side, f"drives.{joint}": drive, f"springs.{joint}": spring}
    assert judge(built(model, case, **{f"clearance.{joint}.geometry": "closed-form"}, **overrides), 2) < 1.0


HEAVY = {
    "mechanism.links.shaft2.mass": 3.0,
    "mechanism.links.shaft2.inertia": [0.02, 0.03, 0.04, 0.001, 0.002, 0.003],
    "mechanism.links.shaft2.centre_of_mass": [0.1, 0.02, -0.03],
    "mechanism.joints.azimuth.origin_xyz": [0.1, 0.2, 0.3],
    "mechanism.joints.azimuth.origin_rpy": [0.1, 0.2, 0.3],
    "mechanism.joints.elevation.origin_rpy": [0.3, 0.1, 0.2],
    "springs.elevation": {"kind": "spring", "stiffness": 30.0, "rest_angle": 0.3, "damping": 0.2},
    "forces.drag": {
        "kind": "force",
        "at": {"link": "shaft2", "point": [0.1, 0.2, 0.3]},
        "force": [3.0, 0.0, 1.0],
    },
}
ROD = {
    "model": "cylindrical",
    "bearing_radius": "10 mm",
    "radial_clearance": "0.1 mm",
    "slider_length": "50 mm",
    "guide_length": "40 mm",
    "geometry": "closed-form",
    "journal_material": "steel",
    "bearing_material": "steel",
}


@pytest.mark.parametrize(
    "overrides",
    [{}, {"clearance.slide.guide_length": "90 mm"}, {"clearance.slide": ROD}],
    ids=["walls", "edges", "rod"],
)
def test_a_slider_changes_as_the_whole_does(overrides):
    """On walls without end, whose changes have a closed form, and at ends of slider or guide."""
    assert judge(built("slider", "rest", **overrides), 1) < 1.0


def test_a_force_changes_by_its_exponent_over_any_depth():
    """Of a contact at rest: F = K depth^1.5, so that F' = K 1.5 depth^0.5, down to what a depth is known to.

    Depths are differences of 0.1 mm, which is 1e-20 m: a billionth of 1e-11 m.
    """
    closed = {"clearance.bore.geometry": "closed-form"}
    system = built("impact_pair", "planar", **closed)
    field = VectorField(system, RunSettings(engine="compiled"))
    memory, nv = field.workspace.memory, system.model.nv
    memory["touching"], memory["approach_speed"] = 1.0, 0.1
    own = system.mechanism.joint("bore").v.start
    way = np.zeros((field.displacement, 1))
    way[own] = 1.0
    stiffness = []
    for depth in 10.0 ** -np.arange(5.0, 12.0):
        y = system.state(system.neutral(), np.zeros(nv))
        along = np.zeros(nv)
        along[own] = system.clearances[0].geometry.radial_clearance + depth
        field.workspace.retract(y, along)
        gap = field.workspace.along_normal(y, 0)[1]
        found = Tangents(system, field._stepper, np.concatenate(field.units), WEIGHTS)
        slope = found.rates(0.0, y, way, np.full(1, 1e-4))[0, own, 0]
        stiffness.append(slope / np.sqrt(-gap))
    assert np.ptp(stiffness) < 1e-10 * np.abs(stiffness).max()


def test_what_is_not_put_together_from_parts():
    """Friction by load, gaps of coal and loads that are shared out are left to differences of the whole."""
    closed = {"clearance.elevation.geometry": "closed-form"}
    assert Tangents.takes(built("bai2020", "case3", **closed))
    assert not Tangents.takes(built("bai2020", "case3", **{"clearance.elevation.geometry": "coal"}))
    assert not Tangents.takes(
        built("bai2020", "case3", **closed, **{"clearance.elevation.load": "distributed"})
    )
    friction = {"joint": "hinge", "coefficient": 0.1, "radius": 0.01}
    assert not Tangents.takes(built("pendulum", "ideal", **{"frictions.hinge": friction}))
    assert Tangents.takes(built("slider_crank", "planar", **{"clearance.pin.geometry": "closed-form"}))


def test_both_engines_have_the_same_derivatives():
    """The tree's derivative is compiled for both: bit for bit."""
    system, found = built("bai2020", "case3", **{"clearance.elevation.geometry": "closed-form"}), []
    _, y = anywhere(system, 1)
    for engine in ("compiled", "pinocchio"):
        field = VectorField(system, RunSettings(engine=engine))
        memory = field.workspace.memory
        memory["touching"], memory["approach_speed"] = [1.0, 0.0, 0.0, 0.0], 0.1
        parts = Tangents(system, field._stepper, np.concatenate(field.units), WEIGHTS)
        ways = ways_of(field)
        found.append(parts.rates(TIME, y, ways, np.full(ways.shape[1], 1e-4)))
    assert np.array_equal(*found)


NUMBERS = [
    "clearance.elevation.radial_clearance",
    "clearance.elevation.bearing_radius",
    "clearance.elevation.bearing_length",
    "clearance.elevation.normal.restitution",
    "clearance.elevation.friction.static_speed",
    "materials.steel.young",
    "drives.azimuth.amplitude",
    "springs.elevation.stiffness",
    "forces.drag.at.point[1]",
    "mechanism.links.shaft2.mass",
    "mechanism.links.shaft2.inertia[4]",
    "mechanism.links.shaft2.centre_of_mass[2]",
    "mechanism.joints.azimuth.origin_xyz[0]",
    "mechanism.joints.azimuth.origin_rpy[1]",
    "mechanism.joints.elevation.origin_rpy[2]",
    "mechanism.gravity[1]",
]


def test_rates_change_over_numbers_of_the_system_as_the_whole_does():
    """Of geometry, laws, elements, bodies, their places and gravity, with a contact pressed together."""
    overrides = {
        "clearance.elevation.geometry": "closed-form",
        "mechanism.gravity": [1.0, 2.0, -3.0],
        **HEAVY,
    }
    scenario = load_scenario("bai2020", case="case3", overrides=overrides)
    system, numbers = with_numbers(scenario, NUMBERS)
    field, rng = VectorField(system, RunSettings(engine="compiled"), numbers), np.random.default_rng(0)
    y = system.state(system.neutral(), 0.3 * rng.normal(size=system.model.nv))
    field.workspace.memory["approach_speed"], field.workspace.memory["effective_mass"] = 0.05, 1.3
    press(field, y, system.clearances[0], rng)
    system.turn_on(y)
    ways = np.eye(field.displacement)[:, field.parts[-3]]
    found = field._tangents.rates(TIME, y, ways, np.full(len(NUMBERS), 1e-4))[0]
    for k, way in enumerate(np.eye(len(NUMBERS))):
        tried = [field._near.over_numbers(TIME, y, way, step) for step in STEPS]
        sixth, _ = min(tried, key=lambda two: np.abs(field._weighed((two[0] - two[1])[:, None])).max())
        right = field._weighed(sixth[:, None])[:, 0]
        # What differences of the whole are good to is 1e-9 of the column, and round-off of the largest.
        off = np.abs(field._weighed(found)[:, k] - right).max()
        assert off < 1e-8 * np.abs(right).max(), NUMBERS[k]


def test_the_arm_of_what_acts_along_a_slider_goes_with_where_its_bearing_is():
    """A number that no element has, but the joint's frames, of which its arm is made."""
    drive = {"kind": "sine", "amplitude": 3.0, "frequency": 50.0, "phase": 0.3}
    overrides = {
        "clearance.slide.geometry": "closed-form",
        "clearance.slide.offset": 0.01,
        "drives.slide": drive,
    }
    system, numbers = with_numbers(
        load_scenario("slider", case="rest", overrides=overrides), ["clearance.slide.offset"]
    )
    field, rng = VectorField(system, RunSettings(engine="compiled"), numbers), np.random.default_rng(0)
    y = system.state(system.neutral(), 0.3 * rng.normal(size=system.model.nv))
    field.workspace.retract(y, 1e-5 * rng.normal(size=system.model.nv))
    system.turn_on(y)
    ways = np.eye(field.displacement)[:, field.parts[-3]]
    found = field._tangents.rates(TIME, y, ways, np.full(1, 1e-4))[0, :, 0]
    tried = [field._near.over_numbers(TIME, y, np.ones(1), step) for step in STEPS]
    right, _ = min(tried, key=lambda two: np.abs(two[0] - two[1]).max())
    # As above.
    assert np.abs(found - right).max() < 1e-8 * np.abs(right).max() and right.any()
