"""The returns of a run to a section, a few at a time: each call goes on where the one before has ended."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.analysis import quantity
from antenna_pin.assemble import build_system, initial_angles, initial_state
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.base.state import State
from antenna_pin.errors import InvalidParameterError
from antenna_pin.nonlinear.surfaces import Crossing, Section, Stroboscope
from antenna_pin.scenario import Scenario
from antenna_pin.simulation import Event, Progress, simulate
from antenna_pin.simulation.inputs import check_without_controllers, events_of, settings_of
from antenna_pin.trajectory import Outcome, Trajectory

__all__ = ["Points", "Returns"]

Array = NDArray[np.float64]

# Samples at a rate are not wanted: one this long [1/s] away is never come to.
_NO_RATE = 1e-12
# Stretches of a run that cross a surface are made longer and shorter as points come, by at most so much.
_LONGER = 8.0
# Part of the scenario's duration that is run to see whether it has the quantities.
_GLANCE = 1e-9
# Points of one stretch: what bounds the memory that its record takes.
_AT_ONCE = 64
# What the datasets of sections and diagrams call something else.
_TAKEN = {"time", "point", "points", "branch", "value", "settled", "transient", "drift", "period", "message"}


class Points(NamedTuple):
    """Some returns to a section.

    Attributes:
        times: (n,) [s].
        values: Of each quantity, (n, quantities).
    """

    times: Array
    values: Array


class Returns:
    """A run that is made for its returns to a section, and keeps nothing else.

    Args:
        scenario: What to run.
        section: Where to look at it.
        quantities: What to note there, by the names that :func:`antenna_pin.analysis.quantity` knows.
        start: State to start from; the scenario's own start if left out.
        progress: Called about ten times a second while it runs.

    Attributes:
        state: To go on from; None before anything was run.
        outcome: How the last stretch of the run ended.
        message: That in words.
        units: Of each quantity.
        titles: What each quantity is.
        period: Of the stroboscope [s]; NaN of a surface.
        sizes: Largest amount of each quantity that was seen, on the section or off it, (quantities,).
    """

    def __init__(
        self,
        scenario: Scenario,
        section: Section,
        quantities: Sequence[str],
        start: State | None = None,
        progress: Callable[[Progress], None] | None = None,
    ) -> None:
        """Build the system; nothing is run yet."""
        if not quantities or isinstance(quantities, str):
            raise InvalidParameterError("section", "quantities", "names of one quantity or more", quantities)
        taken = _TAKEN.intersection(quantities)
        if taken:
            rule = "another name; a section has its own"
            raise InvalidParameterError("section", "quantity", rule, said=", ".join(sorted(taken)))
        if not isinstance(section, Stroboscope | Crossing):
            raise InvalidParameterError("section", "section", "a Stroboscope or a Crossing", section)
        self.section, self.quantities, self.state = section, tuple(quantities), start
        self.period = section.period_in(scenario) if isinstance(section, Stroboscope) else math.nan
        self.system = build_system(scenario)
        self.outcome, self.message = Outcome.COMPLETED, Outcome.COMPLETED.value
        self.units: tuple[str, ...] = ()
        self.titles: tuple[str, ...] = ()
        self.sizes: Array = np.zeros(len(self.quantities))
        self._progress = progress
        # What the last stretch came to beyond what was asked for.
        self._over = Points(np.zeros(0), np.zeros((0, len(self.quantities))))
        settings = settings_of(scenario)
        self._settings = dataclasses.replace(
            settings, output_rate=_NO_RATE, output_times=(), output_form="full"
        )
        if not math.isnan(self.period):
            begin = 0.0 if start is None else start.reached
            self._settings.check_long_enough("section", "period", self.period, begin)
        check_without_controllers("section", scenario)
        own = events_of(scenario)
        self._event = "section"
        while any(event.name == self._event for event in own):
            self._event += "_"
        self._events = own
        if isinstance(section, Crossing):
            passing = Event(name=self._event, when=section.when, direction=section.direction)
            self._events = (*own, passing)
        self._patience = self._span = scenario.duration
        q, v = initial_state(scenario, self.system)
        self._first: dict[str, Any] = {"q": q, "v": v, "angles": initial_angles(scenario, self.system)}
        # A run that is next to none tells what is wrong with names before a long one is made.
        glance = dataclasses.replace(self._settings, max_wall_time=None, output_form="full")
        shown = simulate(
            self.system,
            duration=max(_GLANCE * scenario.duration, glance.shortest_at(0.0)),
            settings=glance,
            events=self._events,
            **self._first,
        )
        self._points(uninterrupted(shown), np.zeros(0, dtype=np.intp))

    @property
    def time(self) -> float:
        """How far the run has come [s]."""
        return 0.0 if self.state is None else self.state.reached

    @property
    def ended(self) -> bool:
        """Whether it cannot go on: it failed, or was stopped by an event of the scenario's."""
        return self.outcome is not Outcome.COMPLETED

    def more(self, count: int) -> Points:
        """Return the next ``count`` points; fewer if the run ends, or passes the surface no more.

        After that ``ended`` is true. It is not passed any more if that does not happen for as long as the
        scenario's duration, and for as long as the eightfold of what points have taken so far.
        """
        found = [self._over]
        here = len(self._over.times)
        while here < count and not self.ended:
            some = (
                self._strobed(min(count - here, _AT_ONCE)) if self._strobes else self._crossed(count - here)
            )
            if not len(some.times) and not self.ended:
                self.outcome = Outcome.STOPPED
                self.message = (
                    f"from {self.time - self._span:.6g} to {self.time:.6g} s the section is not crossed: "
                    f"{self.section.words}"
                )
            found.append(some)
            here += len(some.times)
        times, values = (np.concatenate([part[k] for part in found]) for k in range(2))
        self._over = Points(times[count:], values[count:])
        return Points(times[:count], values[:count])

    @property
    def _strobes(self) -> bool:
        return isinstance(self.section, Stroboscope)

    def _strobed(self, count: int) -> Points:
        assert isinstance(self.section, Stroboscope)
        phase, period = self.section.phase, self.period
        # The first instant behind the present time; the run ends half a period behind the last one.
        k = math.floor(self.time / period - phase + 0.25) + 1
        if self.state is None:
            k = math.floor(-phase) + 1
        instants = [(phase + n) * period for n in range(k, k + count)]
        run = self._go_on(instants[-1] + 0.5 * period - self.time, tuple(instants))
        times = np.asarray(run.data["time"].values, dtype=float)
        reached = [t for t in instants if t <= times[-1]]
        return self._points(run, np.searchsorted(times, reached))

    def _crossed(self, count: int) -> Points:
        began = self.time
        run = self._go_on(self._span)
        crossed = np.zeros(0)
        if "event" in run.data.sizes:
            mine = np.asarray(run.data["event"].values).astype(str) == self._event
            crossed = np.asarray(run.data["event_time"].values, dtype=float)[mine]
        times = np.asarray(run.data["time"].values, dtype=float)
        points = self._points(run, np.searchsorted(times, crossed))
        if len(crossed):
            spacing = (self.time - began) / len(crossed)
            wanted = min(count - len(crossed), _AT_ONCE) if count > len(crossed) else _AT_ONCE
            self._patience = max(self._patience, _LONGER * spacing)
            self._span = min(max(1.1 * spacing * wanted, _LONGER * spacing), _AT_ONCE * spacing)
        elif self._span < self._patience:
            # Fewer than hoped for: look for as long as patience is before giving up.
            self._span = self._patience
            return points if self.ended else self._crossed(count)
        return points

    def _go_on(self, span: float, instants: tuple[float, ...] = ()) -> Trajectory:
        settings = dataclasses.replace(self._settings, output_times=instants)
        start: dict[str, Any] = self._first if self.state is None else {"start": self.state}
        run = simulate(
            self.system,
            duration=span,
            settings=settings,
            events=self._events,
            progress=self._progress,
            **start,
        )
        uninterrupted(run)
        self.state, self.outcome, self.message = run.end, run.outcome, run.message
        return run

    def _points(self, run: Trajectory, places: NDArray[np.intp]) -> Points:
        times = np.asarray(run.data["time"].values, dtype=float)[places]
        series = [quantity(run, name) for name in self.quantities]
        self.units = tuple(one.units for one in series)
        self.titles = tuple(one.meaning for one in series)
        whole = np.stack([one.values for one in series])
        self.sizes = np.fmax(self.sizes, np.abs(whole).max(axis=1))
        columns = list(whole[:, places])
        return Points(times, np.stack(columns, axis=1) if len(times) else np.zeros((0, len(columns))))
