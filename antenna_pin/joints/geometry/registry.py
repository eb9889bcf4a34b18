"""Kinds of joints with play by their ``kind``, one line each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from antenna_pin.base.lazy import Classes

if TYPE_CHECKING:
    from antenna_pin.joints.geometry.look import Look

    LOOKS: Mapping[str, Look]

SHAPES = Classes(
    "antenna_pin.joints.geometry",
    {
        "revolute": "revolute.RevoluteClearance",
        "planar": "planar.PlanarClearance",
        "spherical": "spherical.SphericalClearance",
        "prismatic": "prismatic.PrismaticClearance",
        "cylindrical": "cylindrical.CylindricalClearance",
    },
)

#: What a scenario calls a kind, where that is another word.
MODELS = {"revolute": "contact"}


def __getattr__(name: str) -> Any:
    """Return ``LOOKS``, the descriptions of all kinds."""
    if name == "LOOKS":
        return globals().setdefault(name, {kind: shape.look for kind, shape in SHAPES.items()})
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
