"""Where journal and bearing meet and how deep: surfaces, no forces."""

from antenna_pin.geometry.coal_backend import CoalPlanar, CoalRevolute
from antenna_pin.geometry.shapes import (
    AxialScenario,
    ClearanceGeometry,
    ContactPoint,
    PlanarClearance,
    RadialScenario,
    RevoluteClearance,
)

__all__ = [
    "AxialScenario",
    "ClearanceGeometry",
    "CoalPlanar",
    "CoalRevolute",
    "ContactPoint",
    "PlanarClearance",
    "RadialScenario",
    "RevoluteClearance",
]
