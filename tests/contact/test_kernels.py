"""The compiled arithmetic is the Python that is written; it continues smoothly where a step overshoots."""

import ctypes
import dataclasses
import math
import sys
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from antenna_pin.compiled.decorators import record
from antenna_pin.contact import (
    DISSIPATIONS,
    FRICTION_LAWS,
    NORMAL_LAWS,
    CustomFriction,
    Hertz,
    Johnson,
    KelvinVoigt,
    LiuPinJoint,
    Persson,
    kernels,
    normal,
)
from antenna_pin.contact.records import (
    FRICTION_LAW,
    FRICTION_SIZE,
    NORMAL_LAW,
    dissipation_record,
    elastic_record,
    friction_record,
    number_of,
)

from .conftest import DIMENSIONS, combinations, instances

# Parameters that may take any positive value, whatever the others are.
STRETCHED = {"stiffness", "damping", "full_damping_depth", "length", "modulus"}

# Compiled powers and divisions may differ from the interpreter's in the last bits.
ULPS = dict(rel=4 * np.finfo(float).eps, abs=0.0)


def python(kernel):
    if not hasattr(kernel, "py_func"):
        pytest.skip("compilation is switched off")
    return kernel.py_func


@contextmanager
def interpreted():
    """All contact kernels as plain Python, also where they call one another, and in chains of kinds."""
    modules = [vars(sys.modules[name]) for name in sys.modules if name.startswith("antenna_pin.contact.")]
    with pytest.MonkeyPatch.context() as patch:
        for names in modules:
            for name, function in list(names.items()):
                if hasattr(function, "py_func"):
                    if function.py_func.__globals__ is not names and name.startswith("_"):
                        modules.append(function.py_func.__globals__)  # of a chain
                    patch.setitem(names, name, function.py_func)
        yield


@st.composite
def contacts(draw, laws):
    """A law of the registries, with parameters about its examples', and its state: depth, rate, approach."""
    law = draw(st.sampled_from(laws))
    factor = draw(st.floats(0.5, 1.0))
    stretched = {
        name: value * factor if name in STRETCHED and value else value
        for name, value in ((f.name, getattr(law, f.name)) for f in dataclasses.fields(law) if f.init)
    }
    depth = 10.0 ** draw(st.floats(-10.0, -4.4)) * draw(st.sampled_from([1.0, 1.0, -1.0]))
    return type(law)(**stretched), depth, draw(st.floats(-3.0, 3.0)), 10.0 ** draw(st.floats(-4.0, 0.0))


@settings(max_examples=300)
@given(contacts([parameter.values[0] for parameter in (*instances(NORMAL_LAWS), *combinations())]))
def test_normal_kernels_equal_their_python(contact):
    """Any law, with and without dissipation, on both sides of the surface; a code fills its slot."""
    law, depth, rate, approach = contact
    code = law.code()
    assert code.shape == (kernels.NORMAL_SIZE,)

    def evaluate():
        return [
            float(kernels.elastic_force(code, depth)),
            float(kernels.elastic_energy(code, depth)),
            float(kernels.normal_force(code, depth, rate, approach, 0.7)),
        ]

    one = evaluate()
    with interpreted():
        other = evaluate()
    # exp and log come from another library; what cancels amplifies it: near the cut-off, in energies.
    assert one[0] == pytest.approx(other[0], rel=2e-14, abs=0.0)
    assert one[1] == pytest.approx(other[1], rel=1e-12, abs=0.0)
    damping = abs(one[2] - one[0]) + abs(one[0]) + 1e-30
    assert one[2] == pytest.approx(other[2], rel=2e-14, abs=1e-13 * damping)


def test_every_kind_that_is_declared_is_known_to_the_kernels_and_no_other():
    """A kind that a kernel does not know gives NaN, never a silent zero."""
    kept = [ctypes.CFUNCTYPE(*[ctypes.c_double] * (count + 1))(lambda *_: 1.0) for count in (1, 3)]
    one, three = (float(ctypes.cast(function, ctypes.c_void_p).value) for function in kept)

    def of_normal(elastic, dissipation):
        code = np.ones(kernels.NORMAL_SIZE)
        record(code, NORMAL_LAW).elastic, record(code, NORMAL_LAW).dissipation = elastic, dissipation
        if elastic == number_of(kernels.called_force):
            record(code, elastic_record(kernels.called_force)).address = one
        if dissipation == number_of(kernels.called_whole):
            record(code, dissipation_record(kernels.called_whole)).whole = three
        return kernels.normal_force(code, 0.01, 0.1, 1.0, 1.0)

    def of_friction(law):
        code, rates = np.ones(FRICTION_SIZE), np.zeros(4)
        record(code, FRICTION_LAW).kind = kind = number_of(law.kernel) if law else 10.0
        if law is CustomFriction:
            record(code, friction_record(law.kernel)).address = one
        if law is None or not hasattr(law, "steady"):
            assert math.isnan(kernels.friction_ratio(code, 0.1, 1.0)) == (law is None), kind
        if law is None or hasattr(law, "steady"):
            state = np.full(4, 0.1)
            slip, across = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
            force = kernels.bristle_force(code, 1.0, slip, across, state, rates)[0]
            assert math.isnan(force) == (law is None), kind

    laws = [law for law in NORMAL_LAWS.values() if hasattr(law, "kernel")]
    elastic = {number_of(one) for one in (*(law.kernel for law in laws), kernels.called_force)}
    damped = {
        number_of(one) for one in (*(law.kernel for law in DISSIPATIONS.values()), kernels.called_whole)
    }
    assert len(elastic) == 7 and len(damped) == 10  # no digest stands for two
    power, free = number_of(Hertz.kernel), number_of(normal.NoDissipation.kernel)
    for kind in (*elastic, 7.0):
        assert math.isnan(of_normal(kind, free)) == (kind == 7.0), kind
    for kind in (*damped, 9.0):
        assert math.isnan(of_normal(power, kind)) == (kind == 9.0), kind
    for law in (*FRICTION_LAWS.values(), CustomFriction, None):
        of_friction(law)


def _kernel(*names):
    law = type("Law", (), {"__annotations__": dict.fromkeys(names, float)})

    def force(law, depth):
        return 0.0

    force.__annotations__ = {"law": law}
    return force


def test_a_law_is_written_by_the_names_of_its_record():
    """They are those of the class that a kernel's first argument is annotated with."""
    assert elastic_record(_kernel("a", "b")).names == ("a", "b")
    with pytest.raises(ValueError, match="there is room for 6"):
        dissipation_record(_kernel(*"abcdefg"))
    with pytest.raises(ValueError, match="numpy.void, got shape"):
        dissipation_record(_kernel("shape"))
    assert Hertz.kernel is not Johnson.kernel and elastic_record(Johnson.kernel).names == (
        "clearance",
        "force_scale",
        "depth_scale",
    )


def test_friction_kernels_equal_their_python(friction_law):
    code, rng = friction_law.code(), np.random.default_rng(2)
    assert code.shape == (FRICTION_SIZE,)
    for _ in range(100):
        slip = (rng.normal(size=3) * 10.0 ** rng.uniform(-6, 1)).tolist()
        speed = math.sqrt(sum(s * s for s in slip))
        kernel = kernels.friction_ratio
        # The ramp's (speed - v_0) cancels near its lower end; it does so alike in both.
        assert kernel(code, speed, 3.0) == pytest.approx(python(kernel)(code, speed, 3.0), rel=1e-14, abs=0.0)
        kernel = kernels.friction_force
        assert kernel(code, 12.0, *slip) == pytest.approx(
            python(kernel)(code, 12.0, *slip), rel=1e-12, abs=0.0
        )


def test_bristle_kernels_equal_their_python(bristle_law):
    code, rng = bristle_law.code(), np.random.default_rng(3)
    assert code.shape == (FRICTION_SIZE,)
    kernel = kernels.bristle_force
    scales = np.array(bristle_law.state_scales)
    for _ in range(100):
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        slip = np.cross(normal, rng.normal(size=3)) * 10.0 ** rng.uniform(-6, 0)
        state = scales * rng.uniform(-1, 1, size=scales.size)
        out = []
        for function in (kernel, python(kernel)):
            rates = np.zeros(scales.size)
            force = function(code, 12.0, tuple(slip.tolist()), tuple(normal.tolist()), state, rates)
            out.append([*force, *rates])
        size = np.abs(out[0]).max()
        assert out[0] == pytest.approx(out[1], rel=1e-12, abs=1e-13 * size)


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0, 4.0])
def test_integer_powers_continue_analytically_below_zero_depth(exponent):
    """So that a trial step across the end of a contact keeps the integrator's order."""
    for depth in (-1e-3, -1e-6, 1e-6, 1e-3):
        expected = depth ** int(exponent)
        assert normal.power(depth, exponent) == pytest.approx(expected, rel=1e-15, abs=0.0)  # round-off


@pytest.mark.parametrize("exponent", [10 / 9, 1.5, 2.5])
def test_other_powers_vanish_below_zero_depth(exponent):
    assert normal.power(-1e-6, exponent) == 0.0
    assert normal.power(0.0, exponent) == 0.0
    assert normal.power(1e-6, exponent) == pytest.approx(1e-6**exponent, rel=1e-15, abs=0.0)  # round-off


@pytest.mark.parametrize(
    "law", [Johnson(**DIMENSIONS), LiuPinJoint(**DIMENSIONS)], ids=lambda x: type(x).__name__
)
def test_nearly_linear_laws_continue_as_odd_functions(law):
    code = law.code()
    for depth in (1e-12, 1e-7, 3e-5):
        assert kernels.elastic_force(code, -depth) == -kernels.elastic_force(code, depth)
    assert kernels.elastic_force(code, 0.0) == 0.0


def test_persson_continues_analytically():
    """A parabola through three points around zero is met to the third order."""
    code, h = Persson(**DIMENSIONS).code(), 1e-8
    values = [kernels.elastic_force(code, k * h) for k in (-2, -1, 0, 1)]
    third = values[3] - 3.0 * values[2] + 3.0 * values[1] - values[0]
    assert abs(third) < 1e-6 * values[3]  # (h / dR)^2
    assert math.isfinite(kernels.elastic_force(code, -1.0))


def test_a_damper_does_not_pull_below_zero_depth_either():
    """Its force has ended before the contact does: there is nothing to continue."""
    law = KelvinVoigt(stiffness=1e6, damping=100.0)
    assert kernels.normal_force(law.code(), -1e-6, -0.1, 0.1, 1.0) == 0.0


def test_the_continuation_stays_below_the_surface_of_a_law():
    """The class, unlike the kernel, speaks of free flight: no force there."""
    law = Hertz(stiffness=1e9, exponent=1.0)
    assert kernels.normal_force(law.code(), -1e-6, 0.0, 1.0, 1.0) == pytest.approx(
        -1e3, rel=1e-15, abs=0.0
    )  # round-off
    assert law.force(-1e-6, 0.0, 1.0) == 0.0
