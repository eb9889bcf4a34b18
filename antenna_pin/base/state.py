"""The state of a run as a value: all that its future depends on."""

from __future__ import annotations

import dataclasses
import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import is_number
from antenna_pin.base.readable import brief
from antenna_pin.errors import FileFormatError

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
    """Discrete state of an event.

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
    """Discrete state of a controller.

    Attributes:
        name: Its name.
        tick: Number of its next instant.
        queue: What it has commanded that is not yet written: number of the instant, commands by name.
        state: Its own, as text (:func:`antenna_pin.elements.control.kept`).
    """

    name: str
    tick: int
    queue: tuple[tuple[int, tuple[tuple[str, float], ...]], ...]
    state: str


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class State(_Value):
    """A state to start from: compared bit for bit, pickled, stored as text.

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
        memory: Contact memory, (contacts, 3): in its columns, those of
            :data:`antenna_pin.base.records.MEMORY`, touching [-], approach speed [m/s] and effective mass
            [kg]; a row for each of ``system.contact_names``.
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
            breach = next(_breaches(content), None)
            if breach is not None:
                value = json.dumps(breach.value)
                said = value if len(value) <= _SHOWN else f"{value[:_SHOWN]}..."
                raise FileFormatError(f"state: {breach.place} must be {breach.rule}, got {said}")
            for name in ("q", "v", "x"):
                content[name] = np.array(content[name], dtype=float)
            content["memory"] = np.array(content["memory"], dtype=float).reshape(-1, 3)
            content["sizes"] = tuple((name, float(size)) for name, size in content["sizes"])
            content["changed"] = tuple(content["changed"])
            content["contacts"] = tuple(_open_contact(one) for one in content["contacts"])
            content["events"] = tuple(EventMemory(**one) for one in content["events"])
            content["adjusted"] = tuple((place, float(value)) for place, value in content["adjusted"])
            content["controllers"] = tuple(map(_controller_memory, content.get("controllers", ())))
            return cls(**content)
        except FileFormatError:
            raise
        except (KeyError, TypeError, ValueError, AttributeError, RecursionError, OverflowError) as error:
            raise FileFormatError(f"state: must be one that a run wrote, got text with {error!r}") from None


class StateBreach(NamedTuple):
    """A part of a state that no run leaves.

    Attributes:
        place: Its place, such as ``q[3]``.
        rule: Requirement, as it reads after "must be".
        value: What stands there.
    """

    place: str
    rule: str
    value: Any


def breach_of_state(state: State) -> StateBreach | None:
    """Return the first invalid part of a state; None for a valid state."""
    return next(_breaches(state), None)


def _fields(content: Any) -> Mapping[str, Any]:
    """Return the fields of a value, or of its JSON object."""
    if isinstance(content, Mapping):
        return content
    return {item.name: getattr(content, item.name) for item in dataclasses.fields(content)}


def _breaches(state: Any) -> Iterator[StateBreach]:
    own = _fields(state)
    yield from _of_numbers(own, "", ("time", "reached", "error"), "a finite number")
    yield from _of_numbers(own, "", ("step",), "positive")
    if own["reached"] < own["time"]:
        yield StateBreach("reached", f"time or later, {own['time']!r} s", own["reached"])
    for name in ("q", "v", "x"):
        yield from _of_array(own[name], name, (-1,))
    yield from _of_array(own["memory"], "memory", (-1, 3))
    contacts, states = len(own["memory"]), sum(len(own[name]) for name in ("q", "v", "x"))
    for k, one in enumerate(own["contacts"]):
        place, open_ = f"contacts[{k}].", _fields(one)
        if not _is_count(open_["contact"]) or open_["contact"] >= contacts:
            yield StateBreach(
                f"{place}contact", f"the number of one of {contacts} contacts", open_["contact"]
            )
        names = ("onset", "approach_speed", "effective_mass", "impulse", "dissipated")
        yield from _of_numbers(open_, place, names, "a finite number")
        yield from _of_array(open_["peak"], f"{place}peak", (3,))
        for name, shape in (("peak_state", (states,)), ("peak_memory", (contacts, 3))):
            if len(open_[name]):
                yield from _of_array(open_[name], f"{place}{name}", shape)
    yield from _of_pairs(own["sizes"], "sizes", "positive")
    yield from _of_pairs(own["adjusted"], "adjusted", "a number")
    for k, count in enumerate(own["changed"]):
        if not _is_count(count):
            yield StateBreach(f"changed[{k}]", "a whole number, zero or more", count)
    for k, one in enumerate(own["events"]):
        event = _fields(one)
        yield from _of_numbers(event, f"events[{k}].", ("count", "side", "noise"), "a finite number")
        yield from _of_numbers(event, f"events[{k}].", ("last",), "a number")


_HOLDS: Mapping[str, Callable[[float], bool]] = {
    "a finite number": math.isfinite,
    "positive": lambda value: 0.0 < value <= sys.float_info.max,  # no integer beyond floats
    "a number": lambda value: not math.isnan(value),
}
_SHOWN = 60  # letters of a value in a message


def _is_count(value: Any) -> bool:
    return is_number(value) and value >= 0 and value == int(value)


def _of_numbers(
    own: Mapping[str, Any], place: str, names: tuple[str, ...], rule: str
) -> Iterator[StateBreach]:
    for name in names:
        if not is_number(own[name]) or not _HOLDS[rule](own[name]):
            yield StateBreach(f"{place}{name}", rule, own[name])


def _of_pairs(pairs: Any, place: str, rule: str) -> Iterator[StateBreach]:
    for k, (name, value) in enumerate(pairs):
        if not isinstance(name, str) or not is_number(value) or not _HOLDS[rule](value):
            yield StateBreach(f"{place}[{k}]", f"a text with a value that is {rule}", [name, value])


def _of_array(values: Any, place: str, shape: tuple[int, ...]) -> Iterator[StateBreach]:
    """Yield breaches of a finite array of given shape; -1 for any length."""
    if not isinstance(values, np.ndarray):
        if not isinstance(values, list | tuple):
            yield StateBreach(place, "a list of numbers", values)
            return
        for k, value in enumerate(values):
            if len(shape) == 2:
                yield from _of_array(value, f"{place}[{k}]", shape[1:])
            elif not is_number(value):
                yield StateBreach(f"{place}[{k}]", "a finite number", value)
    array = np.array(values, dtype=float)
    if array.size == 0 and shape[0] in (-1, 0):
        return
    if array.ndim != len(shape) or any(n not in (-1, m) for n, m in zip(shape, array.shape, strict=True)):
        wanted = " x ".join("any number" if n == -1 else str(n) for n in shape)
        yield StateBreach(place, f"an array of {wanted} numbers", list(array.shape))
    elif not np.isfinite(array).all():
        at = np.argwhere(~np.isfinite(array))[0]
        where = "".join(f"[{k}]" for k in at)
        yield StateBreach(f"{place}{where}", "a finite number", float(array[tuple(at)]))


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
