"""References: what motions and controllers follow over time, with exact first and second derivatives."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from antenna_pin.base.lazy import Classes
from antenna_pin.base.parameters import check, parameters_of
from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.elements import term_kernels as kernels
from antenna_pin.elements.curve import SweptPiece


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """Base of the references: a sum of terms for kernels.

    Angles of a joint that turns [rad], or ways of one that slides [m]; or what else who follows it takes.
    """

    def __post_init__(self) -> None:
        """Check the parameters."""
        check(self)

    def terms(self) -> tuple[float, ...]:
        """Return it for kernels (:mod:`antenna_pin.elements.term_kernels`)."""
        raise NotImplementedError

    @property
    def instants(self) -> tuple[float, ...]:
        """Times at which steps end: jumps of a derivative, or long spans [s]."""
        return ()

    @property
    def longest_step(self) -> float:
        """Step that still resolves it [s]."""
        return math.inf

    @property
    def known(self) -> tuple[float, float]:
        """From when to when it is known [s]."""
        return -math.inf, math.inf

    def at(self, t: float) -> tuple[float, float, float]:
        """Return value, rate and acceleration at time t [s]."""
        return self.over_time()(t)

    def over_time(self) -> OverTime:
        """Return value, rate and acceleration as a function of time [s], for many times."""
        return OverTime(self)

    def words(self, slides: bool = False) -> str:
        """Return what it is in words, numbers with units; of what slides or turns."""
        raise NotImplementedError

    def text_of(self, name: str, slides: bool) -> str:
        """Return one of its parameters with its unit."""
        found = parameters_of(type(self))[name]
        unit = found.sliding if slides and found.sliding else found.unit
        return readable(getattr(self, name), unit.replace("*", " "), GIVEN)


@dataclass(frozen=True)
class OverTime:
    """A reference as a function of time [s]: value, rate and acceleration.

    Attributes:
        reference: The reference.
    """

    reference: Reference

    @cached_property
    def _words(self) -> Any:
        return np.array(self.reference.terms())

    def __call__(self, t: float) -> tuple[float, float, float]:
        """Return value, rate and acceleration at a time [s]."""
        found: tuple[float, float, float] = kernels.course(self._words, 0, self._words.size, float(t))
        return found


def term(kind: int, more: Sequence[float] = (), **numbers: float) -> tuple[float, ...]:
    """Return a term for kernels: its record, then further numbers."""
    record = np.zeros(1, dtype=kernels.TERM)
    record["kind"], record["length"] = kind, kernels.SIZE + len(more)
    for name, value in numbers.items():
        record[name] = value
    return (*record.view(np.float64).tolist(), *more)


def pieces(
    times: Sequence[float], coefficients: Sequence[Sequence[float]], again: float = 0.0
) -> tuple[float, ...]:
    """Return pieces of polynomials for kernels.

    Args:
        times: Between which the pieces are, one more than these [s].
        coefficients: Of each piece, from the constant on, of the time since its begin.
        again: After what time all comes again [s]; 0: never, the end is held.
    """
    powers = max(map(len, coefficients))
    padded = [list(row) + [0.0] * (powers - len(row)) for row in coefficients]
    own = (*times, *itertools.chain.from_iterable(padded))
    return term(kernels.PIECES, own, count=len(padded), powers=powers, begin=times[0], span=again)


def swept(parts: Sequence[SweptPiece]) -> tuple[float, ...]:
    """Return a swept sine for kernels; its last piece has no end."""
    found = np.zeros(len(parts), dtype=kernels.SWEPT_PIECE)
    for k, part in enumerate(parts):
        found[k] = tuple(part)
    return term(kernels.SWEPT, found.view(np.float64).tolist(), count=len(parts))


# --- references by their kinds ------------------------------------------------------------------------------

REFERENCES = Classes(
    "antenna_pin.elements",
    {
        "constant": "courses.Constant",
        "ramp": "courses.Ramp",
        "polynomial": "courses.Polynomial",
        "sine": "courses.Sine",
        "chirp": "courses.Chirp",
        "sines": "courses.Sines",
        "table": "composed_courses.Table",
        "trapezoid": "slews.Trapezoid",
        "s-curve": "slews.SCurve",
        "rest-to-rest": "slews.RestToRest",
        "sum": "composed_courses.Sum",
    },
)
"""References by their ``kind`` in ``[references.NAME]``."""
