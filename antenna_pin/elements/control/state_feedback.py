"""Sampled linear feedback of measurements by matrices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.parameters import check, parameter
from antenna_pin.elements.control.controller import Now, SampledController, limited
from antenna_pin.elements.control.measurement import Measure, Sensor
from antenna_pin.errors import InvalidParameterError

Array = NDArray[np.float64]

Matrix = tuple[tuple[float, ...], ...]
"""Rows of numbers."""


@takes()
@dataclass(frozen=True, kw_only=True)
class StateFeedback(SampledController):
    r"""Sampled linear feedback of measurements by matrices.

    .. math:: u_k = f - K (y_k - r) + C z_k, \quad z_{k+1} = A z_k + B (y_k - r) + G u_k

    u are the commands, within their limits, y the measurements. Without A, B and C it has no state; with them
    it is any linear controller, such as one with an observer: G feeds the limited command to it.

    Attributes:
        acts_on: Commanded drives, by name: m of them.
        measures: Measurements, as ``angle hinge`` and ``rate hinge``: p of them.
        gain: K, (m, p), in SI units.
        a: A, (n, n).
        b: B, (n, p).
        c: C, (m, n).
        g: G, (n, m); zero if not given.
        start: z at the first sampling time, (n,); zero if not given.
        reference: r, (p,), in SI units; zero if not given.
        feedforward: f, (m,), in SI units; zero if not given.
        lower: Least commands, (m,); none if not given.
        upper: Largest commands, (m,); none if not given.
        sensors: One for each measure, or one for all.
        state: z.
    """

    acts_on: tuple[str, ...]
    measures: tuple[str, ...]
    gain: Matrix | None = None
    a: Matrix | None = None
    b: Matrix | None = None
    c: Matrix | None = None
    g: Matrix | None = None
    start: tuple[float, ...] | None = parameter(sizes=(0,), default=None)
    reference: tuple[float, ...] | None = parameter(sizes=(0,), default=None)
    feedforward: tuple[float, ...] | None = parameter(sizes=(0,), default=None)
    lower: tuple[float, ...] | None = parameter(sizes=(0,), default=None)
    upper: tuple[float, ...] | None = parameter(sizes=(0,), default=None)
    sensors: tuple[Sensor, ...] = ()
    state: Array = field(default_factory=lambda: np.zeros(0), repr=False)

    def __post_init__(self) -> None:
        """Check that all sizes go together."""
        check(self)
        for name in ("acts_on", "measures"):
            if not getattr(self, name):
                raise InvalidParameterError(self, name, "one name or more", ())
        for text in self.measures:
            Measure.read(self, "measures", text)
        m, p = len(self.acts_on), len(self.measures)
        n = 0 if self.a is None else len(self.a)
        if self.gain is None and self.a is None:
            raise InvalidParameterError(self, "gain", "given, or a, b and c", None)
        if self.g is not None and self.a is None:
            raise InvalidParameterError(self, "g", "left out without a", self.g)
        shapes = {"gain": (m, p), "a": (n, n), "b": (n, p), "c": (m, n), "g": (n, m)}
        for name, shape in shapes.items():
            given = getattr(self, name)
            if given is not None and self._shape(name) != shape:
                rule = f"{shape[0]} rows of {shape[1]} finite numbers"
                raise InvalidParameterError(self, name, rule, given)
            if name in ("b", "c") and (given is None) != (self.a is None):
                raise InvalidParameterError(self, name, "given beside a, and only there", given)
        for name, size in (("start", n), ("reference", p), ("feedforward", m), ("lower", m), ("upper", m)):
            given = getattr(self, name)
            if given is not None and len(given) != size:
                raise InvalidParameterError(self, name, f"{size} numbers", given)
        if self.lower is not None and self.upper is not None:
            for k, (low, high) in enumerate(zip(self.lower, self.upper, strict=True)):
                if not low < high:
                    raise InvalidParameterError(self, f"upper[{k}]", f"above lower = {low:g}", high)
        if len(self.sensors) not in (0, 1, p):
            raise InvalidParameterError(
                self, "sensors", f"one for each of {p} measures, or one", self.sensors
            )
        if not self.state.size:
            object.__setattr__(self, "state", np.array(self.start or np.zeros(n), dtype=float))

    def _shape(self, name: str) -> tuple[int, ...]:
        try:
            found = np.array(getattr(self, name), dtype=float)
        except (TypeError, ValueError):
            return ()
        return found.shape if np.isfinite(found).all() else ()

    @property
    def signals(self) -> tuple[str, ...]:  # type: ignore[override]
        """Recorded signals: measurements, and saturation of commands."""
        return (*self.measures, "saturated")

    @cached_property
    def measured(self) -> tuple[Measure, ...]:
        """Measured quantities."""
        return tuple(Measure.read(self, "measures", text) for text in self.measures)

    def update(self, now: Now) -> Mapping[str, float]:
        """Return the commands from now on."""
        sensors = (
            self.sensors if len(self.sensors) > 1 else (*self.sensors, *[Sensor()])[:1] * len(self.measures)
        )
        seen = [
            sensor.read(measure(now), now.tick, k)
            for k, (measure, sensor) in enumerate(zip(self.measured, sensors, strict=True))
        ]
        off = np.array(seen) - (0.0 if self.reference is None else np.array(self.reference))
        wished = np.zeros(len(self.acts_on))
        if self.feedforward is not None:
            wished = wished + np.array(self.feedforward)
        if self.gain is not None:
            wished = wished - np.array(self.gain) @ off
        if self.c is not None:
            wished = wished + np.array(self.c) @ self.state
        none = [None] * len(self.acts_on)
        bounds = zip(self.lower or none, self.upper or none, strict=True)
        used = [limited(float(one), 0.0, None, both) for one, both in zip(wished, bounds, strict=True)]
        if self.a is not None:
            following = np.array(self.a) @ self.state + np.array(self.b) @ off
            self.state[:] = following if self.g is None else following + np.array(self.g) @ np.array(used)
        held = float(any(a != b for a, b in zip(used, wished.tolist(), strict=True)))
        now.note(**dict(zip(self.measures, seen, strict=True)), saturated=held)
        return dict(zip(self.acts_on, used, strict=True))

    def words(self) -> str:
        """Return a description."""
        states = f", {len(self.a)} states of its own" if self.a is not None else ""
        return f"state feedback of {', '.join(self.measures)}{states}"
