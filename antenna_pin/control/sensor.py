"""What a sensor makes of a number: bias, noise by seed, steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.parameters import LEAST, check, parameter
from antenna_pin.errors import InvalidParameterError

__all__ = ["Sensor"]


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    r"""A sensor: the number, a bias and noise, in whole steps.

    .. math:: y = d \, \mathrm{round}((x + b + \sigma n) / d)

    Noise is white from one instant to the next: n is drawn from a normal distribution by the seed and the
    number of the instant alone, so that it does not depend on what was asked before.

    Attributes:
        bias: b, in the number's unit.
        noise: Standard deviation, sigma, in the number's unit.
        seed: Of the noise; controllers with one seed hear the same [-].
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
            rule = f"left out beside {given[0]}; a sensor has steps of one size"
            raise InvalidParameterError(self, given[1], rule, getattr(self, given[1]))
        if 0.0 < self.resolution < LEAST:
            raise InvalidParameterError(
                self, "resolution", f"0 for none, or {LEAST:g} or more", self.resolution
            )
        if self.bits is not None and self.bits > 52:
            raise InvalidParameterError(self, "bits", "52 or less, as a double has", self.bits)

    @property
    def step(self) -> float:
        """One step, in the number's unit; 0 for none."""
        if self.counts is not None:
            return 2.0 * math.pi / self.counts
        return 2.0 * math.pi / 2**self.bits if self.bits is not None else self.resolution

    def read(self, number: float, tick: int, channel: int = 0) -> float:
        """Return what it shows.

        Args:
            number: What is.
            tick: Number of the instant, of which the noise is.
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
