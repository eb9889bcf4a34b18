"""Trial steps: tried until one passes, and made again to end where something happens."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from antenna_pin.errors import FunctionError
from antenna_pin.integrate import Stepper
from antenna_pin.simulation.control import StepControl
from antenna_pin.trajectory import Outcome

__all__ = ["Made", "Trial", "Trials"]

_RELOCATIONS = 5
_REJECTED_IN_A_ROW = 1000


class Trial(NamedTuple):
    """What has come of trying.

    Attributes:
        passed: Whether there is a trial step that passes, in the stepper.
        following: Size to try next [s].
        outcome: Why the run ends, if it does.
        words: What of, where that is known.
        tried: Whether there is anything to conclude of, beside those.
    """

    passed: bool
    following: float
    outcome: Outcome | None = None
    words: str = ""
    tried: bool = True


class Made(NamedTuple):
    """What a run has made so far.

    Attributes:
        tried: Trial steps.
        rejected: Those whose error was too large.
        relocated: Those made to end where something happens.
        evaluations: Of the right-hand side.
        wall: Wall time that it took [s].
    """

    tried: int
    rejected: int
    relocated: int
    evaluations: int
    wall: float


class Trials:
    """Tries steps and counts them.

    Args:
        stepper: What makes them.
        control: What decides how long they are.

    Attributes:
        accepted: Steps that have been accepted.
        rejected: Trial steps rejected by their error.
        relocated: Trial steps made to end where something happens.
    """

    def __init__(self, stepper: Stepper, control: StepControl) -> None:
        """Begin to count."""
        self._stepper = stepper
        self._control = control
        self.accepted = self.rejected = self.relocated = 0
        self._failure: FunctionError | None = None
        #: Returns what a function that kernels call has failed by, in a step of a size [s]; None if none has.
        self.failure_in: Callable[[Stepper, float], FunctionError | None] = lambda stepper, h: None

    @property
    def made(self) -> int:
        """Trial steps made so far."""
        return self.accepted + self.rejected + self.relocated

    def so_far(self, wall: float) -> Made:
        """Return what was made, in so much wall time [s]."""
        return Made(self.made, self.rejected, self.relocated, self._stepper.evaluations, wall)

    def first(self, h: float, cut: Callable[[float], None]) -> Trial:
        """Try steps until one passes.

        Args:
            h: Size to begin with [s].
            cut: Called before a step is tried that the end of the run has cut, with the size begun with.
        """
        stepper, control = self._stepper, self._control
        rejected, wished = self.rejected, h
        while True:
            tried, by_end = control.pace.cut(stepper.t, h)
            if by_end:
                cut(wished)
            if stepper.t + tried == stepper.t:
                return Trial(False, h, Outcome.STEP_TOO_SMALL)
            error = self._attempt(tried)
            if error <= 1.0:
                return Trial(True, control.pace.following(h, tried, error, self.rejected > rejected))
            self.rejected += 1
            if self.rejected - rejected >= _REJECTED_IN_A_ROW:
                return Trial(False, h, Outcome.NO_PROGRESS)
            shorter = self._shortened(tried, error)
            if shorter.outcome is not None:
                return shorter
            h = shorter.following

    def again(self, size: float, longest: float, lack: Callable[[], float]) -> Trial:
        """Make the trial step again so that it ends where something happens.

        The error of the step that went on past that point says nothing of the one up to it. Where that one's
        is too large, there is none that passes.

        Args:
            size: How far into the step that is, by a dense output [s].
            longest: What the step may be corrected to at most [s].
            lack: How much longer the trial step should be [s], or 0.
        """
        for _ in range(_RELOCATIONS):
            error = self._attempt(size)
            self.relocated += 1
            if not error <= 1.0:
                return self._shortened(size, error)
            more = lack()
            if more == 0.0 or not 0.0 < size + more <= longest:
                break
            size += more
        return Trial(True, size)

    def _attempt(self, h: float) -> float:
        """Try a step; return its error, none where a function of the user's has no answer in it.

        A shorter step may not come to where it has none.
        """
        self._failure = None
        try:
            return self._stepper.attempt(h)
        except FunctionError as failure:
            self._failure = failure
            return math.nan

    def _shortened(self, tried: float, error: float) -> Trial:
        h = self._control.pace.shortened(tried, error)
        if not self._control.pace.hopeless(h):
            return Trial(False, h)
        failure = self._failure or self.failure_in(self._stepper, tried)
        if failure is not None:
            return Trial(False, h, Outcome.FUNCTION_FAILED, f", {failure.seen}")
        return Trial(False, h, Outcome.STEP_TOO_SMALL if math.isfinite(error) else Outcome.NOT_FINITE)
