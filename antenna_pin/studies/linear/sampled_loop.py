r"""Stability margins of a sampled control loop about an operating point.

The loop is opened at the command. With the plant :math:`x' = A x + B u`, :math:`y = C x`, a command that is
held for a period h and a delay :math:`d = m h + r`, :math:`0 \le r < h`, the response from commands to
measurements at the sampling times is exact:

.. math:: G(z) = C (z - \Phi)^{-1} (\Gamma_0 z^{-m} + \Gamma_1 z^{-m-1}), \quad \Phi = e^{A h}, \quad
          \Gamma_0 = \int_0^{h-r} e^{A s} ds\, B, \quad \Gamma_1 = e^{A (h-r)} \int_0^{r} e^{A s} ds\, B

and :math:`L(z) = C_{pid}(z) G(z)` on the unit circle, :math:`z = e^{i \omega h}`, is the loop's frequency
response, aliasing and hold included. Small motions exclude play, limits and sticking friction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array, Complex
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.merge import key_of
from antenna_pin.studies.linear.modal_analysis import modes
from antenna_pin.studies.linear.response import Plant, plant_of

# Frequencies of a response: points, and the lowest one as a share of half the sampling rate.
_POINTS, _LOWEST = 20_000, 1e-5
# Distance of roots z below which feedback counts as not moving one: the round-off of a double root.
_SAME = 1e-7


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SampledLoop:
    """Open loop at the sampling times, from commands to the controller's next command, sign reversed."""

    period: float  # h [s]
    matrix: Array  # phi of plant, delayed commands and controller, (n, n)
    input: Array  # column of the command, (n,)
    output: Array  # row of the loop's output, (n,)

    def response(self, frequency: Array) -> Complex:
        """Return the open loop's frequency response, (frequencies,) [-]; frequencies in Hz."""
        z = np.exp(2j * np.pi * np.asarray(frequency, dtype=float) * self.period)
        n = len(self.matrix)
        found = np.empty(len(z), dtype=complex)
        for first in range(0, len(z), 2000):
            part = z[first : first + 2000]
            systems = part[:, None, None] * np.eye(n) - self.matrix
            found[first : first + 2000] = (
                np.linalg.solve(systems, self.input[None, :, None])[:, :, 0] @ self.output
            )
        return found

    def closed_roots(self) -> Complex:
        """Return the roots z of the closed loop that the feedback moves [-]."""
        closed = self.matrix - np.outer(self.input, self.output)
        roots = np.asarray(np.linalg.eigvals(closed), dtype=complex)
        for old in np.linalg.eigvals(self.matrix):
            apart = np.abs(roots - old)
            if apart.size and apart.min() < _SAME:
                roots = np.delete(roots, int(apart.argmin()))
        return roots


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoopMargins:
    """Stability margins of a sampled loop, and its frequency response."""

    controller: str  # name of the controller
    # factor on the loop's gain at which it becomes unstable: the least above 1, or the inverse of the largest
    # below 1, whichever is smaller [-]; infinite without one
    gain_margin: float
    phase_margin: float  # least phase lag that makes the loop unstable [rad]; infinite without a gain of 1
    delay_margin: float  # least further delay that makes the loop unstable [s]
    modulus_margin: float  # least distance of the response from -1 [-]
    loop_damping: float  # least damping ratio of the closed loop's vibrations [-]
    bandwidth: float  # highest frequency with a gain of 1 [Hz]; NaN without one
    stable: bool  # true if the closed loop is stable
    frequency: Array  # frequencies of the response [Hz]
    response: Complex  # open loop's frequency response [-]


@takes()
def margins_of(loop: SampledLoop, name: str = "loop") -> LoopMargins:
    """Return the margins of a sampled loop; those of an unstable one are 0."""
    half = 0.5 / loop.period
    frequency = np.geomspace(_LOWEST * half, half * (1.0 - 1e-9), _POINTS)
    response = loop.response(frequency)
    roots = loop.closed_roots()
    stable = bool(np.abs(roots).max(initial=0.0) < 1.0)
    damping = _least_damping(roots, loop.period)
    gain = _gain_margin(response)
    phase, at, band = _phase_margin(frequency, response)
    delay = phase / (2.0 * math.pi * at) if math.isfinite(phase) else math.inf
    modulus = float(np.abs(1.0 + response).min())
    if not stable:
        gain = phase = delay = modulus = 0.0
    return LoopMargins(
        controller=name, gain_margin=gain, phase_margin=phase, delay_margin=delay, modulus_margin=modulus,
        loop_damping=damping, bandwidth=band, stable=stable, frequency=frequency, response=response,
    )  # fmt: skip


def _least_damping(roots: Complex, period: float) -> float:
    """Return the least damping ratio of sampled roots."""
    some = np.abs(roots) > 1e-12
    s = np.log(roots[some]) / period
    vibrates = np.abs(s.imag) > 1e-9 * np.abs(s) + 1e-12
    if not vibrates.any():
        return 1.0
    return float((-s.real[vibrates] / np.abs(s[vibrates])).min())


def _gain_margin(response: Complex) -> float:
    """Return the least factor, above 1 or inverted below, to a response of -1."""
    real, imag = response.real, response.imag
    at = np.flatnonzero((imag[:-1] < 0.0) != (imag[1:] < 0.0))
    share = imag[at] / (imag[at] - imag[at + 1])
    crossings = real[at] + share * (real[at + 1] - real[at])
    # The ends of the circle are real themselves: half the sampling rate.
    crossings = np.append(crossings, real[-1])
    factors = [1.0 / -one for one in crossings if one < 0.0]
    return min((max(one, 1.0 / one) for one in factors), default=math.inf)


def _phase_margin(frequency: Array, response: Complex) -> tuple[float, float, float]:
    """Return least phase margin [rad], its frequency and the highest crossing [Hz]."""
    size = np.log(np.abs(response))
    at = np.flatnonzero((size[:-1] < 0.0) != (size[1:] < 0.0))
    if not at.size:
        return math.inf, math.nan, math.nan
    share = size[at] / (size[at] - size[at + 1])
    turn = np.unwrap(np.angle(response))
    phase = turn[at] + share * (turn[at + 1] - turn[at])
    places = frequency[at] * (frequency[at + 1] / frequency[at]) ** share
    margins = np.mod(phase + math.pi, 2.0 * math.pi)
    k = int(margins.argmin())
    return float(margins[k]), float(places[k]), float(places[-1])


@takes()
def loop_margins(scenario: Scenario, controller: str | None = None) -> LoopMargins:
    """Return the margins of a PID loop about the start of a scenario.

    Other controllers' commands are held at their start values. Coulomb friction of ``[springs]`` counts as
    constant, as in moving joints: regularised, it would damp a joint at rest too much.

    Args:
        scenario: The scenario.
        controller: Name of its PID controller; optional if there is only one.

    Raises:
        UnknownNameError: The controller is unknown.
        InvalidParameterError: The controller is not a PID of a joint's angle that commands a drive, or its
            motor has an inductance.
    """
    known = [name for name, table in scenario.controllers.items() if table.kind == "pid"]
    if controller is None and len(known) == 1:
        controller = known[0]
    if controller not in known:
        raise UnknownNameError("loop margins", "pid controller", controller or "any", known)
    table = scenario.controllers[controller]
    made: Any = table.build()
    drive = made.acts_on.removeprefix("drives.").removesuffix(".value")
    if drive not in scenario.drives:
        raise InvalidParameterError("loop margins", f"{controller}.acts_on", "a drive", made.acts_on)
    joint = _joint_of(made, scenario.drives[drive])
    small = modes(_slipping(scenario))
    factor = _effort_per_command(small, drive)
    plant = plant_of(small, drive, joint)
    return margins_of(_sampled(plant, factor, made), controller)


def _slipping(scenario: Scenario) -> Scenario:
    """Return a scenario without the Coulomb part of friction elements."""
    rubs = [
        key_of(("springs", name, "friction"))
        for name, one in scenario.springs.items()
        if one.kind == "friction" and one.friction
    ]
    return scenario.with_overrides(dict.fromkeys(rubs, 0.0)) if rubs else scenario


def _joint_of(controller: Any, drive: Any) -> str:
    if not controller.measures:
        return str(drive.joint)
    kind, _, name = controller.measures.partition(" ")
    if kind != "angle":
        raise InvalidParameterError("loop margins", "measures", "the angle of a joint", controller.measures)
    return str(name)


def _effort_per_command(small: Any, name: str) -> float:
    """Return the effort of a drive per unit of its command [N m or N]."""
    drive = small.linearisation.system.drives[name]
    kind = type(drive).__name__
    if kind == "ConstantDrive":
        return 1.0
    if kind != "Motor":
        raise InvalidParameterError("loop margins", f"drives.{name}", "a constant drive or a motor", kind)
    if drive.inductance > 0.0:
        rule = "zero for margins of small motions, which have no currents of their own; run the loop instead"
        raise InvalidParameterError("loop margins", f"drives.{name}.inductance", rule, drive.inductance)
    per = drive.torque_constant * drive.ratio
    return float(per if drive.mode == "current" else per / drive.resistance)


def _integral(matrix: Array, column: Array, span: float) -> tuple[Array, Array]:
    """Return exp(A t), and the integral of exp(A s) B over a span."""
    from scipy.linalg import expm

    n = len(matrix)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n] = matrix * span, column * span
    made = expm(whole)
    return made[:n, :n], made[:n, n]


def _sampled(plant: Plant, factor: float, pid: Any) -> SampledLoop:
    """Return the open loop of a plant and a PID; states: plant, delayed commands, PID."""
    h = pid.period
    delay = pid.delay + pid.delay_periods * h
    whole = int(math.floor(delay / h + 1e-9))
    rest = max(delay - whole * h, 0.0)
    b = factor * plant.input
    phi, _ = _integral(plant.matrix, b, h)
    late, now = _integral(plant.matrix, b, h - rest)
    _, before = _integral(plant.matrix, b, rest)
    old = late @ before
    n, held = len(phi), whole + 1
    # States: x, then commands of the last 1, 2, ..., whole + 1 periods.
    size = n + held
    matrix, column = np.zeros((size, size)), np.zeros(size)
    matrix[:n, :n] = phi
    if whole == 0:
        column[:n] = now
        matrix[:n, n] = old
    else:
        matrix[:n, n + whole - 1] = now
        matrix[:n, n + whole] = old
    column[n] = 1.0
    for k in range(1, held):
        matrix[n + k, n + k - 1] = 1.0
    angle, rate = np.zeros(size), np.zeros(size)
    angle[:n], rate[:n] = plant.angle, plant.rate
    return _with_pid(pid, h, matrix, column, angle, rate)


def _with_pid(pid: Any, h: float, matrix: Array, column: Array, angle: Array, rate: Array) -> SampledLoop:
    """Return a plant in series with a PID.

    States of the PID: the integral before the sampling time, the measurement before, and the derivative's.
    The output is minus the command for a zero reference: the loop closes by u = -output.
    """
    n = len(matrix)
    integral, last, derived = n, n + 1, n + 2
    whole, enters = np.zeros((n + 3, n + 3)), np.zeros(n + 3)
    whole[:n, :n], enters[:n] = matrix, column
    y, w = np.zeros(n + 3), np.zeros(n + 3)
    y[:n], w[:n] = angle, rate
    unit = np.eye(n + 3)
    before = unit[integral]
    grows = {
        "backward": pid.ki * h * y,
        "forward": pid.ki * h * y,
        "trapezoid": 0.5 * pid.ki * h * (y + unit[last]),
    }[pid.integrator]
    used = before if pid.integrator == "forward" else before + grows
    if pid.derivative == "rate":
        slope = pid.kd * w
    else:
        filtered = pid.derivative_filter * unit[derived] + pid.kd * (y - unit[last])
        slope = filtered / (pid.derivative_filter + h)
    whole[integral], whole[last], whole[derived] = before + grows, y, slope
    return SampledLoop(period=h, matrix=whole, input=enters, output=pid.kp * y + used + slope)
