"""The controllers of a run: when they are asked, what they command, what is kept of that.

At one instant all are asked, in their order, before anything is written; then what is due is written, what
was commanded earlier first. Events of the same instant come before.
"""

from __future__ import annotations

import copy
import math
from array import array
from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.answers import asked, number_in
from antenna_pin.base.arguments import unknown_type
from antenna_pin.base.state import ControllerMemory
from antenna_pin.control import Controller, Instants, kept, remembered
from antenna_pin.dynamics import System, actuators_of, settled
from antenna_pin.errors import AntennaPinError, FunctionError
from antenna_pin.simulation.actions import Actions
from antenna_pin.simulation.now import Sight

__all__ = ["Ticked", "Ticks"]

Array = NDArray[np.float64]

# Instants that are nearer are one: what phase and period leave where they are no decimals [ulp].
_SAME = 4.0


class Ticked(NamedTuple):
    """What is kept of the instants of one controller.

    Attributes:
        name: The controller.
        columns: Names of what stands in the columns of ``values``: signals, then commands.
        saturated: Which column says that limits held; None if none does.
        times: (n,) [s].
        values: NaN where nothing was noted or commanded, (n, columns).
    """

    name: str
    columns: tuple[str, ...]
    saturated: int | None
    times: Array
    values: Array


class _Loop:
    """One controller in a run."""

    def __init__(self, name: str, controller: Controller, places: Mapping[str, str]) -> None:
        self.name, self.controller = name, controller
        self.places = {command: places[command] for command in controller.commands}
        self.instants = Instants(controller)
        self.tick, self.begins = 0, True
        self.queue: deque[tuple[int, dict[str, float]]] = deque()
        self.columns = (*controller.signals, *controller.commands)
        self.times, self.values = array("d"), array("d")

    @property
    def next(self) -> float:
        """When something is due next [s]."""
        ask = self.instants.tick(self.tick)
        return min(ask, self.instants.write(self.queue[0][0])) if self.queue else ask

    def state_set(self, state: Any) -> None:
        object.__setattr__(self.controller, "state", state)  # of frozen ones too

    def asked(self, sight: Sight) -> dict[str, float]:
        """Ask the controller; return its commands."""
        place = f"controller {self.name!r}: update"
        told = f"instant {self.tick}, t = {sight.time:.9g} s"
        answer = asked(place, told, "commands by name", self.controller.update, sight)
        if not isinstance(answer, Mapping):
            raise FunctionError(place, told, "commands by name", unknown_type(answer))
        for what, numbers, known in (
            ("commands", answer, self.controller.commands),
            ("signals", sight.noted, self.controller.signals),
        ):
            for name, value in numbers.items():
                if name not in known:
                    rule = f"{what} among {', '.join(known) or 'none'}"
                    raise FunctionError(place, told, rule, f"one called {name!r}")
                number = number_in(value)
                if number is None or not math.isfinite(number):
                    raise FunctionError(place, told, f"a finite number for {name}", unknown_type(value))
        return {name: float(value) for name, value in answer.items()}

    def keep(self, sight: Sight, commands: Mapping[str, float]) -> None:
        self.times.append(sight.time)
        self.values.extend(sight.noted.get(name, math.nan) for name in self.controller.signals)
        self.values.extend(commands.get(name, math.nan) for name in self.controller.commands)


class Ticks:
    """Asks the controllers of a run at their instants.

    Args:
        controllers: By name; the run works on copies.
        actions: Write what they command.
        begin: From when on the run records [s].
    """

    def __init__(
        self, controllers: Mapping[str, Controller], system: System, actions: Actions, begin: float
    ) -> None:
        """Begin before the first instant."""
        self._begin = begin
        self._actions = actions
        self._sight: Sight | None = None
        self._commands: dict[str, Callable[[], float]] = {}
        self._loops: list[_Loop] = []
        if controllers:
            places = actuators_of(system)
            self._sight = actions.sight()
            self._commands = {name: partial(self._number, place) for name, place in places.items()}
            own = settled(copy.deepcopy(dict(controllers)), system)
            self._loops = [_Loop(name, one, places) for name, one in own.items()]

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._loops)

    def _number(self, place: str) -> float:
        element, _, key = place.rpartition(".")
        return float(getattr(self._actions.adjustments.elements[element], key))

    @property
    def next(self) -> float | None:
        """The next instant at which something is due [s]; None without controllers."""
        return min(loop.next for loop in self._loops) if self._loops else None

    # --- an instant -----------------------------------------------------------------------------------------

    def happen(self, t: float, y: Array) -> bool:
        """Do what is due at a time [s] and state; return whether anything was."""
        until = t + _SAME * math.ulp(t)
        due = [loop for loop in self._loops if loop.instants.tick(loop.tick) <= until]
        late = [loop for loop in self._loops if loop.queue and loop.instants.write(loop.queue[0][0]) <= until]
        if not due and not late:
            return False
        if due:
            self._ask(due, t, y)
        writes: list[tuple[float, int, dict[str, float]]] = []
        for k, loop in enumerate(self._loops):
            while loop.queue and loop.instants.write(loop.queue[0][0]) <= until:
                tick, commands = loop.queue.popleft()
                written = {loop.places[name]: value for name, value in commands.items()}
                writes.append((loop.instants.tick(tick), k, written))
        commanded: dict[str, float] = {}
        for *_, written in sorted(writes, key=lambda one: one[:2]):
            commanded |= written
        self._write(commanded)
        return True

    def _ask(self, due: list[_Loop], t: float, y: Array) -> None:
        """Ask controllers, all before anything is written; none has been asked if one has no answer."""
        assert self._sight is not None
        before = [copy.deepcopy(loop.controller.state) for loop in due]
        answers = []
        try:
            for loop in due:
                self._sight.set(t, y).look(loop.tick, self._commands)
                answers.append((loop, loop.asked(self._sight), dict(self._sight.noted)))
        except BaseException:
            for loop, state in zip(due, before, strict=True):
                loop.state_set(state)
            raise
        for loop, commands, noted in answers:
            if t > self._begin or (loop.begins and t == self._begin):
                self._sight.noted = noted
                loop.keep(self._sight, commands)
            loop.queue.append((loop.tick, commands))
            loop.tick += 1

    def _write(self, commanded: Mapping[str, float]) -> None:
        new = {place: value for place, value in commanded.items() if self._number(place) != value}
        if not new:
            return
        try:
            self._actions.command(new)
        except AntennaPinError as error:
            told = ", ".join(f"{place} = {value:g}" for place, value in new.items())
            rule = "a command that its actuator can follow"
            raise FunctionError("controller", told, rule, " ".join(str(error).split())) from error

    # --- memory ---------------------------------------------------------------------------------------------

    def value(self) -> tuple[ControllerMemory, ...]:
        """Return what the controllers remember."""
        return tuple(
            ControllerMemory(
                name=loop.name,
                tick=loop.tick,
                queue=tuple((tick, tuple(commands.items())) for tick, commands in loop.queue),
                state=kept(loop.controller.state),
            )
            for loop in self._loops
        )

    def take_up(self, memories: tuple[ControllerMemory, ...], reached: float) -> None:
        """Go on from what the controllers of another run remember, by name; others begin where it came to."""
        known = {one.name: one for one in memories}
        for loop in self._loops:
            one = known.get(loop.name)
            if one is None:
                loop.tick = loop.instants.first_from(reached)
                continue
            loop.tick, loop.begins = one.tick, False
            loop.queue = deque((tick, dict(commands)) for tick, commands in one.queue)
            loop.state_set(remembered(one.state, loop.controller.state))

    # --- record ---------------------------------------------------------------------------------------------

    @property
    def ticked(self) -> tuple[Ticked, ...]:
        """What is kept of their instants."""
        return tuple(
            Ticked(
                loop.name,
                (*loop.controller.signals, *(f"command {name}" for name in loop.controller.commands)),
                loop.columns.index("saturated") if "saturated" in loop.columns else None,
                np.array(loop.times),
                np.array(loop.values).reshape(-1, len(loop.columns)),
            )
            for loop in self._loops
        )

    def counts(self) -> tuple[int, ...]:
        """Return of how many instants of each controller something is kept."""
        return tuple(len(loop.times) for loop in self._loops)

    def cut(self, counts: tuple[int, ...]) -> None:
        """Let go of what came after so many."""
        for loop, count in zip(self._loops, counts, strict=True):
            del loop.times[count:], loop.values[count * len(loop.columns) :]

    def forget_before(self, begin: float) -> None:
        """Let go of what came before a time [s]."""
        for loop in self._loops:
            first = int(np.searchsorted(np.array(loop.times), begin))
            del loop.times[:first], loop.values[: first * len(loop.columns)]

    def numbers(self) -> dict[str, Array]:
        """Return the record as arrays for a file."""
        return {
            f"tick_{what}_{k}": np.array(getattr(loop, what))
            for k, loop in enumerate(self._loops)
            for what in ("times", "values")
        }

    def take_up_record(self, numbers: Mapping[str, NDArray[Any]]) -> None:
        """Go on with a record that :meth:`numbers` has made arrays of."""
        for k, loop in enumerate(self._loops):
            for what in ("times", "values"):
                setattr(loop, what, array("d", numbers[f"tick_{what}_{k}"].tolist()))
