"""The shapes of joints with play by their ``kind``: one line each, beside that of what readers know of it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from antenna_pin.geometry.cylindrical import CylindricalClearance
from antenna_pin.geometry.planar import PlanarClearance
from antenna_pin.geometry.prismatic import PrismaticClearance
from antenna_pin.geometry.revolute import RevoluteClearance
from antenna_pin.geometry.spherical import SphericalClearance

__all__ = ["SHAPES"]

SHAPES: Mapping[str, type[Any]] = MappingProxyType(
    {
        shape.kind: shape
        for shape in (
            RevoluteClearance,
            PlanarClearance,
            SphericalClearance,
            PrismaticClearance,
            CylindricalClearance,
        )
    }
)
