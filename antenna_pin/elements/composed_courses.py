"""References made of points, and of others: table, sum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar, Literal

import numpy as np

from antenna_pin.base.parameters import check, parameter
from antenna_pin.elements.curve import Interpolation, check_table, cubics, points_and_middles
from antenna_pin.elements.reference import Reference, pieces
from antenna_pin.errors import InvalidParameterError


@lru_cache(maxsize=8)
def curve_term(
    time: tuple[float, ...],
    values: tuple[float, ...],
    interpolation: Interpolation | Literal["smooth"],
    periodic: bool = False,
) -> tuple[float, ...]:
    """Return a curve through points for kernels (:func:`antenna_pin.elements.curve.cubics`)."""
    n = len(time)
    curve = cubics(time, values, interpolation, periodic)
    rows = [curve[n + 4 * k : n + 4 * k + 4][::-1] for k in range(n - 1)]
    return pieces(time, rows, time[-1] - time[0]) if periodic else pieces(going_on(time), rows)


def going_on(time: Sequence[float]) -> tuple[float, ...]:
    """Return the times of a table whose last piece has no end."""
    return (*time[:-1], math.inf)


@dataclass(frozen=True, slots=True, kw_only=True)
class Table(Reference):
    """Values at times, and what joins them.

    Attributes:
        file: Where it came from, relative to the scenario's folder; None if it is given as numbers.
        time: Strictly increasing, at least two [s].
        values: One for each [rad] ([m]).
        interpolation: ``linear``; ``cubic``, monotone between points; ``smooth``, of continuous second
            derivative.
        periodic: Whether it repeats; its ends are the same then, and a run may go beyond them.
    """

    columns: ClassVar[tuple[str, str]] = ("time", "values")

    file: str | None = None
    time: tuple[float, ...] = parameter("s", sizes=(0,), repr=False)
    values: tuple[float, ...] = parameter("rad", sliding="m", sizes=(0,), repr=False)
    interpolation: Literal["linear", "cubic", "smooth"] = "smooth"
    periodic: bool = False

    def __post_init__(self) -> None:
        """Check the points."""
        check(self)
        check_table(self, "values")
        if self.periodic and self.values[0] != self.values[-1]:
            rule = f"such that the last is the first, {self.values[0]!r}, of a periodic table"
            raise InvalidParameterError(self, "values", rule, said=repr(self.values[-1]))

    @property
    def known(self) -> tuple[float, float]:
        """From its first time to its last [s]; always if it comes again."""
        return (-math.inf, math.inf) if self.periodic else (self.time[0], self.time[-1])

    @property
    def instants(self) -> tuple[float, ...]:
        """Points and the middles between them [s]; none if it comes again (``longest_step``)."""
        return () if self.periodic else points_and_middles(self.time)

    @property
    def longest_step(self) -> float:
        """Least distance of points of a periodic course [s]."""
        return float(np.diff(self.time).min()) if self.periodic else math.inf

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        return curve_term(self.time, self.values, self.interpolation, self.periodic)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        where = "" if self.file is None else f" of {self.file}"
        again = ", again and again" if self.periodic else ""
        return f"a table{where} of {len(self.time)} points{again}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sum(Reference):
    """The sum of other references.

    Attributes:
        parts: The references.
    """

    parts: tuple[Reference, ...]

    def __post_init__(self) -> None:
        """Check that there are some."""
        check(self)
        if not self.parts or not all(isinstance(part, Reference) for part in self.parts):
            raise InvalidParameterError(self, "parts", "one or more references", said=f"{len(self.parts)}")

    @property
    def instants(self) -> tuple[float, ...]:
        """Kinks of the parts [s]."""
        return tuple(sorted({t for part in self.parts for t in part.instants}))

    @property
    def longest_step(self) -> float:
        """The shortest of its parts [s]."""
        return min(part.longest_step for part in self.parts)

    @property
    def known(self) -> tuple[float, float]:
        """Time from which all parts are known [s]."""
        return max(part.known[0] for part in self.parts), min(part.known[1] for part in self.parts)

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels."""
        return tuple(number for part in self.parts for number in part.terms())

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return " + ".join(part.words(slides) for part in self.parts)
