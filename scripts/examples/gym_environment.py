"""The antenna as an environment of Gymnasium: bring the elevation joint, which has play, to an angle."""

import numpy as np

from antenna_pin import load_scenario
from antenna_pin.run.session import start

try:
    import gymnasium  # of which antenna_pin knows nothing
except ImportError:
    gymnasium = None

MOTOR = "drives.elevation={kind='constant', value=0.0, replace=true}"


class Antenna(gymnasium.Env if gymnasium else object):
    """Torque of the motor in [N m], angle and rate of the joint out."""

    if gymnasium:
        action_space = gymnasium.spaces.Box(-4.0, 4.0, (1,), np.float64)
        observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (2,), np.float64)

    def __init__(self, target=1e-3, period=0.002, length=0.1):
        """Make one session, which each episode begins anew."""
        self.target, self.period, self.length = target, period, length
        self.session = start(load_scenario("bai2020", case="case3", overrides=[MOTOR]), record=False)

    def _seen(self):
        return np.array([self.session["elevation.angle"], self.session["elevation.rate"]])

    def reset(self, *, seed=None, options=None):
        """Begin an episode."""
        self.session.reset()
        return self._seen(), {}

    def step(self, action):
        """Hold a torque for a period."""
        self.session.command["elevation"] = float(action[0])
        goes_on = self.session.step(self.period)
        seen = self._seen()
        late = self.session.time > self.length - 0.5 * self.period
        return seen, -abs(seen[0] - self.target), not goes_on, late, {"outcome": self.session.outcome.name}


if __name__ == "__main__":
    environment = Antenna()
    seen, _ = environment.reset(seed=0)
    done, total = False, 0.0
    while not done:
        torque = 4e3 * (environment.target - seen[0]) - 80.0 * seen[1]
        seen, reward, terminated, truncated, about = environment.step(np.clip([torque], -4.0, 4.0))
        total, done = total + reward, terminated or truncated
    print(f"angle {seen[0]:.9f} rad after {environment.session.time:g} s, {about['outcome']}")
