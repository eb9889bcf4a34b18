"""The size of a step: what its error allows, what must not be stepped over, and when a run is given up."""

from __future__ import annotations

import math
from collections.abc import Iterable

from antenna_pin.dynamics import System
from antenna_pin.elements import ForceElement
from antenna_pin.integrate import Method
from antenna_pin.settings import RunSettings
from antenna_pin.trajectory import Outcome

__all__ = ["StepControl"]

_SAFETY = 0.9
_SHRINK = 0.2
_GROW = 6.0
_LARGEST_TURN = 2.0  # [rad] of a joint in one step: an angle's whole turns are counted from step to step
_PACE_STEPS = 50_000  # trial steps from one look at the pace to the next: a burst of impacts takes fewer


class StepControl:
    """What decides how long the next step is.

    Args:
        system: Its drives say where steps must end, and how long they may be.
        method: Of integration.
        settings: How to integrate.
        begin: From when on the run records [s].
        end: Where it ends [s].

    Attributes:
        spin: Fastest rate of a joint that turns without end, at the present state [rad/s].
        sizes: Step sizes by pattern of touching contacts: impacts of one kind need steps of one size [s].
    """

    def __init__(
        self, system: System, method: Method, settings: RunSettings, begin: float, end: float
    ) -> None:
        """Collect the instants at which steps must end."""
        self.settings = settings
        self.method = method
        self.end = end
        self.spin = 0.0
        self.sizes: dict[bytes, float] = {}
        elements = (*system.drives.values(), *system.springs.values())
        self._breaks: list[float] = []
        self.end_at({t for element in elements for t in element.instants})
        self.renew(elements)
        self._paced = (0, begin)

    def end_at(self, instants: Iterable[float]) -> None:
        """Let steps end at further instants [s]."""
        self._breaks = sorted({*self._breaks, *(t for t in instants if 0.0 < t < self.end)})

    def renew(self, elements: Iterable[ForceElement]) -> None:
        """Look how long a step may be with elements that have changed."""
        self._longest = self.settings.max_step
        if self.method.adaptive:
            self._longest = min([self._longest, *(element.longest_step for element in elements)])

    @property
    def first(self) -> float:
        """Size of the first step to try [s]."""
        settings = self.settings
        if not self.method.adaptive:
            return settings.step
        if settings.first_step is not None:
            return min(settings.first_step, settings.max_step)
        return min(1e-6, settings.max_step, self.end)

    def cut(self, t: float, h: float) -> tuple[float, bool]:
        """Cut a step from t [s] to the longest allowed, to the next instant of a torque table, to the end.

        Returns:
            Its size [s], and whether the run's end has cut it.
        """
        h = min(h, self._longest)
        if h * self.spin > _LARGEST_TURN:
            h = _LARGEST_TURN / self.spin
        while self._breaks and self._breaks[0] <= t:
            self._breaks.pop(0)
        end = self._breaks[0] if self._breaks else self.end
        rest = end - t
        # Two equal steps rather than a sliver at the end.
        halved = self.method.adaptive and h > 0.5 * rest
        cut = (h >= rest or halved) and not self._breaks
        if h >= rest:
            return rest, cut
        return (0.5 * rest if halved else h), cut

    def following(self, wished: float, tried: float, error: float, rejected: bool) -> float:
        """Return the step to try after one that passed [s].

        Args:
            wished: What was to be tried [s].
            tried: What it was cut to, and passed [s].
            error: Its scaled error [-].
            rejected: Whether longer ones did not pass.
        """
        if not self.method.adaptive:
            return self.settings.step
        size = tried * (_GROW if error == 0.0 else min(_GROW, _SAFETY * math.pow(error, -1.0 / self._power)))
        if rejected:
            size = min(size, tried)
        if tried < wished:  # cut for the sake of an output or the end, not of the error
            size = max(size, wished)
        return size

    def shortened(self, tried: float, error: float) -> float:
        """Return the step to try after one with too large an error [s]."""
        if math.isfinite(error):
            return tried * max(_SHRINK, _SAFETY * math.pow(error, -1.0 / self._power))
        return tried * _SHRINK

    def hopeless(self, h: float) -> bool:
        """Whether a step shortened to h [s] is not to be tried."""
        return h < self.settings.min_step or not self.method.adaptive

    @property
    def _power(self) -> int:
        order = self.method.error_order
        return (self.method.order if order is None else order) + 1

    def limit(self, trials: int, t: float, wall: float) -> Outcome | None:
        """Return the limit that is reached, or that the run makes so little way that it would never end.

        Args:
            trials: Trial steps made so far.
            t: How far they went [s].
            wall: Wall time they took [s].
        """
        settings = self.settings
        if settings.max_steps is not None and trials >= settings.max_steps:
            return Outcome.STEP_LIMIT
        if settings.max_wall_time is not None and wall >= settings.max_wall_time:
            return Outcome.TIME_LIMIT
        return None if self._makes_way(trials, t) else Outcome.NO_PROGRESS

    def _makes_way(self, trials: int, t: float) -> bool:
        """Whether a run that has made so many trial steps up to t [s] may ever come to its end."""
        if trials - self._paced[0] < _PACE_STEPS:
            return True
        made, way = trials - self._paced[0], t - self._paced[1]
        self._paced = (trials, t)
        return made * (self.end - t) <= self.settings.max_expected_steps * way
