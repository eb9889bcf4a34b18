"""Lyapunov exponents with their errors: rates of divergence of perturbed states."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.linalg import qr

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.capacity import MOST, check_count
from antenna_pin.base.readable import brief
from antenna_pin.base.state import State
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.nonlinear.chart import Chart, NotAlikeError
from antenna_pin.studies.nonlinear.coordinates import ElementMemory, Frame, own_coordinates
from antenna_pin.studies.nonlinear.flow import Flow
from antenna_pin.trajectory import open_table, table_attributes

# --- independent directions of perturbed states -------------------------------------------------------------


class _ReferenceMotion:
    """Motion after each interval, run ahead to find the contacts that last."""

    def __init__(
        self,
        flow: Flow,
        start: State,
        interval: float,
        count: int,
        progress: Callable[[int, float], None] | None,
    ) -> None:
        self._flow, self._interval, self._states = flow, interval, [start]
        self._kept = [(k, one.key) for k, one in enumerate(ElementMemory(flow.system).numbers) if one.of_rate]
        #: Contacts that touch at the end, with their onsets [s].
        self.onsets: dict[int, float] = {}
        known = flow.system.contact_names or self._kept
        for k in range(count if known else 0):
            self.after(k + 1)
            if progress is not None:
                progress(0, math.nan)
        if len(self._states) > count:
            self.onsets = {one.contact: one.onset for one in self._states[-1].contacts}

        #: Rates in element memory that last to the end, with the earliest time [s].
        self.kept: dict[int, float] = {}
        for k, key in self._kept if len(self._states) > count else ():
            values = [dict(one.adjusted).get(key) for one in self._states]
            since = next(j for j in range(len(values)) if all(one == values[-1] for one in values[j:]))
            self.kept[k] = self._states[since].time

    def after(self, count: int) -> State:
        """Return the state after a number of intervals."""
        while len(self._states) <= count:
            self._states.append(self._flow.after(self._states[-1], self._interval))
        return self._states[count]

    def own(self, frame: Frame, size: int, time: float) -> NDArray[np.bool_]:
        """Return which coordinates at a time [s] belong to a perturbed state alone, (size,)."""
        lasting = [c for c, onset in self.onsets.items() if onset <= time]
        return own_coordinates(frame, size, lasting, [k for k, since in self.kept.items() if since <= time])


def _mechanical_coordinates(chart: Chart) -> NDArray[np.bool_]:
    """Return which coordinates are no memory of contacts or stops, (size,)."""
    remembered = [contact for contact, _ in chart.frame.contact_memory]
    return own_coordinates(chart.frame, chart.size, remembered, chart.of_rates)


def _independent(matrix: Array, rank: int, time: float) -> NDArray[Any]:
    """Return which tangents are still independent, (rank,), in order."""
    if rank == matrix.shape[1]:
        return np.arange(rank)
    if rank == 0:
        rule = "a motion whose neighbours do not all come onto it, where joints come to rest"
        said = f"no direction is left at t = {time:.6g} s"
        raise InvalidParameterError("Lyapunov exponents", "start", rule, said=said)
    order = np.asarray(qr(matrix, mode="r", pivoting=True)[1])
    return np.sort(order[:rank])


Verdict = Literal["chaotic", "neutral", "contracting", "too short to decide"]
"""What a largest exponent says: perturbed states part, keep their distance, come together; or nothing yet."""

# Distance of a perturbed state in error scales; largest, beyond which growth is no longer that of a tangent;
# least above round-off.
_DISTANCE, _FARTHEST, _NEAREST = 1e-6, 1e-3, 1e-10
# Fewest intervals, and blocks of them, for a verdict; standard errors that decide; exponent over an interval
# that counts as none.
_FEWEST, _BLOCKS, _SIGMAS, _NEUTRAL = 32, 8, 3.0, 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Exponents:
    """Lyapunov exponents of one motion from its start: attractors may coexist."""

    __repr__ = brief

    values: Array  # the largest first, (n,) [1/s]
    # one standard error of each, from blocks of intervals so long that they depend little on one another,
    # (n,) [1/s]
    errors: Array
    interval: float  # between two renormalisations, a period of the section if there is one [s]
    growth: Array  # logarithm of what each has grown by in each interval, (intervals, n) [-]
    lengths: Array  # of the intervals, (intervals,) [s]; some are longer, to where the same contacts touch
    start: State  # state after the transient
    end: State  # state that was come to

    @property
    def running(self) -> Array:
        """The exponents as they were after each interval, (intervals, n) [1/s]: how they converge."""
        return np.asarray(np.cumsum(self.growth, axis=0) / np.cumsum(self.lengths)[:, None])

    @property
    def verdict(self) -> Verdict:
        """Classification of the largest exponent, at three standard errors."""
        value, error = float(self.values[0]), float(self.errors[0])
        if len(self.growth) < _FEWEST or not math.isfinite(error):
            return "too short to decide"
        if abs(value) > _SIGMAS * error and abs(value) * self.interval > 1e-9:
            return "chaotic" if value > 0.0 else "contracting"
        return "neutral" if _SIGMAS * error * self.interval < _NEUTRAL else "too short to decide"


def _exponents(growth: Array, lengths: Array, interval: float, start: State, end: State) -> Exponents:
    total = float(lengths.sum())
    values = growth.sum(axis=0) / total
    # Consecutive growths are not independent: distances oscillate, and chaos has bursts. The error is the
    # spread of long blocks.
    errors = np.full(growth.shape[1], math.inf)
    width = len(growth) // _BLOCKS
    if width:
        count = len(growth) // width
        blocks = growth[: count * width].reshape(count, width, -1).sum(axis=1)
        spans = lengths[: count * width].reshape(count, width).sum(axis=1)
        off = blocks - values * spans[:, None]
        errors = np.sqrt((off**2).sum(axis=0) * count / (count - 1)) / spans.sum()
    return Exponents(values, errors, interval, growth, lengths, start, end)


def _check_arguments(flow: Flow, start: State, interval: float, count: int, transient: float) -> None:
    check_count("Lyapunov exponents", "count", count)
    check_number("Lyapunov exponents", "transient", transient, "zero or more", "s")
    flow.check_long_enough("Lyapunov exponents", "interval", interval, start.time + transient)
    if transient / interval > MOST:
        rule = f"at most {MOST} intervals, {MOST * interval:g} s"
        raise InvalidParameterError("Lyapunov exponents", "transient", rule, transient)


@takes(interval="s", transient="s")
def largest_exponent(
    flow: Flow,
    start: State,
    interval: float,
    count: int,
    *,
    transient: float = 0.0,
    seed: int = 0,
    progress: Callable[[int, float], None] | None = None,
) -> Exponents:
    """Return the largest exponent by two trajectories with renormalisation (Benettin and others 1976).

    The perturbed trajectory locates its own contacts and events, and has its own approach speeds, except for
    contacts that last to the end: these are constant, and shared, as those of an orbit
    (:func:`antenna_pin.studies.nonlinear.coordinates.own_coordinates`). Where different contacts touch at the
    end of an interval, both trajectories continue until the same do.

    Args:
        flow: The flow.
        start: From where.
        interval: Between renormalisations, such as a drive's period [s].
        count: How many intervals.
        transient: What is run before [s].
        seed: Seed of the first direction; the first tenth of the intervals, in which it turns into that of
            fastest growth, is left out.
        progress: Called with the number of intervals done and the exponent so far [1/s]; of a system with
            contacts with zero and no number before, after each interval that the motion itself is run.

    Raises:
        FlowError: A run did not come to its end.
    """
    _check_arguments(flow, start, interval, count, transient)
    first = here = flow.after(start, transient) if transient else start
    turning, done = max(1, count // 10), 0
    ahead = _ReferenceMotion(flow, here, interval, count + turning, progress)
    chart = Chart(flow.system, here)
    way = np.random.default_rng(seed).standard_normal(chart.size) * _mechanical_coordinates(chart)
    way /= np.linalg.norm(way)
    growth: list[float] = []
    lengths: list[float] = []
    while len(growth) < count + turning:
        neighbour, begun = chart.state(_DISTANCE * way), here.time
        distance = _DISTANCE
        while True:
            done += 1
            here, neighbour = ahead.after(done), flow.after(neighbour, interval)
            chart = Chart(flow.system, here)
            try:
                z = chart.coordinates(neighbour)
            except NotAlikeError:
                if here.time - begun > 50.0 * interval:
                    raise
                continue
            break
        z = np.where(ahead.own(chart.frame, chart.size, here.time), z, 0.0)
        distance = float(np.linalg.norm(z))
        if distance > _FARTHEST and here.time - begun > 1.5 * interval:
            way = z / distance  # parted so far while waiting that its growth is not a tangent's: not counted
            continue
        if distance < _NEAREST:
            rule = "so short that neighbours do not come together to round-off in it"
            said = f"{interval:g} s, in which they come {_DISTANCE / max(distance, 1e-300):.0e} times nearer"
            raise InvalidParameterError("Lyapunov exponents", "interval", rule, said=said)
        growth.append(math.log(distance / _DISTANCE))
        lengths.append(here.time - begun)
        way = z / distance
        if progress is not None:
            kept = max(len(growth) - turning, 1)
            progress(len(growth), sum(growth[-kept:]) / sum(lengths[-kept:]))
    return _exponents(np.array(growth[turning:])[:, None], np.array(lengths[turning:]), interval, first, here)


@takes(interval="s", transient="s")
def lyapunov_spectrum(
    flow: Flow,
    start: State,
    interval: float,
    count: int,
    *,
    transient: float = 0.0,
    progress: Callable[[int, float], None] | None = None,
) -> Exponents:
    """Return all exponents by the variational equation, tangents orthogonalized after each interval.

    Contacts and events act by their saltation (:mod:`antenna_pin.studies.nonlinear.variational`). The memory
    of contacts that last to the end is shared, as for :func:`largest_exponent`. There is an exponent for each
    position, rate and bristle, and for each place at which a joint sticks; less those of directions that
    changes of mode remove for good, which would be minus infinity.

    Args:
        flow: The flow.
        start: From where.
        interval: [s].
        count: How many intervals.
        transient: What is run before [s].
        progress: As for :func:`largest_exponent`, of the largest.

    Raises:
        FlowError: A run did not come to its end.
        InvalidParameterError: Changes of mode leave no direction.
    """
    _check_arguments(flow, start, interval, count, transient)
    first = here = flow.after(start, transient) if transient else start
    ahead = _ReferenceMotion(flow, here, interval, count, progress)
    chart = Chart(flow.system, here)
    frame, ways = chart.frame, np.eye(chart.size)[:, _mechanical_coordinates(chart)]
    growth: list[Array] = []
    while len(growth) < count:
        carrier, here = flow.propagate(here, interval, frame, ways)
        matrix, _, frame, _ = carrier.tangents
        own = ahead.own(frame, len(matrix), here.time)
        matrix = np.where(own[:, None], matrix, 0.0)
        left = _independent(matrix, carrier.rank, here.time)
        ways, triangle = np.linalg.qr(matrix[:, left])
        growth = [one[left] for one in growth]  # what is lost was none of the motion's own directions
        growth.append(np.log(np.maximum(np.abs(np.diag(triangle)), 1e-300)))
        if progress is not None:
            progress(len(growth), float(sum(one[0] for one in growth)) / (len(growth) * interval))
    table = np.array(growth)
    order = np.argsort(-table.sum(axis=0), kind="stable")
    return _exponents(table[:, order], np.full(count, interval), interval, first, here)


# --- dataset and file ---------------------------------------------------------------------------------------


@takes()
def exponents_table(exponents: Exponents, scenario: Scenario | None = None) -> xr.Dataset:
    """Return exponents as a dataset, which :func:`antenna_pin.studies.nonlinear.save_table` writes.

    Returns:
        Over ``exponent``, from 1 on: ``value`` and ``error`` [1/s]. Over ``interval``: ``length`` [s], and
        ``time``, when it ends, from the end of the transient on [s]. Over both: ``growth`` [-] and
        ``running`` [1/s], the exponents after each interval. Attributes ``verdict``,
        ``interval`` [s], and ``start`` and ``end``, states to continue from
        (:meth:`antenna_pin.base.state.State.from_json`).
    """
    over = ("interval", "exponent")
    rate, none = {"units": "1/s"}, {"units": "1"}
    count = exponents.growth.shape[1]
    return xr.Dataset(
        {
            "value": ("exponent", exponents.values, rate | {"long_name": "Lyapunov exponent"}),
            "error": ("exponent", exponents.errors, rate | {"long_name": "one standard error of it"}),
            "length": ("interval", exponents.lengths, {"units": "s", "long_name": "length of an interval"}),
            "growth": (
                over,
                exponents.growth,
                none | {"long_name": "logarithm of the growth in an interval"},
            ),
            "running": (over, exponents.running, rate | {"long_name": "exponent after each interval"}),
        },
        coords={
            "exponent": ("exponent", np.arange(1, count + 1), {"long_name": "the largest first"}),
            "time": (
                "interval",
                np.cumsum(exponents.lengths),
                {"units": "s", "long_name": "end of an interval"},
            ),
        },
        attrs={
            **table_attributes("exponents", scenario),
            "verdict": exponents.verdict,
            "interval": exponents.interval,
            "start": exponents.start.to_json(),
            "end": exponents.end.to_json(),
        },
    )


@takes()
def open_exponents(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return an :func:`exponents_table` from a file of ``antenna-pin lyapunov --out``."""
    return open_table(path, "exponents")
