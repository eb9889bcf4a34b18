"""Least-squares problem of a fit: residuals of all records as functions of the unknowns."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.fit.plan import FitPlan, Unknowns
from antenna_pin.studies.fit.preparation import PreparedRecords, prepare_records
from antenna_pin.studies.fit.residuals import ResidualRows
from antenna_pin.studies.fit.run_service import RunService
from antenna_pin.studies.fit.runs import NoRunError, Readings, RunRequest, scenario_with

# --- derivatives of residuals by unknowns -------------------------------------------------------------------

#: Largest deviation of the equation from differences, over the size of derivatives by one unknown.
_APART = 1e-2


class DerivativeLog(NamedTuple):
    """Methods by which the derivatives of a fit were found."""

    equation: int = 0  # evaluations by the variational equation
    differences: int = 0  # evaluations by differences of runs
    why: str = ""  # first reason against a requested equation, or ""
    # deviation of both methods over the size of derivatives by one unknown, or NaN
    apart: float = float("nan")

    def once_more(self, equation: bool, why: str = "") -> DerivativeLog:
        """Return the log with one more evaluation."""
        if equation:
            return self._replace(equation=self.equation + 1)
        return self._replace(differences=self.differences + 1, why=self.why or why)

    def compared(self, equation: Array, runs: Array) -> DerivativeLog:
        """Return the log with a comparison of the equation with runs."""
        sizes = np.linalg.norm(runs, axis=0)
        off = np.linalg.norm(equation - runs, axis=0) / np.where(sizes > 0.0, sizes, 1.0)
        apart = float(off.max(initial=0.0))
        why = f"they contradict runs, by {apart:.2g} of their size" if apart > _APART else self.why
        return self._replace(apart=apart, why=why)

    def words(self) -> str:
        """Return the log as text."""
        if not self.equation:
            return "differences of runs" + (f", not the equation: {self.why}" if self.why else "")
        said = f"the variational equation, within {self.apart:.1g} of differences of runs where it began"
        if not self.differences:
            return said
        every = self.equation + self.differences
        return f"{said}; {self.differences} of {every} times by these: {self.why}"


def central_differences(
    evaluate: Callable[[Sequence[Array]], list[Array]], here: Array, lower: Array, upper: Array, step: float
) -> Array:
    """Return the derivatives, (m, n), of residuals at unknowns (n,), each over its size.

    The error of central differences is of the square of the step. At a bound, and next to unknowns without a
    run, they are one-sided, with an error of the step itself; where both sides are missing, the step is a
    tenth or ten times as large.

    Raises:
        NoRunError: No run exists here, or on either side.
    """
    n = len(here)
    steps = step * np.eye(n)
    ends = [np.clip(here + sign * one, lower, upper) for one in steps for sign in (-1.0, 1.0)]
    try:
        found: list[Array | None] = list(evaluate(ends))
    except NoRunError:
        found = [_or_none(evaluate, end) for end in ends]
    columns = []
    for i in range(n):
        sides = []
        for end, residuals in zip(ends[2 * i : 2 * i + 2], found[2 * i : 2 * i + 2], strict=True):
            if residuals is None:
                end, residuals = here, evaluate([here])[0]
            sides.append((float(end[i]), residuals))
        (left, below), (right, above) = sides
        if not right > left:
            columns.append(_one_sided(evaluate, here, i, lower, upper, step))
            continue
        columns.append((above - below) / (right - left))
    return np.column_stack(columns)


def _one_sided(
    evaluate: Callable[[Sequence[Array]], list[Array]],
    here: Array,
    i: int,
    lower: Array,
    upper: Array,
    step: float,
) -> Array:
    """Return the derivatives by one unknown, one-sided where a run is missing."""
    for farther in (0.1, -0.1, 10.0, -10.0):
        end = here.copy()
        end[i] = np.clip(here[i] + farther * step, lower[i], upper[i])
        found = _or_none(evaluate, end) if end[i] != here[i] else None
        if found is not None:
            return np.asarray((found - evaluate([here])[0]) / (end[i] - here[i]))
    raise NoRunError(f"unknown {i + 1} has no run on either side of {here[i]:g}, a step of {step:g} away")


def _or_none(evaluate: Callable[[Sequence[Array]], list[Array]], there: Array) -> Array | None:
    try:
        return evaluate([there])[0]
    except NoRunError:
        return None


#: Most runs of pieces made together: their sensors are read at once, and round-off must not depend on the
#: number of workers.
_TOGETHER = 16


class _Run(NamedTuple):
    """Run of the fit: record, piece, and index of its start among the unknowns."""

    record: int
    piece: int
    first: int
    size: int


def _flat(answers: Iterable[Sequence[Readings]]) -> list[Readings]:
    return list(itertools.chain.from_iterable(answers))


class Problem:
    """Least-squares problem of a fit, checked; runs are made on demand.

    With records in pieces the pieces' starts are unknown too: coordinates beside the parameters, stored in
    ``states``, which :meth:`residuals` uses if it is given parameters only.

    Args:
        plan: Plan of the fit file.
        service: Service that makes and stores runs; this process by default.

    Attributes:
        plan: The argument.
        unknowns: Parameters and the pieces' starts, with bounds and sizes.
        states: Coordinates of the pieces' starts, (h,), in the run's error scales.
        rows: Residuals of the records.
        derived: Log of derivatives.

    Raises:
        AntennaPinError: Plan, records or scenarios are not valid; raised before any run of any length.
    """

    @takes()
    def __init__(self, plan: FitPlan, service: RunService | None = None) -> None:
        self.plan = plan
        self._prepared: PreparedRecords = prepare_records(plan)
        self.service = service or RunService()
        self.unknowns = Unknowns.of(plan, sum(map(sum, self._prepared.ways)))
        self.states = np.zeros(self.unknowns.states)
        self._own_parameters = [plan.own_parameters(name) for name in plan.records]
        self.rows = ResidualRows(plan, self._prepared)
        self.derived = DerivativeLog()
        self._runs: list[_Run] = []
        first = self.unknowns.count
        for r, ways in enumerate(self._prepared.ways):
            test = self._prepared.record_tests[r]
            for k, size in enumerate((0, *ways)):
                self._runs.append(_Run(r, k if test.pieces else -1, first, size))
                first += size
        self._check_times()
        self.service.take(plan, self._prepared.record_tests)  # which begins a store: not for what is refused

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, (p,)."""
        return self.unknowns.names

    @property
    def start(self) -> Array:
        """Values that the fit file begins with, (p,) [SI]."""
        return self.unknowns.start

    @property
    def first(self) -> Array:
        """Start of the search, (p,) [SI]: given, or estimated along pieces."""
        return self._prepared.first

    @property
    def lower(self) -> Array:
        """Lower bounds, (p,) [SI]; minus infinity if there is none."""
        return self.unknowns.lower

    @property
    def upper(self) -> Array:
        """Upper bounds, (p,) [SI]; infinity if there is none."""
        return self.unknowns.upper

    @property
    def scale(self) -> Array:
        """Size of each parameter, (p,) [SI]."""
        return self.unknowns.scale

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on suspicious records, a line each."""
        return tuple(f"note: {one}" for one in self._prepared.notes)

    @property
    def runs(self) -> int:
        """Number of runs made, of all records and pieces."""
        return self.service.made

    def failed(self) -> list[str]:
        """Return a note on failed runs, if any."""
        found = self.service.failed
        first = f"the first: {found[0]}" if found else ""
        return [f"note: {len(found)} of {self.runs} runs failed, {first}"] if found else []

    def unbalanced(self, whole: Array) -> list[str]:
        """Return a note on runs whose energy or momentum does not balance, if any."""
        return self.service.said_of_unbalanced(self._readings([whole])[0])

    @property
    def count(self) -> int:
        """Number of residuals."""
        rows = sum(len(target.data) for target in self._prepared.targets.values())
        return rows + sum(self._prepared.joints) + len(self.unknowns.prior_residuals(self.start))

    @takes()
    def residuals(self, values: ArrayLike) -> Array:
        """Return weighted residuals of all records, and gaps between pieces, (m,) [-].

        Args:
            values: Values of the parameters, (p,) [SI], or of parameters and states, (p + h,).

        Raises:
            NoRunError: A record has no run for these values.
        """
        return self.residuals_at([self._whole(values)])[0]

    @takes()
    def jacobian(self, values: ArrayLike) -> Array:
        """Return the derivatives of the residuals, (m, p), or (m, p + h) with states.

        Raises:
            NoRunError: A record has no run for values near these.
        """
        given = np.asarray(values, dtype=float)
        whole = self._whole(given)
        slopes = self.slopes(self.unknowns.to_search(whole))
        return np.asarray(slopes * self.unknowns.search_slopes(whole))[:, : len(given)]

    @takes()
    def predictions(self, values: ArrayLike) -> xr.Dataset:
        """Return each record's columns beside the model's, all along ``row``.

        Returns:
            ``model``, ``data``, ``sd`` and ``residual`` (row), with the coordinates ``record``, ``column``,
            ``measure`` (what is compared: ``reading``, ``rms``, ...) and ``at``, a time by the run's clock, a
            frequency or a bin's middle.
        """
        whole = self._whole(values)
        return self.rows.table(whole, self._readings([whole])[0])

    # --- residuals and derivatives for searches -------------------------------------------------------------

    def residuals_at(self, wholes: Sequence[Array]) -> list[Array]:
        """Return the residuals at several values with states, (p + h,) each, in parallel."""
        found = self._without_priors(wholes)
        return [self._with_priors(whole, one) for whole, one in zip(wholes, found, strict=True)]

    def tried(self, wholes: Sequence[Array]) -> list[Array | None]:
        """Return the residuals at several values, None where there is no run."""
        answers: list[Array | None] = []
        for whole, found in zip(wholes, self._readings(wholes), strict=True):
            try:
                answers.append(self._with_priors(whole, self.rows.residuals(whole, found)))
            except NoRunError:
                answers.append(None)
        return answers

    def curves(self, whole: Array) -> dict[str, tuple[Array, Array]]:
        """Return times and curves over their noise, of records of one run."""
        return self.rows.curves(whole, self._readings([whole])[0])

    def scenario(self, record: str, values: Array) -> Scenario:
        """Return the scenario of a record with values of the parameters, (p,) [SI]."""
        r = list(self.plan.records).index(record)
        return scenario_with(
            self._prepared.record_tests[r], tuple(float(values[i]) for i in self._own_parameters[r])
        )

    def slopes(self, coordinates: Array) -> Array:
        """Return the derivatives of the residuals by search coordinates, (m, p + h)."""
        found, why = None, ""
        if self.plan.jacobian == "equation":
            found, why = self._by_equation(self.unknowns.from_search(coordinates))
        runs = None if found is not None and self.derived.apart <= _APART else self._by_runs(coordinates)
        if found is not None and runs is not None:  # for the first time
            self.derived = self.derived.compared(found, runs)
            found = found if self.derived.apart <= _APART else None
        self.derived = self.derived.once_more(found is not None, why)
        answer = runs if found is None else found
        assert answer is not None
        return np.vstack([answer, self.unknowns.prior_slopes(self.unknowns.from_search(coordinates))])

    def _by_equation(self, whole: Array) -> tuple[Array | None, str]:
        """Return the derivatives by the variational equation, or None and the reason."""
        if self.derived.apart > _APART:
            return None, self.derived.why
        request = [
            one._replace(slopes=True, clock=self.rows.has_clock(one.record)) for one in self._requests(whole)
        ]
        found = _flat(self.service.readings(request))
        failed = next((one.failed for one in found if one.failed), "")
        if failed:
            return None, failed
        fitted = [
            np.array([*self._own_parameters[one.record], *range(one.first, one.first + one.size)], dtype=int)
            for one in self._runs
        ]
        return self.rows.slopes(whole, found, fitted) / self.unknowns.search_slopes(whole), ""

    def _by_runs(self, coordinates: Array) -> Array:
        """Return the derivatives by differences of runs."""
        p, step = self.unknowns.count, self.plan.difference_step
        lower, upper = (one[:p] for one in self.unknowns.bounds())

        def of_parameters(ends: Sequence[Array]) -> list[Array]:
            whole = [np.concatenate([one, coordinates[p:]]) for one in ends]
            return self._without_priors([self.unknowns.from_search(one) for one in whole])

        found = central_differences(of_parameters, coordinates[:p], lower, upper, step)
        return np.hstack([found, self._by_starts(coordinates, step)]) if len(coordinates) > p else found

    def _by_starts(self, coordinates: Array, step: float) -> Array:
        """Return the derivatives by the pieces' starts, (m, h), one-sided where necessary.

        A start acts on its own piece only: one run of all pieces perturbs one coordinate of each.
        """
        whole, p = self.unknowns.from_search(coordinates), self.unknowns.count
        (here,) = self._readings([whole])
        middle = self.rows.residuals(whole, here)
        slopes = np.zeros((len(middle), len(coordinates) - p))
        ends = []
        for i in range(max(one.size for one in self._runs)):
            own = [n for n, one in enumerate(self._runs) if i < one.size]
            for sign in (-1.0, 1.0):
                end = coordinates.copy()
                end[[self._runs[n].first + i for n in own]] += sign * step
                ends.append((i, own, end, self._requests(self.unknowns.from_search(end), own)))
        self.service.readings([one for *_, request in ends for one in request])
        for below, above in zip(ends[::2], ends[1::2], strict=True):
            i, own = below[:2]
            made = [_flat(self.service.readings(side[3])) for side in (below, above)]
            for k, n in enumerate(own):
                at, sides = self._runs[n].first + i, []
                for side, found in zip((below, above), made, strict=True):
                    if found[k].failed:
                        sides.append((float(coordinates[at]), middle))
                        continue
                    there = [*here[:n], found[k], *here[n + 1 :]]
                    sides.append((float(side[2][at]), self.rows.residuals(whole, there)))
                (left, lower), (right, upper) = sides
                if not right > left:
                    raise NoRunError(f"state {at - p + 1} of pieces has no run a step of {step:g} away")
                slopes[:, at - p] = (upper - lower) / (right - left)
        return slopes

    # --- one evaluation -------------------------------------------------------------------------------------

    def _without_priors(self, wholes: Sequence[Array]) -> list[Array]:
        found = self._readings(wholes)
        return [self.rows.residuals(whole, one) for whole, one in zip(wholes, found, strict=True)]

    def _with_priors(self, whole: Array, residuals: Array) -> Array:
        return np.concatenate([residuals, self.unknowns.prior_residuals(whole)])

    def _whole(self, values: ArrayLike) -> Array:
        given = np.asarray(values, dtype=float)
        p, h = len(self.names), len(self.states)
        if given.shape == (p,):
            return np.concatenate([given, self.states])
        if given.shape != (p + h,):
            rule = f"of shape ({p},)" + (f", or ({p + h},) with the states of pieces" if h else "")
            raise InvalidParameterError("Problem", "values", rule, said=str(given.shape))
        return given

    def _requests(self, whole: Array, only: Sequence[int] | None = None) -> list[RunRequest]:
        """Return the runs, all or some, in batches of one record."""
        numbers = range(len(self._runs)) if only is None else only
        request = []
        for r, own in itertools.groupby(numbers, lambda n: self._runs[n].record):
            values = tuple(float(whole[i]) for i in self._own_parameters[r])
            shift, starts = self.rows.shift(whole, r), []
            for n in own:
                one = self._runs[n]
                starts.append((one.piece, tuple(whole[one.first : one.first + one.size].tolist())))
            for k in range(0, len(starts), _TOGETHER):
                request.append(RunRequest(r, values, shift, tuple(starts[k : k + _TOGETHER])))
        return request

    def _readings(self, wholes: Sequence[Array]) -> list[list[Readings]]:
        """Return the readings of all runs, at each of several values with states."""
        request = [self._requests(whole) for whole in wholes]
        answers = iter(self.service.readings([one for several in request for one in several]))
        return [_flat(itertools.islice(answers, len(several))) for several in request]

    def _check_times(self) -> None:
        """Refuse a record beyond its run, at any shift of its clock."""
        for r, (name, test) in enumerate(zip(self.plan.records, self._prepared.record_tests, strict=True)):
            shifts = [self.rows.shift(self.start, r)]
            for number in self.rows.numbers:
                i = number.parameter
                if number.record == r and number.name == "clock_shift":
                    if not (math.isfinite(self.lower[i]) and math.isfinite(self.upper[i])):
                        rule = "given: a clock that is fitted must keep its record within the run"
                        raise InvalidParameterError(
                            f"fit {self.plan.name}", f"parameters.{self.names[i]}.between", rule, None
                        )
                    shifts += [float(self.lower[i]), float(self.upper[i])]
            span = json.loads(test.scenario)["duration"]
            windowed = self.plan.records[name].window is not None
            self._prepared.check_span(name, min(shifts), max(shifts), span, windowed)
