"""How a journal touches its bearing, in words; nothing of it needs compiled code."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["AxialScenario", "RadialScenario"]


class RadialScenario(IntEnum):
    """How the journal touches the bore; the numbers are those of the kernels."""

    NONE = 0
    ONE_POINT = 1
    TWO_POINTS = 2
    LINE = 3


class AxialScenario(IntEnum):
    """How the flanges touch the bearing's end faces; the numbers are those of the kernels."""

    NONE = 0
    ONE_POINT = 1
    TWO_POINTS = 2
    SURFACE = 3
