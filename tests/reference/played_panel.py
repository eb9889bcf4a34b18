"""A panel on a hinge with play that a spring unfolds against a stop, by equations of its own and SciPy's.

Of the package nothing is used: Newton's and Euler's laws for one body with three freedoms, a circle in a
circle with Lankarani and Nikravesh's force and friction by tanh, a stop that presses back by K d + D d' and
never pulls. In the plane x and z, turns from z to x; SciPy finds every touch and release.
"""

import numpy as np
from scipy.integrate import solve_ivp

MASS, CENTRE, INERTIA = 4.0, 0.3, 0.12013  # of the panel; its centre from the journal [m]; about its centre
REST, LIMIT = np.radians(-120.0), np.radians(-90.0)  # of spring and stop
PLAY, STIFFNESS, RESTITUTION, EXPONENT = 2e-4, 1e9, 0.6, 1.5  # of the joint
BEARING_RADIUS, TRANSITION, FRICTION = 5e-3, 1e-2, 0.15

TRUTH = {"spring": 2.0, "damping": 0.1, "stop": 2000.0, "stop_damping": 4.0}
NOISE, SEED = 1e-3, 35  # of the encoder [rad]
TIMES = np.arange(1, 501) * 1e-2  # [s]


def record(spring, damping, stop, resistance, times):
    """Return the angle by which the panel has turned at times, rising [rad].

    It starts with its journal in the bearing's middle, at rest.

    Args:
        spring: Of the hinge [N m/rad].
        damping: Of it [N m s/rad].
        stop: Its stiffness [N m/rad].
        resistance: Its damping [N m s/rad].
        times: After the panel was let go [s].
    """

    def pressed(state):
        return stop * (LIMIT - state[2]) - resistance * state[5]

    def rates(_, state, approach, mode):
        (x, z, turn), velocity, spin = state[:3], state[3:5], state[5]
        force, moment = np.zeros(2), -spring * (turn - REST) - damping * spin
        centre = -CENTRE * np.array([np.sin(turn), np.cos(turn)])  # from the journal
        if mode == "pressed":
            moment += pressed(state)
        if approach > 0.0:
            distance = np.hypot(x, z)
            out = np.array([x, z]) / distance
            across = np.array([out[1], -out[0]])  # where a turn moves what is outwards
            depth, rate = max(distance - PLAY, 0.0), velocity @ out
            loss = 0.75 * (1.0 - RESTITUTION**2) * rate / approach
            normal = max(STIFFNESS * depth**EXPONENT * (1.0 + loss), 0.0)
            slip = velocity @ across + spin * (BEARING_RADIUS - distance)
            force = -normal * out - FRICTION * np.tanh(slip / TRANSITION) * normal * across
            arm = BEARING_RADIUS * out - np.array([x, z]) - centre
            moment += arm[1] * force[0] - arm[0] * force[1]
        turning = moment / INERTIA
        carried = turning * np.array([centre[1], -centre[0]]) - spin**2 * centre
        return np.concatenate([state[3:], force / MASS - carried, [turning]])

    def gap(_, state, approach, mode):
        return (PLAY - np.hypot(*state[:2])) * (1.0 if approach == 0.0 else -1.0)

    def stopped(_, state, approach, mode):
        """Pass zero downwards where a mode ends: at the touch, where nothing presses, back at the limit."""
        return {"free": state[2] - LIMIT, "pressed": pressed(state), "behind": LIMIT - state[2]}[mode]

    for event in (gap, stopped):
        event.terminal, event.direction = True, -1.0
    after = {"free": "pressed", "pressed": "behind", "behind": "free"}
    now, state, approach, mode, found = 0.0, np.zeros(6), 0.0, "free", []
    while len(found) < len(times):
        made = solve_ivp(
            rates, (now, times[-1] + 1e-9), state, "DOP853", events=(gap, stopped), args=(approach, mode),
            dense_output=True, rtol=1e-9, atol=1e-12, max_step=1e-3,
        )  # fmt: skip
        for time in times[len(found) :]:
            if time > made.t[-1]:
                break
            found.append(made.sol(time)[2])
        now, state = made.t[-1], made.y[:, -1]
        if len(made.t_events[0]):
            speed = state[3:5] @ state[:2] / np.hypot(*state[:2])
            approach = speed if approach == 0.0 else 0.0
        if len(made.t_events[1]):
            mode = after[mode]
    return np.array(found)


def text():
    """Return the record with its noise, as a logger writes it."""
    noise = NOISE * np.random.default_rng(SEED).standard_normal(len(TIMES))
    rows = zip(TIMES, record(*TRUTH.values(), TIMES) + noise, strict=True)
    return "time,angle\n" + "".join(f"{time:.2f},{read:.5f}\n" for time, read in rows)
