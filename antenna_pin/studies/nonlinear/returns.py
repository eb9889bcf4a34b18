"""Returns of a motion to a Poincaré section, behind its transient."""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis import quantity
from antenna_pin.analysis.transients import LEAST, RULE, Settled, settled
from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.capacity import check_count
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.base.state import State
from antenna_pin.errors import InvalidParameterError
from antenna_pin.run.simulation import Event, Progress, simulate
from antenna_pin.run.simulation.inputs import check_without_controllers, events_of, settings_of
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state
from antenna_pin.studies.nonlinear.sections import Crossing, Section, Stroboscope
from antenna_pin.trajectory import Outcome, Trajectory, open_table, table_attributes

# Rate of even samples so low that none occurs [1/s].
_NO_RATE = 1e-12
# Largest factor by which the spans of a run between crossings grow.
_LONGER = 8.0
# Share of the scenario's duration run to check the names of quantities.
_GLANCE = 1e-9
# Most points of one span, which bounds memory.
_AT_ONCE = 64
# Names used otherwise in datasets of sections and diagrams.
_TAKEN = {"time", "point", "points", "branch", "value", "settled", "transient", "drift", "period", "message"}


class _Points(NamedTuple):
    """Returns to a section."""

    times: Array  # (n,) [s]
    values: Array  # of each quantity, (n, quantities)


class SectionRun:
    """Run of a scenario that stores its returns to a section only.

    Attributes:
        state: To continue from; None before anything was run.
        outcome: How the last stretch of the run ended.
        message: That as text.
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
        """Build the system, without a run."""
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
        # Points of the last span beyond the requested ones.
        self._over = _Points(np.zeros(0), np.zeros((0, len(self.quantities))))
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
        # A very short run checks names before a long one.
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
        """Time reached by the run [s]."""
        return 0.0 if self.state is None else self.state.reached

    @property
    def ended(self) -> bool:
        """Return whether the run has ended: failed, or stopped by an event of the scenario."""
        return self.outcome is not Outcome.COMPLETED

    def more(self, count: int) -> _Points:
        """Return the next ``count`` points, fewer at the end of run or crossings.

        After that ``ended`` is true. It is not passed any more if that does not happen for as long as the
        scenario's duration, and for as long as the eightfold of what points have taken so far.
        """
        found = [self._over]
        here = len(self._over.times)
        while here < count and not self.ended:
            strobes, left = isinstance(self.section, Stroboscope), count - here
            some = self._strobed(min(left, _AT_ONCE)) if strobes else self._crossed(left)
            if not len(some.times) and not self.ended:
                self.outcome = Outcome.STOPPED
                self.message = (
                    f"from {self.time - self._span:.6g} to {self.time:.6g} s the section is not crossed: "
                    f"{self.section.words}"
                )
            found.append(some)
            here += len(some.times)
        times, values = (np.concatenate([part[k] for part in found]) for k in range(2))
        self._over = _Points(times[count:], values[count:])
        return _Points(times[:count], values[:count])

    def _strobed(self, count: int) -> _Points:
        assert isinstance(self.section, Stroboscope)
        phase, period = self.section.phase, self.period
        # First time behind the present one; the run ends half a period behind the last.
        k = math.floor(self.time / period - phase + 0.25) + 1
        if self.state is None:
            k = math.floor(-phase) + 1
        instants = [(phase + n) * period for n in range(k, k + count)]
        run = self._go_on(instants[-1] + 0.5 * period - self.time, tuple(instants))
        times = np.asarray(run.data["time"].values, dtype=float)
        reached = [t for t in instants if t <= times[-1]]
        return self._points(run, np.searchsorted(times, reached))

    def _crossed(self, count: int) -> _Points:
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
            # Too few: one full patience before giving up.
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

    def _points(self, run: Trajectory, places: NDArray[np.intp]) -> _Points:
        times = np.asarray(run.data["time"].values, dtype=float)[places]
        series = [quantity(run, name) for name in self.quantities]
        self.units = tuple(one.units for one in series)
        self.titles = tuple(one.meaning for one in series)
        whole = np.stack([one.values for one in series])
        self.sizes = np.fmax(self.sizes, np.abs(whole).max(axis=1))
        columns = list(whole[:, places])
        return _Points(times, np.stack(columns, axis=1) if len(times) else np.zeros((0, len(columns))))


# --- points behind the transient ----------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True, slots=True)
class _SettledPoints:
    """Last points of a section, with their transient and outcome."""

    times: Array  # (n,) [s]
    values: Array  # (n, quantities)
    settled: bool  # whether they have settled
    drift: float  # largest of their statistics over the size of the quantities; NaN for too few [-]
    transient: int  # points before them [-]
    outcome: str  # how the run ended, by name
    message: str  # that in words
    end: State | None  # state that the run left; None if nothing was run


def settled_points(
    returns: SectionRun, count: int, transient: int | None, most: int | None, tolerance: float
) -> _SettledPoints:
    """Return the points of a section behind its transient.

    With a transient of None points are cut, half of ``count`` at a time, until those kept have settled, or
    ``most`` were made. See :func:`poincare`.
    """
    kept = _Points(np.zeros(0), np.zeros((0, len(returns.quantities))))
    made = 0
    limit = (transient or 0) + count if transient is not None else max(most or 20 * count, count)
    ask = limit if transient is not None else count
    while True:
        some = returns.more(ask)
        made += len(some.times)
        kept = _Points(*(np.concatenate(pair)[-count:] for pair in zip(kept, some, strict=True)))
        found = _judge(kept.values, returns.sizes, tolerance)
        if found.start == 0 or made >= limit or returns.ended:
            break
        ask = min(max(count // 2, 1), limit - made)
    whole = len(kept.times) == count and not returns.ended
    return _SettledPoints(
        *kept,
        settled=found.start == 0 and whole,
        drift=found.drift,
        transient=made - len(kept.times),
        outcome=returns.outcome.name,
        message=returns.message,
        end=returns.state,
    )


def _judge(values: Array, sizes: Array, tolerance: float) -> Settled:
    """Return whether points, (n, quantities), have settled; points with NaN have not."""
    if not np.isfinite(values).all():
        return Settled(None, math.nan, tolerance, len(values))
    scale = np.where(sizes > 0.0, sizes, 1.0)
    return settled(values, scale=scale, tolerance=tolerance, whole=True)


@takes()
def poincare(
    scenario: Scenario,
    section: Section,
    quantities: Sequence[str],
    *,
    count: int = 100,
    transient: int | None = None,
    most: int | None = None,
    tolerance: float = 1e-4,
    start: State | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> xr.Dataset:
    """Return the points in which the motion of a scenario returns to a section.

    The run is made in stretches as long as it takes, whatever the scenario's duration, and keeps nothing but
    these points. Where they have settled is judged (:func:`antenna_pin.analysis.settled`), not assumed.

    Args:
        scenario: What to run.
        section: Once a period (:class:`Stroboscope`), or where a surface is passed (:class:`Crossing`).
        quantities: Quantities to record, by the names of :func:`antenna_pin.analysis.quantity`.
        count: Points to return, at least 32 [-].
        transient: Points to cut before them; None to cut until what follows has settled [-].
        most: Points after which to stop cutting; 20 times ``count`` if left out [-].
        tolerance: A drift below this part of a quantity's largest amount is none [-].
        start: State that a run left, to start from; the scenario's start if left out. It is one of this
            scenario's system.
        progress: Called about ten times a second.

    Returns:
        Over ``point``: ``time`` [s] and each quantity. ``settled`` says whether they have settled,
        ``transient`` how many points were cut before them, ``drift`` [-] how far their statistics
        went; attributes ``rule``, ``section``, ``period`` [s], ``outcome``, ``message``,
        ``scenario`` (JSON) and ``state``, to continue from (:meth:`antenna_pin.base.state.State.from_json`);
        it is that to which the run got, behind the last point, and of a surface behind later ones too. A run
        that ended early has fewer points, and has not settled.

    Raises:
        AntennaPinError: The input is not valid.
        InvalidParameterError: Likewise; no drive has a period, or the section was never crossed.
    """
    check_counts("poincare", count, transient, most, tolerance)
    returns = SectionRun(scenario, section, quantities, start, progress)
    found = settled_points(returns, count, transient, most, tolerance)
    if not len(found.times):
        raise InvalidParameterError(
            "poincare",
            "section",
            "one that the motion comes to; choose another surface, direction or start, or a longer duration",
            said=f"{section.words}: {_fate(returns)}",
        )
    return _dataset(scenario, returns, found, tolerance)


def check_counts(
    place: str, count: object, transient: object, most: object, tolerance: float, fewest: int = LEAST
) -> None:
    """Refuse numbers of points too small for a judgement."""
    for name, value, least in (("count", count, fewest), ("transient", transient, 0), ("most", most, count)):
        if value is None and name != "count":
            continue
        if isinstance(value, bool) or not isinstance(value, int) or value < least:  # type: ignore[operator]
            why = ", with fewer of which nothing can be judged" if name == "count" else ""
            raise InvalidParameterError(place, name, f"a whole number of {least} or more{why}", value)
        check_count(place, name, value, least)  # type: ignore[arg-type]
    if transient is not None and most is not None:
        raise InvalidParameterError(place, "most", "left out with a transient", most)
    check_number(place, "tolerance", tolerance, "from 0 to below 1")


def _dataset(scenario: Scenario, returns: SectionRun, points: _SettledPoints, tolerance: float) -> xr.Dataset:
    variables: dict[str, Any] = {
        name: ("point", points.values[:, k], {"units": returns.units[k], "long_name": returns.titles[k]})
        for k, name in enumerate(returns.quantities)
    }
    about = {"long_name": "whether the points have settled"}
    variables["settled"] = ((), points.settled, about)
    variables["transient"] = ((), points.transient, {"units": "1", "long_name": "points cut before these"})
    what = "largest drift of a statistic of the points, over the size of the quantities"
    variables["drift"] = ((), points.drift, {"units": "1", "long_name": what})
    return xr.Dataset(
        variables,
        coords={"time": ("point", points.times, {"units": "s", "long_name": "when the section is passed"})},
        attrs={
            **table_attributes("section", scenario),
            "quantities": json.dumps(returns.quantities),
            "section": returns.section.words,
            "period": returns.period,
            "rule": RULE,
            "tolerance": tolerance,
            "outcome": points.outcome,
            "message": points.message,
            "state": "" if points.end is None else points.end.to_json(),
        },
    )


def _fate(returns: SectionRun) -> str:
    """Return the outcome of a run without a point."""
    kept = "" if returns.outcome.name == "STOPPED" else f"; {returns.message}"
    return f"not once in {returns.time:.6g} s{kept}"


@takes()
def open_section(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return the points of a section from their file.

    Returns:
        As :func:`antenna_pin.studies.nonlinear.poincare` does.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    table = open_table(path, "section")
    table["settled"] = table["settled"].astype(bool)
    return table
