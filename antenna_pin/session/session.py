"""The session: one object that steps a run, reads it and commands it."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
import os
import threading
import time as clock
from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType, TracebackType
from typing import Any, Concatenate, ParamSpec, Self, TypeVar

from numpy.typing import ArrayLike

from antenna_pin.base.arguments import is_number, takes
from antenna_pin.base.interruption import interruptible
from antenna_pin.base.parameters import holds, parameters_of
from antenna_pin.base.readable import readable
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.base.units import quantity
from antenna_pin.control import Controller
from antenna_pin.dynamics import System, acting_in, check_motions
from antenna_pin.elements import Element
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError
from antenna_pin.scenario import Scenario, scenario_named
from antenna_pin.session.numbers import Numbers, slides
from antenna_pin.session.screen import on_screen
from antenna_pin.simulation import Event, Mark, Moment, Set, Time
from antenna_pin.simulation.inputs import (
    PreparedRun,
    RunStart,
    as_run,
    check_events,
    check_sizes,
    check_spans,
    prepared,
)
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.open_run import OpenRun, RecordSnapshot
from antenna_pin.simulation.run import result_of
from antenna_pin.trajectory import Outcome, Trajectory

__all__ = ["EndedError", "InUseError", "Session", "start"]


# --- where a session is told to go: times and conditions as they are given, and whether it may go there ---

_UNTIL = "until"  # what an event is called that a session goes to


def sought(goal: Event | Callable[[Moment], float]) -> Event:
    """Return the event that a session goes to: one, or a condition."""
    if isinstance(goal, Event):
        return dataclasses.replace(goal, name=f"{_UNTIL} {goal.name}", action=Mark())
    return Event(name=_UNTIL, when=goal)


def looked_to(ready: PreparedRun, run: Run, end: float) -> float:
    """Refuse a time beyond the data of an element or motion, or beyond its limits.

    Args:
        ready: What the run is made of.
        run: The run.
        end: The time [s].

    Returns:
        Up to when it may go at least [s]: far ahead, so that it is looked rarely.

    Raises:
        AntennaPinError: It may not go there.
    """
    for far in (end + (end - ready.begin), end):
        try:
            check_spans(ready.system, ready.begin, far)
            check_motions(ready.system, run.here, run.stepper.t, far)
        except AntennaPinError:
            if far == end:
                raise
        else:
            return far
    return end


def seconds(place: str, name: str, value: float | str) -> float:
    """Return a time that is given in seconds or as text with a unit, or refuse it."""
    seconds = quantity(value, "s", f"{place}: {name}") if isinstance(value, str) else value
    if not holds(seconds, "positive"):
        raise InvalidParameterError(place, name, "a positive time [s], or text with a unit", value)
    return float(seconds)


# --- exclusive use of a session: one thread at a time ---

S = TypeVar("S", bound="Exclusive")
P = ParamSpec("P")
R = TypeVar("R")


class InUseError(AntennaPinError, RuntimeError):
    """A session is called by a thread while another works with it."""


class Exclusive:
    """An object with a state that two threads must not work on at once; calls within a thread may nest."""

    def __init__(self) -> None:
        """Begin unused."""
        self._lock = threading.RLock()
        self._user = ""

    @contextmanager
    def used(self, name: str) -> Iterator[None]:
        """Keep other threads out; ``name`` is of the call.

        Raises:
            InUseError: Another thread is in.
        """
        if not self._lock.acquire(blocking=False):
            raise InUseError(
                f"session: must be used by one thread at a time, got {name} of thread "
                f"{threading.current_thread().name!r} during {self._user}; "
                "wait for it, or give each thread a session of its own: copy()"
            )
        before = self._user
        try:
            self._user = f"{name} of thread {threading.current_thread().name!r}"
            yield
        finally:
            self._user = before
            self._lock.release()


def exclusive(method: Callable[Concatenate[S, P], R]) -> Callable[Concatenate[S, P], R]:
    """Refuse a method while another thread is in one of the same object.

    Raises:
        InUseError: Another thread is.
    """

    @functools.wraps(method)
    def alone(self: S, /, *args: P.args, **named: P.kwargs) -> R:
        with self.used(method.__name__.strip("_")):
            return method(self, *args, **named)

    return alone


# --- what a session commands: the numbers of elements, by the elements' names or by place ---


def in_si(run: Run, place: str, value: float | str | bool) -> float | bool:
    """Return what a number of an element is to be in SI units.

    Args:
        run: Whose element.
        place: Of the number; one that there is not is for who sets it to refuse.
        value: A number, or text with a unit.

    Raises:
        AntennaPinError: It is no such number.
    """
    if not isinstance(value, str):
        if not isinstance(value, bool) and not holds(value, ""):
            raise InvalidParameterError("set", place, "a finite number, or text with a unit", value)
        return value
    element, _, key = place.rpartition(".")
    for one in acting_in(run.system):
        if one.place == element and key in (known := parameters_of(type(one.element))):
            joint = one.element.acts_at if isinstance(one.element, Element) else None
            slid = joint is not None and slides(run, joint)
            unit = known[key].sliding if slid and known[key].sliding else known[key].unit
            return quantity(value, unit, f"set: {place}")
    return math.nan


class Commands(MutableMapping[str, float]):
    """The numbers that elements are commanded by, by the elements' names.

    Of two elements of one name in two tables both stand under theirs with the table: ``drives.motor``.

    Args:
        system: What is commanded.
        read: Returns a number, by its place.
        write: Changes one.
    """

    def __init__(
        self,
        system: System,
        read: Callable[[str], float],
        write: Callable[[str, float | str], None],
    ) -> None:
        """Find them."""
        self._read, self._write = read, write
        found = [one for one in acting_in(system) if one.element.commanded]
        names = [one.name for one in found]
        self._places = {
            one.name if names.count(one.name) == 1 else one.place: f"{one.place}.{one.element.commanded}"
            for one in found
        }

    def place(self, name: str) -> str:
        """Return the place of what is commanded, such as ``drives.motor.value``.

        Raises:
            UnknownNameError: Nothing of that name can be commanded.
        """
        if name not in self._places:
            raise UnknownNameError("session", "element to command", name, self._places)
        return self._places[name]

    def __getitem__(self, name: str) -> float:
        """Return what is commanded now."""
        return self._read(self.place(name))

    def __setitem__(self, name: str, value: float | str) -> None:
        """Command it from now on."""
        self._write(self.place(name), value)

    def __delitem__(self, name: str) -> None:
        """Refuse: what is commanded stays."""
        raise InvalidParameterError("session", "command", "set, not removed", name)

    def __contains__(self, name: object) -> bool:
        """Return whether a name can be commanded."""
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        """Name what can be commanded."""
        return iter(self._places)

    def __len__(self) -> int:
        """Number of things that can be commanded."""
        return len(self._places)

    def __repr__(self) -> str:
        """Return what is commanded."""
        return repr(dict(self))


class EndedError(AntennaPinError, RuntimeError):
    """Session that has ended and is continued."""


@takes(angles="rad", record="s")
def start(
    model: Scenario | System | str | os.PathLike[str],
    *,
    q: ArrayLike | None = None,
    v: ArrayLike | None = None,
    angles: Mapping[str, float] | None = None,
    start: State | None = None,
    settings: RunSettings | None = None,
    events: Sequence[Event] = (),
    controllers: Mapping[str, Controller] = MappingProxyType({}),
    record: bool | float = True,
) -> Session:
    """Begin a run whose end and changes are commanded from outside.

    Args:
        model: What to run; or the name of a shipped scenario, or a path, whose default case is run.
        q: Initial configuration, as :func:`antenna_pin.simulate` takes it.
        v: Initial velocity.
        angles: Angles of joints that turn without end.
        start: What to go on from instead: a session's ``state``, or the ``end`` of a run.
        settings: Integration and sampling; the scenario's, or the defaults.
        events: What to look for, and what to do then, beside the scenario's own.
        controllers: What commands it at instants of its own, by name, beside the scenario's own.
        record: How much of the past is kept for :meth:`Session.trajectory`: all, nothing, or so much time at
            least [s], of a session that never ends.

    Raises:
        AntennaPinError: The input is not valid.
    """
    first = RunStart(q, v, angles, start)
    return Session(scenario_named(model), first, settings, tuple(events), record, controllers)


class Session(Exclusive):
    """Run to a commanded time.

    Its numbers are those of one :func:`antenna_pin.simulate` in which events set at the same times what was
    commanded (:attr:`events`), bit for bit, however long the steps between: the integrator's own steps are
    cut where something was commanded, nowhere else. A state that is read is where such a run would end.

    :func:`start` makes it. One thread at a time works with it; a second one is refused (:class:`InUseError`).

    Args:
        model: What to run.
        first: Where it starts.
        settings: Integration and sampling.
        events: What to look for.
        record: How much of the past is kept.
        controllers: What commands it at instants of its own.
    """

    def __init__(
        self,
        model: Scenario | System,
        first: RunStart,
        settings: RunSettings | None,
        events: tuple[Event, ...],
        record: bool | float,
        controllers: Mapping[str, Controller] = MappingProxyType({}),
    ) -> None:
        """Make the run."""
        super().__init__()
        if not (isinstance(record, bool) or (is_number(record) and record >= 0.0)):
            raise InvalidParameterError("start", "record", "true, false or a time, zero or more [s]", record)
        self._asked = model, first, settings, events, record, controllers
        self._window = (math.inf if record else 0.0) if isinstance(record, bool) else float(record)
        self._ready: PreparedRun = prepared("start", model, first, settings, events, None, None, controllers)
        self._closed = False
        self._began = first.told(self._ready.scenario)
        self._open = self._opened(self._ready.first)
        self._numbers = Numbers(self._open.run)
        self.command = Commands(self._ready.system, self.__getitem__, self.set)

    def _opened(self, first: Any) -> OpenRun:
        ready = self._ready
        self._looked = ready.begin + (ready.span or 0.0)
        self._commanded: list[tuple[float, Set]] = []
        return OpenRun(ready.system, first, ready.settings, ready.events, self._window, ready.controllers)

    # --- to go on -------------------------------------------------------------------------------------------

    @exclusive
    def step(self, duration: float | str) -> bool:
        """Go on for some time [s]; return whether the session may go on then.

        It may not where an event has stopped it, or the run cannot go on: it stands where it came to then,
        and ``outcome`` and ``message`` say why.

        Raises:
            EndedError: It has ended already.
            KeyboardInterrupt: Ctrl-C; the session stands between two steps, and may go on.
        """
        return self._go(self.time + seconds("step", "duration", duration))

    @exclusive
    def run_until(
        self, goal: float | str | Event | Callable[[Moment], float], timeout: float | str | None = None
    ) -> bool:
        """Go on to a time [s], or to where a function of the state passes zero next; return whether it did.

        Args:
            goal: A time; an event, or a condition as events have them (``Angle("hinge", 0.1)``). What it
                would do is not done, and it leaves no trace in the record.
            timeout: Of a condition: how long to go at most [s].

        Raises:
            EndedError: The session has ended already.
        """
        if isinstance(goal, int | float | str):
            end = seconds("run_until", "goal", goal)
            if not end > self.time:
                rule = f"a time later than the session's, {readable(self.time, 's')}"
                raise InvalidParameterError("run_until", "goal", rule, said=readable(end, "s"))
            self._go(end)
            return self.time == end
        if timeout is None:
            raise InvalidParameterError("run_until", "timeout", "given beside a condition [s]", None)
        end = self.time + seconds("run_until", "timeout", timeout)
        event = sought(goal)
        if isinstance(event.when, Time):
            left = [t for t in event.when.instants if t > self.time][event.after - 1 :]
            self._go(min([end, *left[:1]]))
            return bool(left) and self.time == left[0]
        check_events((*self._ready.events, event), self._ready.system, self._open.run.here)
        return self._go(end, event)

    def _go(self, end: float, event: Event | None = None) -> bool:
        """Go to a time [s] or an event; return whether it may go on, or the event has happened."""
        self._check_open()
        if self.outcome is not Outcome.COMPLETED:
            raise EndedError(f"session: has ended {self.message}; reset() begins anew, state is what it left")
        if not end > self.time:
            raise InvalidParameterError("step", "duration", "long enough to move the time on [s]", end)
        if end > self._looked:
            self._looked = looked_to(self._ready, self._open.run, end)
        self._numbers.forget()
        opened, happened = self._open, False
        with interruptible() as interrupted:
            if event is None:
                opened.go_to(end, interrupted)
            else:
                happened = opened.go_until(event, end, interrupted)
        outcome: Outcome = opened.run.outcome
        if outcome is Outcome.INTERRUPTED:
            opened.may_go_on()
            raise KeyboardInterrupt
        return happened if event is not None else outcome is Outcome.COMPLETED

    # --- to command -----------------------------------------------------------------------------------------

    @exclusive
    def set(self, place: str, value: float | str | bool) -> None:
        """Change a number of an element now, as an event with :class:`antenna_pin.simulation.Set` would.

        Args:
            place: ``drives.motor.value``, ``springs.coil.stiffness``; ``drives.motor.on``.
            value: In SI units or as text with a unit; of ``on`` true or false.

        Raises:
            AntennaPinError: There is no such number, or it cannot have this value; nothing is changed.
        """
        self._check_open()
        action = Set(place, in_si(self._open.run, place, value))
        said = action.value if isinstance(action.value, bool) else f"{action.value:.6g}"
        self._open.command(f"{place} = {said}", action)
        self._numbers.forget()
        self._commanded.append((self.time, action))

    def on(self, place: str) -> None:
        """Switch an element on: ``drives.motor``."""
        self.set(f"{place}.on", True)

    def off(self, place: str) -> None:
        """Switch an element off: ``drives.motor``."""
        self.set(f"{place}.on", False)

    # --- to read --------------------------------------------------------------------------------------------

    @exclusive
    def __getitem__(self, name: str) -> float:
        """Return a number of the present state (:mod:`antenna_pin.session.numbers`)."""
        return self._numbers[name]

    def names(self) -> dict[str, str]:
        """Return what can be read by name, each with its unit."""
        return self._numbers.names()

    def unit(self, name: str) -> str:
        """Return the unit of a number that can be read."""
        return self._numbers.unit(name)

    @property
    def settable(self) -> list[str]:
        """Places of the elements' numbers."""
        return self._numbers.settable

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.names())

    @property
    def time(self) -> float:
        """Present time of the session [s]."""
        return self._open.time

    @property
    @exclusive
    def state(self) -> State:
        """The state to go on from here: of :func:`start`, of ``simulate(start=...)``, of :meth:`restore`."""
        return self._open.state

    @property
    def outcome(self) -> Outcome:
        """``COMPLETED`` as long as it may go on; else why it may not."""
        return self._open.run.outcome

    @property
    def message(self) -> str:
        """The outcome in words."""
        return self._open.run.message

    @property
    def system(self) -> System:
        """Scenario of the session."""
        return self._ready.system

    @property
    def events(self) -> tuple[Event, ...]:
        """Commands so far, as events of a run from its beginning, with the same numbers."""
        return tuple(
            Event(name=f"command {k}: {action.place}", when=Time(t), action=action)
            for k, (t, action) in enumerate(self._commanded, 1)
        )

    @exclusive
    def trajectory(self) -> Trajectory:
        """Return what is recorded so far, as a run that ends here has it; the session goes on."""
        run, ready, began = self._open.run, self._ready, clock.perf_counter()
        kept, wall = RecordSnapshot(run), run.wall
        told = self._began
        if run.begin > ready.begin:
            told = f"a session's state at {run.begin:.12g} s: the first sample"
        scenario = ready.scenario
        if scenario is not None and self.time > ready.begin:
            scenario = as_run(scenario, self.time - ready.begin, ready.settings)
        try:
            run.judge()
            run.complete()
            result = result_of(run, scenario, told, None, began)
        finally:
            run.samples.leave()
            kept.restore()
            run.wall = wall
        if self._commanded:
            said = [[t, action.place, float(action.value)] for t, action in self._commanded]
            result.data.attrs["commands"] = json.dumps(said)
        return result

    # --- to go elsewhere ------------------------------------------------------------------------------------

    def save(self) -> State:
        """Return the present state, for :meth:`restore`."""
        return self.state

    @exclusive
    def restore(self, state: State) -> None:
        """Go to a state of this system's, saved or of any run; the record begins anew there."""
        check_sizes(self._ready.system, state)
        self._begin_at(state, f"another run's state at {state.reached:.12g} s: the first sample")

    @exclusive
    def copy(self) -> Session:
        """Return another session that stands here; what is done to one the other does not see."""
        model, _, settings, events, record, controllers = self._asked
        return Session(model, RunStart(start=self.state), settings, events, record, controllers)

    @exclusive
    def reset(
        self,
        q: ArrayLike | None = None,
        v: ArrayLike | None = None,
        angles: Mapping[str, float] | None = None,
    ) -> None:
        """Begin anew: where the session began, or at another configuration and velocity."""
        if q is not None or v is not None or angles is not None:
            model, _, settings, events, record, controllers = self._asked
            first = RunStart(q, v, angles)
            self._ready = prepared("reset", model, first, settings, events, None, controllers=controllers)
            self._asked = model, first, settings, events, record, controllers
        self._begin_at(self._ready.first, self._asked[1].told(self._ready.scenario))

    def _begin_at(self, first: Any, told: str) -> None:
        self._check_open()
        self._open = self._opened(first)
        self._numbers.use(self._open.run)
        self._began = told

    def close(self) -> None:
        """End the session; what it has recorded can still be read."""
        self._closed = True

    def _check_open(self) -> None:
        if self._closed:
            raise EndedError("session: must be open, is closed; start another, from its state for instance")

    def __enter__(self) -> Self:
        """Begin."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    def __repr__(self) -> str:
        """Return what a screen shows: time, outcome, joints, contacts that touch, commands."""
        return on_screen(self, self._numbers.units)
