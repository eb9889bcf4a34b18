"""What a test can tell, before anything is fitted: from the Jacobian at the start and the stated noise."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.errors import InvalidParameterError
from antenna_pin.fit.rank import DOUBT, Rank, rank_of
from antenna_pin.fit.sureness import Residuals, student

__all__ = ["Identifiable", "identifiable", "said_of_direction"]

Array = NDArray[np.float64]

# What of a direction is said: parts of it as large as this share of the largest.
_SAID = 0.02

#: An expected interval as wide as this many times the size of the value tells hardly anything [-].
POOR = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Identifiable:
    """What a record can tell of parameters at given values.

    Attributes:
        names: Of the parameters.
        values: At which this holds, (p,).
        scale: Typical sizes, (p,).
        rank: What of them the record feels.
        error: Standard errors to expect by the stated noise, (p,); infinite of one that cannot be told.
        half: Half widths of the intervals to expect, (p,).
        alone: Standard errors to expect if all others were known, (p,).
        inflation: How many times an error is larger for the others not being known, (p,) [-].
        level: Of the intervals [-].
        quantile: Half widths over errors [-].
        singular: Singular values of the Jacobian over the scales, falling, (p,) [-]: one over a value is the
            standard error along its direction, in scales.
        directions: Those directions, a row each, (p, p), of length 1 in scales.
        together: In words, what cannot be told: parameters one by one, and combinations.
        hold: Parameters to hold, so that the others can be told: one of each combination.
    """

    names: tuple[str, ...]
    values: Array
    scale: Array
    rank: Rank
    error: Array
    half: Array
    alone: Array
    inflation: Array
    level: float
    quantile: float
    singular: Array
    directions: Array
    together: tuple[str, ...]
    hold: tuple[str, ...]

    @property
    def poor(self) -> tuple[str, ...]:
        """Names of those that the record tells, but to no better than their own size."""
        wide = np.isfinite(self.half) & (self.half > POOR * self.scale)
        return tuple(name for name, one in zip(self.names, wide, strict=True) if one)


@takes()
def identifiable(
    problem: Residuals, values: Array | None = None, *, level: float = 0.95, doubt: float = DOUBT
) -> Identifiable:
    """Return what a record can tell of parameters; nothing is fitted, one Jacobian is made.

    Args:
        problem: What would be fitted.
        values: Where, (p,); the values to start from if left out.
        level: Of the intervals to expect [-].
        doubt: Relative error of the Jacobian's columns [-].
    """
    if not 0.0 < level < 1.0:
        raise InvalidParameterError("fit", "level", "between 0 and 1 [-]", level)
    at = np.asarray(problem.start if values is None else values, dtype=float)
    scale, names = np.asarray(problem.scale, dtype=float), tuple(problem.names)
    jacobian = problem.jacobian(at)
    rank = rank_of(jacobian, scale, doubt)
    root = rank.told.T / rank.singular[: len(rank.told)]
    error = np.where(rank.determined, np.linalg.norm(root, axis=1) * scale, math.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        alone = np.where(rank.felt, scale / rank.lengths, math.inf)
        inflation = np.where(rank.felt, error / alone, math.nan)
    reach = student(level, math.inf)
    _, singular, directions = np.linalg.svd(jacobian * scale, full_matrices=len(jacobian) < len(scale))
    singular = np.concatenate([singular, np.zeros(len(scale) - len(singular))])
    return Identifiable(
        names,
        at,
        scale,
        rank,
        error,
        reach * error,
        alone,
        inflation,
        level,
        reach,
        singular,
        directions,
        tuple(said_of_direction(row, names, scale, at) for row in rank.null),
        tuple(names[int(np.abs(row).argmax())] for row in rank.null),
    )


def said_of_direction(row: Array, names: tuple[str, ...], scale: Array, values: Array) -> str:
    """Return in words along which changes of parameters a record stays as it is.

    Args:
        row: The direction, in scales of the parameters, (p,).
        names: Of the parameters.
        scale: Their scales, (p,).
        values: Their values, (p,); changes are said in percent of them, or in scales where they are zero.
    """
    size = np.abs(row)
    places = [int(k) for k in np.argsort(-size, kind="stable") if size[k] > _SAID * size.max()]
    if len(places) == 1:
        return f"{names[places[0]]}: not at all, the record stays as it is when it changes"
    shares = [row[k] * scale[k] / abs(values[k]) if values[k] else row[k] for k in places]
    moves = ", ".join(
        f"{names[k]} by {number(share / shares[0], 2)} %{'' if values[k] else ' of its scale'}"
        for k, share in zip(places, shares, strict=True)
    )
    together = f"{', '.join(names[k] for k in places[:-1])} and {names[places[-1]]}"
    return f"{together}: only together, the record stays as it is when they change, {moves}"
