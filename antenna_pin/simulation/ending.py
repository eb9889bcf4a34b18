"""Why a run ends, and what is said of it."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from antenna_pin.dynamics import acting_in
from antenna_pin.engine import loop_kernels as kernels
from antenna_pin.trajectory import Outcome

__all__ = ["NeverSettlesError", "RefusedError", "message_of", "no_step", "too_deep", "undetermined"]


class NeverSettlesError(Exception):
    """Changes of mode at one instant would never end; of which element."""

    outcome: ClassVar[Outcome] = Outcome.NO_PROGRESS

    @property
    def seen(self) -> str:
        """Return the reason as part of a message."""
        return f", {self} comes to no mode in which it stays"


class RefusedError(NeverSettlesError):
    """Setting of an element that the position of its joint forbids; the reason."""

    outcome: ClassVar[Outcome] = Outcome.REFUSED

    @property
    def seen(self) -> str:
        """Return the reason as part of a message."""
        return f", {self}"


def no_step(run: Any, reason: int) -> tuple[Outcome, str]:
    """Return how a run ends whose step does not come about, and what is to be said of it.

    Args:
        run: The run (:class:`antenna_pin.simulation.loop.Run`).
        reason: Why the loop came back.
    """
    tried, error, refused = run.steps.tried
    if reason == kernels.NO_WAY:
        return Outcome.NO_PROGRESS, ""
    if reason == kernels.STANDS_STILL:
        return Outcome.STEP_TOO_SMALL, ""
    failure = run.stepper.answers.refusal if refused else run.oversight.failure_in(run.stepper, tried)
    if failure is not None:
        return Outcome.FUNCTION_FAILED, f", {failure.seen}"
    return (Outcome.STEP_TOO_SMALL if math.isfinite(error) else Outcome.NOT_FINITE), ""


def too_deep(run: Any) -> tuple[Outcome, str]:
    """Return how a run ends whose contact has come to a limit of its depth, and what is to be said of it."""
    c = run.steps.contact
    of_joint = run.search.reasons[c] == "maximum_depth"
    return (Outcome.TOO_DEEP if of_joint else Outcome.OUT_OF_LAW_RANGE), f", {run.search.words(c)}"


def undetermined(run: Any) -> str:
    """Return of which elements the load is not determined while their joint stands; "" if of none."""
    names = [
        one.label
        for one in acting_in(run.system)
        if getattr(run.actions.adjustments.elements[one.place], "prescribed", False)
    ]
    said = (
        f"; {', '.join(names)}: the joint is held to a motion, and while it stands the torque of friction is "
        "not determined: recorded is that of the way it came"
        if names
        else ""
    )
    if shares := sorted(run.actions.modes.shares):
        said += (
            f"; {', '.join(shares)}: one freedom is held by several, the share of its load is not determined"
        )
    return said


def message_of(run: Any, outcome: Outcome, what: str) -> tuple[Outcome, str]:
    """Return an outcome as it is once what a run was near to is known, and the message.

    Args:
        run: The run.
        outcome: How it ends.
        what: What is to be said of that, from a comma on.
    """
    found = outcome
    if outcome in (Outcome.NOT_FINITE, Outcome.STEP_TOO_SMALL) and run.singular and run.singular.near:
        found, what = Outcome.NOT_CLOSED, run.singular.near
    if outcome is Outcome.NOT_FINITE and (jammed := run.actions.modes.jammed(run.stepper.t, run.here)):
        what = jammed
    return found, f"at t = {run.stepper.t:.9g} s{what}: {found.value}"
