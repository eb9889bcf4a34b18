"""Diagnostics of a fit: verdict with likely causes, tests of residuals, growth of differences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from antenna_pin.base.arrays import Array
from antenna_pin.base.readable import number, prefixed, readable
from antenna_pin.studies.fit.confidence_bands import ParameterBands
from antenna_pin.studies.fit.problem import Problem
from antenna_pin.studies.fit.runs import NoRunError
from antenna_pin.studies.fit.uncertainty import autocorrelation, is_correlated

# --- verdict ------------------------------------------------------------------------------------------------

# Relative distance from a bound of a value at it.
_AT_BOUND = 1e-6
# Ratio of record to model at the start that suggests a wrong unit; correlation that suggests a wrong sign;
# share of chi2 removed by a clock shift that is named; shifts tried, over the record.
_UNIT, _SIGN, _CLOCK, _SHIFTS = 5.0, -0.8, 0.8, np.linspace(-0.2, 0.2, 161)


class _Curve(NamedTuple):
    """Column compared row by row: name, times, model and record."""

    name: str
    at: Array
    model: Array
    data: Array


def verdict(problem: Problem, whole: Array, bands: ParameterBands) -> tuple[str, ...]:
    """Return objections to a fit as a whole and their likely causes, line by line."""
    lines = list(_at_bounds(problem, whole))
    if bands.beyond_chance:
        widened = (
            f"bands are widened by {number(math.sqrt(bands.excess), 3)}, as if each sd was larger by that"
        )
        note = f"the values have no bands: {bands.absence}" if bands.absence else widened
        spread = math.sqrt(2.0 * bands.freedoms)
        lines.append(
            f"the model does not fit the records: chi2 is {number(bands.chi2, 4)}, where noise of the stated "
            f"sd leaves {bands.freedoms} ± {number(spread, 2)}; {note}"
        )
        lines += [f"  may be {cause}" for cause in _causes(problem, whole, bands)]
    return tuple(lines)


def recommends_starts(problem: Problem, bands: ParameterBands) -> bool:
    """Return whether a search from many starts comes before other advice."""
    bounded = all(one.between is not None for one in problem.plan.parameters.values())
    return bands.beyond_chance and problem.plan.starts is None and bounded


def _at_bounds(problem: Problem, whole: Array) -> Iterator[str]:
    """Yield a line if every parameter is at a bound."""
    unknowns = problem.unknowns
    p = unknowns.count
    at, (lower, upper) = unknowns.to_search(whole)[:p], (one[:p] for one in unknowns.bounds())
    width = np.where(np.isfinite(upper - lower), upper - lower, 1.0)
    if np.all(np.minimum(at - lower, upper - at) <= _AT_BOUND * width):
        said = []
        for k, name in enumerate(unknowns.names):
            said.append(f"{name} at {readable(whole[k], unknowns.units[k] or '1', 5)}")
        every = "every parameter stands" if p > 1 else "the parameter stands"
        yield f"{every} at its bound, {', '.join(said)}: the records fit best beyond it"


def _causes(problem: Problem, whole: Array, bands: ParameterBands) -> Iterator[str]:
    """Yield likely causes of a bad fit, the likeliest first."""
    begun, ended = (_curves(problem, at) for at in (np.concatenate([problem.first, problem.states]), whole))
    yield from _unit_errors(begun)
    clocks = [*_clock_errors(begun), *_clock_errors(ended)]
    yield from clocks[:1]
    if recommends_starts(problem, bands):
        yield "a wrong valley of the sum of squares: search from many points, [starts] with count = 64"
    elif problem.plan.starts is None:
        yield "a wrong valley of the sum of squares: give each parameter bounds (between), and [starts]"
    yield "a model that lacks something, or an sd that is too small"


def _curves(problem: Problem, whole: Array) -> list[_Curve]:
    """Return the columns compared as curves; none without a run."""
    try:
        found = problem.predictions(whole)
    except NoRunError:
        return []
    names = np.array(
        [f"{r}.{c}" for r, c in zip(found["record"].values, found["column"].values, strict=True)]
    )
    curves = []
    for name in dict.fromkeys(names.tolist()):
        rows = names == name
        if (found["measure"].values[rows] == "reading").all():
            parts = (found[key].values[rows].astype(float) for key in ("at", "model", "data"))
            curves.append(_Curve(name, *parts))
    return curves


def _unit_errors(curves: Sequence[_Curve]) -> Iterator[str]:
    """Yield columns whose size or sign differs from the model's at the start."""
    for name, _, model, data in curves:
        if not (np.ptp(model) > 0.0 and np.ptp(data) > 0.0):
            continue
        ratio = math.sqrt(float(np.mean(data**2) / np.mean(model**2)))
        if not 1.0 / _UNIT < ratio < _UNIT:
            times = f"{number(ratio, 2)} times as large as"
            yield f"the unit of {name}: the record is {times} the model at the start"
        elif np.corrcoef(model, data)[0, 1] < _SIGN:
            yield f"the sign of {name}: the record goes against the model at the start; give gain = -1"


def _clock_errors(curves: Sequence[_Curve]) -> Iterator[str]:
    """Yield records that a shift of the clock would bring nearer to the model."""
    for name, at, model, data in curves:
        shifts, costs = _SHIFTS * float(at[-1] - at[0]), []
        for shift in shifts:
            inside = (at + shift >= at[0]) & (at + shift <= at[-1])
            off = np.interp(at[inside] + shift, at, model) - data[inside]
            costs.append(float(np.mean(off**2)))
        best = int(np.argmin(costs))
        if costs[best] < (1.0 - _CLOCK) * costs[len(costs) // 2] and 0 < best < len(costs) - 1:
            record, shift = name.partition(".")[0], readable(float(shifts[best]), "s", 2)
            yield f"the clock of {record}: {shift} more of clock_shift would take most of chi2"


# --- tests of residuals: whiteness by correlation, randomness by runs of sign, normality by moments ---------
#
# References:
#     Wald and Wolfowitz (1940), Ann. Math. Stat. 11, 147-162: runs.
#     D'Agostino and Pearson (1973), Biometrika 60, 613-622: normality.

# Fewest residuals of a test; chance below which it fails; and excess kurtosis from which tails matter to a
# least squares fit.
_FEWEST, _RARE, _TAILS = 20, 1e-4, 1.0


class _ResidualTests(NamedTuple):
    """Tests of the residuals of one column, with the probabilities of worse ones by noise."""

    correlation: float  # of each residual with the next [-]
    runs: int  # number of runs of one sign about the mean
    runs_chance: float  # probability of as unusual a number by independent residuals [-]
    excess_kurtosis: float  # fourth moment over the squared variance, less 3 [-]
    normal_chance: float  # probability of as unusual a skewness and kurtosis by normal residuals [-]


def residual_tests(residuals: Array) -> _ResidualTests | None:
    """Return tests of residuals in order of time, (n,), or None."""
    from scipy import stats

    if len(residuals) < _FEWEST or not np.ptp(residuals) > 0.0:
        return None
    above = residuals > residuals.mean()
    runs, (a, b) = 1 + int(np.count_nonzero(np.diff(above))), (int(above.sum()), int((~above).sum()))
    expected = 1.0 + 2.0 * a * b / (a + b)
    variance = (expected - 1.0) * (expected - 2.0) / (a + b - 1.0)
    apart = abs(runs - expected) / math.sqrt(variance)
    return _ResidualTests(
        autocorrelation(residuals),
        runs,
        float(2.0 * stats.norm.sf(apart)),
        float(stats.kurtosis(residuals)),
        float(stats.normaltest(residuals).pvalue),
    )


def residual_notes(curves: Mapping[str, Array]) -> Iterator[str]:
    """Yield a line for each column whose uncorrelated residuals are not normal noise."""
    for name, residuals in curves.items():
        found = None if is_correlated(residuals) else residual_tests(residuals)
        if found is not None and found.runs_chance < _RARE:
            yield (
                f"note: residuals of {name} have {found.runs} stretches of one sign, as by chance "
                f"{number(found.runs_chance, 1)} of records would: the model lacks something"
            )
        if found is not None and found.normal_chance < _RARE and found.excess_kurtosis > _TAILS:
            yield (
                f"note: residuals of {name} have tails that normal noise has not, an excess kurtosis of "
                f'{number(found.excess_kurtosis, 2)}: outliers count less by loss = "soft_l1"'
            )


# --- growth of differences between perturbed runs along a record --------------------------------------------
#
# A search follows derivatives. Along a chaotic motion differences grow with its exponent: behind some time
# perturbed runs share nothing but their statistics, and derivatives, however exact, do not lead to a smaller
# sum of squares. Over pieces that are short enough they do.

# Parts of a record; second over first difference from which it is not linear; growths by e over a piece.
_PARTS, _BENT, _FOLDS = 24, 0.5, 1.0
_AT_LEAST = 3.0  # growths by e that have passed, where the rate is unknown
_ROUND_OFF = 1e-9  # of readings [-]


class DifferenceGrowth(NamedTuple):
    """Growth of differences along a record too long for one run."""

    since: float  # time from which the growth is nonlinear [s]
    fold: float  # time in which a difference grows by e [s]

    @property
    def length(self) -> float:
        """Length of pieces over which differences grow little [s]."""
        return _FOLDS * self.fold

    def words(self, record: str, parameter: str, step: float) -> str:
        """Return a line on the record's sensitivity to a relative step of a parameter."""
        since, fold, length = (_time(one) for one in (self.since, self.fold, self.length))
        return (
            f"note: records.{record}: one run does not hold it: from {since} on the effect of {step:g} of "
            f"{parameter} is not straight any more, and it grows by e in {fold}; give it "
            f'pieces = {{ length = "{length}" }}'
        )


def _time(value: float) -> str:
    factor, unit = prefixed("s", [value])
    return f"{factor * value:.2g} {unit.replace('µ', 'u')}"


def difference_growth(
    time: Array, below: Array, here: Array, above: Array, reach: float = 1.0
) -> DifferenceGrowth | None:
    """Return the growth of differences between perturbed runs, or None if small.

    Readings, over the noise, are (columns, rows). The result is extrapolated to a perturbation ``reach``
    times as large.
    """
    if len(time) < 2 * _PARTS:
        return None
    bends, sizes = np.zeros(_PARTS), np.zeros(_PARTS)
    for k, rows in enumerate(np.array_split(np.arange(len(time)), _PARTS)):
        bends[k] = np.linalg.norm(above[:, rows] + below[:, rows] - 2.0 * here[:, rows])
        sizes[k] = np.linalg.norm(above[:, rows] - below[:, rows])
    floor = _ROUND_OFF * np.linalg.norm(here)  # differences of next to nothing are bent by round-off
    bent = (reach * bends > _BENT * sizes) & (sizes > floor)
    # Start of lasting growth: a single part of zero crossings does not count.
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
    return DifferenceGrowth(float(middles[first]), fold) if fold > 0.0 else None
