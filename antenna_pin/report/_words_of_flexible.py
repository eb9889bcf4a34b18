"""Flexible links in words: their elastic parts, those that are alike together."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

from antenna_pin.analysis import elastic_parts_of
from antenna_pin.base.readable import number, readable
from antenna_pin.report._runs import ReportedRun

__all__ = ["words_of_flexible"]


def words_of_flexible(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield each flexible link of a run, with its elastic parts."""
    about = elastic_parts_of(run.run)
    for hub in dict.fromkeys(one["hub"] for one in about.values()):
        texts = []
        mine = [(name, one) for name, one in about.items() if one["hub"] == hub]
        for said, group in itertools.groupby(mine, key=lambda pair: _said(pair[1])):
            names = [name for name, _ in group]
            texts.append(
                f"{names[0]}: {said}"
                if len(names) == 1
                else f"{names[0]} to {names[-1]}, {len(names)} in all: each {said}"
            )
        yield hub, "; ".join(texts)


def _said(part: dict[str, Any]) -> str:
    unit, verb = ("kg", "slides") if part["slides"] else ("kg m^2", "turns")
    return (
        f"{readable(part['moved'], unit, 4)} that {verb} against a spring, "
        f"{readable(part['frequency'], 'Hz', 5)} with the hub held, "
        f"damping ratio {number(part['damping_ratio'], 4)}"
    )
