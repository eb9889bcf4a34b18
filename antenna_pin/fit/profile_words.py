"""What profiles say of parameters, in words: from where to where, and why a side has no end."""

from __future__ import annotations

import math

import xarray as xr

from antenna_pin.base.readable import number, prefixed

__all__ = ["from_to", "profile_interval", "profile_lines"]

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
        said = profile_interval(table.sel(parameter=name))
        if said:
            found.append(f"{name}: by its profile {said} (95 %)")
    return found


def profile_interval(one: xr.Dataset) -> str:
    """Return from where to where the profile of one parameter reaches, in words; "" if it has none.

    Args:
        one: A fit's table at that parameter.
    """
    how = [str(word) for word in one["profile_how"].values]
    if not all(how):
        return ""
    value, unit = float(one["value"]), str(one["units"].item())
    ends = [float(end) for end in one["profile_end"].values]
    if how == ["crossed", "crossed"]:
        return f"from {from_to(value, ends[0], ends[1], unit)}"
    said = [
        f"{text}{_BEHIND.get(word, '')}"
        for text, word in zip(_printed(value, ends, unit, each=True), how, strict=True)
    ]
    open_on = [side for side, word in zip(_SIDES, how, strict=True) if word == "open"]
    if len(open_on) == 2:
        return "any value: the records do not bound it, as far as was looked"
    if open_on:
        known, word = (said[0], "or more") if open_on == ["above"] else (said[1], "or less")
        return f"{known} {word}: {open_on[0]} the records do not bound it"
    return f"from {said[0]} to {said[1]}"


def from_to(value: float, low: float, high: float, unit: str) -> str:
    """Return an interval about a value, with as many digits as show how wide it is: ``0.9 to 1.2 mm``."""
    return " to ".join(_printed(value, [low, high], unit, each=False))


def _printed(value: float, ends: list[float], unit: str, each: bool) -> list[str]:
    """Return ends in the unit that suits the value, which stands behind each or behind the last."""
    factor, printed = prefixed(unit or "1", [value])
    half = max((abs(end - value) for end in ends if math.isfinite(end)), default=0.0)
    digits = 3
    if half > 0.0 and value != 0.0:
        digits = min(12, 2 + max(0, math.floor(math.log10(abs(value) / half)) + 1))
    behind = f"\N{NO-BREAK SPACE}{printed}" if printed else ""
    texts = [number(factor * end, digits) if math.isfinite(end) else "" for end in ends]
    return [text + (behind if each or k == len(ends) - 1 else "") for k, text in enumerate(texts)]
