"""Where journal and bearing meet and how deep: surfaces, no forces."""

from antenna_pin.geometry.coal_backend import CoalPlanar, CoalRevolute, CoalSpherical
from antenna_pin.geometry.shapes import (
    AxialScenario,
    ClearanceGeometry,
    ContactPoint,
    PlanarClearance,
    RadialScenario,
    RevoluteClearance,
    SphericalClearance,
)

__all__ = [
    "AxialScenario",
    "ClearanceGeometry",
    "CoalPlanar",
    "CoalRevolute",
    "CoalSpherical",
    "ContactPoint",
    "PlanarClearance",
    "RadialScenario",
    "RevoluteClearance",
    "SphericalClearance",
]
