"""Base of gears and belts: sides in contact between two joints, and their releases."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from antenna_pin.elements.element import IMPULSE, LOSS, ForceElement, Integral
from antenna_pin.elements.mesh_kernels import APART, BOTH, BOTH_WAYS, MINUS, PLUS, TURNS, TWO
from antenna_pin.elements.modal import Change, Met, Modal
from antenna_pin.errors import InvalidParameterError

__all__ = [
    "BetweenJoints",
    "Flanks",
]

# --- elements between two joints ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class BetweenJoints(ForceElement):
    """Base of the elements between two joints, by a deflection of both positions.

    Such an element is one at a joint whose angle is its deflection, ``x(input, output)``: its kernels
    ``effort``, ``stored`` and ``kink`` are given x and its rate. The effort is along x: at each joint it acts
    times the derivative of x over that joint's position, with the reaction on the joint's own parent.
    Besides there are

    - ``between(words, at, angle, rate, other, other_rate)``: x, its rate, and its derivatives over the
      positions of the input and of the output;
    - ``dissipation(words, at, x, rate)``: the power that it takes by its deflection [W];
    - if there is friction beside it ``drag(words, at, torque, rate)``: the torque on the input, against its
      rate, where the element gives it a torque.

    Attributes:
        input: Name of the joint on the driving side.
        output: Name of the joint on the driven side.
    """

    integrals: ClassVar[tuple[Integral, ...]] = (LOSS, IMPULSE)
    # Whether its deflection is a way [m] and its effort a force [N]; else they are an angle and a torque.
    along: ClassVar[bool] = False
    # Whether its input and its output are to slide; what else to take where they do not as they are to.
    slide: ClassVar[tuple[bool, bool]] = (False, False)
    instead: ClassVar[str] = 'kind "rack" from a pinion to what it moves, or a coupling'

    input: str
    output: str

    def __post_init__(self) -> None:
        """Check the parameters, and that there are two joints."""
        ForceElement.__post_init__(self)
        if self.input == self.output:
            raise InvalidParameterError(self, "output", "another joint than the input", self.output)

    def between_said(self) -> str:
        """Return between which joints it is, in words."""
        return f"from {self.input} to {self.output}"

    def check_joints(self, place: str, slides: tuple[bool, bool]) -> None:
        """Refuse joints between which it cannot act.

        Args:
            place: Its name, for the message.
            slides: Whether input and output slide along their axes rather than turning about them.
        """
        for key, name, seen, wanted in zip(
            ("input", "output"), (self.input, self.output), slides, self.slide, strict=True
        ):
            if seen != wanted:
                does, is_to = ("slides", "turns") if seen else ("turns", "slides")
                rule = f"a joint that {is_to}, and {name!r} {does}; take {self.instead}"
                raise InvalidParameterError(place, key, rule, name)


# --- flanks and strands -------------------------------------------------------------------------------------

_SIDES = {PLUS: "plus", MINUS: "minus"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Flanks(Modal, BetweenJoints):
    """Base of meshes and strands: a side on either sign of the deflection.

    Its modes say which are in contact. They change at located instants, so that steps end there and touches
    are known; its torque is a function of deflection and rate alone, whatever they say. In a touch of one
    side there is one instant more that is located, where the deflection turns back: between touch, turn and
    release the damper comes to its limit and off it once at most, so that no step goes over both.

    Attributes:
        mode: The number of the present one.
        turned: Whether it has turned back in the present touch, 0 or 1.
        lost: What it had lost before that [J].
        struck: Its impulse before that, by size [N*m*s] ([N*s]).
    """

    integrals: ClassVar[tuple[Integral, ...]] = (LOSS, IMPULSE)
    modes: ClassVar[tuple[str, ...]] = ("apart", "plus", "minus", "both")
    sides: ClassVar[tuple[str, ...]] = ("plus", "minus")
    change_names: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "touch": ("on", "taut"),
        "turn": ("turns",),
        "lift-off": ("off", "slack"),
    }
    switches: ClassVar[int] = 3
    remembers: ClassVar[tuple[str, ...]] = ("turned", "lost", "struck")
    # What is recorded of a side that comes into contact, and that leaves it.
    said_of_change: ClassVar[tuple[str, str]] = ("on", "off")

    mode: int = field(default=0, repr=False)
    turned: float = field(default=0.0, repr=False)
    lost: float = field(default=0.0, repr=False)
    struck: float = field(default=0.0, repr=False)

    @property
    def side_numbers(self) -> tuple[float, int]:
        """Deflection at which a side begins to act, and the number of springs."""
        raise NotImplementedError

    @property
    def shares(self) -> tuple[float, float]:
        """Derivatives a and -b of the deflection over the positions of input and output."""
        raise NotImplementedError

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields: a mesh without offset, friction and error."""
        (a, b), (room, springs) = self.shares, self.side_numbers
        found = {"a": a, "b": b, "room": room, "springs": springs, "rest": 0.0, "points": 0}
        return found | {"forward": 1.0, "backward": 1.0, "slow": 1.0}

    def words(self, slides: bool = False) -> str:
        """Return the description: the joints, then labels with numbers and units."""
        return ", ".join([self.between_said(), *self.said_of(self.labels, slides)])

    @property
    def ever_changes(self) -> bool:
        """Return whether the element has sides: without play it is one spring both ways."""
        return self.side_numbers[1] != BOTH_WAYS

    def initial_change(self, met: Met) -> Change | None:
        """Return which sides are in contact where both joints are."""
        room, springs = self.side_numbers
        if springs == BOTH_WAYS:
            return None
        mode = APART
        for side, depth, rate in ((PLUS, met.angle + room, met.rate), (MINUS, room - met.angle, -met.rate)):
            if (side == PLUS or springs == TWO) and (depth > 0.0 or (depth == 0.0 and rate > 0.0)):
                mode += side
        return self._in(mode, met) if mode != self.mode else None

    def armed(self, met: Met) -> Change | None:
        """Return which sides are in contact when it is switched on."""
        return self.initial_change(met)

    def passed(self, k: int, met: Met) -> Change:
        """Bring side k into contact or out of it, or turn back in contact."""
        if k == TURNS:
            return Change(self.mode, f"{_SIDES[self.mode]}: turns", {"turned": 1.0})
        side = PLUS if k == 0 else MINUS
        on, off = self.said_of_change
        if not self.mode & side:
            return self._in(self.mode | side, met, f"{_SIDES[side]}: {on}")
        what = f"{_SIDES[side]}: {off}"
        if self.mode != side:
            return self._in(self.mode & ~side, met, what)
        lost, struck = met.integrals
        sign = -1.0 if side == PLUS else 1.0
        impulse = sign * (struck - self.struck)
        return Change(APART, what, {"turned": 0.0}, loss=lost - self.lost, impulse=impulse)

    def _in(self, mode: int, met: Met, what: str = "") -> Change:
        """Return the change to a mode with a side in contact, or none."""
        into = met.rate if mode == PLUS else -met.rate
        lost, struck = met.integrals or (0.0, 0.0)
        memory = {"turned": float(mode in (APART, BOTH) or into <= 0.0), "lost": lost, "struck": struck}
        return Change(mode, what, memory)

    def facts(self) -> dict[str, float]:
        """Return the deflections beyond which its sides act, and its shares of the two positions."""
        room, springs = self.side_numbers
        found = dict(zip("ab", map(float, self.shares), strict=True))
        if springs != BOTH_WAYS:
            found["plus"] = -room
        if springs == TWO:
            found["minus"] = room
        return found
