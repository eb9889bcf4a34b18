"""A scenario set up once and run as often as it is asked, whole or from other states; what its runs show."""

from __future__ import annotations

import dataclasses
from functools import cached_property
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.assemble import build_system, initial_angles, initial_state
from antenna_pin.base.interruption import interruptible, uninterrupted
from antenna_pin.base.state import State
from antenna_pin.nonlinear import Flow
from antenna_pin.scenario import Scenario
from antenna_pin.simulation.inputs import RunStart, controllers_of, events_of, prepared, settings_of
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.recorder import labelled_at, open_ledger
from antenna_pin.simulation.samples import Chunk
from antenna_pin.trajectory import ENDED_WELL

__all__ = ["Bench", "Ran", "at_times"]

Array = NDArray[np.float64]

_ROUND_OFF = 1e-12  # by which a run may end before its end [s]


class Ran(NamedTuple):
    """One run.

    Attributes:
        chunk: Its samples.
        end: The state that it came to.
        failed: Why it did not come to its end, in words; "" if it did.
        unbalanced: How its energy or momentum does not balance, in words; "" if both do.
    """

    chunk: Chunk
    end: State
    failed: str
    unbalanced: str = ""


class Bench:
    """A scenario with its system, which is built once.

    Args:
        scenario: What is run.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Build the system."""
        self.scenario, self.system = scenario, build_system(scenario)
        self._latest: Run | None = None

    @cached_property
    def _first(self) -> RunStart:
        q, v = initial_state(self.scenario, self.system)
        return RunStart(q, v, initial_angles(self.scenario, self.system))

    @cached_property
    def flow(self) -> Flow:
        """The system's flow, as its runs are integrated."""
        return Flow(self.system, settings_of(self.scenario), events_of(self.scenario), self.scenario)

    @cached_property
    def first(self) -> State:
        """The state that the scenario starts from."""
        q, v = initial_state(self.scenario, self.system)
        return self.flow.first(q, v, initial_angles(self.scenario, self.system))

    def run(self, times: Array, until: float, start: State | None = None) -> Ran:
        """Make a run that is sampled at times, rising [s], and goes on until an instant [s].

        Args:
            times: Of its samples, beside its start and end; those of the run's span count.
            until: Its end [s].
            start: From where; the scenario's start if left out.

        Raises:
            AntennaPinError: It cannot begin.
            KeyboardInterrupt: It was interrupted.
        """
        begin = 0.0 if start is None else start.reached
        settings = dataclasses.replace(
            settings_of(self.scenario),
            accuracy=None,
            output_rate=0.5 / (until - begin),
            output_times=tuple(times[(times >= begin) & (times <= until)].tolist()),
            output_form="full",
        )
        given = self._first if start is None else RunStart(start=start)
        events, controllers = events_of(self.scenario), controllers_of(self.scenario)
        ready = prepared("fit", self.system, given, settings, events, until - begin, None, controllers)
        run = Run(self.system, ready.first, until, settings, events, begin, controllers=controllers)
        with interruptible() as interrupted:
            run.advance(interrupted=interrupted)
        self._latest = uninterrupted(run)
        ended = run.outcome in ENDED_WELL and run.stepper.t >= until - _ROUND_OFF
        unbalanced = open_ledger(run) if ended else ""
        return Ran(run.samples.held, run.present(), "" if ended else run.message, unbalanced)

    def counted(self, chunk: Chunk) -> Chunk:
        """Return one state twice, all that is integrated along a run larger by 1 in the second.

        What is not the same of both counts from a run's start on, as work does: pieces of a run, and states
        displaced, do not have it.
        """
        both = Chunk.joined([chunk.part(0, 1), chunk.part(0, 1)])
        system, first = self.system, self.system.model.nq + self.system.model.nv
        books = np.ones(system.manifold.nx, dtype=bool)
        books[np.asarray(system.bristle_x, dtype=int)] = False
        books[list(system.turn_x.values())] = False
        states = both.states.copy()
        states[1, first:][books] += 1.0
        return both._replace(states=states)

    def data(self, chunk: Chunk) -> xr.Dataset:
        """Return what states of this system show, as a result has it; they may be of several of its runs.

        What is integrated along a run, as work is, counts from the first of them.
        """
        if self._latest is None:
            first, settings = np.ascontiguousarray(chunk.states[0]), settings_of(self.scenario)
            self._latest = Run(self.system, first, 1.0, settings)
        return labelled_at(self._latest, chunk)


def at_times(chunk: Chunk, times: Array) -> NDArray[np.intp]:
    """Return the places of samples at times that are among them; of two at an instant, the later one."""
    return np.searchsorted(chunk.times, times, side="right") - 1
