"""Displacements carried by the stages of the run's own method, against whole matrices."""

import numpy as np

from antenna_pin import load_scenario
from antenna_pin.nonlinear import Chart, flow_of
from antenna_pin.nonlinear.field import Field

CLOSED = ["integrator.engine=compiled", "clearance.bore.geometry=closed-form"]


def pair(law, case="planar"):
    """Two free bodies that meet at 1 ms and part before 1.3 ms."""
    changes = [*CLOSED, f"clearance.bore.normal={{ {law}, replace = true }}"]
    return flow_of(load_scenario("impact_pair", case=case, overrides=changes))


def carried(flow, start, span):
    """What carries all displacements over a span."""
    return flow.carry(start, span, Chart(flow.system, start).frame)[0]


def test_an_impact_by_stages_is_one_by_matrices(monkeypatch):
    """Through onset, contact and release; where nothing breaks no matrix is asked for."""
    flow, start = pair("law = 'lankarani-nikravesh', restitution = 0.5")
    by_stages = carried(flow, start, 1.9e-3)
    monkeypatch.setattr(Field, "carrying", lambda _: None)
    by_matrices = carried(flow, start, 1.9e-3)
    one, other = by_stages.carried.matrix, by_matrices.carried.matrix
    # Each is good to a thousand of the run's tolerances of 1e-12, many steps together.
    assert np.abs(one - other).max() < 1e-8 * np.abs(other).max()
    assert by_stages.stages.made > 0 and by_stages.matrices == 0
    assert by_matrices.stages is None and by_matrices.matrices > 0


def test_matrices_see_that_a_force_begins_with_a_root_in_a_shallow_contact(monkeypatch):
    """F' goes with the root of depth there: a rule of four nodes is off by 6e-5 before a release."""
    flow, start = pair("law = 'marhefka-orin', slope = 0.5")
    by_stages = carried(flow, start, 1.9e-3)
    monkeypatch.setattr(Field, "carrying", lambda _: None)
    by_matrices = carried(flow, start, 1.9e-3)
    one, other = by_stages.carried.matrix, by_matrices.carried.matrix
    # Found: 1e-10; 1e-8 where what a polynomial leaves of it does not count.
    assert np.abs(one - other).max() < 1e-9 * np.abs(other).max()


def test_steps_in_which_a_force_breaks_are_left_to_matrices():
    """A law that would pull is cut at zero: near there the two orders of differences part."""
    carrier = carried(*pair("law = 'tsuji', restitution = 0.7"), 1.9e-3)
    assert 0 < carrier.matrices < carrier.stages.made


def test_a_spinning_body_by_stages(monkeypatch):
    """Ways are in the axes of a body that turns: they change by the bracket with its velocity."""
    flow, start = flow_of(load_scenario("impact_pair", overrides=CLOSED))
    v = start.v.copy()
    v[3:6] = 30.0, -20.0, 10.0  # of the base
    start = flow.first(start.q, v)
    by_stages = carried(flow, start, 5e-4)
    assert by_stages.stages.made > 0
    monkeypatch.setattr(Field, "carrying", lambda _: None)
    one, other = by_stages.carried.matrix, carried(flow, start, 5e-4).carried.matrix
    assert np.abs(one - other).max() < 1e-9 * np.abs(other).max()
