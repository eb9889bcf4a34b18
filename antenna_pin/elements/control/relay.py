"""Sampled three-state relay, for thrusters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from antenna_pin.base.arguments import takes
from antenna_pin.base.parameters import check, parameter
from antenna_pin.elements.control.controller import Now, SampledController
from antenna_pin.elements.control.measurement import Measure, Sensor
from antenna_pin.errors import InvalidParameterError


@dataclass
class BangBangState:
    """State of a relay.

    Attributes:
        way: Direction of the command: 1, -1, or 0 if off.
        since: Instants for which it has been so.
    """

    way: int = 0
    since: int = 0


@takes()
@dataclass(frozen=True, kw_only=True)
class BangBang(SampledController):
    r"""Sampled three-state relay, by a line in the plane of angle and rate.

    .. math:: s_k = (r - y_k) - T \dot y_k

    It comes on, in the sense of s, where :math:`|s|` is more than the dead band, and goes off where it is
    less than that by more than the hysteresis (a Schmitt trigger) or has changed its sign. With no dead band
    it is a relay: it goes from one way to the other where s has passed zero by more than the hysteresis.

    Attributes:
        acts_on: Drive, commanded with plus or minus ``level``.
        positive: Or what pushes one way, commanded with ``level`` or 0: thrusters.
        negative: And what pushes the other way.
        measures: y, as ``base-rotation x``.
        measures_rate: Its rate, as ``base-rate x``; none if not given.
        slope: T: how much a rate counts [s].
        reference: r, in the unit of what is measured, SI.
        dead_band: Likewise.
        hysteresis: Likewise.
        level: Of the command that is on, in SI units.
        minimum_on: Time for which it stays on at least [s].
        sensor: Of what is measured.
        rate_sensor: Of the rate.
        state: Its memory.
    """

    acts_on: str = ""
    positive: tuple[str, ...] = ()
    negative: tuple[str, ...] = ()
    measures: str
    measures_rate: str = ""
    slope: float = parameter("s", rule="zero or more", default=0.0)
    reference: float = parameter(default=0.0)
    dead_band: float = parameter(rule="zero or more", default=0.0)
    hysteresis: float = parameter(rule="zero or more", default=0.0)
    level: float = parameter(rule="positive", default=1.0)
    minimum_on: float = parameter("s", rule="zero or more", default=0.0)
    sensor: Sensor = field(default_factory=Sensor)
    rate_sensor: Sensor = field(default_factory=Sensor)
    state: BangBangState = field(default_factory=BangBangState, repr=False)

    signals = ("measured", "line")

    def __post_init__(self) -> None:
        """Check the parameters together."""
        check(self)
        if bool(self.acts_on) == bool(self.positive or self.negative):
            rule = "given, or positive and negative, and not both"
            raise InvalidParameterError(self, "acts_on", rule, self.acts_on)
        if bool(self.measures_rate) != (self.slope > 0.0):
            raise InvalidParameterError(
                self, "slope", "above zero with measures_rate, and only then", self.slope
            )
        Measure.read(self, "measures", self.measures)
        if self.measures_rate:
            Measure.read(self, "measures_rate", self.measures_rate)
        if self.dead_band and not self.hysteresis <= self.dead_band:
            rule = f"at most dead_band = {self.dead_band:g}, or it would never go off"
            raise InvalidParameterError(self, "hysteresis", rule, self.hysteresis)

    @property
    def commands(self) -> tuple[str, ...]:  # type: ignore[override]
        """Names of commanded actuators."""
        return (self.acts_on,) if self.acts_on else (*self.positive, *self.negative)

    @cached_property
    def measured(self) -> tuple[Measure, ...]:
        """Measured quantities."""
        rate = [Measure.read(self, "measures_rate", self.measures_rate)] if self.measures_rate else []
        return (Measure.read(self, "measures", self.measures), *rate)

    def update(self, now: Now) -> Mapping[str, float]:
        """Return the commands from now on."""
        state = self.state
        value, *rates = self.measured
        measured = self.sensor.read(value(now), now.tick)
        line = self.reference - measured
        if rates:
            line -= self.slope * self.rate_sensor.read(rates[0](now), now.tick, 1)
        way = self._way(line)
        least = math.ceil(self.minimum_on / self.period - 1e-9)
        if state.way not in (0, way) and state.since < least:
            way = state.way
        state.since = state.since + 1 if way == state.way else 1
        state.way = way
        now.note(measured=measured, line=line)
        if self.acts_on:
            return {self.acts_on: way * self.level}
        on = {name: self.level * (way > 0) for name in self.positive}
        return on | {name: self.level * (way < 0) for name in self.negative}

    def _way(self, line: float) -> int:
        """Return the sign of the command."""
        before = self.state.way
        toward = (line > 0.0) - (line < 0.0)
        if self.dead_band == 0.0:
            return before if before and line * before > -self.hysteresis else toward
        if before and line * before > self.dead_band - self.hysteresis:
            return before
        return toward if abs(line) > self.dead_band else 0

    def words(self) -> str:
        """Return a description."""
        return f"on and off by {self.measures}, dead band {self.dead_band:g}, hysteresis {self.hysteresis:g}"
