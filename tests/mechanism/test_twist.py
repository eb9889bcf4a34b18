"""Twist of a rotation about an axis: its angle, and derivatives of that along small turns."""

import math

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin.mechanism.spatial_kernels import twist_angle, twist_slopes

ANGLE, SLOPES = (getattr(one, "py_func", one) for one in (twist_angle, twist_slopes))


def twist(rotation):
    """Return the vector part and the scalar of a rotation's quaternion."""
    x, y, z, w = pin.Quaternion(rotation).coeffs()
    return (x, y, z), w


@pytest.mark.parametrize("number", range(8))
def test_derivatives_of_the_twist_are_those_along_small_turns(number):
    rng = np.random.default_rng(number)
    rotation, way = pin.exp3(rng.normal(size=3)), rng.normal(size=3)

    def angle(step):
        h, qw = twist(rotation @ pin.exp3(step * way))
        return ANGLE(*h, qw)

    h, qw = twist(rotation)
    step = 1e-5
    behind, here, ahead = angle(-step), angle(0.0), angle(step)
    # Central differences: step^2 of a third derivative, and round-off over the step.
    rate = math.remainder(ahead[0] - behind[0], 2.0 * math.pi) / (2.0 * step)
    assert here[1] * way[0] + here[2] * way[1] + way[2] == pytest.approx(rate, abs=1e-7)
    found = SLOPES(h, qw, tuple(way))
    assert found == pytest.approx((np.array(ahead[1:]) - behind[1:]) / (2.0 * step), abs=1e-6)
