"""A rigid end stop, from which a joint bounces, or on which it rests."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from antenna_pin.elements.modal import Change, Met, Modal
from antenna_pin.errors import InvalidParameterError
from antenna_pin.parameters import parameter

__all__ = ["RigidStop"]

_SIDES = ("lower", "upper")
# Beyond a stop by no more than this a joint is on it: at the start, and where a hop is not told from rest
# [rad] ([m]).
_ROUND_OFF, _HOP = 1e-11, 1e-10


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidStop(Modal):
    r"""A rigid end stop: an impulse on both sides reverses the joint's rate, times the restitution.

    .. math:: \dot\phi^+ = -e \dot\phi^-

    with what is held elsewhere kept held, and all momentum kept. A joint that comes slower than ``rest_rate``
    comes to rest on the stop and is held, by a torque that pushes only: it leaves when that would have to
    pull.

    Attributes:
        lower: Least angle [rad] ([m]); None for no stop on that side.
        upper: Greatest angle [rad] ([m]); None for no stop on that side.
        restitution: e, at most 1 [-].
        rest_rate: Rate below which a joint that comes no longer bounces [rad/s] ([m/s]).
        on: Whether it is there from the start on; an event may switch it.
    """

    kernels: ClassVar[str] = "rigid_stop_kernels"
    modes: ClassVar[tuple[str, ...]] = ("free", "lower", "upper")
    switches: ClassVar[int] = 3
    loaded: ClassVar[tuple[int, ...]] = (2,)
    holds: ClassVar[bool] = True

    lower: float | None = parameter("rad", sliding="m", default=None)
    upper: float | None = parameter("rad", sliding="m", default=None)
    restitution: float = parameter(rule="zero or more", default=0.5)
    rest_rate: float = parameter("rad/s", sliding="m/s", rule="positive", default=1e-3)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the parameters together."""
        Modal.__post_init__(self)
        if self.lower is None and self.upper is None:
            raise InvalidParameterError(self, "upper", "given, or lower", None)
        if self.lower is not None and self.upper is not None and not self.lower < self.upper:
            raise InvalidParameterError(self, "upper", f"above lower = {self.lower:g}", self.upper)
        if not self.restitution <= 1.0:
            raise InvalidParameterError(self, "restitution", "at most 1", self.restitution)

    def values(self) -> dict[str, Any]:
        """Return its numbers, by the names that its record has for them."""
        return {
            "lower": -math.inf if self.lower is None else self.lower,
            "upper": math.inf if self.upper is None else self.upper,
            "mode": self.mode,
        }

    def first(self, met: Met) -> Change | None:
        """Refuse a start beyond a stop."""
        for name, beyond in (("lower", -1.0), ("upper", 1.0)):
            limit = getattr(self, name)
            if limit is not None and beyond * (met.angle - limit) > _ROUND_OFF:
                rule = f"within its rigid stop, {name} = {limit:g}; start it there, or move the stop"
                raise InvalidParameterError("initial state", f"position of {self.joint}", rule, met.angle)
        return None

    def passed(self, k: int, met: Met) -> Change | None:
        """Bounce, come to rest, or leave."""
        if k == 2:
            return Change(0, f"{self.modes[self.mode]}: left")
        side, approach = (2, met.rate) if k == 0 else (1, -met.rate)
        limit = self.upper if k == 0 else self.lower
        # What leaves and is back already hops lower than angles are known, and rests.
        if approach < 0.0 and limit is not None and abs(met.angle - limit) > _HOP:
            return None
        if self.restitution == 0.0 or approach <= self.rest_rate:
            return Change(side, f"{self.modes[side]}: rests")
        return Change(0, f"{self.modes[side]}: bounces", restitution=self.restitution)

    def bears(self, impulse: float) -> Change | None:
        """Let go of a joint that an impulse elsewhere takes off the stop."""
        pulls = impulse < 0.0 if self.mode == 1 else impulse > 0.0
        return Change(0, f"{self.modes[self.mode]}: left") if pulls else None

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
        said = [f"{name} {self.said(name, slides)}" for name in _SIDES if getattr(self, name) is not None]
        return f"rigid stop, {', '.join(said)}, restitution {self.said('restitution', slides)}"
