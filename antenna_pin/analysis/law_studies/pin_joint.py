r"""Measured pin joint of Liu et al. 2013, Table 1, with laws and printed columns.

A pin of steel in a clevis and a tang, pulled slowly: load over displacement for three plays. The data decide
little. The joint with the largest play is the stiffest at low load, against every law; the load of 3000 N
gives the same displacement for two plays; one displacement (0.02308 mm) does not fit the paper's own column
of equation (6), which requires 0.02312. The length of the contact and the radii are not given: the paper
takes one millimetre, and its column of equation (14) has radii of 0.9 mm that no specimen can have.

Equation (6) is :math:`F = \tfrac\pi4 E^* L \delta` and has one parameter, :math:`E^*`, for the whole column;
equation (14) is Hertz's for spheres, :math:`F = \tfrac43 E^* \sqrt R\, \delta^{3/2}`, and has one more for
each play, :math:`R = R_i R_j / \Delta R`. A row of the table fits if its own parameter may be the common one:
it lies in the interval that the rounding of the row's load and of its displacement leaves.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.contact import (
    NORMAL_LAWS,
    CompiledNormalLaw,
    ElasticLaw,
    Material,
    NormalLaw,
    effective_modulus,
    internal_hertz_stiffness,
    is_elastic,
    law_parameters,
    make_normal_law,
)
from antenna_pin.errors import InvalidParameterError


@takes()
def elastic_laws_of_joint(
    *, bearing_radius: float, journal_radius: float, length: float, bearing: Material, journal: Material
) -> dict[str, ElasticLaw]:
    """Return every elastic law for a journal in a bore, by name.

    Laws that do not hold for these dimensions are left out; :func:`laws_left_out` gives the reason.

    Args:
        bearing_radius: R_i [m].
        journal_radius: R_j [m].
        length: L, of the line of contact [m].
        bearing: Material of the bearing.
        journal: Material of the journal.
    """
    tried = _try_all(bearing_radius, journal_radius, length, bearing, journal)
    return {name: law for name, law in tried.items() if not isinstance(law, InvalidParameterError)}


@takes()
def laws_left_out(
    *, bearing_radius: float, journal_radius: float, length: float, bearing: Material, journal: Material
) -> dict[str, InvalidParameterError]:
    """Return the reasons against elastic laws; arguments as of :func:`elastic_laws_of_joint`."""
    tried = _try_all(bearing_radius, journal_radius, length, bearing, journal)
    return {name: law for name, law in tried.items() if isinstance(law, InvalidParameterError)}


def _try_all(
    bearing_radius: float, journal_radius: float, length: float, bearing: Material, journal: Material
) -> dict[str, ElasticLaw | InvalidParameterError]:
    """Return every elastic law by name, or its refusal."""
    modulus = effective_modulus(bearing, journal)
    stiffness = internal_hertz_stiffness(bearing_radius, journal_radius, modulus)
    known = {"length": length, "modulus": modulus, "stiffness": stiffness}
    known |= {"journal_radius": journal_radius, "bearing_radius": bearing_radius}
    found: dict[str, ElasticLaw | InvalidParameterError] = {}
    for name, cls in NORMAL_LAWS.items():
        if not is_elastic(name):
            continue
        parameters = {key: known[key] for key, p in law_parameters(cls).items() if p.from_joint}
        try:
            law: CompiledNormalLaw = make_normal_law(name, parameters)
        except InvalidParameterError as refusal:
            found[name] = refusal
            continue
        assert isinstance(law, ElasticLaw)
        found[name] = law
    return found


@takes()
def differing_factor(forces: Iterable[float]) -> float | None:
    """Return the ratio of the largest to the smallest force; None for fewer than two.

    Forces are those of several laws at one depth [N], NaN where a law does not hold.
    """
    known = [force for force in forces if math.isfinite(force)]
    return max(known) / min(known) if len(known) > 1 else None


@takes()
def force_table(laws: Mapping[str, NormalLaw], depths: Iterable[float]) -> dict[str, tuple[float, ...]]:
    """Return the elastic force of each law at each depth [N]; NaN beyond its range."""
    points = tuple(depths)
    return {name: tuple(force_within(law, depth) for depth in points) for name, law in laws.items()}


@takes()
def force_within(law: NormalLaw, depth: float) -> float:
    """Return the elastic force of a law at a depth [N]; NaN out of range."""
    return law.elastic_force(depth) if depth <= getattr(law, "depth_limit", math.inf) else math.nan


# --- measured loads -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ExperimentPoint:
    """Row of the table."""

    clearance: float  # radial play [m]
    depth: float  # displacement [m]
    load: float  # measured load [N]
    hertz: float  # load by equation (6), as printed [N]
    conformal: float  # load by equation (14), as printed [N]


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
    """Law, or printed column, compared with the measured loads."""

    law: str  # its name
    contacts: int | None  # equal contacts in series that share the displacement, 1 or 2; None as printed
    loads: tuple[float, ...]  # by the law at each point [N]; NaN out of its range
    errors: tuple[float, ...]  # of the loads over the measured ones, at each point [-]

    @property
    def in_range(self) -> int:
        """Number of points within the law's range."""
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
        """Return the mean error size of one play [-], or NaN as ``mean``."""
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
    """Return fits of full range first, sorted by mean error."""

    def rank(fit: ExperimentFit) -> tuple[int, float]:
        known = [abs(error) for error in fit.errors if math.isfinite(error)]
        return len(fit.errors) - len(known), sum(known) / max(len(known), 1)

    return sorted(fits, key=rank)


# --- printed columns ----------------------------------------------------------------------------------------

_LENGTH = 1e-3  # of the contact, as the paper takes it [m]
_LOAD_ROUNDING = 0.5  # half the last digit of a printed load [N]
_DEPTH_ROUNDING = 5e-9  # and of a displacement [m]
_DEPTH_DIGITS = 8  # decimals of a displacement in metres

_Row = tuple[ExperimentPoint, float]  # a row, and the displacement that counts for it [m]


@dataclass(frozen=True, slots=True)
class ReproducedTable:
    """The two printed columns by their formulas, with the common parameters."""

    modulus: float  # E*, common to the Hertz column [Pa]
    radii: tuple[float, ...]  # R_i R_j / play of the conformal column, one for each of ``LIU_2013_PLAYS`` [m]
    depths: tuple[float, ...]  # displacement of each row [m], mended where it is misprinted
    hertz_fits: tuple[bool, ...]  # whether the load by (6) is each row's as printed, within the rounding
    conformal_fits: tuple[bool, ...]  # whether the load by (14) is, with the mended displacement

    @property
    def misprinted(self) -> tuple[int, ...]:
        """Rows whose displacement contradicts their load by (6), from 0."""
        return tuple(row for row, fits in enumerate(self.hertz_fits) if not fits)

    @property
    def bore_radii(self) -> tuple[float, ...]:
        """R_i of the radius of each play [m]: R_i (R_i - play) / play."""
        return tuple(
            0.5 * play + math.sqrt(radius * play + 0.25 * play**2)
            for play, radius in zip(LIU_2013_PLAYS, self.radii, strict=True)
        )

    def radius_of(self, clearance: float) -> float:
        """Return R_i R_j / play of the conformal column for a play [m]."""
        return self.radii[LIU_2013_PLAYS.index(clearance)]

    def hertz(self, row: int) -> float:
        """Return the load of a row by (6) [N]."""
        return 0.25 * math.pi * _LENGTH * self.modulus * self.depths[row]

    def conformal(self, row: int) -> float:
        """Return the load of a row by (14) [N]."""
        return self.conformal_load(LIU_2013[row].clearance, self.depths[row])

    def conformal_load(self, clearance: float, depth: float) -> float:
        """Return the load by (14) for a play and a displacement [m], in N."""
        return float(4.0 / 3.0 * self.modulus * math.sqrt(self.radius_of(clearance)) * depth**1.5)


def reproduce_table() -> ReproducedTable:
    """Return both printed columns by their formulas.

    A displacement that does not fit its load by (6) is mended: it becomes the one which that load requires,
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
    """Return the bounds of ``column / divisor`` by the rounding of one row."""
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
    """Return the middle of the interval of most overlaps."""
    best, found = 0, 0.0
    for low, _ in intervals:
        holding = [(a, b) for a, b in intervals if a <= low <= b]
        if len(holding) >= best:
            best, found = len(holding), 0.5 * (low + min(b for _, b in holding))
    return found


# --- findings -----------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class LeastError:
    """Least error of any law of a kind in one of two rows."""

    first: int  # row of the joint with the smaller play, from 0
    second: int  # row of the joint with the larger play, from 0
    error: float  # in the one row or the other, at least [-]


@dataclass(frozen=True, slots=True)
class ExperimentFindings:
    """Reproduced table, errors of the laws, and conclusions."""

    table: ReproducedTable  # the paper's own columns by their formulas
    fits: tuple[ExperimentFit, ...]  # of every elastic law, in one contact and in two, best first
    printed: tuple[ExperimentFit, ExperimentFit]  # of the paper's columns (6) and (14), as printed
    journal_radius: float  # of the pin, as taken for the laws [m]
    least_error: LeastError  # what a law that stiffens with depth and not with play must be off by

    @property
    def best(self) -> ExperimentFit:
        """Law of full range with the smallest mean error."""
        return min((fit for fit in self.fits if fit.in_range == len(LIU_2013)), key=lambda fit: fit.mean)

    @property
    def poisson(self) -> float:
        """Poisson's ratio implied by the Hertz column and the paper's 206 GPa [-]."""
        return math.sqrt(1.0 - LIU_2013_STEEL.young / (2.0 * self.table.modulus))

    @property
    def modulus_excess(self) -> float:
        """Excess of the steel's E* over that of the Hertz column [-]."""
        return effective_modulus(LIU_2013_STEEL, LIU_2013_STEEL) / self.table.modulus - 1.0

    @property
    def bore_radius(self) -> float:
        """Radius of the bore that the conformal column holds, mean over the plays [m]."""
        return sum(self.table.bore_radii) / len(self.table.bore_radii)

    @property
    def conformal_factor(self) -> float:
        """Factor of (14) with this pin over the printed column, at the least play [-]."""
        play = LIU_2013_PLAYS[0]
        radius = (self.journal_radius + play) * self.journal_radius / play
        return math.sqrt(radius / self.table.radius_of(play))

    def fit(self, law: str, contacts: int = 1) -> ExperimentFit:
        """Return the fit of one law."""
        (found,) = (fit for fit in self.fits if (fit.law, fit.contacts) == (law, contacts))
        return found


@takes()
def experiment_findings(*, journal_radius: float = 5e-3, length: float = 1e-3) -> ExperimentFindings:
    """Return the findings of the measured joint."""
    return ExperimentFindings(
        table=reproduce_table(),
        fits=tuple(ranked(compare_with_experiment(journal_radius=journal_radius, length=length))),
        printed=printed_columns(),
        journal_radius=journal_radius,
        least_error=_least_error(),
    )


def _least_error() -> LeastError:
    """Return the least largest error of a law that stiffens with depth only.

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
