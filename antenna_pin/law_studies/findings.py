"""What the measured pin joint of Liu et al. 2013 says of the laws, and what it cannot decide."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from antenna_pin.base.arguments import takes
from antenna_pin.contact import effective_modulus
from antenna_pin.law_studies.experiment import (
    LIU_2013,
    LIU_2013_PLAYS,
    LIU_2013_STEEL,
    ExperimentFit,
    ExperimentPoint,
    compare_with_experiment,
    printed_columns,
    ranked,
)
from antenna_pin.law_studies.reproduction import ReproducedTable, reproduce_table

__all__ = ["ExperimentFindings", "LeastError", "experiment_findings"]


@dataclass(frozen=True, slots=True)
class LeastError:
    """An error that no law of a kind can avoid in one of two rows.

    Attributes:
        first: Row of the joint with the smaller play, from 0.
        second: Row of the joint with the larger play, from 0.
        error: In the one row or the other, at least [-].
    """

    first: int
    second: int
    error: float


@dataclass(frozen=True, slots=True)
class ExperimentFindings:
    """The table reproduced, the laws against its measured loads, and what follows from both.

    Attributes:
        table: The paper's own columns by their formulas.
        fits: Of every elastic law, in one contact and in two, best first.
        printed: Of the paper's columns (6) and (14), as printed.
        journal_radius: Of the pin, as taken for the laws [m].
        least_error: What a law that stiffens with depth and not with play must be off by.
    """

    table: ReproducedTable
    fits: tuple[ExperimentFit, ...]
    printed: tuple[ExperimentFit, ExperimentFit]
    journal_radius: float
    least_error: LeastError

    @property
    def best(self) -> ExperimentFit:
        """Of the laws that reach every point, that of the smallest mean error."""
        return min((fit for fit in self.fits if fit.in_range == len(LIU_2013)), key=lambda fit: fit.mean)

    @property
    def poisson(self) -> float:
        """Poisson's ratio that the modulus of the Hertz column asks for, with the paper's 206 GPa [-]."""
        return math.sqrt(1.0 - LIU_2013_STEEL.young / (2.0 * self.table.modulus))

    @property
    def modulus_excess(self) -> float:
        """By what share E* of the paper's steel exceeds that of its Hertz column [-]."""
        return effective_modulus(LIU_2013_STEEL, LIU_2013_STEEL) / self.table.modulus - 1.0

    @property
    def bore_radius(self) -> float:
        """Radius of the bore that the conformal column holds, mean over the plays [m]."""
        return sum(self.table.bore_radii) / len(self.table.bore_radii)

    @property
    def conformal_factor(self) -> float:
        """By what factor (14) with this pin exceeds the printed column, at the least play [-]."""
        play = LIU_2013_PLAYS[0]
        radius = (self.journal_radius + play) * self.journal_radius / play
        return math.sqrt(radius / self.table.radius_of(play))

    def fit(self, law: str, contacts: int = 1) -> ExperimentFit:
        """Return the fit of one law.

        Args:
            law: Its name in ``NORMAL_LAWS``.
            contacts: In series, 1 or 2.
        """
        (found,) = (fit for fit in self.fits if (fit.law, fit.contacts) == (law, contacts))
        return found


@takes()
def experiment_findings(*, journal_radius: float = 5e-3, length: float = 1e-3) -> ExperimentFindings:
    """Return what the measured joint says.

    Args:
        journal_radius: Of the pin [m]; the paper gives none.
        length: Of the contact [m]; the paper takes 1 mm.
    """
    return ExperimentFindings(
        table=reproduce_table(),
        fits=tuple(ranked(compare_with_experiment(journal_radius=journal_radius, length=length))),
        printed=printed_columns(),
        journal_radius=journal_radius,
        least_error=_least_error(),
    )


def _least_error() -> LeastError:
    """Return the largest error that a law which stiffens with depth and not with play must have somewhere.

    Of a joint a and one b with more play that is displaced less, such a law makes f_a / f_b at least
    d_a / d_b. If the measured loads fall short of that by a factor q, the law is too high in a or too low in
    b: the least that the larger of the two errors can be is e with (1 + e) / (1 - e) = q.
    """

    def error(a: ExperimentPoint, b: ExperimentPoint) -> float:
        if not (a.clearance < b.clearance and a.depth > b.depth):
            return 0.0
        short = (a.depth / b.depth) / (a.load / b.load)
        return (short - 1.0) / (short + 1.0)

    pairs = itertools.permutations(range(len(LIU_2013)), 2)
    first, second = max(pairs, key=lambda pair: error(LIU_2013[pair[0]], LIU_2013[pair[1]]))
    return LeastError(first, second, error(LIU_2013[first], LIU_2013[second]))
