"""Elements with modes, which change at located events, as at a stop.

Beside the kernels of any element these have ``switch`` and ``mode``, and if they hold their joint ``hold``
(:class:`antenna_pin.elements.hook_kernels.Hooks`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import ClassVar, Literal, NamedTuple

from antenna_pin.elements.element import LOSS, Element, ForceElement, Integral

Remembered = Literal["way", "rate"]
"""Of what of its joint an element remembers a number."""

# Order of changes at one instant: captures, blows, and all others.
CAPTURE, BLOW, AFTER = 0, 1, 2

_NOTHING: Mapping[str, float] = MappingProxyType({})
_NOTHING_KEPT: Mapping[str, Remembered] = MappingProxyType({})


class Met(NamedTuple):
    """State of an element's joint at a zero of one of its functions.

    Attributes:
        t: Time [s].
        angle: Of the joint, with whole turns [rad] ([m]).
        rate: Of the joint [rad/s] ([m/s]).
        load: Torque of its row on the child, 0 where it holds nothing [N m] ([N]).
        integrals: Its integrals so far, in their order.
        inertia: Reduced inertia about the joint's axis of what is on both its sides [kg m^2] ([kg]), for
            elements that need it (``weighs``), else 0.
    """

    t: float
    angle: float
    rate: float
    load: float
    integrals: tuple[float, ...] = ()
    inertia: float = 0.0

    @property
    def energy(self) -> float:
        """Kinetic energy of the joint's own motion [J], lost in a lock."""
        return 0.5 * self.inertia * self.rate * self.rate


class Change(NamedTuple):
    """A change of mode.

    Attributes:
        mode: The next mode.
        what: Recorded description, such as ``upper: on``; "" for none.
        memory: Further numbers that it changes, by the names of fields.
        restitution: e of an impulse at the joint, after which its rate is -e times that before; None where
            there is none. A joint that is held from now on comes to rest by itself.
        switches_off: Places of elements that are off from now on.
        loss: Energy lost in the mode that ends, to be recorded [J]; without that of an impulse.
        impulse: Impulse on the child in the mode that ends, to be recorded [N m s] ([N s]); likewise.
        phase: CAPTURE, BLOW or AFTER: of changes at one instant those of the earliest phase are made
            together, and the others are evaluated again afterwards.
    """

    mode: int
    what: str = ""
    memory: Mapping[str, float] = _NOTHING
    restitution: float | None = None
    switches_off: tuple[str, ...] = ()
    loss: float = 0.0
    impulse: float = 0.0
    phase: int = AFTER


class Modal(ForceElement):
    """Base of the elements with modes, wherever they act.

    Their field ``mode`` is the number of the present one. What an element between two joints meets is its
    deflection and the rate of that.
    """

    # The field is that of the classes that declare it.
    __slots__ = ()

    mode: int

    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)

    # Names of the modes; how many functions change them, and which of these ask for the load.
    modes: ClassVar[tuple[str, ...]]
    switches: ClassVar[int]
    loaded: ClassVar[tuple[int, ...]] = ()
    # Whether it meets its joint's reduced inertia, and the energy of its motion is told.
    weighs: ClassVar[bool] = False
    # Fields beside ``mode`` that changes of mode write; whether it holds its joint in some mode.
    remembers: ClassVar[tuple[str, ...]] = ()
    holds: ClassVar[bool] = False
    # Of what it remembers what its motion goes by later, which stands in its record (or tail) as it is: of
    # neighbours each has its own. And the modes in which it does.
    goes_by: ClassVar[Mapping[str, Remembered]] = _NOTHING_KEPT
    goes_by_in: ClassVar[tuple[int, ...]] = ()
    # Changes that an event may be about, with what is recorded of each behind its side, and the sides.
    change_names: ClassVar[Mapping[str, tuple[str, ...]]] = MappingProxyType({})
    sides: ClassVar[tuple[str, ...]] = ()
    # Whether it is dry friction: what sticks and what slips is decided of all of them together.
    together: ClassVar[bool] = False

    @property
    def ever_changes(self) -> bool:
        """Return whether the element has more than one mode."""
        return True

    @property
    def weighed(self) -> tuple[int, ...]:
        """Return the functions that need the joint's reduced inertia."""
        return ()

    @property
    def has_row(self) -> bool:
        """Return whether the element has a row among constraints, to hold its joint."""
        return self.holds

    def initial_change(self, met: Met) -> Change | None:
        """Return the mode at the start, None for the present one; without impulse."""
        return None

    def first_off(self, met: Met) -> Change | None:
        """Return the memory at the start of an element switched off; None for none."""
        return None

    def in_another(self, met: Met) -> Change | None:
        """Return the mode where parameters or position have been changed; None: the present one.

        Raises:
            InvalidParameterError: It cannot.
        """
        return None

    def facts(self) -> dict[str, float]:
        """Return numbers that readers of a result may draw, by name."""
        return {}

    def armed(self, met: Met) -> Change | None:
        """Return what it remembers of a joint when it is switched on; None for nothing."""
        return None

    def moved(self, key: str, met: Met) -> Change | None:
        """Return the change of mode after a parameter was set; None for none.

        Raises:
            InvalidParameterError: The position of the joint forbids it.
        """
        return self.armed(met) if key == "on" else None

    def passed(self, k: int, met: Met) -> Change | None:
        """Return what happens where function k passes zero, by logic; None if nothing does."""
        raise NotImplementedError

    def change_said(self, before: int) -> str:
        """Return the record of a mode decided jointly, with that before; "" for none."""
        return ""

    @property
    def bears(self) -> tuple[float, float]:
        """Least and greatest impulse of its row on the child [N m s] ([N s])."""
        return -math.inf, math.inf

    def lets_go(self) -> Change | None:
        """Return the change where its row no longer holds; None without such a mode."""
        return None

    @classmethod
    def is_change(cls, name: str, side: str | None, what: str) -> bool:
        """Return whether a recorded change is the named one, on a given side."""
        at, _, said = what.rpartition(": ")
        return said.startswith(cls.change_names[name]) and side in (None, at)

    @classmethod
    def own_keys(cls) -> tuple[str, ...]:
        """Return the fields that no scenario writes."""
        return ("mode", *cls.remembers)


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalElement(Modal, Element):
    """Base of the elements with modes at one joint.

    Attributes:
        mode: The number of the present one.
    """

    mode: int = field(default=0, repr=False)
