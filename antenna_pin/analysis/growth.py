r"""How a deviation grows: by a power of time, or exponentially.

What is fitted is the envelope :math:`E(t) = \max_{s \le t} |d(s)|`, which never falls, so that zero crossings
of an oscillating deviation do not count. In its logarithm both laws are straight lines,

.. math:: \ln E = \ln c + p \ln (t - t_0), \qquad \ln E = \ln c + \lambda (t - t_0),

with :math:`t_0` the start of the run. They are fitted by least squares at 200 points evenly over the time of
growth: from where E first passes a thousandth of its final value (less may be no more than two integrations
differ by) to where it reaches that value. The rest of the run, where nothing grows, is left out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import Array
from antenna_pin.base.arguments import takes

__all__ = ["Growth", "growth_of", "growths_of"]

_POINTS = 200
_LEAST_RECORDS = 8
_LEAST_GROWTH = 3.0
_LEAST_SHARE = 0.2
_LEAST_FIT = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class Growth:
    """Fits to the envelope of a deviation.

    Attributes:
        kind: Law that fits better, or "none" where neither says anything (see ``note``).
        exponent: p of the power of time [-]; NaN where nothing is fitted.
        power_r2: Coefficient of determination of ln E for the power [-].
        rate: lambda of the exponential [1/s]; NaN where nothing is fitted.
        exponential_r2: The same for the exponential [-].
        start: Where the fit begins [s].
        end: Where the fit ends [s].
        note: Why neither law says anything; empty if one does.
    """

    kind: Literal["power", "exponential", "none"]
    exponent: float
    power_r2: float
    rate: float
    exponential_r2: float
    start: float
    end: float
    note: str = ""

    def __str__(self) -> str:
        """Return the better law in words."""
        if self.kind == "power":
            return f"t^{self.exponent:.3g} (R2 {self.power_r2:.3f})"
        if self.kind == "exponential":
            return f"exp({self.rate:.3g}/s t) (R2 {self.exponential_r2:.3f})"
        return self.note


@takes()
def growth_of(time: ArrayLike, deviation: ArrayLike) -> Growth:
    """Return how a deviation grows; the module's text says what is fitted.

    The fit means nothing, and ``kind`` is "none", if the envelope rises in fewer than 8 samples (one or two
    jumps are not a law), by less than a factor of 3 (then it is level), for less than a fifth of the run
    (then one early event made it), or if neither straight line explains nine tenths of the variance of ln E.
    A rate is that of this run over this time, not a Lyapunov exponent: play bounds a deviation, or friction
    drives it, long before.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        deviation: Samples, (n,).
    """
    values = np.asarray(deviation, dtype=float)
    return growths_of(np.asarray(time, dtype=float), lambda: [values[:, None]])[0]


def growths_of(time: Array, parts: Callable[[], Iterable[Array]]) -> list[Growth]:
    """Return how deviations grow that are too long for memory: those of :func:`growth_of`, to the last digit.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        parts: Returns the samples part by part, (m, k) of k deviations; it is asked twice.
    """
    tops: list[_Top] = []
    begin = 0
    for part in parts():
        sizes = np.abs(part)
        if not tops:
            tops = [_Top() for _ in sizes.T]
        for top, size in zip(tops, sizes.T, strict=True):
            top.rise(size, begin)
        begin += len(sizes)
    envelopes = [_Envelope(time, top) for top in tops]
    begin = 0
    for part in parts() if time.size > 1 else ():
        sizes = np.abs(part)
        for envelope, size in zip(envelopes, sizes.T, strict=True):
            envelope.go_on(size, begin)
        begin += len(sizes)
    return [envelope.fitted() for envelope in envelopes]


class _Top:
    """The largest of a size, and where it is first."""

    def __init__(self) -> None:
        self.size, self.place = 0.0, 0

    def rise(self, size: Array, begin: int) -> None:
        """Take the next samples, the first of which is ``begin`` of all; what is not a number stays so."""
        if size.size and not size.max() <= self.size:
            self.place, self.size = begin + int(np.argmax(size)), float(size.max())


class _Envelope:
    """What is fitted of an envelope, gathered as it goes on."""

    def __init__(self, time: Array, top: _Top) -> None:
        self._time, self._top = time, top
        self._so_far = 0.0
        self._first: int | None = None
        self._rises = 0
        self._points, self._places = np.zeros(0), np.zeros(0, dtype=int)
        self._held = np.zeros(0)
        self._at_first = 0.0

    def go_on(self, size: Array, begin: int) -> None:
        """Take the next samples, the first of which is ``begin`` of all."""
        if not self._top.size > 0.0 or not size.size:
            return
        all_of_it = np.maximum.accumulate(np.concatenate([[self._so_far], size]))
        self._so_far, envelope = float(all_of_it[-1]), all_of_it[1:]
        if self._first is None and self._so_far > 1e-3 * self._top.size:
            self._start(begin + int(np.argmax(envelope > 1e-3 * self._top.size)))
        if self._first is None:
            return
        if begin <= self._first < begin + size.size:
            self._at_first = float(envelope[self._first - begin])
        first, last = max(self._first + 1 - begin, 0), self._top.place + 1 - begin
        self._rises += int(np.count_nonzero(np.diff(all_of_it)[first : max(last, 0)]))
        here = (self._places >= begin) & (self._places < begin + size.size)
        self._held[here] = envelope[self._places[here] - begin]

    def _start(self, risen: int) -> None:
        time, last = self._time, self._top.place
        # Time zero has no logarithm, and a deviation there would be no growth.
        first = self._first = max(risen, int(np.argmax(time > time[0])))
        self._points = np.linspace(time[first] - time[0], time[last] - time[0], _POINTS)
        places = np.searchsorted(time - time[0], self._points, side="right") - 1
        self._places = np.clip(places, first, max(last, first))
        self._held = np.zeros(_POINTS)

    def fitted(self) -> Growth:
        """Return the fits to what has been gathered."""
        t, first, last = self._time, self._first, self._top.place
        if t.size < 2 or not self._top.size > 0.0 or first is None:
            return _nothing("it does not deviate", t)
        if self._rises + 1 < _LEAST_RECORDS:
            return _nothing("it rises in a few jumps only", t)
        if self._top.size < _LEAST_GROWTH * self._at_first:
            return _nothing("it is level", t)
        if t[last] - t[first] < _LEAST_SHARE * (t[-1] - t[0]):
            return _nothing("it grows for less than a fifth of the run", t)
        logarithm = np.log(self._held)
        exponent, power = _line(np.log(self._points), logarithm)
        rate, exponential = _line(self._points, logarithm)
        better = max(power, exponential)
        poor = better < _LEAST_FIT
        return Growth(
            kind="none" if poor else "power" if power >= exponential else "exponential",
            exponent=exponent,
            power_r2=power,
            rate=rate,
            exponential_r2=exponential,
            start=float(t[first]),
            end=float(t[last]),
            note="neither a power nor an exponential fits" if poor else "",
        )


def _nothing(note: str, time: Array) -> Growth:
    nan = float("nan")
    start, end = (float(time[0]), float(time[-1])) if time.size else (nan, nan)
    return Growth(
        kind="none",
        exponent=nan,
        power_r2=nan,
        rate=nan,
        exponential_r2=nan,
        start=start,
        end=end,
        note=note,
    )


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Return slope and coefficient of determination of a straight line."""
    dx, dy = x - x.mean(), y - y.mean()
    slope = float(dx @ dy / (dx @ dx))
    left = dy - slope * dx
    return slope, float(1.0 - left @ left / (dy @ dy))
