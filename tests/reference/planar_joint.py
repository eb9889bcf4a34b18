"""A bar that hangs from a hinge with play and keeps its plane, by equations of its own and SciPy's steps.

Of the package nothing is used: Newton's and Euler's laws for one body with three freedoms, the contact of a
circle in a circle, Lankarani and Nikravesh's force, friction by tanh; SciPy finds the onsets and releases.
In the plane x to the right, y downwards, turns from x to y.
"""

import numpy as np
from scipy.integrate import solve_ivp

MASS, INERTIA, LENGTH = 1.872, 0.0251004, 0.2  # about the mass centre, which is LENGTH below the journal
GRAVITY, BEARING_RADIUS, TRANSITION, DAMPING = 9.80665, 0.01, 1e-2, 1.2
EXPONENT = 1.5
FIRST_ANGLE = np.radians(10.0)


def record(play, stiffness, restitution, friction, times, velocity=(0.15, 0.0), angle=FIRST_ANGLE):
    """Return what sensors read at times: journal (n, 2) [m], force on it (n, 2) [N], angle (n,) [rad].

    It starts in the bore's middle, with a velocity of the journal [m/s].
    """

    def force(state, approach):
        """Return force and moment about the mass centre; approach is 0 where nothing touches."""
        p, v, turn, spin = state[:2], state[3:5], state[2], state[5]
        if approach == 0.0:
            return np.zeros(2), 0.0
        distance = np.hypot(*p)
        out = p / distance
        across = np.array([-out[1], out[0]])
        depth, rate = max(distance - play, 0.0), v @ out
        hysteresis = 1.0 + 0.75 * (1.0 - restitution**2) * rate / approach
        normal = max(stiffness * depth**EXPONENT * hysteresis, 0.0)
        slip = v @ across + spin * (
            BEARING_RADIUS - distance
        )  # of the journal's point at the bearing's surface
        whole = -normal * out - friction * np.tanh(slip / TRANSITION) * normal * across
        arm = BEARING_RADIUS * out - p - LENGTH * np.array([-np.sin(turn), np.cos(turn)])
        return whole, arm[0] * whole[1] - arm[1] * whole[0]

    def rates(_, state, approach):
        whole, moment = force(state, approach)
        turn, spin = state[2], state[5]
        r = LENGTH * np.array([-np.sin(turn), np.cos(turn)])
        turning = (moment - DAMPING * spin) / INERTIA
        centre = whole / MASS + np.array([0.0, GRAVITY])
        journal = centre - turning * np.array([-r[1], r[0]]) + spin**2 * r
        return np.concatenate([state[3:], journal[:1], journal[1:], [turning]])

    def gap(_, state, approach):
        return play - np.hypot(*state[:2])

    gap.terminal = True
    now, state, approach = 0.0, np.array([0.0, 0.0, angle, *velocity, 0.0]), 0.0
    places, forces, angles = [], [], []
    while len(angles) < len(times):
        gap.direction = -1.0 if approach == 0.0 else 1.0
        step = 1e-3 if approach == 0.0 else 2e-5
        wanted = np.array(times[len(angles) :])
        found = solve_ivp(
            rates, (now, times[-1] + 1e-9), state, "DOP853", events=gap, args=(approach,),
            dense_output=True, rtol=1e-10, atol=1e-13, max_step=step,
        )  # fmt: skip
        for time in wanted[wanted <= found.t[-1]]:
            there = found.sol(time)
            places.append(there[:2])
            forces.append(force(there, approach)[0])
            angles.append(there[2])
        now, state = found.t[-1], found.y[:, -1]
        if approach == 0.0:
            approach = state[3:5] @ state[:2] / np.hypot(*state[:2])
        else:
            approach = 0.0
    return np.array(places), np.array(forces), np.array(angles)
