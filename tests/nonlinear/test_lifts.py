"""Displacements of coordinates, in loops and under motions: they leave constraints held, to first order."""

import numpy as np
import pytest
from displacements import with_numbers

from antenna_pin import RunSettings, load_scenario
from antenna_pin.studies.nonlinear import flow_of
from antenna_pin.studies.nonlinear.vector_field import VectorField

STEP = 1e-3
HELD = 1e-10
"""Of what residuals would be at all, some 1: sixth order leaves 1e-18 of a step of a thousandth, round-off of
speeds of some 100 m/s 1e-14 over it, and lifts have as much."""


def residuals(field, time, y, ways):
    """Return how gaps and speeds of constraints change along displacements, (rows of both, k)."""
    constraints = field.workspace.constraints

    def both(t, state):
        field.workspace.prepare_motions(t, state)
        constraints.residuals(t, state, field.workspace.program)
        return np.concatenate([constraints.every_gap, constraints.every_speed])

    return np.column_stack(
        [field._near.over(both, time, y, way, STEP / np.abs(way).max())[0] for way in ways.T]
    )


CLOSED = "closed-form"
CRANK = {"clearance.pin.geometry": CLOSED, "mechanism.links.rod.mass": 1.0}
OF_CRANK = {
    "clearance.pin.radial_clearance": None,
    "closures.guide.first.point[2]": 0.1,
    "closures.guide.second.axis[2]": 1.0,
    "mechanism.links.rod.mass": None,
    "drives.crank.rate": None,
}
LEGS = {"clearance.s2.geometry": CLOSED, "mechanism.joints.swing1.origin_xyz": [0.0, -0.71, 0.0]}
OF_LEGS = {
    "closures.u1.first.axis[0]": 1.0,
    "closures.u1.second.point[1]": None,
    "closures.s3.second.point[2]": None,
    "mechanism.joints.swing1.origin_xyz[1]": None,
    "drives.leg1.frequency": None,
    "drives.leg2.amplitude[1]": None,
    "clearance.s2.normal.restitution": None,
}
WING = {
    "couplings.first": {"leader": "root", "second": "third", "multiplier": -1.7, "second_multiplier": 0.3},
    "drives.root": {"kind": "motion", "joint": "root", "amplitude": 0.3, "frequency": 1.3, "rate": 0.2},
    "initial.joints": {"replace": True, "third": {"angle": 0.4, "velocity": 0.3}},
}
OF_WING = {
    "couplings.first.multiplier": None,
    "couplings.first.second_multiplier": None,
    "drives.root.amplitude": None,
    "drives.root.rate": None,
    "materials.steel.young": None,
}


@pytest.mark.parametrize(
    ("model", "case", "changes", "keys"),
    [
        ("slider_crank", "planar", CRANK, OF_CRANK),
        ("chen2021", "friction-010", LEGS, OF_LEGS),
        ("solar_array", "uncoupled", WING, OF_WING),
    ],
    ids=["crank", "legs", "wing"],
)
@pytest.mark.parametrize("clock", [False, True], ids=["at equal times", "at own times"])
def test_displacements_leave_constraints_held(model, case, changes, keys, clock):
    """Over all coordinates: ways, rates, time, numbers of closures, couplings, motions, places, masses."""
    scenario = load_scenario(model, case=case, overrides=changes)
    flow, start = flow_of(scenario)
    _, numbers = with_numbers(scenario, keys)
    field = VectorField(flow.system, RunSettings(engine="compiled"), numbers)
    up = field.lift(field.frame(start.y, clock), start.time, start.y).up
    assert np.linalg.matrix_rank(up) == up.shape[1]
    left = np.abs(residuals(field, start.time, start.y, up / np.abs(up).max(axis=0)))
    assert left.max() < HELD, np.unravel_index(left.argmax(), left.shape)
    # Lifts that are known are those of their own state and of their own axes.
    faster, axes = start.y.copy(), field.frame(start.y, clock)
    faster[flow.system.model.nq :][: flow.system.model.nv] *= 2.0
    assert np.array_equal(field.lift(axes, start.time, start.y).up, up)
    assert not np.array_equal(field.lift(axes, start.time, faster).up, up)
    assert field.lift(field.frame(start.y, not clock), start.time, start.y).up.shape != up.shape
    assert np.array_equal(field.lift(axes, start.time, start.y).up, up)


def test_axes_serve_until_a_loop_has_turned_away_from_them():
    """A crank under a torque: what its loop leaves at one angle is far off that at another."""
    torque = {"drives.crank": {"replace": True, "kind": "constant", "value": 5.0}}
    flow, start = flow_of(load_scenario("slider_crank", case="ideal", overrides=torque))
    field = VectorField(flow.system, RunSettings(engine="compiled"))
    first, there = flow.after(start, 1e-3), flow.after(start, 31e-3)
    axes = field.frame(first.y)
    assert not field.is_tilted(axes, first.time, first.y)
    assert field.is_tilted(axes, there.time, there.y)
    assert not field.is_tilted(field.frame(there.y), there.time, there.y)
    ours = flow.tangent(first, 0.03).matrix
    # As in tests/nonlinear/test_variational.py; found 1e-11.
    assert ours == pytest.approx(flow.tangent_by_runs(first, 0.03).matrix, abs=1e-8 * np.abs(ours).max())
