"""Measurements of controllers: quantities such as ``"angle hinge"``, and sensors with bias, noise, steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.parameters import LEAST, check, parameter
from antenna_pin.elements.control.controller import Now
from antenna_pin.errors import InvalidParameterError, nearest

# --- sensors ------------------------------------------------------------------------------------------------


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    r"""Sensor: a number with bias and noise, in whole steps.

    .. math:: y = d \, \mathrm{round}((x + b + \sigma n) / d)

    Noise is white from one sampling time to the next: n is drawn from a normal distribution by the seed and
    the number of the sampling time alone, so that it does not depend on earlier measurements.

    Attributes:
        bias: b, in the number's unit.
        noise: Standard deviation, sigma, in the number's unit.
        seed: Of the noise; controllers with one seed have the same noise [-].
        resolution: d, one step, in the number's unit; 0 for none.
        counts: Steps a turn instead, of an angle [-].
        bits: Instead, so many that a turn has 2^bits steps [-].
        rounding: To the nearest step, halves up; down; or towards zero.
    """

    bias: float = parameter(default=0.0)
    noise: float = parameter(rule="zero or more", default=0.0)
    seed: int = parameter(rule="zero or more", default=0)
    resolution: float = parameter(rule="zero or more", default=0.0)
    counts: int | None = parameter(rule="1 or more", default=None)
    bits: int | None = parameter(rule="1 or more", default=None)
    rounding: Literal["half-up", "floor", "truncate"] = "half-up"

    def __post_init__(self) -> None:
        """Check the parameters together."""
        check(self)
        given = [name for name in ("resolution", "counts", "bits") if getattr(self, name)]
        if len(given) > 1:
            rule = f"omitted if {given[0]} is given; a sensor has steps of one size"
            raise InvalidParameterError(self, given[1], rule, getattr(self, given[1]))
        if 0.0 < self.resolution < LEAST:
            raise InvalidParameterError(
                self, "resolution", f"0 for none, or {LEAST:g} or more", self.resolution
            )
        if self.bits is not None and self.bits > 52:
            raise InvalidParameterError(self, "bits", "52 or less, as a double has", self.bits)

    @property
    def step(self) -> float:
        """Quantisation step, in the number's unit; 0 for none."""
        if self.counts is not None:
            return 2.0 * math.pi / self.counts
        return 2.0 * math.pi / 2**self.bits if self.bits is not None else self.resolution

    def read(self, number: float, tick: int, channel: int = 0) -> float:
        """Return the reading.

        Args:
            number: What is.
            tick: Number of the sampling time, of which the noise is.
            channel: Number of the sensor among those of one controller, likewise.
        """
        seen = number + self.bias
        if self.noise > 0.0:
            bits = np.random.Philox(key=[self.seed, channel], counter=[0, 0, 0, tick])
            seen += self.noise * float(np.random.Generator(bits).standard_normal())
        step = self.step
        if step == 0.0:
            return seen
        count = seen / step
        if self.rounding == "half-up":
            return step * math.floor(count + 0.5)
        return step * (math.floor(count) if self.rounding == "floor" else math.trunc(count))


# --- measured quantities ------------------------------------------------------------------------------------

_AXES = "xyz"

# What may be measured: what it is of, and how it is called for.
_KINDS: Mapping[str, tuple[str, Callable[[Now, str], float]]] = {
    "angle": ("joint", lambda now, name: now.angle(name)),
    "rate": ("joint", lambda now, name: now.rate(name)),
    "base-rotation": ("axis", lambda now, axis: float(now.base_rotation()[_AXES.index(axis)])),
    "base-rate": ("axis", lambda now, axis: float(now.base_rate()[_AXES.index(axis)])),
    "force": ("contact", lambda now, name: now.force(name)),
    "gap": ("contact", lambda now, name: now.gap(name)),
    "touching": ("contact", lambda now, name: float(now.touching(name))),
    "command": ("actuator", lambda now, name: now.command(name)),
}


@takes()
@dataclass(frozen=True, slots=True)
class Measure:
    """Measured number.

    Attributes:
        kind: ``angle`` [rad] ([m]) or ``rate`` of a joint; ``base-rotation`` [rad] or ``base-rate`` [rad/s]
            about an axis x, y or z; ``force`` [N], ``gap`` [m] or ``touching`` of a contact; the ``command``
            that an actuator follows.
        name: Of what.
    """

    kind: str
    name: str

    @classmethod
    def read(cls, place: object, key: str, text: str) -> Measure:
        """Return the measurement named by a text such as ``angle hinge``.

        Args:
            place: Owner of the measurement, for the message.
            key: Key of the owner.
            text: Text of the measurement.

        Raises:
            InvalidParameterError: The measurement is unknown.
        """
        kind, _, name = text.strip().partition(" ")
        if kind not in _KINDS:
            guess = nearest(kind, _KINDS)
            hint = f" (or did you mean {guess}?)" if guess else ""
            rule = f"one of {', '.join(_KINDS)} and the name of what, as 'angle hinge'{hint}"
            raise InvalidParameterError(place, key, rule, text)
        what = _KINDS[kind][0]
        name = name.strip()
        if not name or (what == "axis" and name not in tuple(_AXES)):
            rule = f"a kind of measure and {'the axis x, y or z' if what == 'axis' else f'a {what}'}"
            raise InvalidParameterError(place, key, rule, text)
        return cls(kind, name)

    @property
    def of(self) -> str:
        """Kind of its name: a joint, an axis, a contact, an actuator."""
        return _KINDS[self.kind][0]

    def __call__(self, now: Now) -> float:
        """Return the number."""
        return _KINDS[self.kind][1](now, self.name)

    def __str__(self) -> str:
        return f"{self.kind} {self.name}"


def measures_of(controller: Any) -> tuple[Measure, ...]:
    """Return the declared measurements of a controller; none by default."""
    found = getattr(controller, "measured", ())
    return tuple(found)
