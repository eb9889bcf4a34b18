"""What controllers measure, as it is written: ``"angle hinge"``, ``"base-rate x"``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.control.controller import Now
from antenna_pin.errors import InvalidParameterError, nearest

__all__ = ["Measure"]

_AXES = "xyz"

# What may be measured: what it is of, and how it is asked for.
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
    """One number that is measured.

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
        """Return what a text such as ``angle hinge`` asks for.

        Args:
            place: Whose it is, for the message.
            key: Which of its keys.
            text: It.

        Raises:
            InvalidParameterError: It asks for nothing known.
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
        """What its name is of: a joint, an axis, a contact, an actuator."""
        return _KINDS[self.kind][0]

    def __call__(self, now: Now) -> float:
        """Return the number."""
        return _KINDS[self.kind][1](now, self.name)

    def __str__(self) -> str:
        return f"{self.kind} {self.name}"


def measures_of(controller: Any) -> tuple[Measure, ...]:
    """Return what a controller says that it measures; none of one that does not say."""
    found = getattr(controller, "measured", ())
    return tuple(found)
