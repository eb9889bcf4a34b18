"""Motions from functions: what jumps, or is no derivative, ends the run; what is only steep does not."""

import math

import numpy as np
import pytest
from numba import njit

from antenna_pin import System, Urdf, build_mechanism, simulate
from antenna_pin.elements import CallableMotion
from antenna_pin.trajectory import Outcome

ARM = """<robot name="r"><link name="base"/><link name="arm"><inertial><mass value="2"/>
<origin xyz="0.3 0 0"/><inertia ixx="0.01" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint>
</robot>"""


def ended(position, velocity, acceleration):
    """Return how a run of 1 s with a motion from functions ends, and in which words."""
    motion = CallableMotion(joint="j", position=position, velocity=velocity, acceleration=acceleration)
    system = System(build_mechanism(Urdf.from_text(ARM, "arm"), base="fixed"), drives={"j": motion})
    angle = position(0.0)
    run = simulate(system, duration=1.0, q=[math.cos(angle), math.sin(angle)], v=[velocity(0.0)])
    return run.outcome, run.message


def zero(t):
    return 0.0


REFUSED = {
    "position jumps": (
        (lambda t: 0.5 if t > 0.5 else 0.0, zero, zero),
        "drive 'j': its position jumps by 0.5 rad at t = 0.5 s",
    ),
    "velocity jumps": (
        (lambda t: abs(t - 0.5), lambda t: math.copysign(1.0, t - 0.5), zero),
        "drive 'j': its velocity jumps by 2 rad/s at t = 0.5 s",
    ),
    "compiled": (
        (njit(lambda t: max(t - 0.25, 0.0)), njit(lambda t: 1.0 if t > 0.25 else 0.0), njit(lambda t: 0.0)),
        "drive 'j': its velocity jumps by 1 rad/s at t = 0.25 s",
    ),
    "half a velocity": (
        (lambda t: t * t, lambda t: t, lambda t: 1.0),
        "drive 'j': velocity gives",
    ),
    "no acceleration": (
        (math.sin, math.cos, zero),
        "drive 'j': acceleration gives 0 rad/s²",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_jumps_or_is_no_derivative_ends_the_run_where_it_is(what):
    functions, words = REFUSED[what]
    outcome, message = ended(*functions)
    assert outcome is Outcome.REFUSED and words in message


def pulse(t):
    return (t - 0.5) / 1e-3


STEEP = {
    "fast": (
        lambda t: 1e-3 * math.sin(2e3 * t),
        lambda t: 2.0 * math.cos(2e3 * t),
        lambda t: -4e3 * math.sin(2e3 * t),
    ),
    "acceleration jumps": (
        lambda t: 0.5 * min(t, 0.3) ** 2 + 0.3 * max(t - 0.3, 0.0),
        lambda t: min(t, 0.3),
        lambda t: 1.0 if t < 0.3 else 0.0,
    ),
    "slow": (lambda t: 3.0 + 1e-9 * t, lambda t: 1e-9, zero),
    "at rest": (zero, zero, zero),
    "a pulse": (
        lambda t: math.exp(-(pulse(t) ** 2)),
        lambda t: -2e3 * pulse(t) * math.exp(-(pulse(t) ** 2)),
        lambda t: (4e6 * pulse(t) ** 2 - 2e6) * math.exp(-(pulse(t) ** 2)),
    ),
    "single precision": (
        lambda t: float(np.float32(math.sin(t))),
        lambda t: float(np.float32(math.cos(t))),
        lambda t: float(np.float32(-math.sin(t))),
    ),
}


@pytest.mark.parametrize("what", STEEP)
def test_what_is_steep_goes_on(what):
    outcome, message = ended(*STEEP[what])
    assert outcome is Outcome.COMPLETED, message
