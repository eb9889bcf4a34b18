"""A fit's dataset with how sure it is: bands of its curves, profiles of its parameters; what tests tell."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.fit.bands import CurveBands, along_jacobian, by_sampling
from antenna_pin.fit.experiments import without
from antenna_pin.fit.identifiable import Identifiable, identifiable
from antenna_pin.fit.problem import Problem
from antenna_pin.fit.profile_words import profile_lines
from antenna_pin.fit.profiled import Profile, profiles
from antenna_pin.fit.result import Fit
from antenna_pin.fit.searched import DOUBT, Searched, band_columns, profile_columns
from antenna_pin.fit.sureness import Sure, sure

__all__ = ["certain", "profiles_of", "sizes_of", "slopes_at", "tells", "values_in"]

Array = NDArray[np.float64]


def _sure(found: Fit) -> tuple[Searched, Sure]:
    plan, whole = found.problem.plan, np.concatenate([found.values, found.states])
    searched = Searched(found.problem, whole)
    known = sure(
        searched,
        searched.start,
        noise=found.bands.noise,
        loss=plan.loss,
        loss_scale=plan.loss_scale,
        curves=found.problem.rows.curve_numbers(),
        doubt=DOUBT,
    )
    return searched, known


@takes()
def profiles_of(
    found: Fit, names: Sequence[str] | None = None, progress: Callable[[str, float], None] | None = None
) -> tuple[Profile, ...]:
    """Return the profiles of a fit's parameters, in the coordinates of the search.

    Args:
        found: The fit.
        names: Of the parameters; all that no bound holds if left out.
        progress: Is told the parameter and the signed root of each point.
    """
    plan = found.problem.plan
    if found.bands.without:
        raise InvalidParameterError("fit", "profiles", "left out of a fit without bands", found.bands.without)
    searched, known = _sure(found)
    for name in names or ():
        if name not in found.names:
            raise UnknownNameError("fit", "parameter", name, found.names)
    held = dict(zip(known.names, known.held, strict=True))
    wanted = [name for name in (found.names if names is None else names) if not held[name]]
    return profiles(searched, known, wanted, loss=plan.loss, loss_scale=plan.loss_scale, progress=progress)


@takes()
def certain(
    found: Fit,
    *,
    profile: bool = False,
    draws: int = 0,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
) -> tuple[xr.Dataset, tuple[str, ...]]:
    """Return a fit's dataset with bands of its curves and profiles of its parameters, and what is to be said.

    Bands are to first order, or by runs at values drawn about the best ones. Where the fit has no bands
    (:attr:`antenna_pin.fit.covariance.Bands.without`), neither have its curves.

    Args:
        found: The fit.
        profile: Whether to make the profile of each parameter: some thirty fits of the others each.
        draws: Runs at drawn values; none for bands to first order.
        seed: Of the draws.
        progress: Is told the parameter and the signed root of each point of a profile.
    """
    table, said = found.data(), []
    if found.problem.plan.surface is not None:
        if profile or draws:
            rule = "left out beside a surface, whose single runs scatter"
            raise InvalidParameterError("fit", "profile" if profile else "draws", rule, profile or draws)
        return table, ()
    if found.bands.without:
        lacks = "no bands, profiles or draws" if profile or draws else "no bands"
        said_already = found.bands.beyond_chance and not (profile or draws)  # the verdict says so
        return table, () if said_already else (f"{lacks}: {found.bands.without}",)
    searched, known = _sure(found)
    plan = found.problem.plan
    if draws:
        bands: CurveBands = by_sampling(
            searched, known, draws, seed, loss=plan.loss, loss_scale=plan.loss_scale
        )
        table.attrs |= {"draws": bands.drawn, "seed": seed, "effective": bands.effective}
        if bands.failed:
            said.append(
                f"the model did not run at {bands.failed} of {draws} draws, which are left out of bands"
            )
        if bands.effective < 0.1 * draws:
            said.append(f"{draws} draws are worth {bands.effective:.0f} only: draw more, or hold a parameter")
    else:
        bands = along_jacobian(searched, known)
    weights = [
        plan.records[str(record)].columns[str(column)].weight
        for record, column in zip(table["record"].values, table["column"].values, strict=True)
    ]
    columns = band_columns(bands, table, np.array(weights))
    if profile:
        made = profiles_of(found, progress=progress)
        columns |= profile_columns(made, found.problem.unknowns)
        said += profile_lines(table.assign(columns))
        better = [one.name for one in made if one.better is not None]
        if better:
            said.append(
                f"on the profile of {', '.join(better)} there is a better fit than the one that was found: "
                "begin there, or from many starts"
            )
    return table.assign(columns), tuple(said)


class _Parameters:
    """A problem over its parameters alone, the starts of its pieces eliminated."""

    def __init__(self, problem: Problem, values: Array, factor: float) -> None:
        unknowns = problem.unknowns
        self._problem, self._root = problem, float(np.sqrt(factor))
        self.names, self.start = problem.names, values
        self.lower, self.upper = unknowns.lower, unknowns.upper
        self.scale = sizes_of(problem, values)

    def residuals(self, values: Array) -> Array:
        return self._problem.residuals(values) / self._root

    def jacobian(self, values: Array) -> Array:
        return slopes_at(self._problem, values) / self._root


def sizes_of(problem: Problem, values: Array) -> Array:
    """Return the sizes of parameters at values, (p,) [SI]: of one searched by its logarithm the value."""
    unknowns = problem.unknowns
    return np.asarray(np.where(unknowns.logarithmic, np.abs(values), unknowns.scale))


def slopes_at(problem: Problem, values: Array) -> Array:
    """Return the derivatives of residuals by parameters, (m, p), the pieces' starts eliminated."""
    p = len(problem.names)
    whole = np.concatenate([values, problem.states])
    slopes = problem.jacobian(whole)
    return without(slopes, np.arange(p, len(whole)))[:, :p]


@takes()
def tells(problem: Problem, values: Array | None = None, factor: float = 1.0) -> Identifiable:
    """Return what a fit's records can tell of its parameters; nothing is fitted.

    Args:
        problem: The fit's problem.
        values: Where, (p,) [SI]; where the search begins if left out.
        factor: Variance of a weighted residual, of a fit whose noise is estimated [-].
    """
    at = problem.first if values is None else np.asarray(values, dtype=float)
    over = _Parameters(problem, at, factor)
    return identifiable(over, at, doubt=DOUBT)


def values_in(table: xr.Dataset, problem: Problem, label: str) -> tuple[Array, float]:
    """Return parameters' values in a saved fit, (p,) [SI], and the variance of a weighted residual there.

    Args:
        table: Of :func:`antenna_pin.fit.open_fit`.
        problem: The fit's problem.
        label: How messages call the file.

    Raises:
        UnknownNameError: It lacks one of the parameters.
    """
    there = [str(one) for one in table["parameter"].values]
    for name in problem.names:
        if name not in there:
            raise UnknownNameError(label, "parameter", name, there)
    values = table["value"].sel(parameter=list(problem.names)).values.astype(float)
    freedoms = float(table.attrs["freedoms"])
    found = problem.plan.noise != "given" and freedoms > 0.0
    return values, float(table.attrs["chi2"]) / freedoms if found else 1.0
