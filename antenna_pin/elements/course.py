"""Courses over time: a sine, and sums with a table and a reference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar, Literal

from antenna_pin.base.readable import GIVEN, number
from antenna_pin.elements.composed_courses import curve_term
from antenna_pin.elements.curve import (
    Interpolation,
    both_given,
    check_covers,
    check_table,
    points_and_middles,
)
from antenna_pin.elements.element import ForceElement, packed
from antenna_pin.elements.reference import Reference
from antenna_pin.errors import InvalidParameterError


def eighth_of_period(frequency: float | None) -> float:
    """Return the step that resolves what swings [s]; infinite where nothing does."""
    return math.inf if frequency is None else 0.125 / frequency


class Swing(ForceElement):
    """Base of the elements of which something swings."""

    # The fields are those of the classes that declare them, with their units and meanings.
    __slots__ = ()

    frequency: float | None

    @property
    def longest_step(self) -> float:
        """An eighth of the period [s]."""
        return eighth_of_period(self.frequency)

    @packed
    def angular_frequency(self) -> float:
        """Angular frequency of the sine, 0 without [rad/s]."""
        return 2.0 * math.pi * (self.frequency or 0.0)

    def check_frequency(self, swings: bool) -> None:
        """Refuse an amplitude without a frequency.

        Args:
            swings: Whether the amplitude is other than zero.
        """
        if swings and self.frequency is None:
            raise InvalidParameterError(self, "frequency", "given beside an amplitude", said="none")


class Course(Swing):
    r"""Base of the elements that follow a course over time.

    .. math:: \phi_0 + \omega t + A \sin(2 \pi f t + \varphi) + \text{table}(t) + \text{reference}(t)
    """

    __slots__ = ()

    follows: Reference | None
    rate: float
    amplitude: float
    phase: float
    file: str | None
    time: tuple[float, ...] | None

    # Field of the constant part; the columns of a file with the table, time and values; how its points are
    # joined.
    constant: ClassVar[str]
    columns: ClassVar[tuple[str, str]]
    joined: ClassVar[Interpolation | Literal["smooth"]]

    @property
    def instants(self) -> tuple[float, ...]:
        """Points and middles of the table, and instants of the reference [s]."""
        own = () if self.time is None else points_and_middles(self.time)
        return own if self.follows is None else tuple(sorted({*own, *self.follows.instants}))

    @property
    def longest_step(self) -> float:
        """An eighth of the period, and what resolves the reference that it follows [s]."""
        own = eighth_of_period(self.frequency)
        return own if self.follows is None else min(own, self.follows.longest_step)

    def check_course(self) -> None:
        """Refuse a course of which something is missing."""
        self.check_frequency(self.amplitude != 0.0)
        if self.frequency is not None and self.amplitude == 0.0:
            raise InvalidParameterError(self, "amplitude", "given beside a frequency", said="none")
        if both_given(self, *self.columns):
            check_table(self, self.columns[1])

    def check_span(self, place: str, begin: float, end: float) -> None:
        """Refuse a run that the table does not cover."""
        if self.time is not None:
            check_covers(self.time, place, begin, end)
        if self.follows is not None:
            check_covers(self.follows.known, f"{place}: reference", begin, end)

    @packed
    def course_length(self) -> int:
        """Number of words of its terms."""
        return len(Course.tail(self))

    def tail(self) -> tuple[float, ...]:
        """Return the terms of what it follows, then the table's."""
        terms = () if self.follows is None else self.follows.terms()
        if self.time is None:
            return terms
        return (*terms, *curve_term(self.time, getattr(self, self.columns[1]), self.joined))

    def course_words(self, slides: bool, powers: Sequence[str] = ()) -> str:
        """Return the parts of the course in words.

        Args:
            slides: Whether the joint slides.
            powers: Words of further parts, behind the one that grows with time.
        """
        parts = [self.text_of(self.constant, slides)] if getattr(self, self.constant) else []
        if self.rate:
            parts.append(f"{self.text_of('rate', slides)} · t")
        parts += powers
        if self.frequency is not None:
            phase = f" + {self.text_of('phase', slides)}" if self.phase else ""
            frequency = number(self.frequency, GIVEN)
            parts.append(f"{self.text_of('amplitude', slides)} × sin(2π · {frequency} Hz · t{phase})")
        if self.time is not None:
            where = "" if self.file is None else f" of {self.file}"
            parts.append(f"a table{where} of {len(self.time)} points")
        if self.follows is not None:
            parts.append(self.follows.words(slides))
        return " + ".join(parts)
