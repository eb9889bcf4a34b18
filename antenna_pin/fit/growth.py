"""Whether one run can hold a record: how differences between neighbours grow along it.

A search goes by derivatives. Along a chaotic motion differences grow with its exponent: behind some instant
neighbours a small step away have nothing in common but their statistics, and derivatives, true as they may
be, tell nothing of where the sum of squares is smaller. Over pieces that are short enough they do.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.readable import prefixed

__all__ = ["Growth", "growth_of"]

Array = NDArray[np.float64]

# In how many parts a record is looked at; the bend of a difference over the difference from which on it is
# none that is straight; and over how many growths by e a piece is to go.
_PARTS, _BENT, _FOLDS = 24, 0.5, 1.0
_AT_LEAST = 3.0  # growths by e that have been, where one cannot be told
_ROUND_OFF = 1e-9  # of what runs read [-]


class Growth(NamedTuple):
    """How differences grow along a record that one run does not hold.

    Attributes:
        since: From when on neighbours differ by more than is straight [s].
        fold: In what time a difference grows by e [s].
    """

    since: float
    fold: float

    @property
    def length(self) -> float:
        """Length of pieces over which it does not grow by much [s]."""
        return _FOLDS * self.fold

    def words(self, record: str, parameter: str, step: float) -> str:
        """Return a line on it.

        Args:
            record: Name of the record.
            parameter: Name of the parameter that neighbours differ by.
            step: By how much of its size [-].
        """
        since, fold, length = (_time(one) for one in (self.since, self.fold, self.length))
        return (
            f"note: records.{record}: one run does not hold it: from {since} on the effect of {step:g} of "
            f"{parameter} is not straight any more, and it grows by e in {fold}; give it "
            f'pieces = {{ length = "{length}" }}'
        )


def _time(value: float) -> str:
    factor, unit = prefixed("s", [value])
    return f"{factor * value:.2g} {unit.replace('µ', 'u')}"


def growth_of(time: Array, below: Array, here: Array, above: Array, reach: float = 1.0) -> Growth | None:
    """Return how differences of neighbours grow along a record; None where they stay small.

    Args:
        time: Of its rows [s].
        below: What is read in a run on one side, over the noise, (columns, rows).
        here: Likewise in the run itself.
        above: On the other side.
        reach: How much farther neighbours are looked for than these are, by how the difference bends.
    """
    if len(time) < 2 * _PARTS:
        return None
    bends, sizes = np.zeros(_PARTS), np.zeros(_PARTS)
    for k, rows in enumerate(np.array_split(np.arange(len(time)), _PARTS)):
        bends[k] = np.linalg.norm(above[:, rows] + below[:, rows] - 2.0 * here[:, rows])
        sizes[k] = np.linalg.norm(above[:, rows] - below[:, rows])
    floor = _ROUND_OFF * np.linalg.norm(here)  # differences of next to nothing are bent by round-off
    bent = (reach * bends > _BENT * sizes) & (sizes > floor)
    # Where it begins for good: a single part of nothing but crossings is none.
    first = next((k for k in range(_PARTS) if bent[k] and bent[k:].mean() > _BENT), None)
    if first is None or not sizes[first] > 0.0:
        return None
    middles = np.array([one.mean() for one in np.array_split(time, _PARTS)])
    grown = np.flatnonzero(sizes[: first + 1] > 0.0)
    since = float(middles[first] - time[0])
    fold = since / _AT_LEAST
    if len(grown) > 2:
        rate = float(np.polyfit(middles[grown], np.log(sizes[grown]), 1)[0])
        if not rate > 0.0:
            return None
        fold = min(fold, 1.0 / rate)
    return Growth(float(middles[first]), fold) if fold > 0.0 else None
