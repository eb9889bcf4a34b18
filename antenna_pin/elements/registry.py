"""The force elements by the names that a scenario has for them. One enters by a line here.

A family is a table of a scenario: ``FAMILIES`` names it, and scenario, overrides, events that set, words and
reference follow.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from antenna_pin.elements.angle_table import TableSpring
from antenna_pin.elements.ball_bearing import BallBearing
from antenna_pin.elements.bearing import AxialPreload, StiffnessBearing
from antenna_pin.elements.belt import Belt, Cable
from antenna_pin.elements.bouc_wen import BoucWen
from antenna_pin.elements.bristle_friction import DahlFriction, GonthierFriction, LuGreFriction
from antenna_pin.elements.constant import ConstantDrive
from antenna_pin.elements.constant_spring import ConstantSpring
from antenna_pin.elements.element import Element, ForceElement
from antenna_pin.elements.given import CallableDrive
from antenna_pin.elements.given_links import CallableElement, CallableForce
from antenna_pin.elements.gravity_gradient import GravityGradient
from antenna_pin.elements.harness import HarnessSpring
from antenna_pin.elements.joint_friction import JointFriction
from antenna_pin.elements.latch import Latch
from antenna_pin.elements.maxwell_slip import MaxwellSlip
from antenna_pin.elements.mesh import Gear, Rack, Spline
from antenna_pin.elements.motor import Motor
from antenna_pin.elements.outside_force import OutsideForce
from antenna_pin.elements.pd import PDController
from antenna_pin.elements.point_spring import PointSpring
from antenna_pin.elements.prescribed import CallableMotion, DistanceMotion, PrescribedMotion
from antenna_pin.elements.random_shake import RandomShake
from antenna_pin.elements.rigid_latch import RigidLatch
from antenna_pin.elements.rigid_stop import RigidStop
from antenna_pin.elements.shake import SineShake, SweepShake
from antenna_pin.elements.shaken_table import TableShake
from antenna_pin.elements.sine import SineDrive
from antenna_pin.elements.spring import JointSpring
from antenna_pin.elements.sticking_friction import StickingFriction
from antenna_pin.elements.stop import EndStop
from antenna_pin.elements.tabulated import TableDrive
from antenna_pin.elements.thruster import Thruster
from antenna_pin.errors import UnknownNameError

__all__ = ["DRIVES", "ELEMENTS", "FAMILIES", "GEARS", "SHAKES", "SPRINGS", "Family", "kind_of"]


class Family(NamedTuple):
    """Elements of one table of a scenario.

    Attributes:
        word: One of them, as messages call it.
        kinds: Their classes by ``kind``.
        default: The kind of a table at a joint that names none; None where each must.
        among: The family that a system has its elements among, if it has none of its own of them.
        in_python: Further classes, which only Python has.
    """

    word: str
    kinds: Mapping[str, type[ForceElement]]
    default: str | None = None
    among: str | None = None
    in_python: tuple[type[ForceElement], ...] = ()


DRIVES: Mapping[str, type[Element]] = MappingProxyType(
    {
        "constant": ConstantDrive,
        "sine": SineDrive,
        "table": TableDrive,
        "pd": PDController,
        "motion": PrescribedMotion,
        "distance": DistanceMotion,
        "motor": Motor,
    }
)
"""Drives by their ``kind`` in ``[drives.NAME]``."""

SPRINGS: Mapping[str, type[ForceElement]] = MappingProxyType(
    {
        "spring": JointSpring,
        "friction": JointFriction,
        "between-points": PointSpring,
        "bouc-wen": BoucWen,
        "maxwell-slip": MaxwellSlip,
        "constant-torque": ConstantSpring,
        "table": TableSpring,
        "harness": HarnessSpring,
    }
)
"""What stores and loses energy by its ``kind`` in ``[springs.NAME]``."""

STOPS: Mapping[str, type[Element]] = MappingProxyType({"compliant": EndStop, "rigid": RigidStop})
"""End stops by their ``kind`` in ``[stops.NAME]``."""

LATCHES: Mapping[str, type[Element]] = MappingProxyType({"compliant": Latch, "rigid": RigidLatch})
"""Latches by their ``kind`` in ``[latches.NAME]``."""

FRICTIONS: Mapping[str, type[ForceElement]] = MappingProxyType(
    {
        "sticking": StickingFriction,
        "dahl": DahlFriction,
        "lugre": LuGreFriction,
        "gonthier-bristle": GonthierFriction,
    }
)
"""Friction of joints by its ``kind`` in ``[frictions.NAME]``."""
GEARS: Mapping[str, type[ForceElement]] = MappingProxyType(
    {
        "gear": Gear,
        "spline": Spline,
        "rack": Rack,
        "belt": Belt,
        "cable": Cable,
    }
)
"""What goes from one joint to another by its ``kind`` in ``[gears.NAME]``."""
BEARINGS: Mapping[str, type[Element]] = MappingProxyType(
    {"stiffness": StiffnessBearing, "balls": BallBearing, "preload": AxialPreload}
)
"""Bearings, and what preloads them, by their ``kind`` in ``[bearings.NAME]``."""

SHAKES: Mapping[str, type[Element]] = MappingProxyType(
    {"sine": SineShake, "sweep": SweepShake, "random": RandomShake, "table": TableShake}
)
"""Motions of a shaken base by their ``kind`` in ``[shake.NAME]``."""
FORCES: Mapping[str, type[ForceElement]] = MappingProxyType(
    {
        "force": OutsideForce,
        "thruster": Thruster,
        "gravity-gradient": GravityGradient,
    }
)
"""What acts on links by its ``kind`` in ``[forces.NAME]``."""

FAMILIES: Mapping[str, Family] = MappingProxyType(
    {
        "drives": Family("drive", DRIVES),
        "springs": Family("spring", SPRINGS, "spring"),
        "stops": Family("stop", STOPS, "compliant"),
        "latches": Family("latch", LATCHES, "compliant"),
        "frictions": Family("friction", FRICTIONS, "sticking"),
        "gears": Family("gear", GEARS, "gear"),
        "bearings": Family("bearing", BEARINGS),
        "shake": Family("shake", SHAKES, among="drives"),
        "forces": Family("force", FORCES, in_python=(CallableElement, CallableForce)),
    }
)
"""Families by the table ``[FAMILY.NAME]`` that a scenario has for each; the order is that of programs."""

ELEMENTS: tuple[type[ForceElement], ...] = (
    *DRIVES.values(),
    CallableDrive,
    CallableMotion,
    *(cls for table, family in FAMILIES.items() if table != "drives" for cls in family.kinds.values()),
    *(cls for family in FAMILIES.values() for cls in family.in_python),
)
"""All elements there are; Python has some that a scenario has not."""

# Blocks of a program with lower numbers are joints.
_FIRST_KIND = 10


def kind_of(element: type[ForceElement]) -> int:
    """Return the number of a kind of element in programs and kernels."""
    if element not in ELEMENTS:
        raise UnknownNameError("System", "kind of element", element.__name__, [e.__name__ for e in ELEMENTS])
    return _FIRST_KIND + ELEMENTS.index(element)
