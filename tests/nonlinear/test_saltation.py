"""What an impact does to a volume of neighbours, with the approach speed that each remembers: closed forms.

A disc of 2 kg meets the wall of a bore that is held fast, at 0.1 m/s, under a force K d^n (1 + chi d'/d'_0).
"""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import load_scenario
from antenna_pin.studies.nonlinear import flow_of

SPEED, ONSET = 0.1, 1e-3  # [m/s], [s]


@pytest.fixture(params=[0.5, 0.7, 0.9])
def impact(request):
    """The flow, its start, chi, and the law's own restitution c, whatever stiffness, exponent and masses."""
    changes = {
        "integrator.engine": "compiled",
        "mechanism.base": "fixed",
        "clearance.bore.geometry": "closed-form",
        "clearance.bore.normal.restitution": request.param,
    }
    flow, start = flow_of(load_scenario("impact_pair", case="planar", overrides=changes))
    chi = 0.75 * (1.0 - request.param**2)
    c = brentq(lambda c: chi * (1.0 + c) - math.log((1.0 + chi) / (1.0 - chi * c)), 0.01, 1.0)
    return flow, start, chi, c


def test_a_volume_of_neighbours_across_an_impact(impact):
    """It shrinks by c^2: dx dv = v dt dv, and the instant of an impact moves as its start does.

    Across the line of impact and about the axis nothing is lost: volumes there stay.
    """
    flow, start, _, c = impact
    whole = flow.tangent(start, 1.9e-3)
    assert whole.end.v[0] == pytest.approx(-c * SPEED, rel=1e-9)
    # The variational equation and differences of sixth order of runs at 1e-12: found 1e-9 and 1e-10 at most.
    assert np.linalg.det(whole.matrix) == pytest.approx(c**2, rel=1e-8)
    assert np.linalg.det(flow.tangent_by_runs(start, 1.9e-3).matrix) == pytest.approx(c**2, rel=1e-8)


def test_a_volume_within_a_contact(impact):
    """Liouville: the divergence is -K d^n chi / (m d'_0), so it goes with 1 + chi d'/d'_0."""
    flow, start, chi, _ = impact
    here = flow.after(start, ONSET + 1e-4)
    tangent = flow.tangent(here, 5e-5)
    before, behind = (1.0 + chi * state.v[0] / state.memory[0, 1] for state in (here, tangent.end))
    # The memory's own row is that of one.
    assert np.linalg.det(tangent.matrix) == pytest.approx(behind / before, rel=1e-9)


def test_the_approach_speed_that_is_remembered_is_part_of_the_tangent(impact):
    """Without it Liouville's (1 - chi c)/(1 + chi) would be left of the volume, not c^2: 9 to 28 % less.

    The onset does nothing else to a tangent, as the force begins at zero.
    """
    flow, start, chi, c = impact
    # To just behind the onset, where a neighbour's approach speed has not yet acted, and from there on.
    onset = flow.tangent(start, ONSET + 1e-7)
    rest = flow.tangent(onset.end, 1.9e-3 - ONSET - 1e-7)
    assert onset.matrix.shape == (7, 6) and rest.matrix.shape == (6, 7)
    assert np.linalg.det(rest.matrix @ onset.matrix) == pytest.approx(c**2, rel=1e-8)
    forgotten = np.linalg.det(rest.matrix[:, :6] @ onset.matrix[:6])
    assert forgotten == pytest.approx((1.0 - chi * c) / (1.0 + chi), rel=1e-6)
    assert forgotten < 0.92 * c**2
