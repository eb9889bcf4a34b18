"""Force elements by the names of scenarios.

A kind is registered by a line here.

A family is a table of a scenario: ``FAMILIES`` names it, and scenario, overrides, events that set, words and
reference follow.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from antenna_pin.base.lazy import Classes
from antenna_pin.errors import UnknownNameError

if TYPE_CHECKING:
    from antenna_pin.elements.element import ForceElement

    ELEMENTS: tuple[type[ForceElement], ...]

_ROOM = "antenna_pin.elements"


class Family(NamedTuple):
    """Elements of one table of a scenario.

    Attributes:
        word: One of them, as messages call it.
        kinds: Their classes by ``kind``.
        default: The kind of a table at a joint that names none; None where each must.
        between: The kind of a table with ``first`` and ``second`` that names none; None where each must.
        among: The family that a system has its elements among, if it has none of its own of them.
        in_python: Further classes by name, which only Python has.
    """

    word: str
    kinds: Classes
    default: str | None = None
    between: str | None = None
    among: str | None = None
    in_python: Classes = Classes(_ROOM, {})

    def has(self, element: object) -> bool:
        """Return whether an element is of the family, without loading the family's other classes."""
        return _name_of(type(element)) in (*self.kinds.places.values(), *self.in_python.places.values())


DRIVES = Classes(
    _ROOM,
    {
        "constant": "constant.ConstantDrive",
        "sine": "sine.SineDrive",
        "table": "tabulated.TableDrive",
        "pd": "pd.PDController",
        "motion": "prescribed.PrescribedMotion",
        "distance": "distance.DistanceMotion",
        "motor": "motor.Motor",
    },
)
"""Drives by their ``kind`` in ``[drives.NAME]``."""

SPRINGS = Classes(
    _ROOM,
    {
        "spring": "spring.JointSpring",
        "friction": "joint_friction.JointFriction",
        "between-points": "point_spring.PointSpring",
        "bouc-wen": "bouc_wen.BoucWen",
        "maxwell-slip": "maxwell_slip.MaxwellSlip",
        "constant-torque": "constant_spring.ConstantSpring",
        "table": "angle_table.TableSpring",
        "harness": "harness.HarnessSpring",
    },
)
"""What stores and loses energy by its ``kind`` in ``[springs.NAME]``."""

STOPS = Classes(_ROOM, {"compliant": "stop.EndStop", "rigid": "rigid_stop.RigidStop"})
"""End stops by their ``kind`` in ``[stops.NAME]``."""

LATCHES = Classes(_ROOM, {"compliant": "latch.Latch", "rigid": "rigid_latch.RigidLatch"})
"""Latches by their ``kind`` in ``[latches.NAME]``."""

FRICTIONS = Classes(
    _ROOM,
    {
        "sticking": "sticking_friction.StickingFriction",
        "dahl": "bristle_friction.DahlFriction",
        "lugre": "bristle_friction.LuGreFriction",
        "gonthier-bristle": "bristle_friction.GonthierFriction",
    },
)
"""Friction of joints by its ``kind`` in ``[frictions.NAME]``."""
GEARS = Classes(
    _ROOM,
    {
        "gear": "mesh.Gear",
        "spline": "mesh.Spline",
        "rack": "mesh.Rack",
        "belt": "belt.Belt",
        "cable": "belt.Cable",
    },
)
"""What goes from one joint to another by its ``kind`` in ``[gears.NAME]``."""
BEARINGS = Classes(
    _ROOM,
    {
        "stiffness": "bearing.StiffnessBearing",
        "balls": "ball_bearing.BallBearing",
        "preload": "bearing.AxialPreload",
    },
)
"""Bearings, and what preloads them, by their ``kind`` in ``[bearings.NAME]``."""

SHAKES = Classes(
    _ROOM,
    {
        "sine": "shake.SineShake",
        "sweep": "shake.SweepShake",
        "random": "random_shake.RandomShake",
        "table": "shaken_table.TableShake",
    },
)
"""Motions of a shaken base by their ``kind`` in ``[shake.NAME]``."""
FORCES = Classes(
    _ROOM,
    {
        "force": "outside_force.OutsideForce",
        "thruster": "thruster.Thruster",
        "gravity-gradient": "gravity_gradient.GravityGradient",
    },
)
"""What acts on links by its ``kind`` in ``[forces.NAME]``."""

_FORCES_IN_PYTHON = Classes(
    _ROOM,
    {"CallableElement": "given_links.CallableElement", "CallableForce": "given_links.CallableForce"},
)

FAMILIES: Mapping[str, Family] = MappingProxyType(
    {
        "drives": Family("drive", DRIVES),
        "springs": Family("spring", SPRINGS, "spring", between="between-points"),
        "stops": Family("stop", STOPS, "compliant"),
        "latches": Family("latch", LATCHES, "compliant"),
        "frictions": Family("friction", FRICTIONS, "sticking"),
        "gears": Family("gear", GEARS, "gear"),
        "bearings": Family("bearing", BEARINGS),
        "shake": Family("shake", SHAKES, among="drives"),
        "forces": Family("force", FORCES, in_python=_FORCES_IN_PYTHON),
    }
)
"""Families by the table ``[FAMILY.NAME]`` that a scenario has for each; the order is that of programs."""

# Python has some that a scenario has not.
_ALL = (
    DRIVES,
    Classes(_ROOM, {"CallableDrive": "given.CallableDrive", "CallableMotion": "given_motion.CallableMotion"}),
    *(family.kinds for table, family in FAMILIES.items() if table != "drives"),
    *(family.in_python for family in FAMILIES.values()),
)

# Blocks of a program with lower numbers are joints.
_NUMBERS = {name: 10 + k for k, name in enumerate(name for one in _ALL for name in one.places.values())}


def __getattr__(name: str) -> Any:
    """Return ``ELEMENTS``, all classes of elements, for listings and compilation."""
    if name == "ELEMENTS":
        return tuple(cls for one in _ALL for cls in one.values())
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def _name_of(cls: type[Any]) -> str:
    return f"{cls.__module__}.{cls.__qualname__}"


def kind_of(element: type[ForceElement]) -> int:
    """Return the number of a kind of element in programs and kernels."""
    if _name_of(element) not in _NUMBERS:
        known = [name.rpartition(".")[2] for name in _NUMBERS]
        raise UnknownNameError("System", "kind of element", element.__name__, known)
    return _NUMBERS[_name_of(element)]


def element_of(kind: int) -> type[ForceElement] | None:
    """Return the element of a number in programs; None if no kind has the number."""
    places = [(one, name) for one in _ALL for name in one]
    return places[kind - 10][0][places[kind - 10][1]] if 0 <= kind - 10 < len(places) else None
