"""Base of gears and belts: sides in contact between two joints, and their releases."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.elements.curve_kernels import curve
from antenna_pin.elements.element import IMPULSE, LOSS, ForceElement, Integral, packed
from antenna_pin.elements.hook_kernels import Loaded
from antenna_pin.elements.modal import Change, Met, Modal
from antenna_pin.errors import InvalidParameterError

# --- elements between two joints ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class BetweenJoints(ForceElement):
    """Base of the elements between two joints, by a deflection of both positions.

    Such an element is one at a joint whose angle is its deflection, ``x(input, output)``: its kernels
    ``effort``, ``stored`` and ``kink`` are given x and its rate. The effort is along x: at each joint it acts
    times the derivative of x over that joint's position, with the reaction on the joint's own parent.
    Besides there are

    - ``between``: x, its rate, and its derivatives over the positions of the input and of the output;
    - ``dissipation``: the power that it takes by its deflection [W];
    - if there is friction beside it ``drag``: the torque on the input, against its rate, where the element
      gives it a torque.

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

# Springs: 1 on the side of a positive deflection, 2 on both sides, 0 one that acts both ways, without room.
BOTH_WAYS, TWO = 0, 2
# Modes: which sides are in contact, each a bit.
APART, PLUS, MINUS, BOTH = range(4)
_SIDES = {PLUS: "plus", MINUS: "minus"}
# The function that passes zero where the deflection turns back, once in a touch of one side.
TURNS = 2


class Sprung(ForceElement):
    """Base of what pushes by a spring and a damper."""

    # The fields are those of the classes that declare them, with their units and meanings.
    __slots__ = ()

    stiffness: float
    damping: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Flanks(Modal, Sprung, BetweenJoints):
    """Base of meshes and strands: a side on either sign of the deflection.

    The deflection is ``x = a input - b output - rest - e(input)``, with e a periodic curve. On the one side a
    spring is compressed by ``x + room``, on the other by ``-x + room``: a negative room is half the play
    between the flanks of teeth, a positive one the stretch at which strands were fitted. A spring pushes
    (pulls) one way only; its damper adds at most as much as the spring gives, so that the sum starts and ends
    at zero.

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

    kernels: ClassVar[str] = __name__
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

    @packed
    def room(self) -> float:
        """Minus half the play, or the stretch at fitting [rad] ([m])."""
        raise NotImplementedError

    @packed
    def springs(self) -> int:
        """Number of springs: 1, TWO or BOTH_WAYS."""
        raise NotImplementedError

    @packed
    def shares(self) -> tuple[float, float]:
        """Derivatives a and -b of the deflection over the positions of input and output."""
        raise NotImplementedError

    @packed
    def rest(self) -> float:
        """Deflection that is none [rad] ([m])."""
        return 0.0

    @packed
    def efficiency(self) -> float:
        """Share of the power that arrives where the input drives."""
        return 1.0

    @packed
    def efficiency_back(self) -> float:
        """Share of the power that arrives where the output drives."""
        return 1.0

    @packed
    def slow_rate(self) -> float:
        """Rate of the input where friction is 71 % of its limit [rad/s]."""
        return 1.0

    @packed
    def points(self) -> int:
        """Number of points of the error's curve over one period, behind the record."""
        return 0

    def words(self, slides: bool = False) -> str:
        """Return the description: the joints, then labels with numbers and units."""
        return ", ".join([self.between_said(), *self.said_of(self.labels, slides)])

    @property
    def ever_changes(self) -> bool:
        """Return whether the element has sides: without play it is one spring both ways."""
        return self.springs != BOTH_WAYS

    def initial_change(self, met: Met) -> Change | None:
        """Return which sides are in contact where both joints are."""
        room, springs = self.room, self.springs
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
        room, springs = self.room, self.springs
        found = dict(zip("ab", map(float, self.shares), strict=True))
        if springs != BOTH_WAYS:
            found["plus"] = -room
        if springs == TWO:
            found["minus"] = room
        return found


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def _pushes(mesh: Flanks, depth: float, rate: float) -> tuple[float, float]:
    """Return the forces of spring and damper on one side, from compression and rate."""
    if depth <= 0.0:
        return 0.0, 0.0
    elastic = mesh.stiffness * depth
    return elastic, min(max(mesh.damping * rate, -elastic), elastic)


@inlined
def _forces(mesh: Flanks, x: float, rate: float) -> tuple[float, float]:
    """Force against the deflection: that of springs, and that of dampers."""
    if mesh.springs == BOTH_WAYS:
        return mesh.stiffness * x, mesh.damping * rate
    elastic, damped = _pushes(mesh, x + mesh.room, rate)
    if mesh.springs == TWO:
        other, more = _pushes(mesh, mesh.room - x, -rate)
        elastic -= other
        damped -= more
    return elastic, damped


@kernel
def between(
    mesh: Flanks, tail: Floats, angle: float, rate: float, other: float, other_rate: float
) -> tuple[float, float, float, float]:
    """Deflection, its rate, and its derivatives over the angles of input and output."""
    slope, b = mesh.shares[0], mesh.shares[1]
    x = slope * angle - b * other - mesh.rest
    if mesh.points > 0:
        first = tail[0]
        period = tail[mesh.points - 1] - first
        turned = angle - first
        turned -= period * math.floor(turned / period)
        error, steep = curve(tail, 0, mesh.points, first + turned)
        x -= error
        slope -= steep
    return float(x), float(slope * rate - b * other_rate), float(slope), float(-b)


@kernel
def effort(mesh: Flanks, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N], along the deflection."""
    elastic, damped = _forces(mesh, angle, rate)
    return float(-elastic - damped)


@inlined
def dissipation(mesh: Flanks, x: float, rate: float) -> float:
    """Power that its dampers take [W]."""
    _, damped = _forces(mesh, x, rate)
    return float(damped * rate)


@kernel
def drag(mesh: Flanks, torque: float, rate: float) -> float:
    """Return the friction torque on the input, by its mesh torque and rate [N m].

    Driving (torque against the rate) the input gives 1 / efficiency of what the mesh takes, driven it gets
    ``efficiency_back`` of what the mesh gives; near rest the share is rounded off.
    """
    if mesh.efficiency == 1.0 and mesh.efficiency_back == 1.0:
        return 0.0
    share = rate / math.sqrt(rate * rate + mesh.slow_rate * mesh.slow_rate)
    driving = 1.0 / mesh.efficiency - 1.0 if torque * rate < 0.0 else 1.0 - mesh.efficiency_back
    return float(-abs(torque) * driving * share)


@kernel
def stored(mesh: Flanks, angle: float) -> float:
    """Energy stored [J]."""
    if mesh.springs == BOTH_WAYS:
        return float(0.5 * mesh.stiffness * angle * angle)
    depth = max(angle + mesh.room, 0.0)
    other = max(mesh.room - angle, 0.0) if mesh.springs == TWO else 0.0
    return float(0.5 * mesh.stiffness * (depth * depth + other * other))


@kernel
def switch(mesh: Flanks, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k with its rate: 0, 1 gap of plus, minus; 2 closing rate."""
    x, rate = motion[1], motion[2]
    if mesh.springs == BOTH_WAYS or (k == 1 and mesh.springs != TWO):
        return 1.0, 0.0
    if k == TURNS:
        if mesh.turned != 0.0 or (mesh.mode != PLUS and mesh.mode != MINUS):
            return 1.0, 0.0
        return (rate if mesh.mode == PLUS else -rate), 0.0
    side, way = (PLUS, 1.0) if k == 0 else (MINUS, -1.0)
    depth, speed = way * x + mesh.room, way * rate
    if mesh.mode & side:
        return float(depth), float(speed)
    return float(-depth), float(-speed)


@kernel
def kink(mesh: Flanks, t: float, angle: float, rate: float) -> float:
    """Return a function that passes zero at a damper's limit; negative at it.

    Of each side in contact what the spring gives beyond its damper; a touch begins and ends at the limit.
    """
    limit = mesh.damping * abs(rate)
    plus = mesh.stiffness * (angle + mesh.room) - limit
    minus = mesh.stiffness * (mesh.room - angle) - limit
    if mesh.mode == BOTH:
        return float(plus * minus)
    if mesh.mode == APART:
        return -1.0
    return float(plus if mesh.mode == PLUS else minus)
