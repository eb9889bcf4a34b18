"""Contact scenarios of journal and bearing in words, without compiled code."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["AxialScenario", "RadialScenario"]


class RadialScenario(IntEnum):
    """Scenario of radial contact, in the bore; numbers as in the kernels."""

    NONE = 0
    ONE_POINT = 1
    TWO_POINTS = 2
    LINE = 3


class AxialScenario(IntEnum):
    """Scenario of axial contact, at the flanges; numbers as in the kernels."""

    NONE = 0
    ONE_POINT = 1
    TWO_POINTS = 2
    SURFACE = 3
