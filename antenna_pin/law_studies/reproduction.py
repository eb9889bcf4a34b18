r"""The printed columns of Table 1 of Liu et al. 2013, reproduced: their parameters, and what does not fit.

Equation (6) is :math:`F = \tfrac\pi4 E^* L \delta` and has one parameter, :math:`E^*`, for the whole column;
equation (14) is Hertz's for spheres, :math:`F = \tfrac43 E^* \sqrt R\, \delta^{3/2}`, and has one more for
each play, :math:`R = R_i R_j / \Delta R`. A row of the table fits if its own parameter may be the common one:
it lies in the interval that the rounding of the row's load and of its displacement leaves.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from antenna_pin.law_studies.experiment import LIU_2013, LIU_2013_PLAYS, ExperimentPoint

__all__ = ["ReproducedTable", "reproduce_table"]

_LENGTH = 1e-3  # of the contact, as the paper takes it [m]
_LOAD_ROUNDING = 0.5  # half the last digit of a printed load [N]
_DEPTH_ROUNDING = 5e-9  # and of a displacement [m]
_DEPTH_DIGITS = 8  # decimals of a displacement in metres

_Row = tuple[ExperimentPoint, float]  # a row, and the displacement that counts for it [m]


@dataclass(frozen=True, slots=True)
class ReproducedTable:
    """The two printed columns by their formulas, with the parameters that most rows share.

    Attributes:
        modulus: E*, common to the Hertz column [Pa].
        radii: R_i R_j / play of the conformal column, one for each of ``LIU_2013_PLAYS`` [m].
        depths: Displacement of each row [m], mended where it is misprinted.
        hertz_fits: Whether the load by (6) is each row's as printed, within the rounding.
        conformal_fits: Whether the load by (14) is, with the mended displacement.
    """

    modulus: float
    radii: tuple[float, ...]
    depths: tuple[float, ...]
    hertz_fits: tuple[bool, ...]
    conformal_fits: tuple[bool, ...]

    @property
    def misprinted(self) -> tuple[int, ...]:
        """Rows whose displacement does not fit their load by (6), from 0."""
        return tuple(row for row, fits in enumerate(self.hertz_fits) if not fits)

    @property
    def bore_radii(self) -> tuple[float, ...]:
        """R_i that the radius of each play asks for [m]: R_i (R_i - play) / play is that radius."""
        return tuple(
            0.5 * play + math.sqrt(radius * play + 0.25 * play**2)
            for play, radius in zip(LIU_2013_PLAYS, self.radii, strict=True)
        )

    def radius_of(self, clearance: float) -> float:
        """Return R_i R_j / play of the conformal column for one of the table's plays [m]."""
        return self.radii[LIU_2013_PLAYS.index(clearance)]

    def hertz(self, row: int) -> float:
        """Return the load of a row by (6) [N]."""
        return 0.25 * math.pi * _LENGTH * self.modulus * self.depths[row]

    def conformal(self, row: int) -> float:
        """Return the load of a row by (14) [N]."""
        return self.conformal_load(LIU_2013[row].clearance, self.depths[row])

    def conformal_load(self, clearance: float, depth: float) -> float:
        """Return the load by (14) for one of the table's plays [m] and a displacement [m], in N."""
        return float(4.0 / 3.0 * self.modulus * math.sqrt(self.radius_of(clearance)) * depth**1.5)


def reproduce_table() -> ReproducedTable:
    """Return both printed columns by their formulas.

    A displacement that does not fit its load by (6) is mended: it becomes the one which that load asks for,
    at the precision of the table.
    """
    printed = [(point, point.depth) for point in LIU_2013]
    moduli = [_interval(row, lambda p: p.hertz, lambda d: 0.25 * math.pi * _LENGTH * d) for row in printed]
    modulus = _common(moduli)
    hertz_fits = tuple(low <= modulus <= high for low, high in moduli)
    rows = [
        (point, depth if fits else round(point.hertz / (0.25 * math.pi * _LENGTH * modulus), _DEPTH_DIGITS))
        for (point, depth), fits in zip(printed, hertz_fits, strict=True)
    ]
    intervals = [
        _interval(row, lambda p: p.conformal**2, lambda d: (4.0 / 3.0 * modulus) ** 2 * d**3) for row in rows
    ]
    of_play = {
        play: _common([at for at, (point, _) in zip(intervals, rows, strict=True) if point.clearance == play])
        for play in LIU_2013_PLAYS
    }
    return ReproducedTable(
        modulus=modulus,
        radii=tuple(of_play.values()),
        depths=tuple(depth for _, depth in rows),
        hertz_fits=hertz_fits,
        conformal_fits=tuple(
            low <= of_play[point.clearance] <= high
            for (low, high), (point, _) in zip(intervals, rows, strict=True)
        ),
    )


def _interval(
    row: _Row, column: Callable[[ExperimentPoint], float], divisor: Callable[[float], float]
) -> tuple[float, float]:
    """Return between what ``column / divisor``, a column's parameter, lies by the rounding of one row."""
    point, depth = row
    ends = []
    for sign in (-1.0, 1.0):
        moved = dataclasses.replace(
            point,
            hertz=point.hertz + _LOAD_ROUNDING * sign,
            conformal=point.conformal + _LOAD_ROUNDING * sign,
        )
        ends.append(column(moved) / divisor(depth - _DEPTH_ROUNDING * sign))
    return ends[0], ends[1]


def _common(intervals: Sequence[tuple[float, float]]) -> float:
    """Return the middle of where most intervals overlap, the last of equals."""
    best, found = 0, 0.0
    for low, _ in intervals:
        holding = [(a, b) for a, b in intervals if a <= low <= b]
        if len(holding) >= best:
            best, found = len(holding), 0.5 * (low + min(b for _, b in holding))
    return found
