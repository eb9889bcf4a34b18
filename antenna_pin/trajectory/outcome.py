"""Outcome and step counts of a run."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Outcome(Enum):
    """Reason why a run ended."""

    COMPLETED = "reached the end of the time span"
    STOPPED = "stopped by an event that was to end it"
    INTERRUPTED = "stopped by the user; the results so far are saved"
    STEP_TOO_SMALL = (
        "the step fell below its floor; take integrator.method = 'radau5', soften the contact, loosen rtol "
        "or lower integrator.min_step"
    )
    NO_PROGRESS = (
        "the run makes no progress, because a force jumps, or a law or drive is too stiff for an explicit "
        "method: inspect the last samples, use integrator.method = 'radau5', loosen rtol, or raise "
        "integrator.max_expected_steps"
    )
    STEP_LIMIT = "made as many steps as integrator.max_steps allows; the results so far are saved"
    TIME_LIMIT = "took as long as integrator.max_wall_time allows; the results so far are saved"
    NOT_FINITE = (
        "numbers of the run are no longer finite; check the drives and stiffnesses, or use a smaller step"
    )
    FUNCTION_FAILED = (
        "a Python function failed or returned no usable value; the results so far are saved: make it return "
        "finite numbers of the required type at every state that the run reaches"
    )
    FUNCTION_WITH_MEMORY = (
        "a Python function returned two values for one state, so the results are invalid; a run calls it "
        "out of order and back in time: use no memory, randomness or clock in it, and write a sampled "
        "controller instead"
    )
    NOT_CLOSED = (
        "the loops cannot be closed from here on, in a singular position or out of reach; change motions or "
        "dimensions"
    )
    REFUSED = (
        "an event or a motion demands a state that is impossible at that time; the results so far are saved"
    )
    OUT_OF_LAW_RANGE = (
        "a contact left the range of its law; choose a law that reaches deeper, or lower the load"
    )
    TOO_DEEP = (
        "a contact was pressed beyond maximum_depth, where rigid bodies with contact stiffness no "
        "longer describe it; stiffen the law, lower the load or raise maximum_depth"
    )

    LEDGER_OPEN = (
        "the run reached its end, but energy or momentum is not conserved; check for a motion that jumps or "
        "an element or function with a wrong energy, tighten integrator.rtol, or set "
        "integrator.ledger_tolerance to the expected error"
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
