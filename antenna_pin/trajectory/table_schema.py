"""What each kind of dataset beside runs holds: variables, their dimensions and types, and attributes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import xarray as xr

__all__ = ["HOLDS", "Holds", "lacking"]

# Types by the letter of NumPy's kind: what is read back, and what it is in words.
_KINDS = {
    "f": ("fiu", "numbers"),
    "i": ("iu", "whole numbers"),
    "b": ("b", "true or false"),
    "U": ("UO", "text"),
}


@dataclass(frozen=True, slots=True)
class Holds:
    """What a dataset of a kind holds at least.

    Attributes:
        variables: Dimensions, separated by blanks, and letter of the type of each variable.
        texts: Attributes that are text.
        numbers: Attributes that are a number.
        quantities: Dimensions of the quantities that the attribute of this name lists; None for none.
    """

    variables: Mapping[str, tuple[str, str]]
    texts: tuple[str, ...] = ()
    numbers: tuple[str, ...] = ()
    quantities: str | None = field(default=None)


def _each(dims: str, kind: str, *names: str) -> dict[str, tuple[str, str]]:
    return {name: (dims, kind) for name in names}


def _solutions(dims: str) -> dict[str, tuple[str, str]]:
    """Return the variables of periodic solutions along some dimension, or of one."""
    along = f"{dims} ".lstrip()
    return {
        **_each(dims, "f", "period", "residual", "doubt", "start"),
        **_each(dims, "i", "neutral", "onsets", "events"),
        **_each(dims, "U", "stability", "state"),
        **_each(f"{along}configuration", "f", "q"),
        **_each(f"{along}coordinate", "f", "v"),
        **_each(f"{along}multiplier", "f", "multiplier_real", "multiplier_imaginary", "exponent"),
        **_each("configuration", "U", "configuration", "configuration_unit"),
        **_each("coordinate", "U", "coordinate", "coordinate_unit"),
        **_each("multiplier", "i", "multiplier"),
    }


#: By kind.
HOLDS: Mapping[str, Holds] = {
    "portrait": Holds(_each("sample", "f", "time"), ("run", "rule"), ("start",), "sample"),
    "section": Holds(
        {
            **_each("", "b", "settled"),
            **_each("", "i", "transient"),
            **_each("", "f", "drift"),
            **_each("point", "f", "time"),
        },
        ("section", "rule", "outcome", "message"),
        ("tolerance",),
        "point",
    ),
    "bifurcation": Holds(
        {
            **_each("branch value", "b", "settled"),
            **_each("branch value", "i", "points", "transient"),
            **_each("branch value", "f", "drift", "period"),
            **_each("branch value", "U", "outcome", "message"),
            **_each("branch", "U", "branch"),
            **_each("value", "f", "value"),
            **_each("branch value point", "f", "time"),
        },
        ("parameter", "section", "rule"),
        ("tolerance",),
        "branch value point",
    ),
    "orbit": Holds(
        {
            **_solutions(""),
            **_each("to", "U", "to"),
            **_each("from", "U", "from"),
            "tangent": ("to from", "f"),
        },
        (),
        ("free_period", "iterations"),
    ),
    "branch": Holds(
        {
            **_solutions("point"),
            **_each("point", "f", "value"),
            **_each("bifurcation", "U", "kind"),
            **_each("bifurcation", "f", "at", "at_doubt"),
            **_each("bifurcation", "i", "after"),
        },
        ("parameter", "message"),
    ),
    "exponents": Holds(
        {
            **_each("exponent", "f", "value", "error"),
            **_each("interval", "f", "length", "time"),
            **_each("interval exponent", "f", "growth", "running"),
            **_each("exponent", "i", "exponent"),
        },
        ("verdict",),
        ("interval",),
    ),
}


def lacking(table: xr.Dataset, kind: str) -> str:
    """Return what a dataset has not that its kind must have, as it reads after "got"; "" if it has all."""
    holds = HOLDS[kind]
    for name in ("title", "name", "case", "scenario", *holds.texts):
        if not isinstance(table.attrs.get(name), str):
            return f"an attribute {name!r} that is no text"
    for name in holds.numbers:
        if not _is_number(table.attrs.get(name)):
            return f"an attribute {name!r} that is no finite number"
    wanted = dict(holds.variables)
    if holds.quantities is not None:
        names = _names_in(table.attrs.get("quantities"))
        if not names:
            return "an attribute 'quantities' that is no list of names"
        wanted |= _each(holds.quantities, "f", *names)
    for name, (dims, letter) in wanted.items():
        if name not in table.variables:
            return f"no variable {name!r}"
        found = table.variables[name]
        if found.dims != tuple(dims.split()):
            return f"a variable {name!r} along {', '.join(map(str, found.dims)) or 'nothing'}"
        letters, words = _KINDS[letter]
        if found.dtype.kind not in letters:
            return f"a variable {name!r} that is not of {words}"
        if found.dtype.kind == "O" and not all(isinstance(one, str) for one in found.values.flat):
            return f"a variable {name!r} that is not of {words}"
    # What there may be none of: only bifurcations along a branch.
    empty = [dim for dim, size in table.sizes.items() if size == 0 and dim != "bifurcation"]
    return f"nothing along {empty[0]!r}" if empty else ""


def _names_in(text: object) -> list[str]:
    """Return the names in a JSON list; none if it is no such list."""
    try:
        found = json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        return []
    return found if isinstance(found, list) and all(isinstance(name, str) for name in found) else []


def _is_number(value: object) -> bool:
    if getattr(value, "ndim", 0) != 0:
        return False
    try:
        return math.isfinite(float(value))  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return False
