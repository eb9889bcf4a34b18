"""Displacements carried by a run's stages: what they are off by, by three of them."""

import numpy as np
import pytest

from antenna_pin.engine.carry_kernels import _grade, _place
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


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda one: one.name)
@pytest.mark.parametrize("away", [0.0, 0.3, 4.0])
def test_roots_of_time_from_an_onset_and_to_a_release_are_polynomials(method, away):
    """``(t - since)^0.5`` and ``(until - t)^0.5``, whose integrals all these methods have to round-off."""
    t, h = 2.0, 0.5
    since, until = t - away * h, t + (1.0 + away) * h
    exact = h**1.5 / 1.5 * ((1.0 + away) ** 1.5 - away**1.5)
    for grade, function in (
        (_grade(t, h, np.inf, since), lambda time: time - since),
        (_grade(t, h, until, -np.inf), lambda time: until - time),
        # Of both the nearer one counts.
        (_grade(t, h, until, since - 0.5 * h), lambda time: until - time),
    ):
        total = 0.0
        for node, weight in zip(method.nodes, method.weights[method.last], strict=True):
            place, speed = _place(node, *grade)
            total += weight * speed * h * np.sqrt(max(function(t + place * h), 0.0))
        # The root of what is left of a cancellation at the very instant: its weight there is nought.
        assert total == pytest.approx(exact, rel=1e-14)
    assert _grade(t, h, np.inf, -np.inf) == (0, 0.0)
