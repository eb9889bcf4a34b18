"""What profiles say of parameters, in words: from where to where, and why a side has no end."""

from __future__ import annotations

import math

import xarray as xr

from antenna_pin.readable import number, prefixed

__all__ = ["profile_lines"]

# How a side of an interval ends, behind its number; of an open one there is none.
_BEHIND = {"crossed": "", "bounded": ", its bound", "stopped": ", beyond which the model cannot be run"}
_SIDES = ("below", "above")


def profile_lines(table: xr.Dataset) -> list[str]:
    """Return a line for each parameter that has a profile.

    Args:
        table: A fit's, with the columns of :func:`antenna_pin.fit.searched.profile_columns`.
    """
    found = []
    for name in map(str, table["parameter"].values):
        one = table.sel(parameter=name)
        how = [str(word) for word in one["profile_how"].values]
        if not all(how):
            continue
        value, ends = float(one["value"]), one["profile_end"].values.tolist()
        found.append(f"{name}: {_interval(value, ends, how, str(one['units'].item()))} (95 %)")
    return found


def _interval(value: float, ends: list[float], how: list[str], unit: str) -> str:
    factor, printed = prefixed(unit or "1", [value])
    unit = f" {printed}" if printed else ""
    spans = [abs(end - value) for end, word in zip(ends, how, strict=True) if word != "open"]
    half = max(spans, default=0.0)
    digits = 3
    if half > 0.0 and value != 0.0:
        digits = min(12, 2 + max(0, math.floor(math.log10(abs(value) / half)) + 1))
    low, high = (number(factor * end, digits) if math.isfinite(end) else "" for end in ends)
    said = [f"{text}{unit}{_BEHIND.get(word, '')}" for text, word in zip((low, high), how, strict=True)]
    open_on = [side for side, word in zip(_SIDES, how, strict=True) if word == "open"]
    if len(open_on) == 2:
        return "by its profile any value: the records do not bound it, as far as was looked"
    if open_on:
        known = said[0] if open_on == ["above"] else said[1]
        word = "or more" if open_on == ["above"] else "or less"
        return f"by its profile {known} {word}: {open_on[0]} the records do not bound it"
    plain = how == ["crossed", "crossed"]
    return f"by its profile from {low if plain else said[0]} to {said[1]}"
