"""Displacements carried by a run's stages: what they are off by, by three of them."""

import numpy as np
import pytest

from antenna_pin.engine.carrying import third_order
from antenna_pin.integrate import METHODS

ADAPTIVE = [one for one in METHODS.values() if one.adaptive and not one.implicit]


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda one: one.name)
def test_three_stages_of_a_method_are_of_third_order(method):
    """Of ``w' = (1 + t) w``, whose solution is exp(t + t^2 / 2): an error that goes with the fourth power."""
    nodes, last = method.nodes, method.last
    weights, asked = third_order(nodes, last)
    assert asked.sum() == 3 and asked[last] == 0

    def off(h):
        slopes = np.zeros(len(nodes))
        for i in np.flatnonzero(asked).tolist():
            slopes[i] = (1.0 + h * nodes[i]) * (1.0 + h * weights[i] @ slopes)
        return abs(1.0 + h * weights[last] @ slopes - np.exp(h + 0.5 * h**2))

    # The next term of the error, of relative size h.
    assert np.log2(off(0.02) / off(0.01)) == pytest.approx(4.0, abs=0.1)
