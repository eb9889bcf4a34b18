"""A panel that a spring unfolds against a stop, and an accelerometer on it, by equations of their own.

Of the package nothing is used: one angle, and the filter's four numbers in the same equations, by SciPy's
steps from touch to touch. The angle goes from 0 to beyond -pi/2, where the stop presses back by K d + D d',
and never pulls.
"""

import numpy as np
from scipy import signal
from scipy.integrate import solve_ivp

MASS, CENTRE, OWN_INERTIA = 4.0, 0.3, 0.12013  # of the panel; the centre from the hinge [m]
INERTIA = OWN_INERTIA + MASS * CENTRE**2  # about the hinge; 0.05 m of the centre are along its axis
REST, LIMIT = np.radians(-120.0), np.radians(-90.0)
ALONG, ACROSS = -0.55, 0.01  # of the sensor: down the panel (z) and out of its middle (x) [m]
CORNER, ORDER = 100.0, 4  # of the filter, Butterworth's [Hz], [-]
# x' = w (A x + B u), out = C x, for a corner of 1 rad/s.
FILTER = signal.tf2ss(*signal.butter(ORDER, 1.0, analog=True))


def record(spring, damping, stiffness, resistance, offset, times):
    """Return what the accelerometer reads at times, rising, without noise [m/s^2].

    Args:
        spring: Of the hinge [N m/rad].
        damping: Of it [N m s/rad].
        stiffness: Of the stop [N m/rad].
        resistance: Its damping [N m s/rad].
        offset: Of the sensor [m/s^2].
        times: After the panel was let go [s].
    """
    inner, into, out, _ = FILTER
    corner = 2.0 * np.pi * CORNER

    def pressed(state):
        return stiffness * (LIMIT - state[0]) - resistance * state[1]

    def turning(state, mode):
        free = -spring * (state[0] - REST) - damping * state[1]
        return (free + (pressed(state) if mode == "pressed" else 0.0)) / INERTIA

    first = turning([0.0, 0.0], "free") * ALONG  # which the filter has seen for long

    def rates(_, state, mode):
        turn = turning(state, mode)
        read = turn * ALONG - state[1] ** 2 * ACROSS - first
        return np.concatenate([[state[1], turn], corner * (inner @ state[2:] + into[:, 0] * read)])

    def ends(_, state, mode):
        """Pass zero downwards where a mode ends: at the touch, where nothing presses, back at the limit."""
        return {"free": state[0] - LIMIT, "pressed": pressed(state), "behind": LIMIT - state[0]}[mode]

    ends.terminal, ends.direction = True, -1.0
    after = {"free": "pressed", "pressed": "behind", "behind": "free"}
    found = np.full(len(times), offset + first)
    now, state, mode = 0.0, np.zeros(2 + ORDER), "free"
    while now < times[-1]:
        made = solve_ivp(
            rates, (now, times[-1] + 1e-9), state, "DOP853", events=ends, args=(mode,),
            dense_output=True, rtol=1e-10, atol=1e-12, max_step=2e-3,
        )  # fmt: skip
        for k in np.flatnonzero((times >= now) & (times <= made.t[-1])):
            found[k] += (out @ made.sol(times[k])[2:]).item()
        now, state, mode = made.t[-1], made.y[:, -1], after[mode]
    return found


TRUTH = {"spring": 2.0, "damping": 0.1, "stop": 2000.0, "stop_damping": 10.0, "offset": 0.3, "clock": -0.0137}
NOISE, SEED = 0.5, 35  # of the sensor [m/s^2]
CLOCK = np.arange(701) * 2e-3  # of the recorder, which was started before the panel was let go [s]


def clean():
    """Return what the sensor reads at the recorder's times without noise, (n,) [m/s^2]."""
    *numbers, early = TRUTH.values()
    times = np.maximum(CLOCK + early, 0.0)
    return np.where(CLOCK + early >= 0.0, record(*numbers, times), TRUTH["offset"])


def text():
    """Return the record as the recorder writes it."""
    noise = NOISE * np.random.default_rng(SEED).standard_normal(len(CLOCK))
    head = (
        "Deployment test;made by tests/reference/deployed_panel.py",
        "Channels;1",
        "Rate;500 Hz",
        "time;a_tip",
        "[ms];[m/s**2]",
    )
    rows = [
        f"{1e3 * time:.0f};{read:.3f}".replace(".", ",")
        for time, read in zip(CLOCK, clean() + noise, strict=True)
    ]
    return "\n".join([*head, *rows]) + "\n"
