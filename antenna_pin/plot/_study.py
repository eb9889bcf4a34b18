"""Parameters and responses of a study as figures take them: a value for each run, in a unit that suits it."""

from __future__ import annotations

import json
import textwrap
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from antenna_pin.errors import UnknownNameError
from antenna_pin.plot._style import Array, literal, prefixed

__all__ = [
    "Quantity",
    "broken",
    "cell_edges",
    "is_spaced_by_factors",
    "label_axis",
    "left_out",
    "names_of",
    "quantity_of",
]

# Values of a parameter that its axis has room for.
_MOST_TICKS = 7


@dataclass(frozen=True, slots=True)
class Quantity:
    """A parameter or response of all runs, in a unit that suits it.

    Attributes:
        name: Its name.
        label: What its axis is called, with the unit.
        values: Of all runs, (runs,).
        texts: Of a parameter that is words.
        ticks: The values of a parameter that has few.
        logarithmic: Whether it is a parameter whose values are spaced by factors.
    """

    name: str
    label: str
    values: Array
    texts: tuple[str, ...] = ()
    ticks: tuple[float, ...] = ()
    logarithmic: bool = False


def names_of(study: xr.Dataset, what: str) -> list[str]:
    """Return the names of a study's ``parameters`` or ``responses``."""
    return [str(name) for name in json.loads(study.attrs[what])]


def quantity_of(study: xr.Dataset, name: str) -> Quantity:
    """Return a parameter or response, one value for each run, (runs,)."""
    known = [*names_of(study, "parameters"), *names_of(study, "responses")]
    if name not in known:
        raise UnknownNameError("study", "parameter or response", name, known)
    found = study[name]
    like = study["outcome"]
    text = str(found.attrs.get("long_name", name))
    text = text[:1].upper() + text[1:]
    if found.dtype.kind not in "fi":
        words = [str(value) for value in found.values]
        numbers = xr.DataArray(np.arange(len(words), dtype=float), dims=found.dims)
        return Quantity(
            name, text, np.ravel(numbers.broadcast_like(like).transpose(*like.dims).values), tuple(words)
        )
    values = np.ravel(found.broadcast_like(like).transpose(*like.dims).values).astype(float)
    sizes = np.abs(values[np.isfinite(values)])
    chosen = name in names_of(study, "parameters")
    by_factors = chosen and is_spaced_by_factors(values)
    # On a logarithmic axis the middle is what is read, on another its end.
    size = float(np.median(sizes) if by_factors else sizes.max()) if sizes.size else 0.0
    factor, unit = prefixed(str(found.attrs.get("units", "")), size)
    label = f"{text} [{unit}]" if unit not in ("", "-", "1") else text
    own = np.unique(factor * values[np.isfinite(values)])
    ticks = tuple(own.tolist()) if chosen and own.size <= _MOST_TICKS else ()
    return Quantity(name, label, factor * values, ticks=ticks, logarithmic=by_factors)


def is_spaced_by_factors(values: Array) -> bool:
    """Whether values lie more evenly by their logarithms, over a decade or nearly so."""
    own = np.unique(values[np.isfinite(values)])
    if own.size < 3 or own[0] <= 0.0 or own[-1] < 8.0 * own[0]:
        return False
    steps, factors = np.diff(own), np.diff(np.log(own))
    return bool(np.std(factors) / np.mean(factors) < np.std(steps) / np.mean(steps))


def cell_edges(values: Array, logarithmic: bool) -> Array:
    """Return the edges of cells around ascending values, halfway between two, by factors or not."""
    own = np.log(values) if logarithmic else values
    middles = 0.5 * (own[1:] + own[:-1])
    if not middles.size:
        edges = own[0] + max(0.5 * abs(own[0]), 0.5) * np.array([-1.0, 1.0])
    else:
        edges = np.concatenate([[2.0 * own[0] - middles[0]], middles, [2.0 * own[-1] - middles[-1]]])
    found: Array = np.exp(edges) if logarithmic else edges
    return found


def left_out(*quantities: Quantity) -> tuple[Any, str]:
    """Return which runs have all the numbers, and the words for those that have not."""
    there = np.logical_and.reduce([np.isfinite(one.values) for one in quantities])
    missing = int(np.count_nonzero(~there))
    return there, f"{missing} of {there.size} runs without a result are not drawn" if missing else ""


def broken(label: str, length: int = 32) -> str:
    """Return a label in lines that an axis has room for; a title may be a sentence."""
    return literal("\n".join(textwrap.wrap(label, length)))


def label_axis(axes: Axes, quantity: Quantity, along: str) -> None:
    """Label an axis; a parameter of words has them as ticks."""
    (axes.set_xlabel if along == "x" else axes.set_ylabel)(broken(quantity.label))
    if quantity.logarithmic:
        (axes.set_xscale if along == "x" else axes.set_yscale)("log")
    if quantity.ticks:
        axis = axes.xaxis if along == "x" else axes.yaxis
        axis.set_minor_locator(NullLocator())
        axis.set_ticks(quantity.ticks, [f"{value:.4g}" for value in quantity.ticks])
    if quantity.texts:
        axis = axes.xaxis if along == "x" else axes.yaxis
        axis.set_ticks(np.arange(len(quantity.texts)), [literal(text) for text in quantity.texts])
