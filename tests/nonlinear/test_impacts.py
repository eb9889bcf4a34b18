"""How what a contact remembers of its onset changes along displacements, and how its gap opens with numbers.

Against differences of what the workspace finds, whose mass is Pinocchio's.
"""

import importlib
from pathlib import Path

import numpy as np
import pytest
from displacements import TIME, anywhere, ways_of, with_numbers

from antenna_pin import RunSettings, build_system, load_scenario
from antenna_pin.studies.nonlinear.vector_field import VectorField

ROOT = Path(__file__).parents[2]
STEPS = 10.0 ** np.arange(1.0, -1.5, -0.5)
"""Over a step of a thousandth of a play; at finer ones orders agree by chance on what is round-off."""
CLOSE = 1e-9
"""Of each number and of the largest: what differences are good to by the best of steps. Masses are known to
1e-14 and, where rows of constraints are nearly dependent, 1e-13 of theirs, plays to 1e-14; steps are a
thousandth."""


def by_differences(field, y, c, ways):
    """Return changes of a contact's depth rate, mass's logarithm and gap by the best of steps, (3, k)."""
    workspace, table = field.workspace, np.zeros_like(field.workspace.table)

    def met(_, state):
        workspace.locate(state, table)
        return np.array([table["rate"][c], np.log(workspace.effective_mass(state, c)), table["gap"][c]])

    first = field.gaps.steps(ways)
    tried = np.array([field.gaps.with_steps(met, TIME, y, ways, step * first) for step in STEPS])
    apart = np.abs(tried[:, 0] - tried[:, 1])
    # By the next coarser step as well: where round-off rules, orders agree by chance at one of them.
    apart[1:] = np.maximum(apart[1:], apart[:-1])
    best = apart.argmin(axis=0)
    return np.take_along_axis(tried[:, 0], best[None], axis=0)[0]


def judge(system, y, numbers=None):
    """Return the largest deviation from differences at any contact, over what is asked."""
    field, worst = VectorField(system, RunSettings(engine="compiled"), numbers), 0.0
    assert field.gaps.tangents is not None
    ways, own = ways_of(field), field.parts[-3]
    for c in range(len(system.contact_names)):
        *met, gaps = by_differences(field, y, c, ways)
        found = [one for one, _ in field.gaps.impact(TIME, y, c, ways)]
        if numbers is not None:
            found, met = [*found, field.gaps.over_numbers(y, c)], [*met, gaps[own]]
        for ours, right in zip(found, met, strict=True):
            asked = CLOSE * (np.abs(right) + np.abs(right).max(initial=0.0)) + 1e-300
            worst = max(worst, (np.abs(ours - right) / asked).max())
    return worst


@pytest.mark.parametrize("number", [0, 4, 5, 6])
def test_impacts_in_random_trees_change_as_differences_say(number, monkeypatch):
    """At revolute, planar and spherical joints, with the bearing on either side."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "check"))
    scenario = importlib.import_module("scenario_generator").draw_scenario(3, number)
    plain = {f"clearance.{name}.geometry": "closed-form" for name in scenario.clearance}
    plain |= {f"clearance.{n}.load": "point" for n, one in scenario.clearance.items() if hasattr(one, "load")}
    system = build_system(scenario.with_overrides(plain))
    assert judge(system, anywhere(system, number)[1]) < 1.0


def test_impacts_of_point_loads_are_known_beside_a_distributed_one(monkeypatch):
    """The closed form is taken for a contact of a point load, whatever other joints carry."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "check"))
    scenario = importlib.import_module("scenario_generator").draw_scenario(1, 70)
    scenario = scenario.with_overrides(
        {f"clearance.{name}.geometry": "closed-form" for name in scenario.clearance}
    )
    loads = [scenario.clearance[name].load for name in ("joint2", "joint3")]
    assert loads == ["distributed", "point"]
    system = build_system(scenario)
    gaps = VectorField(system, RunSettings(engine="compiled")).gaps
    assert [gaps.tangents_at(c) is not None for c in range(8)] == [False] * 4 + [True] * 4
    assert judge(system, anywhere(system, 70)[1]) < 1.0


CLOSED = "closed-form"
TWIST = {"replace": True, "kind": "motion", "joint": "elevation", "amplitude": 0.3, "frequency": 2.0}
HELD = {
    "planar": ("slider_crank", "planar", {"clearance.pin.geometry": CLOSED}),
    "spherical": ("chen2021", "friction-010", {"clearance.s2.geometry": CLOSED}),
    "twist": ("bai2020", "case3", {"clearance.elevation.geometry": CLOSED, "drives.elevation": TWIST}),
    "guide": ("slider", "rest", {"clearance.slide.guide_length": "90 mm"}),
}


@pytest.mark.parametrize("held", HELD)
def test_impacts_under_constraints_change_as_differences_say(held):
    """In loops and with motions, whose multipliers take part of a blow; at ends of a slider in a guide."""
    model, case, changes = HELD[held]
    system = build_system(load_scenario(model, case=case, overrides=changes))
    assert judge(system, anywhere(system, 3)[1]) < 1.0


PIN = {
    "model": "contact",
    "bearing_radius": "10 mm",
    "bearing_length": "20 mm",
    "radial_clearance": "0.1 mm",
    "geometry": CLOSED,
    "journal_material": "steel",
    "bearing_material": "steel",
}
BODIES = {
    "mechanism.gravity": [1.0, 2.0, -3.0],
    "mechanism.links.inner.mass": 3.0,
    "mechanism.links.inner.inertia": [0.02, 0.03, 0.04, 0.001, 0.002, 0.003],
    "mechanism.links.inner.centre_of_mass": [0.1, 0.02, -0.03],
    "mechanism.joints.second.origin_xyz": [0.1, 0.2, 0.3],
    "mechanism.joints.second.origin_rpy": [0.3, 0.1, 0.2],
    "mechanism.joints.third.origin_xyz": [0.1, 0.2, 0.3],
    "mechanism.joints.third.origin_rpy": [0.3, 0.1, 0.2],
    "rotors.second": {"kind": "armature", "ratio": 100.0, "inertia": 1e-5},
    "clearance.third": PIN,
}
NUMBERS = [
    "clearance.third.radial_clearance",
    "clearance.third.bearing_radius",
    "clearance.third.bearing_length",
    "mechanism.links.inner.mass",
    "mechanism.links.inner.inertia[4]",
    "mechanism.links.inner.centre_of_mass[2]",
    "mechanism.joints.second.origin_xyz[0]",
    "mechanism.joints.second.origin_rpy[2]",
    "mechanism.joints.third.origin_xyz[1]",
    "mechanism.joints.third.origin_rpy[0]",
    "mechanism.gravity[1]",
    "rotors.second.inertia",
    "materials.steel.young",
    "couplings.first.multiplier",
    "couplings.first.second_multiplier",
    "closures.tip.first.point[0]",
    "closures.tip.first.axis[1]",
    "closures.tip.second.point[2]",
    "closures.tip.second.axis[0]",
    "drives.root.amplitude",
]
LOOPS = {
    "mechanism.base": "free",
    "couplings.first": {"leader": "root", "second": "second", "multiplier": -1.7, "second_multiplier": 0.3},
    "closures.tip": {
        "kind": "universal",
        "first": {"link": "world", "point": [0.1, 0.2, 0.3], "axis": [1.0, 2.0, 3.0]},
        "second": {"link": "outer", "point": [0.2, 0.1, 0.3], "axis": [3.0, 0.0, 1.0]},
    },
    "drives.root": {"kind": "motion", "joint": "root", "amplitude": 0.3, "frequency": 1.3, "rate": 0.2},
}


def test_impacts_change_with_numbers_of_the_system_as_differences_say():
    """Of the joint's own, of bodies on both sides, of where joints and closures are; not with all of them."""
    scenario = load_scenario("solar_array", case="uncoupled", overrides=BODIES | LOOPS)
    system, numbers = with_numbers(scenario, NUMBERS)
    assert judge(system, anywhere(system, 4)[1], numbers) < 1.0
    field = VectorField(system, RunSettings(engine="compiled"), numbers)
    over = np.eye(field.displacement)[:, field.parts[-3]]
    y = anywhere(system, 4)[1]
    sizes = [np.abs(field.gaps.impact(TIME, y, c, over)[1][0]) for c in range(len(system.contact_names))]
    nothing = np.abs(sizes).max(axis=0) == 0.0
    # The normal's line goes through the journal's axis, whatever the play; a side on the world does not turn.
    none = ["clearance.third.radial_clearance", "mechanism.gravity[1]", "materials.steel.young"]
    none += ["closures.tip.first.point[0]", "drives.root.amplitude"]
    assert [key for key, one in zip(NUMBERS, nothing, strict=True) if one] == none


def test_an_impact_of_two_bodies_changes_as_its_closed_form():
    """Centre to centre the mass is m M / (m + M); the depth rate is v . e / |e|, of a disc off by e."""
    closed = {"clearance.bore.geometry": CLOSED, "mechanism.links.disc.mass": 2.0}
    scenario = load_scenario("impact_pair", case="planar", overrides=closed)
    system, numbers = with_numbers(scenario, ["mechanism.links.disc.mass", "clearance.bore.radial_clearance"])
    field = VectorField(system, RunSettings(engine="compiled"), numbers)
    v, e = np.array([0.1, 0.03]), np.array([0.6e-4, 0.8e-4])
    own, y = system.mechanism.joint("bore").v.start, system.state(system.neutral(), np.zeros(system.model.nv))
    move = np.zeros(system.model.nv)
    move[own : own + 2] = e
    field.workspace.retract(y, move)
    y[system.model.nq + own :][:2] = v
    ways = np.zeros((field.displacement, 6))
    ways[[own, own + 1], [0, 1]] = 1e-4  # [m]
    ways[[system.model.nv + own, system.model.nv + own + 1], [2, 3]] = 0.1  # [m/s]
    ways[field.parts[-3], 4:] = np.eye(2)
    (speed, _), (mass, _) = field.gaps.impact(TIME, y, 0, ways)
    n = e / np.linalg.norm(e)
    across = (v - (v @ n) * n) / np.linalg.norm(e)
    assert speed == pytest.approx([*(1e-4 * across), *(0.1 * n), 0.0, 0.0], abs=1e-15)
    # Scales are the values. How numbers of the system go with these is found by differences, to 1e-13 of
    # them; of radii, to 2e-18 m over 1e-7 m of play, so that of 1e-4 m some 2e-15 are unsure.
    assert mass == pytest.approx([0.0, 0.0, 0.0, 0.0, 3.0 / 5.0, 0.0], abs=1e-12)
    assert field.gaps.opening(y, 0, ways)[0] == pytest.approx([*(-1e-4 * n), 0, 0, 0, 1e-4], abs=2e-15)
    # Where nothing is compiled, as with gaps by coal, differences over a thousandth of the play say the same.
    field.gaps.tangents = None
    found = np.array(field.gaps.impact(TIME, y, 0, ways))
    assert found == pytest.approx(np.array([[speed] * 2, [mass] * 2]), abs=1e-9)
    assert field.gaps.opening(y, 0, ways)[0] == pytest.approx([*(-1e-4 * n), 0, 0, 0, 1e-4], abs=1e-13)
