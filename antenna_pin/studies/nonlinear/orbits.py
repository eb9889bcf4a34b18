"""Periodic orbits by shooting, with their Floquet multipliers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array, Complex
from antenna_pin.base.readable import brief
from antenna_pin.base.rules import AtLeastOne, Positive
from antenna_pin.base.state import State
from antenna_pin.base.views import Plotter, Reporter, View, as_html
from antenna_pin.dynamics import System
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.nonlinear.chart import Chart
from antenna_pin.studies.nonlinear.coordinates import own_coordinates
from antenna_pin.studies.nonlinear.flow import Flow, Tangent

# Relative singular values of (M - 1) below which a direction is neutral, with adjacent orbits: Newton's
# method takes no step along it.
_NEUTRAL = 1e-7
_HALVINGS = 6
# Size of a row of derivatives of a constant; default tolerance of orbits, over that of runs, and its least.
_HELD, _NEAR, _NEAREST = 1e-6, 10.0, 1e-9
# Least length of an orbit in tolerances.
_TELLS = 10.0


class NoOrbitError(AntennaPinError, RuntimeError):
    """Newton's method found no periodic solution; the message gives the distance reached."""


@dataclass(frozen=True, slots=True, eq=False)
class Orbit:
    """Periodic orbit.

    The approach speed of a lasting contact is constant. Where a contact lasts over the whole period, orbits
    come in families over that speed, of which this one has the start's, and a multiplier is 1 for it;
    stability is that at fixed speed. The same holds of element memory that is constant over a period, such as
    the place of a joint that sticks. A change of mode that brings a joint to rest removes a direction: a
    multiplier is 0.

    It shows itself: ``plot()``, its multipliers, and ``report("orbit.html")``.
    """

    __repr__ = brief

    start: State  # a state of the orbit
    period: float  # [s]
    residual: float  # distance between the ends of a period, in error scales [-]
    iterations: int  # newton's iterations
    # floquet multipliers, the largest first, (n,), without those that are 1 for constant memory of contacts
    # and elements. Their number does not depend on the start: directions that elements hold there have 0
    multipliers: Complex
    neutral: int  # number of multipliers left out [-]
    doubt: float  # error estimate of the multipliers [-]
    names: tuple[str, ...]  # names of the coordinates
    tangent: Array  # monodromy matrix, over one period, (coordinates, coordinates)
    # whether the period was found too, of an autonomous system; one multiplier, along the orbit, is 1 then
    free_period: bool
    # contacts that begin in a period, and events that happen, changes of mode among them
    onsets: tuple[int, int]
    system: System | None = field(default=None, repr=False)  # of the flow, which names the numbers
    # of the mechanism; None for a system built in Python
    scenario: Scenario | None = field(default=None, repr=False)

    plot = View[Plotter]()
    report = View[Reporter]()

    @property
    def stable(self) -> bool | None:
        """Return whether perturbed states approach; None where a multiplier's size is 1 within its error."""
        sizes = np.abs(self.multipliers)
        if self.free_period:
            sizes = np.delete(sizes, int(np.argmin(np.abs(self.multipliers - 1.0))))
        largest = float(sizes.max(initial=0.0))
        doubt = max(self.doubt, 1e-9)
        return None if abs(largest - 1.0) <= doubt else largest < 1.0

    @property
    def exponents(self) -> Array:
        """Floquet exponents, the real parts of the multipliers' logarithms over the period, (n,) [1/s]."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(np.abs(self.multipliers)) / self.period)

    def _repr_html_(self) -> str:
        """Show it in a notebook."""
        return as_html(self)


def changing_coordinates(chart: Chart, matrix: Array, free_period: bool = False) -> NDArray[np.bool_]:
    """Return which coordinates change over a period, (n,): all but lasting contact memory.

    Element memory over it is likewise left out, such as where a joint sticks that does not slip. Where a
    period is free a joint that slips, and sticks again where it did, is not told from that: it may be the way
    along the orbit.

    The matrix, (n, n), is the derivative of the map over the period, which is an unknown if ``free_period``.
    """
    rows = np.linalg.norm(matrix - np.eye(len(matrix)), axis=1)
    first = chart.size - len(chart.frame.contact_memory)
    remembered = enumerate(chart.frame.contact_memory, first)
    lasting = {contact for k, (contact, _) in remembered if rows[k] < _HELD}
    numbers = enumerate(chart.frame.element_memory, first - len(chart.frame.element_memory))
    may = set(chart.of_rates if free_period else chart.frame.element_memory)
    kept = may.intersection(one for k, one in numbers if rows[k] < _HELD)
    return own_coordinates(chart.frame, chart.size, lasting, kept)


def default_tolerance(flow: Flow) -> float:
    """Return the default distance between the ends of a period, in error scales [-]."""
    return max(_NEAR * flow.rtol, _NEAREST)


def _multipliers(tangent: Tangent, moves: NDArray[np.bool_], held_directions: int) -> tuple[Complex, float]:
    """Return multipliers and their error estimate, with ``held_directions`` zeros appended."""
    values, basis = np.linalg.eig(tangent.matrix[np.ix_(moves, moves)])
    values = values[np.argsort(-np.abs(values), kind="stable")].astype(complex)
    values[len(values) - min(tangent.lost, len(values)) :] = 0.0  # what is there is round-off
    values = np.append(values, np.zeros(held_directions))
    # To first order an eigenvalue changes by the matrix's error, times the condition of the eigenvectors.
    condition = float(np.linalg.cond(basis)) if len(basis) else 1.0
    return values, float(np.linalg.norm(tangent.doubt[moves])) * min(condition, 1e3)


def _newton_step(flow: Flow, start: State, tangent: Tangent, miss: Array, chart: Chart, free: bool) -> Array:
    """Return Newton's correction of coordinates, and of a free period, of least size.

    What lasting contacts remember stays as it is.
    """
    size = chart.size
    matrix = tangent.matrix - np.eye(size)
    matrix[:, ~changing_coordinates(chart, tangent.matrix, free)] = 0.0
    wanted = -miss
    if free:
        v, a = flow.rates(tangent.end)
        along = chart.directions(v, a)
        v, a = flow.rates(start)
        across = chart.directions(v, a)
        length = float(np.linalg.norm(across))
        if length == 0.0:
            raise NoOrbitError("periodic orbit: the start is at rest, and a state at rest has no period")
        matrix = np.block([[matrix, along[:, None] / length], [across[None, :] / length, np.zeros((1, 1))]])
        wanted = np.append(wanted, 0.0)
    largest = max(float(np.linalg.norm(matrix, 2)), _NEUTRAL)
    step = np.linalg.lstsq(matrix, wanted, rcond=_NEUTRAL * max(1.0, 1.0 / largest))[0]
    if free:
        step[-1] /= length
    return np.asarray(step)


@takes(period="s")
def periodic_orbit(
    flow: Flow,
    guess: State,
    period: float,
    *,
    free_period: bool = False,
    tolerance: Positive | None = None,
    iterations: AtLeastOne = 30,
    progress: Callable[[int, float], None] | None = None,
) -> Orbit:
    """Find a periodic solution near a guess, by shooting: Newton's method over a period.

    Args:
        flow: The flow.
        guess: A state near it. Contacts that touch in it touch at the start of the orbit.
        period: Its period, of a driven system that of the drive or a multiple [s]; a guess if free.
        free_period: Whether the period is to be found too.
        tolerance: Distance between the ends of a period that counts as none, in error scales; if left out ten
            times the tolerance of the flow's runs, and 1e-9 at least [-].
        iterations: Of Newton's method at most.
        progress: Called with the number of each iteration and the distance that it begins with.

    Raises:
        NoOrbitError: There is none so near that Newton's method finds it.
        NotAlikeError: After a period other contacts touch than before.
        FlowError: A run did not come to its end.
    """
    tolerance = default_tolerance(flow) if tolerance is None else tolerance
    flow.check_long_enough("periodic orbit", "period", period, guess.time)
    start, span, best = guess, period, math.inf
    for k in range(iterations + 1):
        chart = Chart(flow.system, start)
        miss = chart.coordinates(flow.after(start, span))
        best = float(np.linalg.norm(miss))
        if progress is not None:
            progress(k, best)
        if best <= tolerance or k == iterations:
            break
        tangent = flow.tangent(start, span, chart)
        step = _newton_step(flow, start, tangent, miss, chart, free_period)
        start, span = _damped_step(flow, chart, span, step, best, free_period)
    if not best <= tolerance:
        raise NoOrbitError(
            f"periodic orbit: after {iterations} iterations the ends of a period of {span:g} s are still "
            f"{best:.3g} error scales apart; begin nearer to it, after a longer transient, or with a "
            "multiple of the period"
        )
    _check_moves(flow, start, span, tolerance)
    return evaluate_orbit(flow, start, span, best, k, free_period)


def _check_moves(flow: Flow, start: State, span: float, tolerance: float) -> None:
    """Refuse a period in which the motion stays within the tolerance."""
    speed = float(np.linalg.norm(Chart(flow.system, start).directions(*flow.rates(start))))
    if speed > tolerance and speed * span < _TELLS * tolerance:
        raise NoOrbitError(
            f"periodic orbit: a period of {span:g} s is too short: the motion covers {speed * span:.3g} "
            f"error scales in it, and its ends count as one within {tolerance:.3g}; give "
            "a longer period"
        )


def evaluate_orbit(flow: Flow, start: State, period: float, residual: float, count: int, free: bool) -> Orbit:
    """Return an orbit with its multipliers from its start and period."""
    chart = Chart(flow.system, start)
    tangent = flow.tangent(start, period, chart)
    moves = changing_coordinates(chart, tangent.matrix, free)
    values, doubt = _multipliers(tangent, moves, chart.held_directions)
    way = flow.traverse(start, period)
    return Orbit(
        start=start,
        period=period,
        residual=residual,
        iterations=count,
        multipliers=values,
        neutral=int(np.count_nonzero(~moves)),
        doubt=doubt,
        names=chart.names,
        tangent=np.asarray(tangent.matrix),
        free_period=free,
        onsets=(way.onsets, way.events),
        system=flow.system,
        scenario=flow.scenario,
    )


def _damped_step(
    flow: Flow, chart: Chart, span: float, step: Array, before: float, free: bool
) -> tuple[State, float]:
    """Return start and period after a correction, halved until the residual falls."""
    for halving in range(_HALVINGS + 1):
        part = step * 0.5**halving
        longer = span + (float(part[-1]) if free else 0.0)
        if longer > 0.0:
            try:
                there = chart.state(part[: chart.size])
                new = Chart(flow.system, there)
                miss = float(np.linalg.norm(new.coordinates(flow.after(there, longer))))
            except AntennaPinError:
                miss = math.inf
            if miss < before:
                return there, longer
    raise NoOrbitError(
        f"periodic orbit: no step from here brings the ends of a period of {span:g} s nearer than "
        f"{before:.3g} error scales; begin nearer to it, or after a longer transient"
    )
