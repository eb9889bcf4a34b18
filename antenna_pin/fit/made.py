"""What an executor calls to have the runs of a fit made."""

from __future__ import annotations

from antenna_pin.fit.equation import with_slopes
from antenna_pin.fit.runs import Asked, Readings, Rig, make

__all__ = ["make_all"]


def make_all(rigs: tuple[Rig, ...], batch: list[Asked]) -> list[tuple[Readings, ...]]:
    """Make what is asked for, one after the other."""
    return [(with_slopes if one.slopes else make)(rigs[one.record], one) for one in batch]
