"""A thruster: a force along a link's direction, in pulses or by command."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import ClassVar, Literal

from antenna_pin.base.directions import A_DIRECTION
from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import GIVEN, number, readable
from antenna_pin.base.records import Triple
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.desk_kernels import Desk, turned
from antenna_pin.elements.element import Integral, packed
from antenna_pin.elements.on_links import BOOKED, AtPoint
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class Thruster(AtPoint):
    r"""A constant force along a link's direction, in pulses or by command.

    Steps end at both edges of a pulse. Outside pulses the force is ``throttle`` times the thrust, which
    events, controllers and sessions command. With time constants it follows by
    :math:`\dot F = (F' - F) / \tau`, with the same impulse in the end.

    The direction may be off by an error: by the angle ``misalignment`` towards an azimuth, which is counted
    about the direction, right-handed, from the one of the link's axes x, y, z that is most across it (the
    first of those that are alike). With a seed the error is drawn: two angles across the direction, each of
    normal distribution with ``misalignment`` as its standard deviation.

    Attributes:
        direction: Of the force on the link, against the jet, in the link's axes [-].
        thrust: [N].
        starts: Starts of pulses, increasing [s].
        durations: Of the pulses, one for each, or one for all [s].
        throttle: Share of the thrust between pulses, which a controller commands [-].
        minimum_on_time: Of a pulse [s].
        minimum_impulse: Impulse bit: of a pulse at least [N*s].
        short_pulses: Shorter pulses: ``refuse`` or ``lengthen``.
        misalignment: Angle of the direction's error, or with a seed its standard deviation [rad].
        azimuth: Of the error [rad].
        seed: From which the error is drawn [-]; None for the one that is given.
        rise_time: Time constant as the force rises [s]; zero for none, at once.
        fall_time: Time constant as it falls [s].
    """

    kernels: ClassVar[str] = __name__
    commanded: ClassVar[str] = "throttle"

    direction: Triple = parameter("1", rule=A_DIRECTION, sizes=(3,))
    thrust: float = parameter("N", rule="positive")
    starts: tuple[float, ...] = parameter("s", rule="zero or more", sizes=(0,), default=())
    durations: tuple[float, ...] = parameter("s", rule="positive", sizes=(0,), default=())
    throttle: float = parameter("1", rule="from 0 to 1, the whole thrust", default=0.0)
    minimum_on_time: float = parameter("s", rule="zero or more", default=0.0)
    minimum_impulse: float = parameter("N*s", rule="zero or more", default=0.0)
    short_pulses: Literal["refuse", "lengthen"] = "refuse"
    misalignment: float = parameter("rad", rule="zero or more", default=0.0)
    azimuth: float = parameter("rad", default=0.0)
    seed: int | None = parameter("1", rule="zero or more", default=None)
    rise_time: float = parameter("s", rule="zero or more", default=0.0)
    fall_time: float = parameter("s", rule="zero or more", default=0.0)
    firing: float = field(default=0.0, repr=False)

    def __post_init__(self) -> None:
        """Check the parameters and the pulses."""
        AtPoint.__post_init__(self)
        if (self.rise_time > 0.0) != (self.fall_time > 0.0):
            missing = "fall_time" if self.rise_time > 0.0 else "rise_time"
            raise InvalidParameterError(self, missing, "above zero, as the other time constant is")
        if self.seed is not None and self.azimuth:
            raise InvalidParameterError(self, "azimuth", "omitted if a seed is given, from which it is drawn")
        if self.misalignment >= 0.5 * math.pi:
            raise InvalidParameterError(self, "misalignment", "below a quarter of a turn")
        if len(self.durations) not in (1, len(self.starts)) or bool(self.starts) != bool(self.durations):
            rule = f"one for each of {len(self.starts)} starts, or one for all"
            raise InvalidParameterError(self, "durations", rule, said=f"{len(self.durations)}")
        self._check_pulses()

    def _check_pulses(self) -> None:
        least = self.minimum
        for k, (start, end) in enumerate(self._command_spans()):
            if self.short_pulses == "refuse" and end - start < least * (1.0 - 1e-12):
                rule = (
                    f"{least:g} s or more by minimum_on_time and minimum_impulse; lengthen the pulse, or say "
                    "short_pulses = 'lengthen'"
                )
                place = min(k, len(self.durations) - 1)
                raise InvalidParameterError(self, f"durations[{place}]", rule, self.durations[place])
        for k, ((_, end), (start, _)) in enumerate(pairwise(self.pulses), start=1):
            if start < end:
                rule = f"at {end:g} s or later, when the pulse before has ended"
                raise InvalidParameterError(self, f"starts[{k}]", rule, start)

    @property
    def minimum(self) -> float:
        """Shortest pulse [s]."""
        return max(self.minimum_on_time, self.minimum_impulse / self.thrust)

    def _command_spans(self) -> tuple[tuple[float, float], ...]:
        lasting = (
            self.durations if len(self.durations) == len(self.starts) else self.durations * len(self.starts)
        )
        return tuple((start, start + long) for start, long in zip(self.starts, lasting, strict=True))

    @property
    def pulses(self) -> tuple[tuple[float, float], ...]:
        """Start and end of each pulse, as it is made [s]."""
        least = self.minimum
        return tuple((start, max(end, start + least)) for start, end in self._command_spans())

    @property
    def edges(self) -> tuple[float, ...]:
        """Starts and ends of its pulses that are later than zero [s]."""
        return tuple(sorted({t for pulse in self.pulses for t in pulse if t > 0.0}))

    def from_now_on(self, t: float) -> dict[str, float]:
        """Return whether a pulse is on from a time on [s]."""
        return {"firing": float(any(start <= t < end for start, end in self.pulses))}

    @classmethod
    def own_keys(cls) -> tuple[str, ...]:
        """Return the fields that no scenario writes."""
        return ("firing",)

    @property
    def follows(self) -> bool:
        """Return whether the force follows its command with a time constant."""
        return self.rise_time > 0.0

    @property
    def states(self) -> tuple[Integral, ...]:  # type: ignore[override]
        """Its force, of the thrust, if that follows."""
        return (Integral("level", "1"),) if self.follows else ()

    @property
    def integrals(self) -> tuple[Integral, ...]:  # type: ignore[override]
        """Names of the booked values and of the force."""
        return (*BOOKED, *self.states)

    @packed
    def way(self) -> Triple:
        """Direction of its force with the error, unit, in the link's axes."""
        size = math.hypot(*self.direction)
        d = [one / size for one in self.direction]
        if self.seed is None:
            angle, azimuth = self.misalignment, self.azimuth
        else:
            import numpy as np

            first, second = self.misalignment * np.random.default_rng(self.seed).normal(size=2)
            angle, azimuth = math.hypot(first, second), math.atan2(second, first)
        if angle == 0.0:
            return d[0], d[1], d[2]
        most = min(range(3), key=lambda k: (round(abs(d[k]), 12), k))
        across = [-d[most] * one for one in d]
        across[most] += 1.0
        size = math.hypot(*across)
        a = [one / size for one in across]
        b = [d[1] * a[2] - d[2] * a[1], d[2] * a[0] - d[0] * a[2], d[0] * a[1] - d[1] * a[0]]
        c, s = math.cos(azimuth), math.sin(azimuth)
        x, y, z = (math.cos(angle) * d[k] + math.sin(angle) * (c * a[k] + s * b[k]) for k in range(3))
        return x, y, z

    def facts(self) -> dict[str, float]:
        """Return its thrust, for those who draw it."""
        return {"thrust": self.thrust}

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        text = f"thruster on {self.at[0]}, {readable(self.thrust, 'N', GIVEN)}"
        if self.starts:
            on = sum(end - start for start, end in self.pulses)
            many = "1 pulse" if len(self.starts) == 1 else f"{len(self.starts)} pulses"
            text += f", {many} of {number(on)} s in all, {readable(on * self.thrust, 'N s')}"
        if self.throttle:
            text += f", throttle {number(self.throttle, GIVEN)}"
        if self.misalignment:
            drawn = "" if self.seed is None else f" (drawn, seed {self.seed})"
            text += f", direction off by {readable(self.misalignment, 'rad', GIVEN)}{drawn}"
        return text


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def act(own: Thruster, t: float, desk: Desk) -> None:
    """Write the force on the link, and the rate of its level if that follows."""
    level = 1.0 if own.firing != 0.0 else own.throttle
    if own.rise_time > 0.0:
        state = desk[3][0]
        lacks = level - state.value
        state.rate = lacks / (own.rise_time if lacks > 0.0 else own.fall_time)
        level = state.value
    force = level * own.thrust
    link = desk[1][0]
    x, y, z = turned(link.rotation, own.way[0], own.way[1], own.way[2])
    link.force[0], link.force[1], link.force[2] = force * x, force * y, force * z
