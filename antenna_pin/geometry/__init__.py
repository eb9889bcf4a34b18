"""Where journal and bearing meet and how deep: surfaces, no forces."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.geometry.cylindrical import CylindricalClearance
    from antenna_pin.geometry.look import Look
    from antenna_pin.geometry.looks import LOOKS
    from antenna_pin.geometry.planar import PlanarClearance
    from antenna_pin.geometry.prismatic import PrismaticClearance
    from antenna_pin.geometry.revolute import HARDEST, RevoluteClearance
    from antenna_pin.geometry.scenarios import AxialScenario, RadialScenario
    from antenna_pin.geometry.shape import ClearanceGeometry, ContactPlace, ContactPoint, Distances, pose_of
    from antenna_pin.geometry.spherical import SphericalClearance

__all__ = [
    "HARDEST",
    "LOOKS",
    "AxialScenario",
    "ClearanceGeometry",
    "ContactPlace",
    "ContactPoint",
    "CylindricalClearance",
    "Distances",
    "Look",
    "PlanarClearance",
    "PrismaticClearance",
    "RadialScenario",
    "RevoluteClearance",
    "SphericalClearance",
    "pose_of",
]

loaded_when_used(
    __name__,
    {
        "shape": "ClearanceGeometry ContactPlace ContactPoint Distances pose_of",
        "cylindrical": "CylindricalClearance",
        "look": "Look",
        "looks": "LOOKS",
        "planar": "PlanarClearance",
        "prismatic": "PrismaticClearance",
        "revolute": "HARDEST RevoluteClearance",
        "scenarios": "AxialScenario RadialScenario",
        "spherical": "SphericalClearance",
    },
)
