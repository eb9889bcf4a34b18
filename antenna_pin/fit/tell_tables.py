"""What a test can tell, and experiments beside one another, as labelled datasets and their files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.fit.designs import Design, Plan
from antenna_pin.fit.identifiable import Identifiable
from antenna_pin.scenario import Scenario
from antenna_pin.trajectory import open_table, table_attributes

__all__ = [
    "experiments_table",
    "identifiability_table",
    "open_experiments",
    "open_identifiability",
]


def _texts(words: Sequence[str]) -> np.ndarray:
    return np.array(list(words), dtype=object)


@takes()
def identifiability_table(
    found: Identifiable, units: Sequence[str], titles: Sequence[str], scenario: Scenario | None = None
) -> xr.Dataset:
    """Return what a test can tell as a dataset, which :func:`antenna_pin.trajectory.save_table` writes.

    Args:
        found: What it can tell.
        units: SI units of the parameters, "" of a pure number.
        titles: What they are called in figures.
        scenario: What the test is of; None for a model that is none.

    Returns:
        Over ``parameter``: ``value``, ``scale``, ``error``, ``half``, ``alone``, in its ``units``, infinite
        where it cannot be told, ``inflation`` [-], ``felt`` and ``determined`` (0, 1), ``title``. Over
        ``direction``: ``singular`` [-], and ``part`` of each parameter in it, over its scale [-]. Over
        ``combination``: ``null``, of each parameter over its scale [-], ``said``, in words, and ``hold``,
        which parameter to hold. Attributes ``level`` and ``quantile``, half widths over errors [-].
    """
    count = len(found.names)
    over = ("parameter",)
    columns = {
        "value": (over, found.values, {"long_name": "value at which it is told"}),
        "scale": (over, found.scale, {"long_name": "typical size"}),
        "error": (over, found.error, {"long_name": "standard error to expect"}),
        "half": (over, found.half, {"long_name": "half width of the interval to expect"}),
        "alone": (over, found.alone, {"long_name": "standard error if all others were known"}),
        "inflation": (over, found.inflation, {"units": "1", "long_name": "error over that"}),
        "felt": (over, found.rank.felt.astype(np.int8), {"units": "1", "long_name": "whether it is felt"}),
        "determined": (
            over,
            found.rank.determined.astype(np.int8),
            {"units": "1", "long_name": "whether it can be told"},
        ),
        "units": (over, _texts(units), {"long_name": "SI unit of the parameter"}),
        "title": (over, _texts(titles), {"long_name": "what it is called"}),
        "singular": (("direction",), found.singular, {"units": "1", "long_name": "singular value"}),
        "part": (
            ("direction", "parameter"),
            found.directions,
            {"units": "1", "long_name": "part of each parameter over its scale"},
        ),
        "null": (
            ("combination", "parameter"),
            found.rank.null,
            {"units": "1", "long_name": "what changes nothing, over scales"},
        ),
        "said": (("combination",), _texts(found.together), {"long_name": "the same in words"}),
        "hold": (("combination",), _texts(found.hold), {"long_name": "the parameter to hold"}),
    }
    return xr.Dataset(
        columns,
        coords={"parameter": np.array(found.names, dtype=str), "direction": np.arange(1, count + 1)},
        attrs=table_attributes("identifiability", scenario)
        | {"level": found.level, "quantile": found.quantile},
    )


@takes()
def experiments_table(
    found: Design,
    plan: Plan | None,
    values: Sequence[float],
    units: Sequence[str],
    titles: Sequence[str],
    words: Mapping[str, str] | None = None,
    scenario: Scenario | None = None,
) -> xr.Dataset:
    """Return experiments beside one another as a dataset, which :func:`save_table` writes.

    Args:
        found: What each would tell.
        plan: How often to make each; None if nobody asked.
        values: Of the parameters, at which this holds, (p,).
        units: Their SI units, "" of a pure number.
        titles: What they are called in figures.
        words: What each experiment is, by its name.
        scenario: What they are of; None for a model that is none.

    Returns:
        Over ``experiment``, the best first: ``half`` and, over ``parameter``, in its ``units``: half widths
        of the intervals to expect, infinite where it cannot be told; ``D``, ``A``, ``E`` and ``c`` if it was
        asked for, lengths in scales [-]; ``share`` and ``count`` of the plan; ``what`` it is. Over
        ``parameter``: ``value``, ``scale``, ``before``, ``title``. Attributes ``criterion``, ``wanted``,
        ``level``, ``total``.
    """
    over, each = ("parameter",), ("experiment",)
    columns = {
        "half": (("experiment", "parameter"), found.half, {"long_name": "half width of the interval"}),
        "before": (over, found.before, {"long_name": "the same before any of them"}),
        "value": (over, np.asarray(values, dtype=float), {"long_name": "value at which this holds"}),
        "scale": (over, found.scale, {"long_name": "typical size"}),
        "units": (over, _texts(units), {"long_name": "SI unit of the parameter"}),
        "title": (over, _texts(titles), {"long_name": "what it is called"}),
        "what": (
            each,
            _texts([(words or {}).get(name, "") for name in found.experiments]),
            {"long_name": "what is done"},
        ),
    }
    about = {"D": "volume", "c": "the wanted one's error", "A": "sum of variances", "E": "longest axis"}
    for name, lengths in found.criteria.items():
        columns[name] = (each, lengths, {"units": "1", "long_name": f"{about[name]}, as a length in scales"})
    total = 0
    if plan is not None:
        order = [plan.experiments.index(name) for name in found.experiments]
        total = int(plan.counts.sum())
        columns["share"] = (each, plan.weights[order], {"units": "1", "long_name": "share of the best plan"})
        columns["count"] = (each, plan.counts[order], {"units": "1", "long_name": "times in that plan"})
    return xr.Dataset(
        columns,
        coords={
            "parameter": np.array(found.names, dtype=str),
            "experiment": np.array(found.experiments, dtype=str),
        },
        attrs=table_attributes("experiments", scenario)
        | {"criterion": found.chosen, "wanted": found.wanted, "level": found.level, "total": total},
    )


@takes()
def open_identifiability(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return what a test can tell from its file, as ``antenna-pin fit --identify --out`` writes it.

    Returns:
        See :func:`identifiability_table`.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    return open_table(path, "identifiability")


@takes()
def open_experiments(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return experiments beside one another from their file, as ``antenna-pin fit --next --out`` writes it.

    Returns:
        See :func:`experiments_table`.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    return open_table(path, "experiments")
