"""A run as it stood between two steps: what is needed to go back there, its record included."""

from __future__ import annotations

import dataclasses
from typing import Any

from antenna_pin.base.state import State
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.standing import take_up

__all__ = ["Mark", "RecordMark"]


class RecordMark:
    """The record of a run as it stands, to go back to; its steps stay where they are.

    Args:
        run: The run, between two steps.
    """

    def __init__(self, run: Run) -> None:
        """Keep what is not kept by anything that comes."""
        self._run = run
        self._samples, self._contacts = run.samples.kept(), run.contacts.kept()
        self._singular: Any = None if run.singular is None else run.singular.value()
        self._happened, self._changed = len(run.actions.happened), len(run.actions.modes.changed)
        self._ticked = run.ticks.counts()
        self._ended = run.outcome, run.message, run.left

    def go_back(self) -> None:
        """Let the run have the record that it had."""
        run = self._run
        run.samples.go_back(self._samples)
        run.contacts.go_back(self._contacts)
        if run.singular is not None:
            run.singular.take_up(self._singular)
        del run.actions.happened[self._happened :], run.actions.modes.changed[self._changed :]
        run.ticks.cut(self._ticked)
        run.outcome, run.message, run.left = self._ended


class Mark:
    """A run as it stood at the beginning of a step, to go back to.

    Args:
        run: The run.
        state: Its state then; what is recorded since is nothing yet.
    """

    def __init__(self, run: Run, state: State) -> None:
        """Keep all of it."""
        self._run, self.state = run, state
        self._record = RecordMark(run)
        self._numbers = run.actions.adjustments.kept()
        made = run.steps
        self._made = made.accepted, made.rejected, made.relocated, run.stepper.evaluations
        self._seen = run.control.paced, run.search.gap_difference

    def is_here(self) -> bool:
        """Whether the run stands at this state, with this record."""
        made = self._run.steps
        now = made.accepted, made.rejected, made.relocated, self._run.stepper.evaluations
        return now == self._made and self._run.stepper.t == self.state.time

    def left(self) -> State:
        """Return the state that the run leaves where it is now, if it goes on from here."""
        return dataclasses.replace(self.state, reached=self._run.stepper.t)

    def go_back(self) -> None:
        """Let the run stand where it stood."""
        run = self._run
        run.actions.adjustments.go_back(self._numbers)
        take_up(run, self.state)
        self._record.go_back()
        made = run.steps
        made.accepted, made.rejected, made.relocated, run.stepper.evaluations = self._made
        run.control.paced, run.search.gap_difference = self._seen
        run.control.renew(run.actions.adjustments.elements.values())
        run.left = None
