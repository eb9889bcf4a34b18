"""A driven mass on a spring against a stop, by exact flights: its orbits with one impact, in closed form."""

import math

import numpy as np
from scipy.linalg import expm
from scipy.optimize import root


class Impacts:
    """A mass on a spring that is driven against a stop, by exact flows between impacts."""

    def __init__(self, m, k, c, force, frequency, stop, restitution):
        self.matrix = np.array([[0.0, 1.0], [-k / m, -c / m]])
        self.m, self.force, self.w = m, force, 2.0 * math.pi * frequency
        self.period, self.stop, self.r = 1.0 / frequency, stop, restitution
        self.steady = force / (k - m * self.w**2 + 1j * c * self.w)

    def particular(self, t):
        turned = self.steady * np.exp(1j * self.w * t)
        return np.array([turned.imag, (1j * self.w * turned).imag])

    def flight(self, t, state, span):
        return self.particular(t + span) + expm(self.matrix * span) @ (state - self.particular(t))

    def acceleration(self, t, state):
        return self.matrix[1] @ state + self.force * math.sin(self.w * t) / self.m

    def orbit(self, guess):
        """Return instant and speed after the impact of the orbit with one impact in a period."""

        def misses(unknown):
            t, v = unknown
            x, speed = self.flight(t, np.array([self.stop, v]), self.period)
            return x - self.stop, v + self.r * speed

        # Asked for its last digit it may say that it gets no further: what it misses by tells.
        found = root(misses, guess, options={"xtol": 1e-13})
        assert np.abs(found.fun).max() < 1e-13
        return found.x

    def multipliers(self, t, v):
        """Eigenvalues of the flight over a period after the impact's jump of the tangent (its saltation)."""
        before = -v / self.r
        jump_rate = self.acceleration(t, np.array([self.stop, v]))
        jump_rate += self.r * self.acceleration(t, np.array([self.stop, before]))
        jump = np.array([[-self.r, 0.0], [jump_rate / before, -self.r]])
        return np.linalg.eigvals(expm(self.matrix * self.period) @ jump)
