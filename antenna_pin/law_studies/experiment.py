r"""The measured pin joint of Liu et al. 2013, Table 1, and how far every law is from it.

A pin of steel in a clevis and a tang, pulled slowly: load over displacement for three plays. What the data
can decide is little. The joint with the largest play is the stiffest at low load, against every law; the load
of 3000 N gives the same displacement for two plays; one displacement (0.02308 mm) does not fit the paper's
own column of equation (6), which wants 0.02312. The length of the contact and the radii are not given: the
paper takes one millimetre, and its column of equation (14) has radii of 0.9 mm that no specimen can have.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.contact import Material
from antenna_pin.law_studies.comparison import elastic_laws_of_joint, force_within

__all__ = [
    "LIU_2013",
    "LIU_2013_PLAYS",
    "LIU_2013_STEEL",
    "ExperimentFit",
    "ExperimentPoint",
    "compare_with_experiment",
    "printed_columns",
    "ranked",
]


@dataclass(frozen=True, slots=True)
class ExperimentPoint:
    """One row of the table.

    Attributes:
        clearance: Radial play [m].
        depth: Displacement [m].
        load: Measured load [N].
        hertz: Load by equation (6), as printed [N].
        conformal: Load by equation (14), as printed [N].
    """

    clearance: float
    depth: float
    load: float
    hertz: float
    conformal: float


def _points() -> tuple[ExperimentPoint, ...]:
    rows = (
        (0.067, 0.981, 500, 871, 494),
        (0.067, 1.971, 1000, 1751, 1410),
        (0.067, 3.253, 2000, 2889, 2988),
        (0.067, 4.484, 3000, 3983, 4836),
        (0.094, 1.156, 500, 1026, 527),
        (0.094, 2.308, 1000, 2054, 1502),
        (0.094, 3.232, 2000, 2871, 2483),
        (0.094, 4.484, 3000, 3983, 4056),
        (0.104, 0.734, 500, 653, 252),
        (0.104, 1.436, 1000, 1275, 696),
        (0.104, 2.512, 1640, 2231, 1607),
    )
    return tuple(
        ExperimentPoint(play * 1e-3, depth * 1e-5, float(load), float(hertz), float(conformal))
        for play, depth, load, hertz, conformal in rows
    )


#: Table 1 of Liu et al. 2013.
LIU_2013 = _points()

#: The radial plays of its joints [m].
LIU_2013_PLAYS = tuple(sorted({point.clearance for point in LIU_2013}))

#: Young's modulus of the paper; Poisson's ratio follows from its column of equation (6) to 0.07 %.
LIU_2013_STEEL = Material(
    young=206e9, poisson=0.3, source="Liu et al. 2013; Poisson's ratio derived from its Table 1"
)


@dataclass(frozen=True, slots=True)
class ExperimentFit:
    """One law, or a printed column, against the measured loads.

    Attributes:
        law: Name of the law.
        contacts: Over how many equal contacts in series the displacement is shared: 1 or 2; None for a column
            as printed.
        loads: By the law, one for each point [N]; NaN where the law says nothing at such a depth.
        errors: Of the loads over the measured ones, one for each point [-].
    """

    law: str
    contacts: int | None
    loads: tuple[float, ...]
    errors: tuple[float, ...]

    @property
    def in_range(self) -> int:
        """Number of points at which the law says something."""
        return int(np.isfinite(self.loads).sum())

    @property
    def mean(self) -> float:
        """Mean of the errors' sizes [-]; NaN if the law does not reach every point."""
        return float(np.mean(np.abs(self.errors)))

    @property
    def largest(self) -> float:
        """Largest size of the errors [-]; NaN if the law does not reach every point."""
        return float(np.max(np.abs(self.errors)))

    def mean_of(self, clearance: float) -> float:
        """Return the mean of the errors' sizes in the group of one play [-], or NaN as ``mean``."""
        group = [
            abs(error)
            for error, point in zip(self.errors, LIU_2013, strict=True)
            if abs(point.clearance - clearance) < 1e-9
        ]
        return float(np.mean(group))


@takes()
def compare_with_experiment(
    *, journal_radius: float = 5e-3, length: float = 1e-3, material: Material = LIU_2013_STEEL
) -> tuple[ExperimentFit, ...]:
    """Return every elastic law of a journal in a bore against the measured loads.

    Each law is compared with the displacement of the table as that of one contact, and as that of two in
    series (pin-clevis and pin-tang). Nothing is fitted.

    Args:
        journal_radius: Of the pin [m]; the paper gives none, and most laws hardly depend on it.
        length: Of the contact [m]; the paper takes 1 mm.
        material: Of all parts.
    """
    by_play = {
        play: elastic_laws_of_joint(
            bearing_radius=journal_radius + play,
            journal_radius=journal_radius,
            length=length,
            bearing=material,
            journal=material,
        )
        for play in LIU_2013_PLAYS
    }
    names = [name for name in next(iter(by_play.values())) if all(name in laws for laws in by_play.values())]
    fits = []
    for name in names:
        for contacts in (1, 2):
            loads = tuple(
                force_within(by_play[point.clearance][name], point.depth / contacts) for point in LIU_2013
            )
            fits.append(_fit(name, contacts, loads))
    return tuple(fits)


def printed_columns() -> tuple[ExperimentFit, ExperimentFit]:
    """Return the paper's own columns, of equations (6) and (14), against the measured loads."""
    return (
        _fit("printed: Hertz", None, tuple(point.hertz for point in LIU_2013)),
        _fit("printed: conformal", None, tuple(point.conformal for point in LIU_2013)),
    )


def _fit(law: str, contacts: int | None, loads: tuple[float, ...]) -> ExperimentFit:
    errors = tuple(load / point.load - 1.0 for load, point in zip(loads, LIU_2013, strict=True))
    return ExperimentFit(law, contacts, loads, errors)


@takes()
def ranked(fits: Iterable[ExperimentFit]) -> list[ExperimentFit]:
    """Return fits sorted: those that reach every point first, then by the mean error where they do."""

    def rank(fit: ExperimentFit) -> tuple[int, float]:
        known = [abs(error) for error in fit.errors if math.isfinite(error)]
        return len(fit.errors) - len(known), sum(known) / max(len(known), 1)

    return sorted(fits, key=rank)
