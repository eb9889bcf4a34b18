"""Outcome and step counts of a run."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

__all__ = ["ENDED_WELL", "REACHED_END", "Counts", "Outcome"]


class Outcome(Enum):
    """Reason why a run ended."""

    COMPLETED = "reached the end of the time span"
    STOPPED = "stopped by an event that was to end it"
    INTERRUPTED = "stopped by the user; what was computed is kept"
    STEP_TOO_SMALL = (
        "the step fell below its floor; take integrator.method = 'radau5', soften the contact, loosen rtol "
        "or lower integrator.min_step"
    )
    NO_PROGRESS = (
        "the run makes no way; a force that jumps does that, or a law or a drive too stiff for an explicit "
        "method: look at the last samples, take integrator.method = 'radau5', loosen rtol, or raise "
        "integrator.max_expected_steps"
    )
    STEP_LIMIT = "made as many steps as integrator.max_steps allows; what was computed is kept"
    TIME_LIMIT = "took as long as integrator.max_wall_time allows; what was computed is kept"
    NOT_FINITE = (
        "numbers of the run stopped being finite; look at the drives and stiffnesses, or tighten the step"
    )
    FUNCTION_FAILED = (
        "a function given in Python has no answer there that can be used; what was computed before is kept: "
        "let it answer with finite numbers of the kind it is asked for, at every state that the run comes to"
    )
    FUNCTION_WITH_MEMORY = (
        "a function given in Python answered one question in two ways, and what was computed means nothing; "
        "a run asks out of order and back in time: give it no memory, chance or clock, and make a sampled "
        "controller of pieces of runs, each with start=run.end"
    )
    NOT_CLOSED = (
        "the loops cannot be closed from here on, in a singular position or out of reach; change motions or "
        "dimensions"
    )
    REFUSED = (
        "what an event sets, or a motion asks for, cannot be where the run is then; what was computed before "
        "is kept"
    )
    OUT_OF_LAW_RANGE = (
        "a contact left the range of its law; choose a law that reaches deeper, or lower the load"
    )
    TOO_DEEP = (
        "a contact was pressed beyond maximum_depth, where rigid bodies with contact stiffness no "
        "longer describe it; stiffen the law, lower the load or raise maximum_depth"
    )

    LEDGER_OPEN = (
        "the run reached its end, but energy or momentum came from nowhere, or went there; look for a motion "
        "that jumps, an element or function that misstates its energy, tighten integrator.rtol, or give "
        "integrator.ledger_tolerance the error that is expected"
    )

    @property
    def may_go_on(self) -> bool:
        """True if the run may be resumed from its checkpoint."""
        return self in (Outcome.INTERRUPTED, Outcome.TIME_LIMIT)

    @property
    def verdict(self) -> str:
        """Description of an incomplete result: ``ended early`` or ``does not balance``."""
        return "does not balance" if self is Outcome.LEDGER_OPEN else "ended early"


@dataclass(frozen=True, slots=True)
class Counts:
    """Steps and times of a run."""

    accepted: int = 0  # steps
    rejected: int = 0  # trial steps, by their error
    relocated: int = 0  # trial steps cut back to a change of contact
    evaluations: int = 0  # of the equations of motion
    wall_seconds: float = 0.0  # with recording, without compiling [s]
    compile_seconds: float = 0.0  # of kernels for this run, which the next run need not compile [s]


#: Those of a run that came to its end, and whose numbers can be relied on.
ENDED_WELL = (Outcome.COMPLETED, Outcome.STOPPED)
#: Those of a run that came to its end: every number of its result is one.
REACHED_END = (*ENDED_WELL, Outcome.LEDGER_OPEN)
