"""Parameters and responses of a study as figures take them: a value for each run, in a unit that suits it."""

from __future__ import annotations

import json
import textwrap
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from antenna_pin.errors import UnknownNameError
from antenna_pin.plot._style import Array, literal, prefixed

__all__ = ["Quantity", "broken", "label_axis", "left_out", "names_of", "quantity_of"]


@dataclass(frozen=True, slots=True)
class Quantity:
    """A parameter or response of all runs, in a unit that suits it."""

    name: str
    label: str
    values: Array
    texts: tuple[str, ...] = ()


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
    text = literal(str(found.attrs.get("long_name", name)))
    text = text[:1].upper() + text[1:]
    if found.dtype.kind not in "fi":
        words = [str(value) for value in found.values]
        numbers = xr.DataArray(np.arange(len(words), dtype=float), dims=found.dims)
        return Quantity(
            name, text, np.ravel(numbers.broadcast_like(like).transpose(*like.dims).values), tuple(words)
        )
    values = np.ravel(found.broadcast_like(like).transpose(*like.dims).values).astype(float)
    sizes = np.abs(values[np.isfinite(values)])
    factor, unit = prefixed(str(found.attrs.get("units", "")), float(sizes.max()) if sizes.size else 0.0)
    return Quantity(name, f"{text} [{unit}]" if unit not in ("", "-", "1") else text, factor * values)


def left_out(*quantities: Quantity) -> tuple[Any, str]:
    """Return which runs have all the numbers, and the words for those that have not."""
    there = np.logical_and.reduce([np.isfinite(one.values) for one in quantities])
    missing = int(np.count_nonzero(~there))
    return there, f"{missing} of {there.size} runs without a result are not drawn" if missing else ""


def broken(label: str, length: int = 32) -> str:
    """Return a label in lines that an axis has room for; a title may be a sentence."""
    return "\n".join(textwrap.wrap(label, length))


def label_axis(axes: Axes, quantity: Quantity, along: str) -> None:
    """Label an axis; a parameter of words has them as ticks."""
    (axes.set_xlabel if along == "x" else axes.set_ylabel)(broken(quantity.label))
    if quantity.texts:
        axis = axes.xaxis if along == "x" else axes.yaxis
        axis.set_ticks(np.arange(len(quantity.texts)), [literal(text) for text in quantity.texts])
