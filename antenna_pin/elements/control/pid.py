"""Sampled PID controller."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from antenna_pin.base.arguments import check_takes, takes
from antenna_pin.base.parameters import check, parameter
from antenna_pin.elements.control.controller import Now, SampledController, limited
from antenna_pin.elements.control.measurement import Measure, Sensor
from antenna_pin.errors import InvalidParameterError

Course = Callable[[float], tuple[float, float, float]]
"""A reference over time [s]: value, rate and acceleration."""

# The rate of what is measured, where it can be measured itself.
_RATES = {"angle": "rate", "base-rotation": "base-rate"}


@dataclass
class PidState:
    """State of a PID controller.

    Attributes:
        begun: Whether it has been evaluated before.
        integral: Of the integrator, in the unit of its command.
        derivative: Its part of the command, filtered.
        error: At the sampling time before.
        measured: Likewise.
        command: Likewise, within its limits.
    """

    begun: bool = False
    integral: float = 0.0
    derivative: float = 0.0
    error: float = 0.0
    measured: float = 0.0
    command: float = 0.0


@takes()
@dataclass(frozen=True, kw_only=True)
class Pid(SampledController):
    r"""Sampled PID controller, in parallel form.

    .. math:: u_k = K_p e_k + I_k + D_k + f, \quad e_k = r_k - y_k

    The gains of the ideal form are :math:`K_i = K_p / T_i` and :math:`K_d = K_p T_d`. With the period h the
    integral grows by :math:`K_i h e_k` before it is used (``backward``), after it (``forward``), or by
    :math:`K_i h (e_k + e_{k-1}) / 2` before (``trapezoid``; at the first sampling time by nothing). The
    derivative, :math:`D_k = (T_f D_{k-1} + K_d \Delta_k) / (T_f + h)`, is of the error (:math:`\Delta_k = e_k
    - e_{k-1}`), of the measurement (:math:`y_{k-1} - y_k`), or that of the reference less the measured rate;
    of differences it is zero at the first sampling time.

    The sum is limited, first in its rate, then in size. While limits hold it, ``clamping`` leaves out what
    would make the integral push further; ``back-calculation`` adds :math:`(h / T_t)` times what the limits
    took away.

    Attributes:
        acts_on: Commanded drive, by name.
        measures: Measurement, as ``angle hinge``; by default the angle of the drive's joint.
        kp: K_p, command per measured unit, in SI units.
        ki: K_i, command per measured unit and second.
        kd: K_d, command per measured unit a second.
        derivative: Differentiated quantity.
        derivative_filter: T_f; 0 for none [s].
        integrator: Rule of integration.
        anti_windup: Treatment of the integral while limits hold the command.
        tracking_time: T_t [s].
        lower: Least command; none if not given.
        upper: Largest command; none if not given.
        slew: Largest change of the command a second [-]; None for no limit.
        reference: r, in the unit of what is measured; in Python also a function of time that gives value,
            rate and acceleration.
        feedforward: f: a constant part of the command.
        feedforward_rate: Part of the command per rate of the reference.
        feedforward_acceleration: Part of the command per acceleration of the reference.
        sensor: Of what is measured.
        rate_sensor: Of the rate, where that is measured too.
        state: Its memory.

    References:
        Astrom and Wittenmark: Computer-Controlled Systems, 3rd edition, Prentice Hall (1997), chapter 8.
    """

    acts_on: str
    measures: str = ""
    kp: float = parameter(default=0.0)
    ki: float = parameter(default=0.0)
    kd: float = parameter(default=0.0)
    derivative: Literal["measurement", "error", "rate"] = "measurement"
    derivative_filter: float = parameter("s", rule="zero or more", default=0.0)
    integrator: Literal["backward", "forward", "trapezoid"] = "backward"
    anti_windup: Literal["clamping", "back-calculation", "none"] = "clamping"
    tracking_time: float | None = parameter("s", rule="positive", default=None)
    lower: float | None = parameter(default=None)
    upper: float | None = parameter(default=None)
    slew: float | None = parameter(rule="positive", default=None)
    reference: float | Course = 0.0
    feedforward: float = parameter(default=0.0)
    feedforward_rate: float = parameter(default=0.0)
    feedforward_acceleration: float = parameter(default=0.0)
    sensor: Sensor = field(default_factory=Sensor)
    rate_sensor: Sensor = field(default_factory=Sensor)
    state: PidState = field(default_factory=PidState, repr=False)

    signals = ("measured", "reference", "saturated")

    def __post_init__(self) -> None:
        """Check the parameters together."""
        check(self)
        if callable(self.reference):
            check_takes(self, "reference", self.reference, "t")
        elif not math.isfinite(self.reference):
            raise InvalidParameterError(self, "reference", "finite", self.reference)
        if self.measures:
            self._check_derivative(Measure.read(self, "measures", self.measures))
        if not (self.kp or self.ki or self.kd):
            raise InvalidParameterError(self, "kp", "other than zero, or ki or kd", self.kp)
        if None not in (self.lower, self.upper) and not self.lower < self.upper:  # type: ignore[operator]
            raise InvalidParameterError(self, "upper", f"above lower = {self.lower:g}", self.upper)
        if (self.anti_windup == "back-calculation") != (self.tracking_time is not None):
            rule = 'given where anti_windup is "back-calculation", and only there'
            raise InvalidParameterError(self, "tracking_time", rule, self.tracking_time)

    def _check_derivative(self, measure: Measure) -> None:
        if self.derivative == "rate" and measure.kind not in _RATES:
            rule = f"measurement or error where it measures {str(measure)!r}, whose rate no sensor has"
            raise InvalidParameterError(self, "derivative", rule, self.derivative)

    @cached_property
    def measured(self) -> tuple[Measure, ...]:
        """Measured quantities; none where they default to the actuated joint."""
        if not self.measures:
            return ()
        found = Measure.read(self, "measures", self.measures)
        if self.derivative != "rate":
            return (found,)
        return found, Measure(_RATES[found.kind], found.name)

    def placed(self, joints: Mapping[str, str | None], axes: Mapping[str, Any]) -> Pid:
        """Return the controller with its default measurement, by the actuated joints."""
        if self.measures:
            return self
        joint = joints[self.acts_on]
        if joint is None:
            rule = f"given, as 'angle JOINT': {self.acts_on} acts at no joint"
            raise InvalidParameterError(self, "measures", rule, self.measures)
        return dataclasses.replace(self, measures=f"angle {joint}")

    def update(self, now: Now) -> Mapping[str, float]:
        """Return the command from now on."""
        state, h = self.state, self.period
        measure, *rates = self.measured
        measured = self.sensor.read(measure(now), now.tick)
        reference, rate, acceleration = (
            self.reference(now.time) if callable(self.reference) else (self.reference, 0.0, 0.0)
        )
        error = reference - measured
        if not state.begun:
            state.error, state.measured, state.command = error, measured, now.command(self.acts_on)
        if rates:
            state.derivative = self.kd * (rate - self.rate_sensor.read(rates[0](now), now.tick, 1))
        else:
            change = error - state.error if self.derivative == "error" else state.measured - measured
            state.derivative = (self.derivative_filter * state.derivative + self.kd * change) / (
                self.derivative_filter + h
            )
        fed = self.feedforward + self.feedforward_rate * rate + self.feedforward_acceleration * acceleration
        wished, command = self._integrated(error, self.kp * error + state.derivative + fed)
        state.begun, state.error, state.measured, state.command = True, error, measured, command
        now.note(measured=measured, reference=reference, saturated=float(command != wished))
        return {self.acts_on: command}

    def _integrated(self, error: float, rest: float) -> tuple[float, float]:
        """Update the integral; return the command without and with limits."""
        state, h = self.state, self.period
        grows = self.ki * h * error
        if self.integrator == "trapezoid":
            grows = 0.5 * self.ki * h * (error + state.error) if state.begun else 0.0
        after = self.integrator == "forward"
        wished = rest + state.integral + (0.0 if after else grows)
        command = self._limited(wished)
        if self.anti_windup == "clamping" and grows * (wished - command) > 0.0:
            grows = 0.0
            wished = rest + state.integral
            command = self._limited(wished)
        state.integral += grows
        if self.tracking_time is not None:
            state.integral += h / self.tracking_time * (command - wished)
        return wished, command

    def _limited(self, wished: float) -> float:
        step = None if self.slew is None else self.slew * self.period
        return limited(wished, self.state.command, step, (self.lower, self.upper))

    def words(self) -> str:
        """Return a description."""
        gains = ", ".join(
            f"{name} {getattr(self, name):g}" for name in ("kp", "ki", "kd") if getattr(self, name)
        )
        return f"PID of {self.measures or 'its joint'}, {gains}"
