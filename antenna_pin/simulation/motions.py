r"""Prescribed motions of a run whose rate jumps: impulses at the time of the jump, their work the drives'.

Up to a jump a motion goes by what its course was before it, so that steps that end there, and their dense
output, are smooth: the run's program has the course continued. At the jump

.. math:: J v^+ = s^+, \qquad W = \Lambda\, \tfrac12 (s^- + s^+)

with the rates s of all motions; what else is held stays so (:class:`antenna_pin.simulation.blows.Blows`).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.parameters import parameters_of
from antenna_pin.base.readable import number
from antenna_pin.dynamics import (
    Adjustments,
    System,
    Workspace,
    acting_in,
    check_restraint,
    kernels,
)
from antenna_pin.elements import Motion, PrescribedMotion
from antenna_pin.elements.term_jumps import continued
from antenna_pin.errors import InvalidParameterError
from antenna_pin.simulation.events import Event, Set, Time

__all__ = ["Motions", "check_sets"]

Array = NDArray[np.float64]

# Of the size of what swings: by what a position may jump that is one but for round-off of located times.
_ROUND_OFF = 1e-9


class _Course(NamedTuple):
    """A course with jumps in a program.

    Attributes:
        words: Where its terms stand.
        terms: They, of the whole course.
        times: Of its jumps [s].
        begins: Of these, less the round-off of times [s].
    """

    words: slice
    terms: Array
    times: Array
    begins: Array


def check_sets(events: Sequence[Event], system: System, y: Array) -> None:
    """Refuse events that set what no motion can follow, where that is known before a run.

    Known are what an event sets at its times, if no other sets a number of the same motion; a position, at
    any time; and what is switched on at a joint that motions move at the start.

    Args:
        events: That a run looks for.
        system: The system.
        y: First state [q, v, x].

    Raises:
        InvalidParameterError: A motion would jump.
        NotFollowedError: A joint would be held where motions move it.
    """
    workspace = Workspace(system)
    adjustments = Adjustments(system, workspace.program)
    motions = Motions(workspace, adjustments)
    sets = [(event, one) for event in events for one in event.actions if isinstance(one, Set)]
    places = [action.place.rpartition(".")[::2] for _, action in sets]
    for (event, action), (element, key) in zip(sets, places, strict=True):
        if not motions.is_one(element):
            if key == "on" and action.value:
                check_restraint(workspace, adjustments, 0.0, y, element)
            continue
        alone = [one for one, _ in places].count(element) == 1
        times = event.when.instants[event.after - 1 :][:1] if alone and isinstance(event.when, Time) else ()
        for t in times or ((0.0,) if key == "position" else ()):
            motions.goes_on(action.place, action.value, t, f"event {event.name!r}")


class Motions:
    """The prescribed motions of a run.

    Args:
        workspace: What the run works on; its program is changed.
        adjustments: Its elements as they are.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments) -> None:
        """Find those whose rate jumps, and where works are booked."""
        self._workspace, self._adjustments = workspace, adjustments
        acting = [one for one in acting_in(workspace.system) if isinstance(one.element, Motion)]
        self._labels = {one.place: one.label for one in acting}
        self._courses: list[_Course] = []
        for one in acting:
            if not isinstance(one.element, PrescribedMotion) or not one.element.edges:
                continue
            terms = np.array(one.element.follows.terms() if one.element.follows else ())
            first = one.block + int(kernels.PARAMETERS) + len(one.element.words_of_kernel())
            first -= len(one.element.tail()) - len(one.element.coefficients)
            jumps = [jump for jump in one.element.jumps if jump.time > 0.0]
            times, begins = ([getattr(jump, name) for jump in jumps] for name in ("time", "begin"))
            words = slice(first, first + len(terms))
            self._courses.append(_Course(words, terms, np.array(times), np.array(begins)))

    def is_one(self, place: str) -> bool:
        """Return whether an element, by its place, is a motion."""
        return place in self._labels

    # --- courses that jump ----------------------------------------------------------------------------------

    def renew(self, t: float) -> None:
        """Write the courses as they are from a time [s] up to their next jumps into the program."""
        for words, terms, times, begins in self._courses:
            k = int(np.searchsorted(times, t, side="right"))
            self._workspace.program[words] = continued(terms, begins[k]) if k < len(times) else terms

    def whole(self) -> Array:
        """Return a copy of the program with whole courses, which hold for samples at any time."""
        program = self._workspace.program.copy()
        for words, terms, _, _ in self._courses:
            program[words] = terms
        return program

    # --- numbers that are set -------------------------------------------------------------------------------

    def goes_on(self, place: str, value: float, t: float, who: str = "Set") -> dict[str, float]:
        """Return what is to be set, by place, for a motion to go on from where it is.

        Args:
            place: Of the number.
            value: Its new value.
            t: When [s].
            who: Who sets it, for the refusal.

        Raises:
            InvalidParameterError: Its position would jump, or its rate, where that is refused.
        """
        name, _, key = place.rpartition(".")
        motion = self._adjustments.elements[name]
        trial: dict[str, Any] = {key: value}
        assert isinstance(motion, Motion)
        found = parameters_of(type(motion)).get(key)
        if key not in motion.own_keys() and (found is None or found.sizes):
            return {place: value}  # for who sets it to refuse
        if key == "rate" and isinstance(motion, PrescribedMotion):
            trial["offset"] = motion.offset + (motion.rate - value) * t
        changed = dataclasses.replace(motion, **trial)
        before, after = motion.at(t), changed.at(t)
        jump, unit = after[0] - before[0], self._unit(motion)
        size = sum(float(np.abs(getattr(one, "amplitude", 0.0)).sum()) for one in (motion, changed))
        if key != "rate" and abs(jump) > _ROUND_OFF * size:
            way = "set its rate, with which it goes on from where it is, or "
            rule = (
                f"left as it is: the motion would jump; {way if isinstance(motion, PrescribedMotion) else ''}"
                "have a pd drive follow the course"
            )
            raise InvalidParameterError(who, place, rule, said=f"{number(jump)} {unit} at t = {t:.9g} s")
        if after[1] != before[1] and getattr(motion, "rate_jumps", "") == "refused":
            rule = "left as it is: the motion's rate would jump; take rate_jumps = 'impulse'"
            jump = after[1] - before[1]
            raise InvalidParameterError(who, place, rule, said=f"{number(jump)} {unit}/s at t = {t:.9g} s")
        return {f"{name}.{one}": float(number_of) for one, number_of in trial.items()}

    def _unit(self, motion: Motion) -> str:
        return "m" if self._workspace.system.slides(motion.joint) else "rad"
