"""Displacements of coordinates, in loops and under motions: they leave constraints held, to first order."""

import numpy as np
import pytest
from displacements import with_numbers

from antenna_pin import RunSettings, load_scenario
from antenna_pin.nonlinear import flow_of
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.modes_of_states import take_up_modes

STEP = 1e-3
HELD = 1e-9
"""Of what residuals would be at all, some 1: sixth order leaves 1e-18 of a step of a thousandth, and round-off
of places 1e-16 of a metre over it."""


def residuals(field, time, y, ways):
    """Return how gaps and speeds of constraints change along displacements, (rows, k) of both."""
    found = []
    for way in ways.T:
        both = [
            field._near.over(field._near.violated(name), time, y, way, STEP / np.abs(way).max())[0]
            for name in ("every_gap", "every_speed")
        ]
        found.append(np.concatenate(both))
    return np.array(found).T


LOOPED = {
    "mechanism.base": "free",
    "mechanism.links.inner.mass": 3.0,
    "mechanism.joints.second.origin_xyz": [0.1, 0.2, 0.3],
    "couplings.first": {"leader": "root", "second": "third", "multiplier": -1.7, "second_multiplier": 0.3},
    "drives.root": {"kind": "motion", "joint": "root", "amplitude": 0.3, "frequency": 1.3, "rate": 0.2},
    "initial.joints": {"replace": True, "second": {"angle": 0.4, "velocity": 0.3}},
    "closures.brace": {
        "kind": "planar",
        "first": {"link": "bus", "point": [0.1, 0.3, 0.2], "axis": [1.0, 2.0, 3.0]},
        "second": {"link": "outer", "point": [0.3, 0.1, 0.3], "axis": [3.0, 0.0, 1.0]},
    },
}
OF_LOOPS = [
    "couplings.first.multiplier",
    "couplings.first.second_multiplier",
    "closures.brace.first.point[1]",
    "closures.brace.first.axis[0]",
    "closures.brace.second.point[0]",
    "drives.root.amplitude",
    "drives.root.frequency",
    "mechanism.joints.second.origin_xyz[0]",
    "mechanism.links.inner.mass",
    "materials.steel.young",
]
CRANK = {"clearance.pin.geometry": "closed-form"}
OF_CRANK = ["clearance.pin.radial_clearance", "closures.guide.first.point[1]", "drives.crank.rate"]


@pytest.mark.parametrize(
    ("model", "case", "changes", "keys"),
    [
        ("slider_crank", "planar", CRANK, OF_CRANK),
        ("solar_array", "uncoupled", LOOPED, OF_LOOPS),
    ],
    ids=["crank", "wing"],
)
@pytest.mark.parametrize("clock", [False, True], ids=["at equal times", "at own times"])
def test_displacements_leave_constraints_held(model, case, changes, keys, clock):
    """Over all coordinates: ways, rates, time, numbers of closures, couplings, motions, places, masses."""
    scenario = load_scenario(model, case=case, overrides=changes)
    flow, start = flow_of(scenario)
    _, numbers = with_numbers(scenario, keys)
    field = Field(flow.system, RunSettings(engine="compiled"), numbers)
    up = field.lift(field.frame(start.y, clock), start.time, start.y).up
    assert np.linalg.matrix_rank(up) == up.shape[1]
    left = np.abs(residuals(field, start.time, start.y, up / np.abs(up).max(axis=0)))
    assert left.max() < HELD, np.unravel_index(left.argmax(), left.shape)
