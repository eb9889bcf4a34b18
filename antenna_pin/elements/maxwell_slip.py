"""Springs that slip, side by side: hysteresis after Maxwell."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.curve import check_as_many
from antenna_pin.elements.element import Element, packed
from antenna_pin.elements.hook_kernels import Loaded, Own, Powered
from antenna_pin.elements.modal import Change, Met, ModalElement, Remembered
from antenna_pin.errors import InvalidParameterError

_MOST = 8
# Share of its reach at which one that is bent slips: what round-off leaves.
_AT = 1.0 - 1e-9
_ANCHORS = tuple(f"anchor_{k}" for k in range(1, _MOST + 1))
# Modes: none slips; some slip, or did last, as the angle grows, or as it falls.
HELD, UP = range(2)
# Share of its reach by which one is bent further before its mode follows: one that has just been let go is
# not told from one that slips. The torque is right either way; of the loss as large a share is left out.
_SLACK = 1e-11


class Slipping(Record):
    """A spring; they stand behind the element's record."""

    stiffness: float  # [N m/rad] ([N/m])
    reach: float  # deflection at which it slips [rad] ([m])
    anchor: float  # [rad] ([m])


_SLIPPING = layout(Slipping)
_EACH = words_of(_SLIPPING)


@dataclass(frozen=True, slots=True, kw_only=True)
class MaxwellSlip(ModalElement):
    r"""Springs in parallel, each with its own slip torque: hysteresis after Maxwell.

    .. math:: \tau = -\sum_i k_i z_i, \quad z_i = \phi - a_i \text{ within } \pm s_i / k_i

    An anchor :math:`a_i` stays where it is until its spring has its slip torque, and is dragged along until
    the joint turns back. Only the way counts; at rest nothing creeps. Steps end where springs slip and turn
    back; the torque is exact between.

    Stored is :math:`\sum k_i z_i^2 / 2`; lost is what slip torques do on the way that anchors are dragged,
    in a cycle of amplitude X :math:`\sum 4 s_i (X - s_i / k_i)` of those that slip.

    Attributes:
        stiffness: Of each, k, at most 8 [N*m/rad] ([N/m]).
        slip: Torque at which each slips, s [N*m] ([N]).
        rest_angle: Angle at which all are unloaded at the start [rad] ([m]); None for that of the joint.

    References:
        Iwan, W. D.: A distributed-element model for hysteresis and its steady-state dynamic response. J.
        Applied Mechanics 33 (1966), 893-900.
    """

    kernels: ClassVar[str] = __name__
    unpacked: ClassVar[tuple[str, ...]] = ("on", *_ANCHORS)
    at_start: ClassVar[tuple[str, ...]] = ("rest_angle",)
    traced: ClassVar[bool] = True
    modes: ClassVar[tuple[str, ...]] = ("held", "up", "down")
    switches: ClassVar[int] = 3
    remembers: ClassVar[tuple[str, ...]] = (*_ANCHORS, "slips")
    goes_by: ClassVar[Mapping[str, Remembered]] = dict.fromkeys(_ANCHORS, "way")
    goes_by_in: ClassVar[tuple[int, ...]] = (0, 1, 2)

    stiffness: tuple[float, ...] = parameter("N*m/rad", sliding="N/m", rule="positive", sizes=(0,))
    slip: tuple[float, ...] = parameter("N*m", sliding="N", rule="positive", sizes=(0,))
    rest_angle: float | None = parameter("rad", sliding="m", default=None)
    on: bool = True
    anchor_1: float = field(default=0.0, repr=False)
    anchor_2: float = field(default=0.0, repr=False)
    anchor_3: float = field(default=0.0, repr=False)
    anchor_4: float = field(default=0.0, repr=False)
    anchor_5: float = field(default=0.0, repr=False)
    anchor_6: float = field(default=0.0, repr=False)
    anchor_7: float = field(default=0.0, repr=False)
    anchor_8: float = field(default=0.0, repr=False)
    slips: float = field(default=0.0, repr=False)

    def __post_init__(self) -> None:
        """Check that there are as many slip torques as springs."""
        Element.__post_init__(self)
        if not 1 <= len(self.stiffness) <= _MOST:
            rule = f"1 to {_MOST} numbers; put further ones into another spring of this kind at the joint"
            raise InvalidParameterError(self, "stiffness", rule, said=f"{len(self.stiffness)}")
        check_as_many(self, "stiffness", "slip")

    @property
    def has_kinks(self) -> bool:
        """Return the number of kinks: begins of slip."""
        return True

    @property
    def reaches(self) -> tuple[float, ...]:
        """By how much each is bent where it slips [rad] ([m])."""
        return tuple(s / k for s, k in zip(self.slip, self.stiffness, strict=True))

    @property
    def anchors(self) -> tuple[float, ...]:
        """Positions at which the springs are relaxed at present [rad] ([m])."""
        return tuple(getattr(self, name) for name in _ANCHORS[: len(self.stiffness)])

    @packed
    def count(self) -> int:
        """Number of springs."""
        return len(self.stiffness)

    def tail(self) -> tuple[float, ...]:
        """Return stiffness, reach and anchor of each."""
        each = zip(self.stiffness, self.reaches, self.anchors, strict=True)
        return tuple(number for one in each for number in one)

    def initial_change(self, met: Met) -> Change:
        """Return the bending of all springs from the rest angle, as far as they reach."""
        rest = met.angle if self.rest_angle is None else self.rest_angle
        return Change(0, memory=self._dragged((rest,) * len(self.slip), met.angle))

    def first_off(self, met: Met) -> Change:
        """Return the bending at the start, constant until the springs are switched on."""
        return self.initial_change(met)

    def in_another(self, met: Met) -> Change:
        """Drag the anchors of springs bent beyond their reach; none slips yet."""
        return Change(self.mode, memory={**self._dragged(self.anchors, met.angle), "slips": 0.0})

    def passed(self, k: int, met: Met) -> Change:
        """Return the change of slip: a spring begins, or the joint turns back.

        Where it turns back no anchor is dragged further.
        """
        if k == 1:
            return Change(3 - self.mode, memory={**self._dragged(self.anchors, met.angle), "slips": 0.0})
        bent = [met.angle - anchor for anchor in self.anchors]
        beyond = [abs(z) - reach for z, reach in zip(bent, self.reaches, strict=True)]
        mode = (
            self.mode if k == 2 else 3 - self.mode if self.mode else 1 + (bent[beyond.index(max(beyond))] < 0)
        )
        way = 1.0 if mode == 1 else -1.0
        slips = sum(
            2.0**i
            for i, (z, reach) in enumerate(zip(bent, self.reaches, strict=True))
            if way * z > _AT * reach
        )
        return Change(mode, memory={"slips": slips})

    def _dragged(self, anchors: tuple[float, ...], angle: float) -> dict[str, float]:
        return {
            name: angle - min(max(angle - anchor, -reach), reach)
            for name, anchor, reach in zip(_ANCHORS, anchors, self.reaches, strict=False)
        }

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        torques = ", ".join(f"{one:g}" for one in self.slip)
        stiff = sum(self.stiffness)
        units = self.unit("slip", slides), self.unit("stiffness", slides)
        many = f"{len(self.slip)} springs that slip" if len(self.slip) > 1 else "a spring that slips"
        return f"{many} at {torques} {units[0]}, stiffness {stiff:g} {units[1]} in all"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def _spring(tail: Floats, k: int) -> Slipping:
    """Return a spring."""
    return record(tail[_EACH * k : _EACH * (k + 1)], _SLIPPING)


@inlined
def _bent(one: Slipping, angle: float) -> float:
    """By how much one spring is bent, and at most can be."""
    return float(min(max(angle - one.anchor, -one.reach), one.reach))


@inlined
def effort(springs: MaxwellSlip, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    found = 0.0
    for k in range(springs.count):
        one = _spring(tail, k)
        found -= one.stiffness * _bent(one, angle)
    return found


@inlined
def write_rates_of(
    springs: MaxwellSlip, tail: Floats, motion: Powered, own: Own, rates: Floats, x: int
) -> None:
    """Return the power of the slipping springs [W].

    Which slip is a discrete state, for the power jumps where one begins to.
    """
    angle, rate, _ = motion
    found = 0.0
    for k in range(springs.count):
        one = _spring(tail, k)
        if int(springs.slips) & (1 << k):
            found += one.stiffness * _bent(one, angle) * rate
    rates[x] = found


@inlined
def stored(springs: MaxwellSlip, tail: Floats, angle: float) -> float:
    """Energy stored [J]."""
    found = 0.0
    for k in range(springs.count):
        one = _spring(tail, k)
        z = _bent(one, angle)
        found += 0.5 * one.stiffness * z * z
    return found


@inlined
def kink(springs: MaxwellSlip, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Return the product of margins to slip, zero where a spring begins to."""
    found = 1.0
    for k in range(springs.count):
        one = _spring(tail, k)
        found *= 1.0 - abs(angle - one.anchor) / one.reach
    return found


@inlined
def switch(springs: MaxwellSlip, tail: Floats, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: margin to slip, or the rate of slipping springs."""
    _, angle, rate, _ = motion
    way = 1.0 if springs.mode == UP else -1.0
    left, slope, slips, more = 1.0, 0.0, False, 1.0
    for i in range(springs.count):
        one = _spring(tail, i)
        bent, reach = angle - one.anchor, one.reach
        if springs.mode == HELD:
            back = -1.0 if bent > 0.0 else 1.0
        else:
            back = way
            # From half way on, well before it slips: where the joint turns back, nothing jumps that is seen.
            slips = slips or way * bent > 0.5 * reach
            if not int(springs.slips) & (1 << i):
                more = min(more, (1.0 + _SLACK) * reach - way * bent)
        own = (1.0 + _SLACK) * reach + back * bent
        if i == 0 or own < left:
            left, slope = own, back * rate
    if k == 0:
        return float(left), float(slope)
    if k == 2:
        return float(more), float(-way * rate) if more < 1.0 else 0.0
    if slips:
        return float(way * rate), 0.0
    return 1.0, 0.0
