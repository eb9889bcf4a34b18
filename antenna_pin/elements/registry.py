"""The force elements by the names that a scenario has for them. One enters by a line here."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from antenna_pin.elements.constant import ConstantDrive
from antenna_pin.elements.element import Element, ForceElement
from antenna_pin.elements.given import CallableDrive
from antenna_pin.elements.joint_friction import JointFriction
from antenna_pin.elements.pd import PDController
from antenna_pin.elements.point_spring import PointSpring
from antenna_pin.elements.prescribed import CallableMotion, DistanceMotion, PrescribedMotion
from antenna_pin.elements.sine import SineDrive
from antenna_pin.elements.spring import JointSpring
from antenna_pin.elements.tabulated import TableDrive

__all__ = ["DRIVES", "ELEMENTS", "SPRINGS", "kernel_modules"]

DRIVES: Mapping[str, type[Element]] = MappingProxyType(
    {
        "constant": ConstantDrive,
        "sine": SineDrive,
        "table": TableDrive,
        "pd": PDController,
        "motion": PrescribedMotion,
        "distance": DistanceMotion,
    }
)
"""Drives by their ``kind`` in ``[drives.NAME]``."""

SPRINGS: Mapping[str, type[ForceElement]] = MappingProxyType(
    {
        "spring": JointSpring,
        "friction": JointFriction,
        "between-points": PointSpring,
    }
)
"""What stores and loses energy by its ``kind`` in ``[springs.NAME]``."""

ELEMENTS: tuple[type[Element], ...] = (
    *DRIVES.values(),
    CallableDrive,
    CallableMotion,
    *(cls for cls in SPRINGS.values() if issubclass(cls, Element)),
)
"""All elements there are; Python has some that a scenario has not."""


def kernel_modules() -> list[Any]:
    """Return the modules of their kernels."""
    return [element.compiled() for element in ELEMENTS]
