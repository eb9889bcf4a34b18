"""Start states of a record's pieces before the fit, by an extended Kalman filter.

With start values of its parameters a run diverges from the record: where the motion is chaotic, and where it
comes to rest before or after the record. So parameters and state are estimated along the record together:
from the end of a piece, both are corrected by the next one's rows, each within its covariance (an extended
Kalman filter with the parameters in its state: Jazwinski 1970, Stochastic Processes and Filtering Theory,
chapter 8).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.arrays import Array
from antenna_pin.base.state import State
from antenna_pin.errors import ScenarioError
from antenna_pin.studies.fit.plan import Unknowns
from antenna_pin.studies.fit.runs import (
    PreparedScenario,
    RecordTest,
    RunSamples,
    failure_reason,
    piece_rows,
    prepared_scenario,
    sensor_readings,
    with_contacts,
)
from antenna_pin.studies.nonlinear import Chart
from antenna_pin.studies.nonlinear.coordinates import configuration_difference

# --- one piece of a record ----------------------------------------------------------------------------------

# Difference step in sizes and error scales; most search steps, and relative change of the sum at their end: a
# start value suffices.
_STEP, _ROUNDS, _ROUGHLY = 1e-4, 10, 0.01
# Sum of squares over rows from which a piece counts as lost.
_LOST = 4.0


class ColumnData(NamedTuple):
    """Column of a record."""

    gain: tuple[float, int]  # of the readings [-], and index of the unknown that replaces it, or -1
    offset: tuple[float, int]  # likewise [SI]
    data: Array  # (rows,)
    noise: Array  # standard deviation, (rows,)


class _PieceResiduals(NamedTuple):
    """Run of a piece: residuals over their noise, and its end."""

    off: Array
    end: State


class _PieceEstimate(NamedTuple):
    """Estimate of parameters and of a piece's start."""

    at: Array  # parameters and start in search coordinates, (p + n,)
    first: Any  # first state of the piece
    end: Any  # last state
    covariance: Array  # of parameters and start, (p + n, p + n)
    ahead: Array  # covariance of parameters and the piece's end, (p + ways, p + ways)
    cost: float  # sum of the squares of the rows
    lost: bool  # larger cost than by noise
    failed: str = ""  # reason for a missing run


class _PieceEstimator:
    """Estimator for one piece of a record, from the end of the piece before."""

    def __init__(
        self,
        test: RecordTest,
        unknowns: Unknowns,
        own: Sequence[int],
        curves: Sequence[ColumnData],
        shift: float,
        piece: int,
        at: Array,
        origin: State | None,
    ) -> None:
        self._test, self._unknowns, self._own = test, unknowns, list(own)
        self._rows, self._until = piece_rows(test, shift, piece), test.pieces[piece + 1]
        first = int(np.searchsorted(test.time + shift, self._rows[0])) if len(self._rows) else 0
        here = slice(first, first + len(self._rows))
        self._curves = [one._replace(data=one.data[here], noise=one.noise[here]) for one in curves]
        self._calibrated = [k for one in curves for _, k in (one.gain, one.offset) if k >= 0]
        self._at, self._origin = at, origin
        self._chart = None if origin is None else Chart(self._bench(at).system, origin)
        self.size = 0 if self._chart is None else 2 * self._chart.positions

    def estimate(self, covariance: Array) -> _PieceEstimate:
        """Return the estimate from the rows and the covariance so far."""
        from scipy.optimize import least_squares

        p, n = self._unknowns.count, self.size
        before = np.concatenate([self._at, np.zeros(n)])
        values, axes = np.linalg.eigh(covariance)
        held = (axes / np.sqrt(np.maximum(values, 1e-12 * values[-1]))).T
        made = self._run_all([before])[0]
        if isinstance(made, str):
            return _PieceEstimate(before, None, None, covariance, covariance, np.inf, True, made)
        latest: dict[str, Any] = {}

        def residuals(x: Array) -> Array:
            one = self._run_all([x])[0]
            off = np.full(len(made.off), np.nan) if isinstance(one, str) else one.off
            return np.concatenate([off, held @ (x - before)])

        def slopes(x: Array) -> Array:
            latest["x"], latest["off"], latest["ends"] = x, *self._slopes(x)
            return np.concatenate([latest["off"], held])

        free = np.full(n, np.inf)
        lower, upper = (one[:p] for one in self._unknowns.bounds())
        x = least_squares(
            residuals,
            before,
            jac=slopes,
            bounds=(np.concatenate([lower, -free]), np.concatenate([upper, free])),
            ftol=_ROUGHLY,
            max_nfev=_ROUNDS,
        ).x
        if not np.array_equal(latest["x"], x):
            slopes(x)
        (one,) = self._run_all([x])
        assert not isinstance(one, str)
        cost, count = float(one.off @ one.off), max(len(one.off), 1)
        factor = max(1.0, cost / count)
        after = np.linalg.inv(latest["off"].T @ latest["off"] / factor + held.T @ held)
        ahead = np.zeros((p + len(latest["ends"]), p + n))
        ahead[:p, :p] = np.eye(p)
        ahead[p:] = latest["ends"]
        return _PieceEstimate(
            x, self._start_state(x), one.end, after, ahead @ after @ ahead.T, cost, cost > _LOST * count
        )

    def _bench(self, at: Array) -> PreparedScenario:
        values = self._unknowns.from_search(np.concatenate([at, np.zeros(self._unknowns.states)]))
        return prepared_scenario(self._test, tuple(values[self._own].tolist()))

    def _start_state(self, x: Array) -> State | None:
        """Return the piece's first state; None of the scenario's own."""
        if self._chart is None:
            return None
        whole = np.zeros(self._chart.size)
        whole[: self.size] = x[self._unknowns.count :]
        return self._chart.state(whole, self._bench(x[: self._unknowns.count]).system)

    def _run_all(self, every: Sequence[Array]) -> list[_PieceResiduals | str]:
        """Return a run or a reason for each of several starts, with the same parameters.

        All runs are read at once, as reading takes longer than a short run.
        """
        numbers = every[0][: self._unknowns.count]
        try:
            bench = self._bench(numbers)
        except Exception as error:
            return [failure_reason(error)] * len(every)
        ran = [self._ran(bench, x) for x in every]
        good = [one.chunk for one in ran if isinstance(one, RunSamples)]
        read = iter(
            sensor_readings(self._test, bench, [self._rows] * len(good), good) if len(self._rows) else ()
        )
        values = self._unknowns.from_search(np.concatenate([numbers, np.zeros(self._unknowns.states)]))
        found: list[_PieceResiduals | str] = []
        for one in ran:
            if isinstance(one, str):
                found.append(one)
                continue
            off = [np.zeros(0)]
            for reading, (gain, offset, data, noise) in zip(next(read, ()), self._curves, strict=False):
                by, and_by = (values[k] if k >= 0 else value for value, k in (gain, offset))
                off.append((by * reading + and_by - data) / noise)
            found.append(_PieceResiduals(np.concatenate(off), one.end))
        return found

    def _ran(self, bench: PreparedScenario, x: Array) -> RunSamples | str:
        try:
            first = self._start_state(x)
            ran = bench.run(self._rows, self._until, first and with_contacts(first, bench.system))
        except Exception as error:
            return failure_reason(error)
        return ran.failed or ran

    def _slopes(self, x: Array) -> tuple[Array, Array]:
        """Return the derivatives of rows and of the piece's end, in its own coordinates."""
        (here,) = self._run_all([x])
        assert not isinstance(here, str)
        p = self._unknowns.count
        lower, upper = (one[:p] for one in self._unknowns.bounds())
        chart = Chart(self._bench(x[:p]).system, here.end)
        rows, ends = np.zeros((len(here.off), len(x))), np.zeros((2 * chart.positions, len(x)))
        numbers, places = list(dict.fromkeys([*self._own, *self._calibrated])), list(range(p, len(x)))
        there = {(k, sign): x.copy() for k in (*numbers, *places) for sign in (-1.0, 1.0)}
        for (k, sign), one in there.items():
            one[k] += sign * _STEP
            if k < p:
                one[k] = min(max(one[k], lower[k]), upper[k])
        made: dict[tuple[int, float], _PieceResiduals | str] = {}
        together = [[one] for one in there if one[0] < p] + [[one for one in there if one[0] >= p]]
        for keys in filter(None, together):
            made.update(zip(keys, self._run_all([there[one] for one in keys]), strict=True))
        for k in (*numbers, *places):
            sides = []
            for sign in (-1.0, 1.0):
                ran = made[k, sign]
                sides.append((x[k], here) if isinstance(ran, str) else (there[k, sign][k], ran))
            (left, below), (right, above) = sides
            if right > left:
                rows[:, k] = (above.off - below.off) / (right - left)
                ends[:, k] = (_chart_coordinates(chart, above.end) - _chart_coordinates(chart, below.end)) / (
                    right - left
                )
        return rows, ends


def _chart_coordinates(chart: Chart, there: State) -> Array:
    """Return coordinates of a state along a chart's freedoms, positions and rates."""
    origin, units, free = chart.origin, chart.units, chart.frame.free
    way = configuration_difference(chart.system, origin.q, there.q) / units.position
    rate = (there.v - origin.v) / units.rate
    return np.concatenate([np.linalg.lstsq(free, one, rcond=None)[0] for one in (way, rate)])


# --- a record in pieces -------------------------------------------------------------------------------------

# Standard deviations: of a parameter before any row, in its size; of an unknown state, in error scales; and
# the nonlinear error of a predicted state.
_NUMBER, _STATE, _BENT = 1.0, 1.0, 1e-2
# Most passes over a record, and standard deviation of a parameter before the next one.
_PASSES, _AGAIN = 2, 0.1


class ParameterEstimate(NamedTuple):
    """Estimate of a fit's parameters, in search coordinates."""

    at: Array  # (p,)
    covariance: Array  # (p, p)

    @classmethod
    def before(cls, unknowns: Unknowns) -> ParameterEstimate:
        """Return the estimate before any row."""
        return cls(unknowns.to_search(unknowns.start), _NUMBER**2 * np.eye(unknowns.count))


class RecordEstimate(NamedTuple):
    """Estimate from a whole record."""

    origins: tuple[str, ...]  # start states of the pieces but the first, as text
    known: ParameterEstimate  # at the end of the record
    lost: int  # number of lost pieces


def estimate_starts(
    test: RecordTest,
    unknowns: Unknowns,
    own: Sequence[int],
    known: ParameterEstimate,
    curves: Sequence[ColumnData],
    shift: float,
    place: str,
) -> RecordEstimate:
    """Estimate the start states of a record's pieces.

    Raises:
        ScenarioError: A piece's run does not complete.
    """
    best: RecordEstimate | None = None
    for _ in range(_PASSES):
        made = _filter_once(test, unknowns, own, known, curves, shift)
        if isinstance(made, str):
            if best is None:
                raise ScenarioError(f"{place}: {made}")
            break
        if best is None or made.lost < best.lost:
            best = made
        if best.lost == 0 or best is not made:
            break
        known = ParameterEstimate(made.known.at, _AGAIN**2 * np.eye(unknowns.count))
    assert best is not None
    return best


def _filter_once(
    test: RecordTest,
    unknowns: Unknowns,
    own: Sequence[int],
    known: ParameterEstimate,
    curves: Sequence[ColumnData],
    shift: float,
) -> RecordEstimate | str:
    """Run the filter over a record once, or return the reason for no run."""
    origins: list[str] = []
    state: State | None = None
    spread, lost, p = np.zeros((0, 0)), 0, unknowns.count
    for piece in range(len(test.pieces) - 1):
        one = _PieceEstimator(test, unknowns, own, curves, shift, piece, known.at, state)
        n = one.size
        whole = np.zeros((p + n, p + n))
        whole[:p, :p] = known.covariance
        if state is not None:
            whole[: len(spread), : len(spread)] = spread
            whole[p:, p:] += _BENT**2 * np.eye(n)
        found = one.estimate(whole)
        if found.lost and n:
            again = one.estimate(_with_unknown_state(known, n))
            found = again if again.cost < found.cost else found
        if found.failed:
            return found.failed
        if state is not None:
            origins.append(found.first.to_json())
        lost, state = lost + found.lost, found.end
        if found.lost:  # it says from where to go on, and nothing for sure
            known = known._replace(at=found.at[:p])
            spread = _with_unknown_state(known, len(found.ahead) - p)
        else:
            known, spread = ParameterEstimate(found.at[:p], found.covariance[:p, :p]), found.ahead
    return RecordEstimate(tuple(origins), known, lost)


def _with_unknown_state(known: ParameterEstimate, n: int) -> Array:
    """Return the covariance of parameters with that of n unknown state coordinates."""
    p = len(known.at)
    whole = _STATE**2 * np.eye(p + n)
    whole[:p, :p] = known.covariance
    return whole
