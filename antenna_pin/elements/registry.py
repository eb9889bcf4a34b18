"""The force elements by the names that a scenario has for them. One enters by a line here."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

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
from antenna_pin.errors import UnknownNameError

__all__ = ["DRIVES", "ELEMENTS", "SPRINGS", "kind_of"]

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

ELEMENTS: tuple[type[ForceElement], ...] = (
    *DRIVES.values(),
    CallableDrive,
    CallableMotion,
    *SPRINGS.values(),
)
"""All elements there are; Python has some that a scenario has not."""

# Blocks of a program with lower numbers are joints.
_FIRST_KIND = 10


def kind_of(element: type[ForceElement]) -> int:
    """Return the number of a kind of element in programs and kernels."""
    if element not in ELEMENTS:
        raise UnknownNameError("System", "kind of element", element.__name__, [e.__name__ for e in ELEMENTS])
    return _FIRST_KIND + ELEMENTS.index(element)
