"""The compiled arithmetic is the Python that is written; it continues smoothly where a step overshoots."""

import math

import numpy as np
import pytest

from antenna_pin.contact import Hertz, _friction_kernels, _kernels

# Compiled powers and divisions may differ from the interpreter's in the last bits.
ULPS = dict(rel=4 * np.finfo(float).eps, abs=0.0)


def python(kernel):
    if not hasattr(kernel, "py_func"):
        pytest.skip("compilation is switched off")
    return kernel.py_func


def states(count, seed):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        depth = 10.0 ** rng.uniform(-10, -3) * rng.choice([1.0, 1.0, -1.0])
        yield float(depth), float(rng.normal()), float(10.0 ** rng.uniform(-4, 0))


def test_normal_kernels_equal_their_python(normal_law):
    code = normal_law.code()
    for depth, rate, first in states(50, 1):
        assert _kernels.power(depth, code[3]) == pytest.approx(python(_kernels.power)(depth, code[3]), **ULPS)
        for kernel, arguments in (
            (_kernels.elastic_force, (depth,)),
            (_kernels.elastic_energy, (depth,)),
            (_kernels.normal_force, (depth, rate, first)),
        ):
            assert kernel(code, *arguments) == pytest.approx(python(kernel)(code, *arguments), **ULPS)


def test_friction_kernels_equal_their_python(friction_law):
    code, rng = friction_law.code(), np.random.default_rng(2)
    for _ in range(200):
        slip = (rng.normal(size=3) * 10.0 ** rng.uniform(-6, 1)).tolist()
        speed = math.sqrt(sum(s * s for s in slip))
        kernel = _friction_kernels.friction_ratio
        # The ramp's (speed - v_0) cancels near its lower end; it does so alike in both.
        assert kernel(code, speed, 12.0) == pytest.approx(python(kernel)(code, speed, 12.0), **ULPS)
        kernel = _friction_kernels.friction_force
        arguments = (code, 12.0, *slip)
        assert kernel(*arguments) == pytest.approx(python(kernel)(*arguments), rel=1e-12, abs=0.0)


def test_codes_have_the_size_of_their_slots(normal_law, friction_law):
    assert normal_law.code().shape == (_kernels.NORMAL_SIZE,)
    assert friction_law.code().shape == (_friction_kernels.FRICTION_SIZE,)


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0, 4.0])
def test_integer_powers_continue_analytically_below_zero_depth(exponent):
    """So that a trial step across the end of a contact keeps the integrator's order."""
    for depth in (-1e-3, -1e-6, 1e-6, 1e-3):
        expected = depth ** int(exponent)
        assert _kernels.power(depth, exponent) == pytest.approx(expected, rel=1e-15, abs=0.0)  # round-off


@pytest.mark.parametrize("exponent", [10 / 9, 1.5, 2.5])
def test_other_powers_vanish_below_zero_depth(exponent):
    assert _kernels.power(-1e-6, exponent) == 0.0
    assert _kernels.power(0.0, exponent) == 0.0
    assert _kernels.power(1e-6, exponent) == pytest.approx(1e-6**exponent, rel=1e-15, abs=0.0)  # round-off


def test_the_continuation_stays_below_the_surface_of_a_law():
    """The class, unlike the kernel, speaks of free flight: no force there."""
    law = Hertz(stiffness=1e9, exponent=1.0)
    assert _kernels.normal_force(law.code(), -1e-6, 0.0, 1.0) == pytest.approx(
        -1e3, rel=1e-15, abs=0.0
    )  # round-off
    assert law.force(-1e-6, 0.0, 1.0) == 0.0
