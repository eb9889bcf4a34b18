"""Settings of integration and sampling, and scales of errors."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from antenna_pin.base.capacity import MOST
from antenna_pin.base.parameters import check, parameter
from antenna_pin.errors import InvalidParameterError

# Below, the error of a step is round-off, and no step is short enough.
_LEAST_RTOL = 1e-15
# Of a run, in floors of a step and in distances of neighbouring times: less is round-off.
_FLOORS, _ULPS = 10.0, 1000.0
# Beyond, samples of the smallest mechanism take tens of gigabytes.

Method = Literal["rk4", "bogacki-shampine-32", "dormand-prince-54", "dormand-prince-853", "radau5"]
"""A Runge-Kutta method by name, of ``antenna_pin.integrate.METHODS``."""


Engine = Literal["pinocchio", "compiled"]
"""What makes the steps of a run."""

# From which accuracy on order 5 takes fewer evaluations than order 8, and how the tolerance of steps follows
# from the error of a run (docs/performance.md, work and precision): steps across the onset of a force are of
# a lower order than the others, so that errors of impulses fall more slowly than the tolerance does.
_ORDER_5_FROM = 1e-6
_PARTS, _SHARE, _POWER, _LARGEST_RTOL = 1000.0, 0.2, 1.5, 1e-3
_ACCURACIES = (1e-10, 1e-1)


def choice_for(accuracy: float) -> tuple[Method, float]:
    """Return the method and the tolerance that reach an accuracy with the fewest evaluations.

    Args:
        accuracy: Wanted relative error of a motion, of impulses and of the largest forces [-].
    """
    method: Method = "dormand-prince-54" if accuracy >= _ORDER_5_FROM else "dormand-prince-853"
    return method, min(max(accuracy / _PARTS, _SHARE * accuracy**_POWER), _LARGEST_RTOL)


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorScales:
    """Error scales of each kind of quantity: step error below rtol (scale + ``|value|``).

    Clearances of fractions of a millimetre and satellites of tonnes need different scales. At a clearance
    joint positions are measured in clearances. Scales of a free base are multiplied by ``base``; left out,
    that is the mass of the other bodies over the whole mass, so that errors weigh alike as momentum.

    Attributes:
        position: [m].
        angle: [rad].
        velocity: [m/s].
        angular_velocity: [rad/s].
        clearance: Position scale of a joint with play, in plays [-]; of the tilt, that over half the
            bearing's length. On ball bearings the play counts as 0.1 mm, the half length as 10 mm.
        clearance_velocity: Velocity scale of a joint with play; over half the length for the tilt's rate
            [m/s].
        base: Factor on the scales of a free base [-]; None for the mass of the other bodies over the whole
            mass.
    """

    position: float = parameter("m", rule="positive", default=1.0)
    angle: float = parameter("rad", rule="positive", default=1.0)
    velocity: float = parameter("m/s", rule="positive", default=1.0)
    angular_velocity: float = parameter("rad/s", rule="positive", default=1.0)
    clearance: float = parameter("1", rule="positive", default=1.0)
    clearance_velocity: float = parameter("m/s", rule="positive", default=0.01)
    base: float | None = parameter("1", rule="positive", default=None)

    def __post_init__(self) -> None:
        """Check the scales."""
        check(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSettings:
    """Settings of integration and sampling.

    Attributes:
        engine: ``pinocchio``, or ``compiled``: whole steps in compiled code, for systems without functions in
            Python.
        method: A Runge-Kutta method; ``radau5`` is implicit, for stiff contact.
        rtol: Relative tolerance of a step of the adaptive methods [-].
        accuracy: Relative error of motion, impulses and largest forces, which selects ``method`` and
            ``rtol`` [-]; None if they are given.
        step: Fixed step of ``rk4`` [s].
        max_step: Longest step [s].
        min_step: Least step, below which a run ends [s].
        first_step: First trial step [s]; None to choose it.
        max_steps: Trial steps in all after which a run ends; None for no limit [-].
        max_wall_time: Wall time after which a run ends [s]; None for no limit.
        max_expected_steps: Largest number of trial steps expected to the end, above which a run ends [-].
        ledger_tolerance: Error of the energy balance, relative to the largest gross work, kinetic or stored
            energy, beyond which a run ends as ``LEDGER_OPEN``; that of a momentum that is kept likewise [-].
            None for the error explained by ``rtol``, 1e-3 with fixed steps.
        ledger_alarm: Whether a run whose ledger does not close ends as ``LEDGER_OPEN``.
        scales: Scales to which the tolerance is relative.
        output_rate: Sample rate, in addition to samples at events [Hz].
        output_times: Times of further samples, ascending [s].
        output_form: ``full``, or ``lean`` without series: a result of numbers and contact episodes only.
        output_keep: Quantities that a lean result must have, by name; without any that is a peak at samples
            or a number of the ledger, the run is sampled for its balance only. None for all.
    """

    engine: Engine = "pinocchio"
    method: Method = "dormand-prince-853"
    rtol: float = parameter("1", rule="between 0 and 1", default=1e-8)
    accuracy: float | None = parameter("1", rule="between 0 and 1", default=None)
    step: float = parameter("s", rule="positive", default=1e-5)
    max_step: float = parameter("s", rule="positive", default=1e-2)
    min_step: float = parameter("s", rule="positive", default=1e-14)
    first_step: float | None = parameter("s", rule="positive", default=None)
    max_steps: int | None = parameter("1", rule="1 or more", default=None)
    max_wall_time: float | None = parameter("s", rule="positive", default=None)
    max_expected_steps: float = parameter("1", rule="positive", default=1e9)
    ledger_tolerance: float | None = parameter("1", rule="positive", default=None)
    ledger_alarm: bool = True
    scales: ErrorScales = field(default_factory=ErrorScales)
    output_rate: float = parameter("Hz", rule="positive", default=1000.0)
    output_times: tuple[float, ...] = parameter("s", rule="zero or more", sizes=(0,), default=())
    output_form: Literal["full", "lean"] = "full"
    output_keep: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        """Check the settings, and choose what the accuracy does."""
        check(self)
        if self.accuracy is not None:
            self._choose(self.accuracy)
        if not isinstance(self.scales, ErrorScales):
            raise InvalidParameterError(self, "scales", "an ErrorScales", type(self.scales).__name__)
        if self.output_keep is not None and self.output_form != "lean":
            rule = 'left out with form = "full", which has all quantities; or set form to "lean"'
            raise InvalidParameterError(self, "output_keep", rule, said=", ".join(self.output_keep))
        if self.rtol < _LEAST_RTOL:
            rule = f"{_LEAST_RTOL:g} or more, because a lower value is below round-off"
            raise InvalidParameterError(self, "rtol", rule, said=f"{self.rtol:g}")
        for k in np.flatnonzero(np.diff(self.output_times) <= 0.0)[:1].tolist():
            said = f"{self.output_times[k + 1]:g} s after {self.output_times[k]:g} s"
            raise InvalidParameterError(self, f"output_times[{k + 1}]", "above the one before", said=said)
        if not self.min_step < self.max_step:
            raise InvalidParameterError(
                self, "min_step", f"below max_step = {self.max_step:g} s", said=f"{self.min_step:g} s"
            )
        if self.first_step is not None and not self.min_step <= self.first_step <= self.max_step:
            rule = f"from min_step = {self.min_step:g} s to max_step = {self.max_step:g} s"
            raise InvalidParameterError(self, "first_step", rule, said=f"{self.first_step:g} s")

    def _choose(self, accuracy: float) -> None:
        """Set method and tolerance."""
        least, most = _ACCURACIES
        if not least <= accuracy <= most:
            rule = f"from {least:g} to {most:g}; for what lies beyond set method and rtol"
            raise InvalidParameterError(self, "accuracy", rule, said=f"{accuracy:g}")
        for name, chosen in zip(("method", "rtol"), choice_for(accuracy), strict=True):
            given = getattr(self, name)
            if given not in (chosen, type(self).__dataclass_fields__[name].default):
                rule = f"left out with accuracy = {accuracy:g}, which chooses it"
                raise InvalidParameterError(self, name, rule, given)
            object.__setattr__(self, name, chosen)

    def shortest_at(self, time: float) -> float:
        """Return the shortest span of more than one least step from a time on [s]."""
        return max(_FLOORS * self.min_step, _ULPS * math.ulp(time))

    def check_long_enough(self, place: object, name: str, span: float, time: float) -> None:
        """Refuse a span that steps cannot make.

        Args:
            place: Owner, for the message.
            name: Its name.
            span: [s].
            time: Start of the span [s].
        """
        least = self.shortest_at(time)
        if not least <= span < math.inf:
            rule = (
                f"finite and {least:.3g} s or more, from t = {time:.6g} s on: {_FLOORS:g} times "
                f"integrator.min_step, and {_ULPS:g} times what times there are apart at least"
            )
            raise InvalidParameterError(place, name, rule, said=f"{span:.6g} s")

    def check_span(self, begin: float, end: float) -> None:
        """Refuse steps and samples for which a run would never end, or outgrow memory.

        Args:
            begin: Start of the run [s].
            end: End of the run [s].
        """
        span = end - begin
        self.check_long_enough(self, "duration", span, begin)
        name = "step" if self.method == "rk4" else "max_step"
        step: float = getattr(self, name)
        unlimited = self.max_steps is None and self.max_wall_time is None
        least = span / self.max_expected_steps if unlimited else 0.0
        if step < max(least, math.ulp(end)):
            told = "integrator.max_expected_steps" if step < least else "round-off of the time"
            rule = f"{max(least, math.ulp(end)):.3g} s or more in a run of {span:g} s, for {told}"
            raise InvalidParameterError(self, name, rule, said=f"{step:g} s")
        if self.output_times and self.output_times[-1] > end:
            rule = f"at most {end:g} s, the end of the run"
            raise InvalidParameterError(self, "output_times", rule, said=f"{self.output_times[-1]:g} s")
        if span * self.output_rate > MOST:
            rule = f"{MOST / span:.3g} Hz or less in a run of {span:g} s, for {MOST:g} samples"
            raise InvalidParameterError(self, "output_rate", rule, said=f"{self.output_rate:g} Hz")
