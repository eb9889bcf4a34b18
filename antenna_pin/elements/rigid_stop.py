"""A rigid end stop."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.elements.hook_kernels import Loaded
from antenna_pin.elements.limits import FREE, LOWER, UPPER, Limits, beyond
from antenna_pin.elements.modal import BLOW, Change, Met
from antenna_pin.errors import InvalidParameterError

# Beyond a stop by no more than this a joint is on it at the start [rad] ([m]); where an event was located by
# no more than that.
_ROUND_OFF, _LOCATED = 1e-11, 1e-10
# A rate that is round-off of one [rad/s] ([m/s]).
STILL = 1e-11

# Its function of the torque that holds it on a side.
LOADED = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidStop(Limits):
    r"""A rigid end stop: the joint rebounds at e times its rate, at once.

    .. math:: \dot\phi^+ = -e\, \dot\phi^-

    The blow is an impulse at the joint on both its sides: momentum is kept, and so is what is held elsewhere;
    what it takes of the energy is its loss. A joint slower than the rest rate comes to rest on the stop, held
    by a row that pushes only. A start beyond a limit is refused.

    Attributes:
        restitution: e, in [0, 1] [-].
        upper_restitution: e of the upper side, where it differs; None for the same [-].
        rest_rate: Rate below which a joint that comes no longer bounces [rad/s] ([m/s]).
    """

    kernels: ClassVar[str] = __name__
    loaded: ClassVar[tuple[int, ...]] = (2,)
    change_names: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "touch": ("bounces", "rests"),
        "rest": ("rests",),
        "lift-off": ("left",),
    }
    holds: ClassVar[bool] = True

    restitution: float = parameter(rule="in [0, 1]")
    upper_restitution: float | None = parameter(rule="in [0, 1]", default=None)
    rest_rate: float = parameter("rad/s", sliding="m/s", rule="positive", default=1e-3)
    on: bool = True

    def __post_init__(self) -> None:
        """Check limits and restitution."""
        Limits.__post_init__(self)
        self.check_upper(("restitution",))

    def initial_change(self, met: Met) -> Change | None:
        """Refuse a start beyond a stop; a start on it comes to rest there."""
        self._check("initial state", "start it there", met, _ROUND_OFF)
        return None

    def moved(self, key: str, met: Met) -> Change | None:
        """Refuse a joint beyond the stop; release one whose stop was moved away.

        The law of a rigid stop does not define the return of a joint from beyond.
        """
        if key not in ("on", "lower", "upper"):
            return None
        self._check("rigid stop", "set it while the joint is within", met, _LOCATED)
        limit = self.lowest if self.mode == LOWER else self.highest
        return Change(FREE) if self.mode != FREE and abs(met.angle - limit) > _LOCATED else None

    def _check(self, place: str, way_out: str, met: Met, margin: float) -> None:
        for name, excess in (("lower", self.lowest - met.angle), ("upper", met.angle - self.highest)):
            if excess > margin:
                at = f"{name} = {getattr(self, name):g}"
                rule = f"within its rigid stop, {at}; {way_out}, or move the stop"
                raise InvalidParameterError(place, f"position of {self.joint}", rule, met.angle)

    def in_another(self, met: Met) -> Change | None:
        """Refuse a position beyond a stop, as at a start; rest on it stays."""
        return self.initial_change(met) if self.mode == FREE else None

    def passed(self, k: int, met: Met) -> Change | None:
        """Return the rebound off side k, or the rest on it; none without approach."""
        if k == LOADED:
            return self.lets_go()
        side, approach = (LOWER, -met.rate) if k == 0 else (UPPER, met.rate)
        if self.mode != FREE or approach <= STILL:
            return None
        restitution = self.of_side("restitution", side)
        if restitution == 0.0 or approach <= self.rest_rate:
            return Change(side, f"{self.modes[side]}: rests", restitution=0.0, phase=BLOW)
        return Change(FREE, f"{self.modes[side]}: bounces", restitution=restitution, phase=BLOW)

    def change_said(self, before: int) -> str:
        """Return the record of a joint that comes to rest on a side, or leaves."""
        if self.mode == before:
            return ""
        return f"{self.modes[before]}: left" if self.mode == FREE else f"{self.modes[self.mode]}: rests"

    def rests(self, side: int) -> Change:
        """Return the change by which a joint that stands at a side rests on it."""
        return Change(side, f"{self.modes[side]}: rests")

    def lets_go(self) -> Change:
        """Return the change by which the joint that rests on it leaves it."""
        return Change(FREE, f"{self.modes[self.mode]}: left")

    @property
    def bears(self) -> tuple[float, float]:
        """A stop only pushes."""
        return (0.0, math.inf) if self.mode == LOWER else (-math.inf, 0.0)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        upper = (
            "" if self.upper_restitution is None else f", above {self.text_of('upper_restitution', slides)}"
        )
        restitution = self.text_of("restitution", slides)
        return f"rigid end stop {self.words_of_limits(slides)}, restitution {restitution}{upper}"


# --- compiled -----------------------------------------------------------------------------------------------


@kernel
def switch(stop: RigidStop, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: 0, 1 distance to a side and rate; 2 load [N m]."""
    if k < 2:
        return (
            beyond(stop.lowest, stop.highest, stop.mode, k, motion[1], motion[2])
            if stop.mode == FREE
            else (1.0, 0.0)
        )
    if stop.mode == FREE:
        return 1.0, 0.0
    return float(motion[3] if stop.mode == LOWER else -motion[3]), 0.0


@inlined
def hold(stop: RigidStop) -> tuple[bool, float]:
    """Return whether the joint rests on a side, and the position of the side."""
    return stop.mode != FREE, stop.highest if stop.mode == UPPER else stop.lowest
