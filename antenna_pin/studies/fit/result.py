"""Result of a fit: values with confidence intervals, records beside the model, validation."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr
from scipy import stats

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.base.readable import brief, number, prefixed
from antenna_pin.errors import UnknownNameError
from antenna_pin.scenario import Scenario, found_from, scenario_toml
from antenna_pin.studies.fit.confidence_bands import BEYOND_CHANCE, ParameterBands
from antenna_pin.studies.fit.plan import FitPlan
from antenna_pin.studies.fit.problem import Problem
from antenna_pin.studies.fit.run_service import RunService
from antenna_pin.studies.fit.runs import NoRunError
from antenna_pin.studies.fit.specs import evaluate
from antenna_pin.studies.fit.uncertainty import student_quantile
from antenna_pin.studies.sweep import Executor
from antenna_pin.trajectory import open_table, save_table, table_attributes

# --- validation ---------------------------------------------------------------------------------------------


class ValidationResult(NamedTuple):
    """Residuals of a record that was not fitted."""

    record: str  # name
    chi2: float  # sum of the squares of the residuals [-]; NaN without a run
    numbers: int  # number of residuals
    failed: str = ""  # reason for a missing run

    @property
    def chance(self) -> float:
        """Probability of a worse record by the stated noise [-]."""
        return float(stats.chi2.sf(self.chi2, self.numbers))

    def words(self) -> str:
        """Return the result as a line."""
        if self.failed:
            return f"validation by {self.record}: no run: {self.failed}"
        holds = (
            "" if self.chance >= BEYOND_CHANCE else ": the values do not hold for it, or its sd is too small"
        )
        return f"validation by {self.record}: chi2 {number(self.chi2)} for {self.numbers} numbers{holds}"


class Validation:
    """Records for validation, read and checked."""

    def __init__(self, plan: FitPlan, executor: Executor | None = None) -> None:
        other = plan.unfitted()
        self._problem = None if other is None else Problem(other, RunService(executor))

    def at(self, names: Sequence[str], values: Array) -> tuple[ValidationResult, ...]:
        """Return the residuals of each record at values (p,) of the fit's parameters [SI]."""
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


# --- result of a fit ----------------------------------------------------------------------------------------

if TYPE_CHECKING:
    from lmfit.minimizer import Minimizer, MinimizerResult


class Search(NamedTuple):
    """Search of a fit: start and end."""

    start: Array  # (p,) [SI]
    end: Array  # (p,) [SI]
    cost: float  # half the sum of the losses at the end [-]; NaN without a run at the start


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Fit:
    """Result of a fit."""

    __repr__ = brief

    problem: Problem  # problem of the fit
    values: Array  # values of the parameters, (p,) [SI]
    states: Array  # coordinates of the pieces' starts, (h,), in error scales
    bands: ParameterBands  # uncertainty of the values
    residuals: Array  # (m,) [-]
    slopes: Array  # their derivatives by the values, (m, p)
    converged: bool  # true if the search converged
    message: str  # end of the search, as text
    evaluations: int  # evaluations by steps of all searches
    searches: tuple[Search, ...]  # all searches, the best first
    validation: tuple[ValidationResult, ...] = ()  # records that were not fitted, beside the model
    # objections to the fit as a whole, with their likely causes, a line each; () if none
    verdict: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()  # further notes, a line each

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return self.problem.names

    @property
    def trusted(self) -> bool:
        """Return whether the search converged, with residuals within chance."""
        return self.converged and not self.bands.beyond_chance

    @property
    def runs(self) -> int:
        """Number of runs."""
        return self.problem.runs

    def minimizer(self) -> Minimizer:
        """Return the problem as an lmfit minimizer, for ``lmfit.conf_interval`` and others."""
        import lmfit

        def residuals(parameters: Any) -> Array:
            return self.problem.residuals([parameters[one].value for one in _lmfit_names(self.names)])

        return lmfit.Minimizer(residuals, self._parameters(), scale_covar=self.problem.plan.noise != "given")

    def result(self) -> MinimizerResult:
        """Return the result as lmfit's: ``lmfit.fit_report(fit.result())`` is its report."""
        from lmfit.minimizer import MinimizerResult

        bands, count = self.bands, len(self.residuals)
        chi2 = max(bands.chi2, np.finfo(float).tiny)
        criterion = count * np.log(chi2 / count)
        p = len(self.values)
        return MinimizerResult(
            params=self._parameters(),
            var_names=list(_lmfit_names(self.names)),
            covar=bands.covariance,
            init_values=dict(zip(_lmfit_names(self.names), self.problem.start.tolist(), strict=True)),
            nvarys=p,
            ndata=count,
            nfree=bands.freedoms,
            residual=self.residuals,
            chisqr=bands.chi2,
            redchi=bands.chi2 / max(bands.freedoms, 1),
            aic=criterion + 2.0 * p,
            bic=criterion + np.log(count) * p,
            success=self.converged,
            message=self.message,
            nfev=self.evaluations,
            method="least_squares",
            errorbars=bool(np.all(np.isfinite(bands.sd))),
            aborted=False,
        )

    def report(self) -> str:
        """Return lmfit's report: values, standard errors, correlations, statistics."""
        import lmfit

        return str(lmfit.fit_report(self.result()))

    def _parameters(self) -> Any:
        import lmfit

        made, unknowns = lmfit.Parameters(), self.problem.unknowns
        names = _lmfit_names(self.names)
        for i, name in enumerate(names):
            made.add(name, float(self.values[i]), min=unknowns.lower[i], max=unknowns.upper[i])
            made[name].init_value = float(unknowns.start[i])
            sd = float(self.bands.sd[i])
            made[name].stderr = sd if np.isfinite(sd) else None
            made[name].correl = {
                other: float(self.bands.covariance[i, j] / (sd * self.bands.sd[j]))
                for j, other in enumerate(names)
                if j != i and np.isfinite(sd * self.bands.sd[j])
            }
        return made

    def scenario(self, record: str | None = None) -> Scenario:
        """Return the scenario of a record, by default the first, with the values found."""
        records = self.problem.plan.records
        name = next(iter(records)) if record is None else record
        if name not in records:
            raise UnknownNameError("Fit", "record", name, records)
        return self.problem.scenario(name, self.values)

    def lines(self) -> list[str]:
        """Return the verdict, if any, and a line for each parameter."""
        rows = [
            (name, *_value_text(*one))
            for name, one in zip(
                self.names,
                zip(self.values, self.bands.low, self.bands.high, self.problem.unknowns.units, strict=True),
                strict=True,
            )
        ]
        if self.bands.absence:  # which the verdict or a note says
            rows = [(name, value, "no band") for name, value, _ in rows]
        rows += self._derived()
        wide = max(len(row[0]) for row in rows)
        return [*self.verdict, *(f"{name.ljust(wide)}  {value}  {band}" for name, value, band in rows)]

    def _derived(self) -> list[tuple[str, str, str]]:
        """Return the derived numbers with their bands to first order, as text."""
        rows, noise = [], self.bands.noise
        reach = student_quantile(0.95, np.inf if noise == "given" else self.bands.freedoms)
        steps = 1e-6 * np.diag(self.problem.unknowns.scale)
        for name, one in self.problem.plan.derived.items():

            def value(at: Array, text: str = one.value) -> float:
                return evaluate(text, dict(zip(self.names, at.tolist(), strict=True)))

            here = value(self.values)
            ends = [(value(self.values + step), value(self.values - step)) for step in steps]
            slopes = np.array([a - b for a, b in ends]) / (2.0 * np.diag(steps))
            used = slopes != 0.0
            covariance = self.bands.covariance[np.ix_(used, used)]
            half = reach * np.sqrt(slopes[used] @ covariance @ slopes[used])
            said = _value_text(here, here - half, here + half, one.unit)
            rows.append((name, said[0], "no band" if not np.isfinite(half) else said[1]))
        return rows

    @takes()
    def write_scenario(self, path: str | os.PathLike[str], record: str | None = None) -> Path:
        """Write the scenario of a record, by default the first, with the values found.

        Raises:
            OutputError: The file cannot be written.
        """
        target = check_writable(path, ".toml")
        self.problem.plan.check_output(target)
        scenario = found_from(self.scenario(record), target.resolve().parent)
        name = next(iter(self.problem.plan.records)) if record is None else record
        files = ", ".join(dict.fromkeys(one.file for one in self.problem.plan.records.values()))
        head = [
            f"Fitted by antenna-pin fit {self.problem.plan.name} to {files}; this is record {name}.",
            *self.lines(),
            f"chi2 {number(self.bands.chi2)} for {self.bands.freedoms} degrees of freedom; {self.message}",
        ]
        text = "".join(f"# {line}\n" for line in head) + "\n" + scenario_toml(scenario)
        with replacing(target) as partial:
            partial.write_text(text, encoding="utf-8")
        return target

    def data(self) -> xr.Dataset:
        """Return the result as a dataset; ``docs/fit.md`` lists its variables."""
        problem, bands, unknowns = self.problem, self.bands, self.problem.unknowns
        seen = problem.predictions(np.concatenate([self.values, self.states]))
        over = ("parameter",)
        found = xr.Dataset(
            {
                "value": (over, self.values),
                **{name: (over, getattr(unknowns, name)) for name in ("start", "lower", "upper")},
                **{name: (over, getattr(bands, name)) for name in ("sd", "low", "high")},
                "logarithmic": (over, unknowns.logarithmic.astype(float)),
                "units": (over, list(unknowns.units)),
                "title": (over, list(unknowns.titles)),
                "key": (over, [", ".join(one.keys_set) for one in problem.plan.parameters.values()]),
                "covariance": (("parameter", "other"), bands.covariance),
                "model": ("row", seen["model"].values),
                "data": ("row", seen["data"].values),
                "noise": ("row", seen["sd"].values),
                "at": ("row", seen["at"].values),
                **{
                    name: ("row", list(seen[name].values)) for name in ("record", "column", "measure", "unit")
                },
                "residual": ("residual_row", self.residuals),
                "slope": (("residual_row", "parameter"), self.slopes),
                "search_cost": ("search", [one.cost for one in self.searches]),
                "search_start": (("search", "parameter"), np.array([one.start for one in self.searches])),
                "search_end": (("search", "parameter"), np.array([one.end for one in self.searches])),
            },
            coords={"parameter": list(self.names), "other": list(self.names)},
        )
        plan = problem.plan
        found.attrs = table_attributes("fit", self.scenario()) | {
            "fit": json.dumps(plan.model_dump(mode="json", exclude={"folder"}, exclude_none=True)),
            "chi2": bands.chi2,
            "freedoms": bands.freedoms,
            "noise": plan.noise,
            "wider": bands.widening,
            "chance": bands.chance,
            "validation": "\n".join(one.words() for one in self.validation),
            "verdict": "\n".join(self.verdict),
            "loss": plan.loss,
            "message": self.message,
            "converged": int(self.converged),
            "runs": self.runs,
            "evaluations": self.evaluations,
            "derivatives": self.problem.derived.words(),
            "notes": "\n".join(self.notes),
        }
        return found

    @takes()
    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the result to a file (NetCDF 4), and return its path.

        Raises:
            OutputError: The file cannot be written.
        """
        save_table(self.data(), path)
        return Path(path)


@takes()
def open_fit(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return a saved fit."""
    return open_table(path, "fit")


def _value_text(value: float, low: float, high: float, unit: str) -> tuple[str, str]:
    """Return a value, and its band at 95 % or both ends, as text."""
    factor, printed = prefixed(unit or "1", [value])
    behind = f" {printed}" if printed else ""
    if not (np.isfinite(low) and np.isfinite(high)):
        why = "it stands at its bound" if np.isnan(low) else "not identifiable from the records"
        return f"{number(factor * value, 5)}{behind}", f"no band: {why}"
    half = 0.5 * (high - low)
    digits = 2 if half == 0.0 or value == 0.0 else 2 + max(0, int(np.floor(np.log10(abs(value) / half))) + 1)
    said = number(factor * value, min(max(digits, 2), 12))
    lopsided = abs(high + low - 2.0 * value) > 0.1 * half
    band = (
        f"from {number(factor * low, 3)} to {number(factor * high, 3)}"
        if lopsided
        else f"± {number(factor * half, 2)}"
    )
    return f"{said}{behind}", f"{band}{behind} (95 %)"


def _lmfit_names(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return names as Python's variables, for lmfit."""
    return tuple(("" if name[:1].isalpha() else "p_") + name.replace("-", "_") for name in names)
