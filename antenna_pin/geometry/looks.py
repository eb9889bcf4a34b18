"""The kinds of joints with play that readers know, by the ``kind`` that a result carries: one line each."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from antenna_pin.geometry import cylindrical_look, planar_look, prismatic_look, revolute_look, spherical_look
from antenna_pin.geometry.look import Look

__all__ = ["LOOKS"]

LOOKS: Mapping[str, Look] = MappingProxyType(
    {
        # Where runs in a figure have different ones, forces are drawn as of the first: without axis first.
        "spherical": spherical_look.LOOK,
        "prismatic": prismatic_look.LOOK,
        "cylindrical": cylindrical_look.LOOK,
        "revolute": revolute_look.LOOK,
        "planar": planar_look.LOOK,
    }
)
