"""Session: a run with its steps, readings and commands in one object."""

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
from antenna_pin.dynamics import System, acting_in, check_motions
from antenna_pin.elements import Element
from antenna_pin.elements.control import Controller
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError
from antenna_pin.run.session.numbers import StateNumbers, slides
from antenna_pin.run.simulation import Event, Mark, Moment, Set, Time
from antenna_pin.run.simulation.inputs import (
    PreparedRun,
    RunStart,
    as_run,
    check_events,
    check_sizes,
    check_spans,
    prepare_run,
)
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.open_run import OpenRun, RecordSnapshot
from antenna_pin.run.simulation.run import result_of
from antenna_pin.scenario import Scenario, scenario_named
from antenna_pin.trajectory import Outcome, Trajectory

# --- goals: times and conditions ----------------------------------------------------------------------------

_LINES = 8  # of a kind, as text
_UNTIL = "until"  # name of an event that is a goal


def sought(goal: Event | Callable[[Moment], float]) -> Event:
    """Return the event of a goal: an event, or a condition."""
    if isinstance(goal, Event):
        return dataclasses.replace(goal, name=f"{_UNTIL} {goal.name}", action=Mark())
    return Event(name=_UNTIL, when=goal)


def checked_up_to(ready: PreparedRun, run: Run, end: float) -> float:
    """Refuse a time beyond the data of an element or motion, or beyond its limits.

    Returns:
        Time up to which the run may continue at least [s]: far ahead, so that checks are rare.

    Raises:
        AntennaPinError: The run may not continue up to the time.
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
    """Return a time from seconds or text with a unit, or refuse it."""
    seconds = quantity(value, "s", f"{place}: {name}") if isinstance(value, str) else value
    if not holds(seconds, "positive"):
        raise InvalidParameterError(place, name, "a positive time [s], or text with a unit", value)
    return float(seconds)


# --- exclusive use: one thread at a time --------------------------------------------------------------------

S = TypeVar("S", bound="Exclusive")
P = ParamSpec("P")
R = TypeVar("R")


class InUseError(AntennaPinError, RuntimeError):
    """Call of a session by a thread during the call of another."""


class Exclusive:
    """Object for one thread at a time; calls within a thread may nest."""

    def __init__(self) -> None:
        """Begin unused."""
        self._lock = threading.RLock()
        self._user = ""

    @contextmanager
    def used(self, name: str) -> Iterator[None]:
        """Exclude other threads during a call of this name.

        Raises:
            InUseError: Another thread is inside.
        """
        if not self._lock.acquire(blocking=False):
            raise InUseError(
                f"session: must be used by one thread at a time, got {name} of thread "
                f"{threading.current_thread().name!r} during {self._user}; "
                "wait for it, or give each thread its own session with copy()"
            )
        before = self._user
        try:
            self._user = f"{name} of thread {threading.current_thread().name!r}"
            yield
        finally:
            self._user = before
            self._lock.release()


def exclusive(method: Callable[Concatenate[S, P], R]) -> Callable[Concatenate[S, P], R]:
    """Refuse a method while another thread is inside a method of the object."""

    @functools.wraps(method)
    def alone(self: S, /, *args: P.args, **options: P.kwargs) -> R:
        with self.used(method.__name__.strip("_")):
            return method(self, *args, **options)

    return alone


# --- commands: numbers of elements, by name or place --------------------------------------------------------


def in_si(run: Run, place: str, value: float | str | bool) -> float | bool:
    """Return the value of an element's number in SI units, NaN for an unknown place.

    Raises:
        AntennaPinError: The value is no such number.
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
    """Commands of elements, by the elements' names.

    Two elements of one name in two tables have names with the table: ``drives.motor``.

    Args:
        system: Commanded system.
        read: Function for a number, by its place.
        write: Function that changes a number.
    """

    def __init__(
        self, system: System, read: Callable[[str], float], write: Callable[[str, float | str], None]
    ) -> None:
        """Find the commanded elements."""
        self._read, self._write = read, write
        found = [one for one in acting_in(system) if one.element.commanded]
        names = [one.name for one in found]
        self._places = {
            one.name if names.count(one.name) == 1 else one.place: f"{one.place}.{one.element.commanded}"
            for one in found
        }

    def place(self, name: str) -> str:
        """Return the place of a command, such as ``drives.motor.value``.

        Raises:
            UnknownNameError: The name is no command.
        """
        if name not in self._places:
            raise UnknownNameError("session", "element to command", name, self._places)
        return self._places[name]

    def __getitem__(self, name: str) -> float:
        """Return the present command."""
        return self._read(self.place(name))

    def __setitem__(self, name: str, value: float | str) -> None:
        """Set the command from now on."""
        self._write(self.place(name), value)

    def __delitem__(self, name: str) -> None:
        """Refuse to remove a command."""
        raise InvalidParameterError("session", "command", "set, not removed", name)

    def __contains__(self, name: object) -> bool:
        """Return whether a name is a command."""
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        """Yield the names of the commands."""
        return iter(self._places)

    def __len__(self) -> int:
        """Return the number of commands."""
        return len(self._places)

    def __repr__(self) -> str:
        """Return the commands as text."""
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
        model: Scenario or system; or the name of a shipped scenario, or a path, whose default case is run.
        q: Initial configuration, (nq,), as for :func:`antenna_pin.simulate`.
        v: Initial velocity, (nv,).
        angles: Angles of joints that turn without end [rad].
        start: State to continue from instead: a session's ``state``, or the ``end`` of a run.
        settings: Integration and sampling; the scenario's, or the defaults.
        events: Events with their actions, besides the scenario's.
        controllers: Sampled controllers, by name, besides the scenario's.
        record: Part of the past kept for :meth:`Session.trajectory`: all, nothing, or at least a time span
            [s], for a session that never ends.

    Raises:
        AntennaPinError: The input is not valid.
    """
    origin = RunStart(q, v, angles, start)
    return Session(scenario_named(model), origin, settings, tuple(events), record, controllers)


class Session(Exclusive):
    """Run to a commanded time; made by :func:`start`.

    The numbers are those of one :func:`antenna_pin.simulate` in which events set the commanded values at the
    same times (:attr:`events`), bit for bit, however long the steps between: the integrator's own steps are
    cut at commands, nowhere else. A state that is read is the end of such a run.

    The arguments are those of :func:`start`. A session is for one thread at a time; another thread is refused
    (:class:`InUseError`).
    """

    def __init__(
        self,
        model: Scenario | System,
        origin: RunStart,
        settings: RunSettings | None,
        events: tuple[Event, ...],
        record: bool | float,
        controllers: Mapping[str, Controller] = MappingProxyType({}),
    ) -> None:
        """Make the run."""
        super().__init__()
        if not (isinstance(record, bool) or (is_number(record) and record >= 0.0)):
            raise InvalidParameterError("start", "record", "true, false or a time, zero or more [s]", record)
        self._inputs = model, origin, settings, events, record, controllers
        self._window = (math.inf if record else 0.0) if isinstance(record, bool) else float(record)
        self._ready: PreparedRun = prepare_run(
            "start", model, origin, settings, events, None, controllers=controllers
        )
        self._closed = False
        self._began = origin.text(self._ready.scenario)
        self._open = self._opened(self._ready.first)
        self._numbers = StateNumbers(self._open.run)
        self.command = Commands(self._ready.system, self.__getitem__, self.set)

    def _opened(self, state: Any) -> OpenRun:
        ready = self._ready
        self._checked = ready.begin + (ready.span or 0.0)
        self._commanded: list[tuple[float, Set]] = []
        return OpenRun(ready.system, state, ready.settings, ready.events, self._window, ready.controllers)

    # --- to continue ----------------------------------------------------------------------------------------

    @exclusive
    def step(self, duration: float | str) -> bool:
        """Continue for a time span [s]; return whether the session may continue afterwards.

        The session ends where an event stops it or the run aborts; ``outcome`` and ``message`` give the
        reason.

        Raises:
            EndedError: The session has ended already.
            KeyboardInterrupt: Ctrl-C; the session is between two steps, and may continue.
        """
        return self._go(self.time + seconds("step", "duration", duration))

    @exclusive
    def run_until(
        self, goal: float | str | Event | Callable[[Moment], float], timeout: float | str | None = None
    ) -> bool:
        """Continue to a time [s] or a zero of a condition; return whether reached.

        Args:
            goal: Time, event, or condition of an event (``Angle("hinge", 0.1)``). Its actions are not carried
                out, and it leaves no trace in the record.
            timeout: Longest time span up to a condition [s].

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
        """Run to a time [s] or an event; return whether it was reached."""
        self._check_open()
        if self.outcome is not Outcome.COMPLETED:
            raise EndedError(
                f"session: has ended {self.message}; reset() restarts it; state holds its last state"
            )
        if not end > self.time:
            raise InvalidParameterError("step", "duration", "long enough to move the time on [s]", end)
        if end > self._checked:
            self._checked = checked_up_to(self._ready, self._open.run, end)
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
        """Change a number of an element now, like the action :class:`antenna_pin.run.simulation.Set`.

        Args:
            place: ``drives.motor.value``, ``springs.coil.stiffness``; ``drives.motor.on``.
            value: In SI units or as text with a unit; of ``on`` true or false.

        Raises:
            AntennaPinError: The number or value is not possible; nothing is changed.
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
        """Return a number of the present state (:mod:`antenna_pin.run.session.numbers`)."""
        return self._numbers[name]

    def names(self) -> dict[str, str]:
        """Return the names that can be read, with units."""
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
        """State to continue from, for :func:`start`, ``simulate(start=...)`` and :meth:`restore`."""
        return self._open.state

    @property
    def outcome(self) -> Outcome:
        """``COMPLETED`` as long as the session may continue; else the reason of its end."""
        return self._open.run.outcome

    @property
    def message(self) -> str:
        """Outcome as text."""
        return self._open.run.message

    @property
    def system(self) -> System:
        """System of the session."""
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
        """Return the record so far, as of a run that ends here; the session continues."""
        run, ready, began = self._open.run, self._ready, clock.perf_counter()
        snapshot, wall = RecordSnapshot(run), run.wall
        origin = self._began
        if run.begin > ready.begin:
            origin = f"a session's state at {run.begin:.12g} s: the first sample"
        scenario = ready.scenario
        if scenario is not None and self.time > ready.begin:
            scenario = as_run(scenario, self.time - ready.begin, ready.settings)
        try:
            run.judge()
            run.complete()
            result = result_of(run, scenario, origin, None, began)
        finally:
            run.samples.leave()
            snapshot.restore()
            run.wall = wall
        if self._commanded:
            said = [[t, action.place, float(action.value)] for t, action in self._commanded]
            result.data.attrs["commands"] = json.dumps(said)
        return result

    # --- other states ---------------------------------------------------------------------------------------

    def save(self) -> State:
        """Return the present state, for :meth:`restore`."""
        return self.state

    @exclusive
    def restore(self, state: State) -> None:
        """Continue from a state of this system, of any run, with a new record."""
        check_sizes(self._ready.system, state)
        self._begin_at(state, f"another run's state at {state.reached:.12g} s: the first sample")

    @exclusive
    def copy(self) -> Session:
        """Return an independent session at the present state."""
        model, _, settings, events, record, controllers = self._inputs
        return Session(model, RunStart(start=self.state), settings, events, record, controllers)

    @exclusive
    def reset(
        self,
        q: ArrayLike | None = None,
        v: ArrayLike | None = None,
        angles: Mapping[str, float] | None = None,
    ) -> None:
        """Begin anew: at the session's own start, or at another configuration and velocity."""
        if q is not None or v is not None or angles is not None:
            model, _, settings, events, record, controllers = self._inputs
            origin = RunStart(q, v, angles)
            self._ready = prepare_run("reset", model, origin, settings, events, None, controllers=controllers)
            self._inputs = model, origin, settings, events, record, controllers
        self._begin_at(self._ready.first, self._inputs[1].text(self._ready.scenario))

    def _begin_at(self, state: Any, origin: str) -> None:
        self._check_open()
        self._open = self._opened(state)
        self._numbers.use(self._open.run)
        self._began = origin

    def close(self) -> None:
        """End the session; its record can still be read."""
        self._closed = True

    def _check_open(self) -> None:
        if self._closed:
            raise EndedError("session: must be open, is closed; start another, from its state for instance")

    def __enter__(self) -> Self:
        """Return the session."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the session."""
        self.close()

    def __repr__(self) -> str:
        """Return time, outcome, joints, touching contacts and commands, in lines."""
        units, system = self._numbers.units, self.system
        lines = [f"Session of {system.mechanism.name} at t = {readable(self.time, 's', 6)}"]
        if self.outcome is not Outcome.COMPLETED:
            lines.append(f"  ended {self.message}")
        joints = [name.removesuffix(".angle") for name in units if name.endswith(".angle")]
        for joint in joints[:_LINES]:
            values = [readable(self[name], units[name], 6) for name in (f"{joint}.angle", f"{joint}.rate")]
            lines.append(f"  {joint}: {', '.join(values)}")
        if len(joints) > _LINES:
            lines.append(f"  and {len(joints) - _LINES} joints more")
        touching = [name for name in system.contact_names if self[f"{name}.touching"]]
        if touching:
            lines.append(f"  touching: {', '.join(touching[:_LINES])}")
        commands = [f"{name} = {value:.6g}" for name, value in list(self.command.items())[:_LINES]]
        if commands:
            lines.append(f"  command: {', '.join(commands)}")
        return "\n".join(lines)
