"""Whether functions of a user's answer equal questions equally: what a run rests on.

A run asks out of order: stages of a step, steps that are rejected and made again, dense output, samples. A
function with a memory, of chance or of the clock answers each time something else, and the run's error
control, its located events and its way from one state to the next then mean nothing. So questions of
earlier states are asked again now and then, with all others of the run in between.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.simulation.events import Event
from antenna_pin.simulation.questions import Asked, asked_functions

__all__ = ["Repeatable"]

Array = NDArray[np.float64]

_LOOKS_AT_FIRST = 32  # states, one after the other
_EVALUATIONS = 192  # of the run from one look to the next: each asks three times, 1.6 % of what the run asks
_AGES = 8  # questions kept besides the first: of ages 1, 2, 4, ... looks


class _Kept:
    """One function, with questions of several ages and its answers to them."""

    def __init__(self, asked: Asked) -> None:
        self._asked = asked
        self._looks = 0
        self._first: tuple[Any, tuple[float, ...]] | None = None
        self._kept: dict[int, tuple[Any, tuple[float, ...]]] = {}
        self._last = -1

    def look(self, t: float, y: Array) -> str:
        """Ask two questions again and a new one; return what is wrong in words."""
        words = self._again(self._older()) or self._again(self._kept.get(self._last))
        question = None if words else self._asked.question(t, y)
        if question is None and self._first is None:
            question = self._asked.first
        if question is not None:
            self._looks += 1
            self._last = min((self._looks & -self._looks).bit_length() - 1, _AGES - 1)
            self._kept[self._last] = question, self._asked.answer(question)
            self._first = self._first or self._kept[self._last]
        return words

    def _older(self) -> tuple[Any, tuple[float, ...]] | None:
        """Return the first question, or one of another age, in turn."""
        kept = [self._first, *self._kept.values()]
        return kept[self._looks % len(kept)]

    def again(self) -> str:
        """Ask all again; return what is wrong in words."""
        return next((words for one in (self._first, *self._kept.values()) if (words := self._again(one))), "")

    def _again(self, one: tuple[Any, tuple[float, ...]] | None) -> str:
        if one is None:
            return ""
        question, before = one
        now = self._asked.answer(question)
        if not self._asked.differ(before, now):
            return ""
        k = next(k for k in range(len(now)) if self._asked.differ(before[k : k + 1], now[k : k + 1]))
        told = self._asked.told(question)
        return f", {self._asked.name} of {told} gave {before[k]:.12g} and then {now[k]:.12g}"


class Repeatable:
    """Asks again what a run's functions of a user's were asked before.

    Args:
        workspace: What the run works on.
        events: What it looks for.
    """

    def __init__(self, workspace: Workspace, events: Sequence[Event]) -> None:
        """Begin without a question."""
        #: What it asks.
        self.asked = asked_functions(workspace, events)
        self._functions = [_Kept(asked) for asked in self.asked]
        self._at_first = _LOOKS_AT_FIRST
        self._next = 0

    def look(self, t: float, y: Array, evaluations: int) -> str:
        """Ask at a state that the run has come to, if it is time to; return what is wrong in words.

        Args:
            t: Time [s].
            y: State [q, v, x].
            evaluations: That the run has made so far.
        """
        if not self._functions or (self._at_first <= 0 and evaluations < self._next):
            return ""
        self._at_first -= 1
        self._next = evaluations + _EVALUATIONS
        return next((words for one in self._functions if (words := one.look(t, y))), "")

    def end(self) -> str:
        """Ask all again, when the run has made its last step; return what is wrong in words."""
        return next((words for one in self._functions if (words := one.again())), "")
