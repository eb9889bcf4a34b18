"""Validation of a fit by records that were not fitted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from antenna_pin.base.readable import number
from antenna_pin.fit.covariance import BEYOND_CHANCE
from antenna_pin.fit.laboratory import Laboratory
from antenna_pin.fit.plan import FitPlan
from antenna_pin.fit.problem import NoRunError, Problem
from antenna_pin.sweep import Executor

__all__ = ["ValidationResult", "Validation"]

Array = NDArray[np.float64]


class ValidationResult(NamedTuple):
    """A record that was not fitted, beside the model with the values found.

    Attributes:
        record: Its name.
        chi2: Sum of the squares of its residuals [-]; NaN if the model has no run.
        numbers: How many residuals that are.
        failed: Why there is no run, in words.
    """

    record: str
    chi2: float
    numbers: int
    failed: str = ""

    @property
    def chance(self) -> float:
        """Share of records of the stated noise that would be farther from the model [-]."""
        return float(stats.chi2.sf(self.chi2, self.numbers))

    def words(self) -> str:
        """Return it as a line."""
        if self.failed:
            return f"validation by {self.record}: no run: {self.failed}"
        holds = (
            "" if self.chance >= BEYOND_CHANCE else ": the values do not hold for it, or its sd is too small"
        )
        return f"validation by {self.record}: chi2 {number(self.chi2)} for {self.numbers} numbers{holds}"


class Validation:
    """Records for validation, read and checked.

    Args:
        plan: The fit's file.
        executor: Who makes the runs: this process if left out.

    Raises:
        AntennaPinError: Something of records or scenarios is not valid.
    """

    def __init__(self, plan: FitPlan, executor: Executor | None = None) -> None:
        """Read and check all."""
        other = plan.unfitted()
        self._problem = None if other is None else Problem(other, Laboratory(executor))

    def at(self, names: Sequence[str], values: Array) -> tuple[ValidationResult, ...]:
        """Return each record beside the model.

        Args:
            names: Of the fit's parameters.
            values: Theirs, (p,) [SI].
        """
        if self._problem is None:
            return ()
        every = dict(zip(names, values, strict=True))
        here = np.array([every[name] for name in self._problem.names])
        try:
            residuals = self._problem.residuals(here)
        except NoRunError as error:
            return tuple(ValidationResult(name, np.nan, 0, str(error)) for name in self._problem.plan.records)
        curves, found = self._problem.rows.by_curve(residuals), []
        for record in self._problem.plan.records:
            own = np.concatenate([one for name, one in curves.items() if name.partition(".")[0] == record])
            found.append(ValidationResult(record, float(own @ own), len(own)))
        return tuple(found)
