"""Models whose answers are known in closed form, as what a fit makes small."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Curve:
    """A function of time and parameters against a record of it.

    Attributes:
        names: Of the parameters.
        time: (m,).
        model: Of time and parameters, (m,).
        slopes: Its derivatives in the parameters, (m, p).
        record: (m,).
        sd: Standard deviation of its noise.
    """

    names: tuple[str, ...]
    time: Array
    model: Callable[[Array, Array], Array]
    slopes: Callable[[Array, Array], Array]
    record: Array
    start: Array
    sd: float = 1.0
    lower: Array = field(default_factory=lambda: np.zeros(0))
    upper: Array = field(default_factory=lambda: np.zeros(0))
    scale: Array = field(default_factory=lambda: np.zeros(0))
    runs: int = 0

    def __post_init__(self) -> None:
        count = len(self.names)
        self.lower = self.lower if self.lower.size else np.full(count, -np.inf)
        self.upper = self.upper if self.upper.size else np.full(count, np.inf)
        self.scale = self.scale if self.scale.size else np.where(self.start == 0.0, 1.0, np.abs(self.start))

    def residuals(self, values: Array) -> Array:
        self.runs += 1
        return (self.model(self.time, values) - self.record) / self.sd

    def jacobian(self, values: Array) -> Array:
        return self.slopes(self.time, values) / self.sd

    def best(self, loss: str = "linear", loss_scale: float = 1.0) -> Array:
        from scipy.optimize import least_squares

        found = least_squares(
            self.residuals,
            self.start,
            jac=self.jacobian,
            x_scale=self.scale,
            bounds=(self.lower, self.upper),
            loss=loss,
            f_scale=loss_scale,
            xtol=1e-14,
            ftol=1e-14,
            gtol=1e-14,
        )
        return found.x


def line(time: Array, record: Array, sd: float = 1.0, **more) -> Curve:
    """Intercept and slope of a straight line."""
    return Curve(
        ("intercept", "slope"),
        time,
        lambda t, x: x[0] + x[1] * t,
        lambda t, x: np.column_stack([np.ones_like(t), t]),
        record,
        np.array([1.0, 1.0]),
        sd,
        **more,
    )


def decay(time: Array, record: Array, sd: float = 1.0, **more) -> Curve:
    """Amplitude and rate of A exp(-k t)."""
    more.setdefault("start", np.array([1.0, 1.0]))
    return Curve(
        ("amplitude", "rate"),
        time,
        lambda t, x: x[0] * np.exp(-x[1] * t),
        lambda t, x: np.column_stack([np.exp(-x[1] * t), -x[0] * t * np.exp(-x[1] * t)]),
        record,
        sd=sd,
        **more,
    )


def oscillator(time: Array, record: Array, sd: float = 1.0, **more) -> Curve:
    """Mass and stiffness of a free mass on a spring, of which the motion has their ratio only."""

    more.setdefault("lower", np.array([1e-3, 1e-2]))

    def slopes(t: Array, x: Array) -> Array:
        omega = np.sqrt(x[1] / x[0])
        of_omega = -t * np.sin(omega * t)
        return np.column_stack([-0.5 * omega / x[0] * of_omega, 0.5 * omega / x[1] * of_omega])

    return Curve(
        ("mass", "stiffness"),
        time,
        lambda t, x: np.cos(np.sqrt(x[1] / x[0]) * t),
        slopes,
        record,
        np.array([2.0, 50.0]),
        sd,
        **more,
    )
