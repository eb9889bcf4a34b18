"""Exponents of motions whose contact lasts: what it remembers is no direction in which neighbours differ."""

import numpy as np
import pytest

from antenna_pin.studies.nonlinear import flow_of, largest_exponent, lyapunov_spectrum

GRAVITY, HOLLOW, STIFFNESS, SPEED = 9.81, 0.1, 1e4, 0.05
SLIP, SPRING, DAMPING = 0.1 * GRAVITY / 0.3, 4.0, 0.5
CHANGES = [
    f"clearance.hollow.normal.stiffness={STIFFNESS}",
    "clearance.hollow.friction={law='tanh', coefficient_of_friction=0.1, transition_speed='0.3 m/s'}",
    f"springs.hollow={{stiffness='{SPRING} N*m/rad', damping={DAMPING}}}",
    "drives.shaker.amplitude='0.1 mm'",
]


def test_a_ball_that_lies_in_a_hollow(ball_on_table):
    """It lands once and stays; its six exponents are those of the oscillator that it then is.

    K d^(3/2) (1 + chi d') under gravity has stiffness 3/2 K d^(1/2) and damping g chi, with the speed of the
    one landing in chi. Sideways it swings in the hollow and turns on a spring, and friction couples both.
    """
    flow, rest = flow_of(ball_on_table(GRAVITY, HOLLOW, 0.5).with_overrides(CHANGES), rtol=1e-9)
    q, v = rest.q.copy(), rest.v.copy()
    q[2], v[2] = HOLLOW - 1e-6, SPEED
    start = flow.after(flow.first(q, v), 0.5)
    (contact,) = start.contacts
    chi, depth = 0.75 * (1.0 - 0.5**2) / contact.approach_speed, (GRAVITY / STIFFNESS) ** (2.0 / 3.0)
    lies, arm = HOLLOW + depth, 1.0 - HOLLOW - depth
    sideways = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-GRAVITY / lies, -SLIP, 0.0, -SLIP * arm],
            [0.0, 0.0, 0.0, 1.0],
            [0.0, -SLIP * arm, -SPRING, -DAMPING - SLIP * arm**2],
        ]
    )
    upright = np.roots([1.0, GRAVITY * chi, 1.5 * STIFFNESS * np.sqrt(depth)])
    expected = np.sort(np.concatenate([np.linalg.eigvals(sideways), upright]).real)[::-1]
    largest = largest_exponent(flow, start, 0.2, 50)
    assert largest.verdict == "contracting"
    # A distance that swings grows and shrinks by some e, which over 10 s is 0.1 1/s.
    assert largest.values[0] == pytest.approx(expected[0], abs=0.1)
    spectrum = lyapunov_spectrum(flow, start, 0.05, 10)
    assert len(spectrum.values) == 6
    # The table's motion changes the force by its rms over gravity, 1e-4, and the sum is the divergence.
    assert spectrum.values.sum() == pytest.approx(expected.sum(), rel=1e-3)
