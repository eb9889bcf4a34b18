"""The state of a run as a value: all that its future depends on."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from antenna_pin.brief import brief
from antenna_pin.errors import FileFormatError

__all__ = ["ControllerMemory", "EventMemory", "OpenContact", "State"]

Array = NDArray[np.float64]


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    return bool(one == other)


class _Value:
    """Equality by content, arrays included."""

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        """Compare field by field, bit for bit."""
        if type(self) is not type(other):
            return NotImplemented
        names = (item.name for item in dataclasses.fields(self))  # type: ignore[arg-type]
        return all(_same(getattr(self, name), getattr(other, name)) for name in names)

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class OpenContact(_Value):
    """A contact that touches: what its record needs at its end.

    Attributes:
        contact: Its number.
        onset: When it began [s].
        approach_speed: At the onset, floored [m/s].
        effective_mass: At the onset [kg].
        impulse: Of the contact before this onset, negative [N s].
        dissipated: By the contact before this onset, negative [J].
        peak: Largest force so far [N], when [s], largest depth so far [m].
        peak_state: State [q, v, x] at the largest force, or empty.
        peak_memory: Contact memory there, (contacts, 3), or empty.
    """

    __repr__ = brief

    contact: int
    onset: float
    approach_speed: float
    effective_mass: float
    impulse: float
    dissipated: float
    peak: tuple[float, float, float]
    peak_state: Array
    peak_memory: Array


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class EventMemory(_Value):
    """What an event remembers.

    Attributes:
        name: Its name.
        count: How often it has happened.
        last: When last [s]; minus infinity if never.
        side: The sign of its function where that was last seen; 0 if not yet, or not since it happened.
        noise: Size up to which the function says nothing of the side, right after it happened.
    """

    name: str
    count: int
    last: float
    side: float
    noise: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ControllerMemory(_Value):
    """What a controller remembers.

    Attributes:
        name: Its name.
        tick: Number of its next instant.
        queue: What it has commanded that is not yet written: number of the instant, commands by name.
        state: Its own, as text (:func:`antenna_pin.control.kept`).
    """

    name: str
    tick: int
    queue: tuple[tuple[int, tuple[tuple[str, float], ...]], ...]
    state: str


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class State(_Value):
    """A state that a run can start from: compared bit for bit, pickled, stored as text.

    A run's last steps are cut to end in time. So that going on gives bit for bit what one long run gives, the
    state that a run leaves is that before the first step so cut: ``time`` lies before ``reached`` by up to
    two of the longest steps. What starts from it makes that way again, uncut, and records from ``reached``
    on.

    Attributes:
        time: Of this state [s].
        reached: To which the run got that left it [s].
        q: Configuration, (nq,).
        v: Velocity, (nv,).
        x: Plain numbers: turned angles, integrals, bristles, (nx,).
        memory: Contact memory, (contacts, 3): in its columns, those of :data:`antenna_pin.records.MEMORY`,
            touching [-], approach speed [m/s] and effective mass [kg]; a row for each of
            ``system.contact_names``.
        contacts: The contacts that touch.
        step: Size to try next [s].
        error: Scaled error of the last step [-]; zero before the first.
        sizes: Step sizes by pattern of touching contacts, (ones and zeros, [s]).
        changed: Of each contact, how often it has changed at this very instant.
        events: What the run's events remember.
        adjusted: Numbers of drives and springs that events and controllers have changed: (place, value).
        controllers: What the run's controllers remember.
    """

    __repr__ = brief

    time: float
    reached: float
    q: Array
    v: Array
    x: Array
    memory: Array
    contacts: tuple[OpenContact, ...]
    step: float
    error: float
    sizes: tuple[tuple[str, float], ...]
    changed: tuple[int, ...]
    events: tuple[EventMemory, ...] = ()
    adjusted: tuple[tuple[str, float], ...] = ()
    controllers: tuple[ControllerMemory, ...] = ()

    @property
    def y(self) -> Array:
        """The state as one array [q, v, x]."""
        return np.concatenate([self.q, self.v, self.x])

    def to_json(self) -> str:
        """Return the state as text, exact to the last bit."""
        return json.dumps(dataclasses.asdict(self), default=lambda array: array.tolist())

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Return the state that :meth:`to_json` wrote.

        Raises:
            FileFormatError: It is no such text.
        """
        try:
            content = json.loads(text)
            for name in ("q", "v", "x"):
                content[name] = np.array(content[name], dtype=float)
            content["memory"] = np.array(content["memory"], dtype=float).reshape(-1, 3)
            content["sizes"] = tuple((str(name), float(size)) for name, size in content["sizes"])
            content["changed"] = tuple(int(count) for count in content["changed"])
            content["contacts"] = tuple(_open_contact(one) for one in content["contacts"])
            content["events"] = tuple(EventMemory(**one) for one in content["events"])
            content["adjusted"] = tuple((str(place), float(value)) for place, value in content["adjusted"])
            content["controllers"] = tuple(map(_controller_memory, content.get("controllers", ())))
            return cls(**content)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise FileFormatError(f"state: must be one that a run wrote, got text with {error!r}") from None


def _controller_memory(content: dict[str, Any]) -> ControllerMemory:
    queue = tuple(
        (int(tick), tuple((str(name), float(value)) for name, value in commands))
        for tick, commands in content["queue"]
    )
    return ControllerMemory(**{**content, "queue": queue})


def _open_contact(content: dict[str, Any]) -> OpenContact:
    content["peak"] = tuple(float(number) for number in content["peak"])
    content["peak_state"] = np.array(content["peak_state"], dtype=float)
    content["peak_memory"] = np.array(content["peak_memory"], dtype=float).reshape(-1, 3)
    return OpenContact(**content)
