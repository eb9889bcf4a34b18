"""Displacements carried by the stages of the run's own method, against whole matrices."""

import numpy as np

from antenna_pin import load_scenario
from antenna_pin.run.engine import Carrying
from antenna_pin.studies.nonlinear import Chart, flow_of
from antenna_pin.studies.nonlinear.variational import TangentPropagation
from antenna_pin.studies.nonlinear.vector_field import VectorField

CLOSED = ["integrator.engine=compiled", "clearance.bore.geometry=closed-form"]


def pair(law, case="planar"):
    """Two free bodies that meet at 1 ms and part before 1.3 ms."""
    changes = [*CLOSED, f"clearance.bore.normal={{ {law}, replace = true }}"]
    return flow_of(load_scenario("impact_pair", case=case, overrides=changes))


def carried(flow, start, span):
    """What carries all displacements over a span."""
    return flow.propagate(start, span, Chart(flow.system, start).frame)[0]


def both_ways(monkeypatch, flow, start, span):
    """What carries all displacements over a span by the run's own stages, and by whole matrices."""
    by_stages = carried(flow, start, span)
    monkeypatch.setattr(VectorField, "stage_propagation", lambda _: None)
    return by_stages, carried(flow, start, span)


def test_an_impact_by_stages_is_one_by_matrices(monkeypatch):
    """Through onset, contact and release; where nothing breaks no matrix is asked for."""
    flow, start = pair("law = 'lankarani-nikravesh', restitution = 0.5")
    by_stages, by_matrices = both_ways(monkeypatch, flow, start, 1.9e-3)
    one, other = by_stages.tangents.matrix, by_matrices.tangents.matrix
    # Each is good to a thousand of the run's tolerances of 1e-12, many steps together.
    assert np.abs(one - other).max() < 1e-8 * np.abs(other).max()
    assert by_stages.stages.made > 0 and by_stages.matrices == 0
    assert by_matrices.stages is None and by_matrices.matrices > 0


def test_matrices_see_that_a_force_begins_with_a_root_in_a_shallow_contact(monkeypatch):
    """Its slope goes with the root of depth there: by four nodes it is 6e-5 of its change off."""
    flow, start = pair("law = 'marhefka-orin', slope = 0.5")
    by_stages, by_matrices = both_ways(monkeypatch, flow, start, 1.9e-3)
    one, other = by_stages.tangents.matrix, by_matrices.tangents.matrix
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
    monkeypatch.setattr(VectorField, "stage_propagation", lambda _: None)
    one, other = by_stages.tangents.matrix, carried(flow, start, 5e-4).tangents.matrix
    assert np.abs(one - other).max() < 1e-9 * np.abs(other).max()


def test_steps_together_are_steps_one_by_one(monkeypatch):
    """Displacements and what is integrated, through onset, contact and release."""
    flow, start = pair("law = 'lankarani-nikravesh', restitution = 0.5")
    together = carried(flow, start, 1.9e-3)
    monkeypatch.setattr(TangentPropagation, "_goes_along", lambda *_: False)
    singly = carried(flow, start, 1.9e-3)
    # The same stages, in halves here or there: each good to a thousand tolerances of 1e-12.
    for one, other in zip(together.tangents[::3], singly.tangents[::3], strict=True):
        assert np.abs(one - other).max() < 1e-8 * np.abs(other).max()


def test_what_displacements_are_off_by_needs_three_stages(monkeypatch):
    """By three stages the doubt is that by all, and the displacements themselves are the same numbers."""
    flow, start = pair("law = 'lankarani-nikravesh', restitution = 0.5")
    three = carried(flow, start, 1.9e-3)
    room = Carrying._room
    monkeypatch.setattr(Carrying, "_room", lambda one, count, few, _: room(one, count, few, True))
    every = carried(flow, start, 1.9e-3)
    assert np.array_equal(three.tangents.matrix, every.tangents.matrix)
    # Third order, where |h A w| < |w|: off by a part in 24 of a displacement in a step at most.
    assert (np.abs(three.doubt - every.doubt) <= every.doubt / 24.0).all() and every.doubt.any()
    assert not np.array_equal(three.doubt, every.doubt)


def test_a_closed_loop_by_stages(monkeypatch):
    """Through an impact in a driven crank's pin: axes are others at each step, and in parts of steps."""
    changes = ["integrator.engine=compiled", "clearance.pin.geometry=closed-form"]
    flow, start = flow_of(load_scenario("slider_crank", case="planar", overrides=changes))
    start = flow.after(start, 1e-3)
    assert flow.traverse(start, 1.2e-3).onsets >= 1
    by_stages = carried(flow, start, 1.2e-3)
    assert by_stages.stages.made > 10 * by_stages.matrices
    monkeypatch.setattr(VectorField, "stage_propagation", lambda _: None)
    one, other = by_stages.tangents.matrix, carried(flow, start, 1.2e-3).tangents.matrix
    # Either says it is in doubt by some 1e-6, beside derivatives of up to 457.
    assert np.abs(one - other).max() < 1e-8 * np.abs(other).max()
