"""Kinds of joints with play by their ``kind``, one line each."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from antenna_pin.joints.geometry.cylindrical import CylindricalClearance
from antenna_pin.joints.geometry.look import Look
from antenna_pin.joints.geometry.planar import PlanarClearance
from antenna_pin.joints.geometry.prismatic import PrismaticClearance
from antenna_pin.joints.geometry.revolute import RevoluteClearance
from antenna_pin.joints.geometry.spherical import SphericalClearance

__all__ = ["LOOKS", "SHAPES"]

SHAPES: Mapping[str, type[Any]] = MappingProxyType(
    {
        shape.kind: shape
        for shape in (
            # Of several kinds in a figure forces are drawn as of the first: those without an axis first.
            SphericalClearance,
            PrismaticClearance,
            CylindricalClearance,
            RevoluteClearance,
            PlanarClearance,
        )
    }
)
LOOKS: Mapping[str, Look] = MappingProxyType({kind: shape.look for kind, shape in SHAPES.items()})
