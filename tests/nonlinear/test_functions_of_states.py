"""Derivatives of what an event or an element goes by, in a contact that has just begun."""

import math

import numpy as np
import pytest

from antenna_pin import load_scenario
from antenna_pin.base.settings import RunSettings
from antenna_pin.scenario.assemble import build_system, initial_state
from antenna_pin.studies.nonlinear.vector_field import VectorField

# Depth of the disc in its bore [m], and the law's stiffness [N/m^1.5].
DEPTH, STIFFNESS = 1e-9, 1e10
FAR = 1.377  # what a place counts from, as that of a stop far from where a joint is at rest


@pytest.fixture(scope="module")
def touching():
    """A disc that is pressed into its bore by next to nothing, and fast."""
    changes = {
        "mechanism.base": "fixed",
        "clearance.bore.geometry": "closed-form",
        "clearance.bore.normal": {"law": "hertz", "stiffness": STIFFNESS, "exponent": 1.5, "replace": True},
        "integrator.engine": "compiled",
    }
    scenario = load_scenario("impact_pair", case="planar", overrides=changes)
    system = build_system(scenario)
    q, v = initial_state(scenario, system)
    field = VectorField(system, RunSettings(engine="compiled"))
    y = np.concatenate([q, v, np.zeros(system.manifold.nx)])
    field.workspace.memory["touching"][0] = 1.0
    field.workspace.memory["approach_speed"][0] = 0.1
    normal, gap = field.workspace.along_normal(y, 0)
    way = np.zeros(field.displacement)
    way[field.parts[0]] = normal * (-DEPTH - gap)
    field.workspace.retract(y, way[field.parts[0]])
    return field, y, normal


def test_a_place_is_not_differentiated_by_steps_of_a_depth(touching):
    """Its derivative is 1: to the round-off of 1.4 m over a part of the play, not of the depth."""
    field, y, _ = touching
    ways = np.zeros((field.displacement, 1))
    ways[0, 0] = 1.0

    def place(_, state):
        return np.array([FAR + state[0]])

    slope = field.along(place, 0.0, y, ways, of_forces=True)
    assert abs(float(slope[0, 0]) - 1.0) < 1e-8


def test_a_force_is_differentiated_by_steps_of_its_depth(touching):
    """Hertz's over the depth is 1.5 K depth^0.5; by coarser steps the contact would end."""
    field, y, normal = touching
    ways = np.zeros((field.displacement, 1))
    ways[field.parts[0], 0] = -normal

    def force(t, state):
        field.rates(t, state)
        return np.array([field._near.stepper.numbers.own["force"][0]])

    slope = field.along(force, 0.0, y, ways, of_forces=True)
    # A depth is known to 1e-20 m of a place of 1e-4 m: 1e-11 of 1e-9 m, over steps of a fiftieth; and of
    # sixth order by these.
    depth = -field.workspace.along_normal(y, 0)[1]
    assert abs(float(slope[0, 0]) / (1.5 * STIFFNESS * math.sqrt(depth)) - 1.0) < 1e-8


def test_how_fast_a_place_goes_is_known_in_a_contact(touching):
    """Its rate is the velocity, to the round-off of 1.4 m likewise."""
    field, y, _ = touching
    nq = field.system.model.nq

    def place(_, state):
        return np.array([FAR + state[0]])

    rate = field.per_second(place, 0.0, y, of_forces=True)
    assert abs(float(rate[0]) - y[nq]) < 1e-8 * abs(y[nq])
