"""The size of a step: what its error allows, what must not be stepped over, and when a run is given up."""

from __future__ import annotations

from collections.abc import Iterable

from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import Workspace
from antenna_pin.elements import ForceElement
from antenna_pin.engine import Pace, Sizes
from antenna_pin.integrate import Method
from antenna_pin.trajectory import Outcome

__all__ = ["StepControl"]

_PACE_STEPS = 50_000  # trial steps from one look at the pace to the next: a burst of impacts takes fewer


class StepControl:
    """What decides how long the next step is.

    Args:
        workspace: Drives of its system say where steps must end, and how long they may be.
        method: Of integration.
        settings: How to integrate.
        begin: From when on the run records [s].
        end: Where it ends [s].

    Attributes:
        sizes: Step sizes by pattern of touching contacts: impacts of one kind need steps of one size [s].
    """

    def __init__(
        self, workspace: Workspace, method: Method, settings: RunSettings, begin: float, end: float
    ) -> None:
        """Collect the instants at which steps must end."""
        self.settings = settings
        self.method = method
        self.end = end
        order = method.order if method.error_order is None else method.error_order
        #: The sizes of steps, in numbers.
        self.pace = Pace(
            adaptive=method.adaptive,
            power=order + 1,
            control=method.control,
            step=settings.step,
            least=settings.min_step,
            end=end,
        )
        self.sizes = Sizes(workspace.memory)
        system = workspace.system
        elements = [element for family in system.families.values() for element in family.values()]
        self.end_at({t for element in elements for t in element.instants})
        self.renew(elements)
        #: Trial steps and time [s] where the pace was last looked at.
        self.paced = (0, begin)

    def end_at(self, instants: Iterable[float]) -> None:
        """Let steps end at further instants [s]."""
        self.pace.end_at(instants)

    def end_next_at(self, here: float, instant: float) -> None:
        """Let a step end at the next instant of the run's controllers, for steps that begin here [s]."""
        self.pace.end_next_at(here, instant)

    def move_end(self, end: float) -> None:
        """Let the run end at another time [s]."""
        self.end = end
        self.pace.move_end(end)

    def renew(self, elements: Iterable[ForceElement]) -> None:
        """Look how long a step may be with elements that have changed."""
        longest = self.settings.max_step
        if self.method.adaptive:
            longest = min([longest, *(element.longest_step for element in elements)])
        self.pace.numbers["longest"] = longest

    @property
    def spin(self) -> float:
        """Fastest rate of a joint that turns without end, at the present state [rad/s]."""
        return float(self.pace.numbers["spin"][0])

    @spin.setter
    def spin(self, rate: float) -> None:
        self.pace.numbers["spin"] = rate

    @property
    def error(self) -> float:
        """Scaled error of the last step that passed [-]; zero before the first."""
        return float(self.pace.numbers["error"][0])

    @error.setter
    def error(self, value: float) -> None:
        self.pace.numbers["error"] = value

    @property
    def first(self) -> float:
        """Size of the first step to try [s]."""
        settings = self.settings
        if not self.method.adaptive:
            return settings.step
        if settings.first_step is not None:
            return min(settings.first_step, settings.max_step)
        return min(1e-6, settings.max_step, self.end)

    def limit(self, trials: int, t: float, wall: float) -> Outcome | None:
        """Return the limit that is reached, or that the run makes so little way that it would never end.

        Args:
            trials: Trial steps made so far.
            t: How far they went [s].
            wall: Wall time since the run was begun, or gone on with [s].
        """
        settings = self.settings
        if settings.max_steps is not None and trials >= settings.max_steps:
            return Outcome.STEP_LIMIT
        if settings.max_wall_time is not None and wall >= settings.max_wall_time:
            return Outcome.TIME_LIMIT
        return None if self._makes_way(trials, t) else Outcome.NO_PROGRESS

    def until_look(self, trials: int) -> int:
        """Return how many trial steps more may be made until :meth:`limit` must be asked."""
        most = self.settings.max_steps
        until = self.paced[0] + _PACE_STEPS - trials
        return until if most is None else min(until, most - trials)

    def _makes_way(self, trials: int, t: float) -> bool:
        """Whether a run that has made so many trial steps up to t [s] may ever come to its end."""
        if trials - self.paced[0] < _PACE_STEPS:
            return True
        made, way = trials - self.paced[0], t - self.paced[1]
        self.paced = (trials, t)
        return made * (self.end - t) <= self.settings.max_expected_steps * way
