"""Assessment of a fit: bands of its curves, profiles, identifiability, and their datasets."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.fit.confidence_bands import (
    DOUBT,
    CurveBands,
    band_columns,
    linear_bands,
    profile_columns,
    sampled_bands,
    search_residuals,
)
from antenna_pin.studies.fit.experiments import eliminate
from antenna_pin.studies.fit.identifiability import Design, Identifiable, Plan, identifiable
from antenna_pin.studies.fit.problem import Problem
from antenna_pin.studies.fit.profile_likelihood import Profile, profile_lines, profiles
from antenna_pin.studies.fit.result import Fit
from antenna_pin.studies.fit.uncertainty import ResidualFunctions, Sure, sure
from antenna_pin.trajectory import open_table, table_attributes

# --- bands and profiles of a fit ----------------------------------------------------------------------------


def _sure(fit: Fit) -> tuple[ResidualFunctions, Sure]:
    problem, plan = fit.problem, fit.problem.plan
    searched = search_residuals(
        problem.unknowns,
        np.concatenate([fit.values, fit.states]),
        lambda values: problem.residuals(problem.unknowns.from_search(values)),
        problem.slopes,
    )
    known = sure(
        searched,
        searched.start,
        noise=fit.bands.noise,
        loss=plan.loss,
        loss_scale=plan.loss_scale,
        curves=problem.rows.curve_numbers(),
        doubt=DOUBT,
    )
    return searched, known


@takes()
def profiles_of(
    fit: Fit, names: Sequence[str] | None = None, progress: Callable[[str, float], None] | None = None
) -> tuple[Profile, ...]:
    """Return the profiles of a fit's parameters, in search coordinates.

    Those of all parameters but those at a bound by default; ``progress`` is called with the parameter and the
    signed root of each point.
    """
    plan = fit.problem.plan
    if fit.bands.absence:
        raise InvalidParameterError("fit", "profiles", "left out of a fit without bands", fit.bands.absence)
    searched, known = _sure(fit)
    for name in names or ():
        if name not in fit.names:
            raise UnknownNameError("fit", "parameter", name, fit.names)
    held = dict(zip(known.names, known.held, strict=True))
    wanted = [name for name in (fit.names if names is None else names) if not held[name]]
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
    """Return a fit's dataset with curve bands and profiles, and notes on them.

    Bands are to first order, or by runs at values drawn about the best ones. Curves of a fit without bands
    (:attr:`antenna_pin.studies.fit.confidence_bands.ParameterBands.absence`) have none.

    Args:
        found: The fit.
        profile: True for the profile of each parameter: some thirty fits of the others each.
        draws: Runs at drawn values; none for bands to first order.
        seed: Seed of the draws.
        progress: Called with the parameter and the signed root of each point of a profile.
    """
    table, said = found.data(), []
    if found.problem.plan.surface is not None:
        if profile or draws:
            rule = "left out with a surface, whose single runs scatter"
            raise InvalidParameterError("fit", "profile" if profile else "draws", rule, profile or draws)
        return table, ()
    if found.bands.absence:
        lacks = "no bands, profiles or draws" if profile or draws else "no bands"
        said_already = found.bands.beyond_chance and not (profile or draws)  # the verdict says so
        return table, () if said_already else (f"{lacks}: {found.bands.absence}",)
    searched, known = _sure(found)
    plan = found.problem.plan
    if draws:
        bands: CurveBands = sampled_bands(
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
        bands = linear_bands(searched, known)
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


def sizes_of(problem: Problem, values: Array) -> Array:
    """Return the sizes of parameters at values, (p,) [SI]."""
    unknowns = problem.unknowns
    return np.asarray(np.where(unknowns.logarithmic, np.abs(values), unknowns.scale))


def slopes_at(problem: Problem, values: Array) -> Array:
    """Return the derivatives of residuals by parameters, (m, p), the pieces' starts eliminated."""
    p = len(problem.names)
    whole = np.concatenate([values, problem.states])
    slopes = problem.jacobian(whole)
    return eliminate(slopes, np.arange(p, len(whole)))[:, :p]


@takes()
def tells(problem: Problem, values: Array | None = None, factor: float = 1.0) -> Identifiable:
    """Return the identifiability of parameters from a fit's records, without a fit.

    Args:
        problem: The fit's problem.
        values: Values of the parameters, (p,) [SI]; the start of the search by default.
        factor: Variance of a weighted residual, of a fit whose noise is estimated [-].
    """
    at = problem.first if values is None else np.asarray(values, dtype=float)
    root, lower, upper = float(np.sqrt(factor)), problem.lower, problem.upper
    over = ResidualFunctions(
        problem.names,
        at,
        lower,
        upper,
        sizes_of(problem, at),
        lambda values: problem.residuals(values) / root,
        lambda values: slopes_at(problem, values) / root,
    )
    return identifiable(over, at, doubt=DOUBT)


def values_in(table: xr.Dataset, problem: Problem, label: str) -> tuple[Array, float]:
    """Return values of a saved fit, (p,) [SI], and the variance of its residuals."""
    there = [str(one) for one in table["parameter"].values]
    for name in problem.names:
        if name not in there:
            raise UnknownNameError(label, "parameter", name, there)
    values = table["value"].sel(parameter=list(problem.names)).values.astype(float)
    freedoms = float(table.attrs["freedoms"])
    found = problem.plan.noise != "given" and freedoms > 0.0
    return values, float(table.attrs["chi2"]) / freedoms if found else 1.0


# --- datasets and their files -------------------------------------------------------------------------------


def _texts(words: Sequence[str]) -> np.ndarray:
    return np.array(list(words), dtype=object)


@takes()
def identifiability_table(
    identifiable: Identifiable, units: Sequence[str], titles: Sequence[str], scenario: Scenario | None = None
) -> xr.Dataset:
    """Return identifiability as a dataset, for :func:`antenna_pin.trajectory.save_table`.

    Returns:
        Over ``parameter``: ``value``, ``scale``, ``error``, ``half``, ``alone``, in its ``units``, infinite
        if unidentifiable, ``inflation`` [-], ``felt`` and ``determined`` (0, 1), ``title``. Over
        ``direction``: ``singular`` [-], and ``part`` of each parameter in it, over its scale [-]. Over
        ``combination``: ``null``, of each parameter over its scale [-], ``said``, as text, and ``hold``, the
        parameter to hold. Attributes ``level`` and ``quantile``, half widths over errors [-].
    """
    count = len(identifiable.names)
    over = ("parameter",)
    columns = {
        "value": (over, identifiable.values, {"long_name": "value at which it is evaluated"}),
        "scale": (over, identifiable.scale, {"long_name": "typical size"}),
        "error": (over, identifiable.error, {"long_name": "standard error to expect"}),
        "half": (over, identifiable.half, {"long_name": "half width of the interval to expect"}),
        "alone": (over, identifiable.alone, {"long_name": "standard error if all others were known"}),
        "inflation": (over, identifiable.inflation, {"units": "1", "long_name": "error over that"}),
        "felt": (
            over,
            identifiable.rank.influential.astype(np.int8),
            {"units": "1", "long_name": "whether it is felt"},
        ),
        "determined": (
            over,
            identifiable.rank.determined.astype(np.int8),
            {"units": "1", "long_name": "whether it is identifiable"},
        ),
        "units": (over, _texts(units), {"long_name": "SI unit of the parameter"}),
        "title": (over, _texts(titles), {"long_name": "what it is called"}),
        "singular": (("direction",), identifiable.singular, {"units": "1", "long_name": "singular value"}),
        "part": (
            ("direction", "parameter"),
            identifiable.directions,
            {"units": "1", "long_name": "part of each parameter over its scale"},
        ),
        "null": (
            ("combination", "parameter"),
            identifiable.rank.null,
            {"units": "1", "long_name": "what changes nothing, over scales"},
        ),
        "said": (("combination",), _texts(identifiable.together), {"long_name": "the same in words"}),
        "hold": (("combination",), _texts(identifiable.hold), {"long_name": "the parameter to hold"}),
    }
    return xr.Dataset(
        columns,
        coords={"parameter": np.array(identifiable.names, dtype=str), "direction": np.arange(1, count + 1)},
        attrs=table_attributes("identifiability", scenario)
        | {"level": identifiable.level, "quantile": identifiable.quantile},
    )


@takes()
def experiments_table(
    design: Design,
    plan: Plan | None,
    values: Sequence[float],
    units: Sequence[str],
    titles: Sequence[str],
    words: Mapping[str, str] | None = None,
    scenario: Scenario | None = None,
) -> xr.Dataset:
    """Return a comparison of experiments as a dataset, for :func:`save_table`.

    Returns:
        Over ``experiment``, the best first: ``half`` and, over ``parameter``, in its ``units``: half widths
        of the expected intervals, infinite if unidentifiable; ``D``, ``A``, ``E``, and ``c`` if requested,
        lengths in scales [-]; ``share`` and ``count`` of the plan; the description ``what``. Over
        ``parameter``: ``value``, ``scale``, ``before``, ``title``. Attributes ``criterion``, ``wanted``,
        ``level``, ``total``.
    """
    over, each = ("parameter",), ("experiment",)
    columns = {
        "half": (("experiment", "parameter"), design.half, {"long_name": "half width of the interval"}),
        "before": (over, design.before, {"long_name": "the same before any of them"}),
        "value": (over, np.asarray(values, dtype=float), {"long_name": "value at which this holds"}),
        "scale": (over, design.scale, {"long_name": "typical size"}),
        "units": (over, _texts(units), {"long_name": "SI unit of the parameter"}),
        "title": (over, _texts(titles), {"long_name": "what it is called"}),
        "what": (
            each,
            _texts([(words or {}).get(name, "") for name in design.experiments]),
            {"long_name": "what is done"},
        ),
    }
    about = {"D": "volume", "c": "the wanted one's error", "A": "sum of variances", "E": "longest axis"}
    for name, lengths in design.criteria.items():
        columns[name] = (each, lengths, {"units": "1", "long_name": f"{about[name]}, as a length in scales"})
    total = 0
    if plan is not None:
        order = [plan.experiments.index(name) for name in design.experiments]
        total = int(plan.counts.sum())
        columns["share"] = (each, plan.weights[order], {"units": "1", "long_name": "share of the best plan"})
        columns["count"] = (each, plan.counts[order], {"units": "1", "long_name": "times in that plan"})
    return xr.Dataset(
        columns,
        coords={
            "parameter": np.array(design.names, dtype=str),
            "experiment": np.array(design.experiments, dtype=str),
        },
        attrs=table_attributes("experiments", scenario)
        | {"criterion": design.chosen, "wanted": design.wanted, "level": design.level, "total": total},
    )


@takes()
def open_identifiability(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return an :func:`identifiability_table` from a file of ``antenna-pin fit --identify --out``."""
    return open_table(path, "identifiability")


@takes()
def open_experiments(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return an :func:`experiments_table` from a file of ``antenna-pin fit --next --out``."""
    return open_table(path, "experiments")
