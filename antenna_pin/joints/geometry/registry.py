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

#: Kinds by the ``model`` of a scenario, which for one is another word.
MODELS = {"contact" if kind == "revolute" else kind: kind for kind in SHAPES}


def __getattr__(name: str) -> Any:
    """Return ``LOOKS``, the descriptions of all kinds."""
    if name == "LOOKS":
        return globals().setdefault(name, {kind: shape.look for kind, shape in SHAPES.items()})
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
