"""Where journal and bearing meet and how deep: surfaces, no forces."""

from antenna_pin.geometry.base import ClearanceGeometry, ContactPlace, ContactPoint, Distances, pose_of
from antenna_pin.geometry.planar import PlanarClearance
from antenna_pin.geometry.prismatic import PrismaticClearance
from antenna_pin.geometry.revolute import AxialScenario, RadialScenario, RevoluteClearance
from antenna_pin.geometry.spherical import SphericalClearance

__all__ = [
    "AxialScenario",
    "ClearanceGeometry",
    "ContactPlace",
    "ContactPoint",
    "Distances",
    "PlanarClearance",
    "PrismaticClearance",
    "RadialScenario",
    "RevoluteClearance",
    "SphericalClearance",
    "pose_of",
]
