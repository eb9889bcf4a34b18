"""Tables over time or angle, and the curves through their points."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.parameters import LARGEST, LEAST
from antenna_pin.errors import InvalidParameterError

Interpolation = Literal["linear", "cubic"]


def check_table(owner: object, values: str, over: str = "time", unit: str = "s") -> None:
    """Refuse times that do not increase, and values without a time.

    Args:
        owner: Whose table it is.
        values: Field of the values.
        over: Field of what they are over, where that is not time.
        unit: Its unit.
    """
    time: tuple[float, ...] = getattr(owner, over)
    given = getattr(owner, values)
    if len(time) < 2:
        raise InvalidParameterError(owner, over, "at least 2 numbers", said=f"{len(time)}")
    check_as_many(owner, over, values)
    for i, (before, after) in enumerate(pairwise(time), start=1):
        if not after > before:
            rule = f"above the one before, {before!r}"
            raise InvalidParameterError(owner, f"{over}[{i}]", rule, said=repr(after))
        if not after - before >= LEAST:
            rule = f"{LEAST:g} {unit} or more above the one before, {before!r}"
            raise InvalidParameterError(owner, f"{over}[{i}]", rule, said=repr(after))
        slope = (given[i] - given[i - 1]) / (after - before)
        if not abs(slope) <= LARGEST:
            rule = (
                f"such that its slope from the one before, {given[i - 1]!r}, is at most {LARGEST:g} in size"
            )
            raise InvalidParameterError(
                owner, f"{values}[{i}]", rule, said=f"{given[i]!r}, a slope of {slope:g}"
            )


def both_given(owner: object, *names: str) -> bool:
    """Return whether two parameters are given; refuse one without the other."""
    given = [name for name in names if getattr(owner, name) is not None]
    if len(given) == 1:
        (missing,) = set(names) - set(given)
        raise InvalidParameterError(owner, missing, f"given beside {given[0]}", said="none")
    return bool(given)


def check_as_many(owner: object, over: str, *names: str) -> None:
    """Refuse parameters that have not as many numbers as another."""
    count = len(getattr(owner, over))
    for name in names:
        if len(getattr(owner, name)) != count:
            rule = f"as many numbers as {over}, {count}"
            raise InvalidParameterError(owner, name, rule, said=f"{len(getattr(owner, name))}")


def check_covers(time: Sequence[float], place: str, begin: float, end: float) -> None:
    """Refuse a table that does not cover a run.

    Args:
        time: Its times [s].
        place: Whose table it is, for the message.
        begin: Start of the run [s].
        end: End of the run [s].
    """
    if not time[0] <= begin < end <= time[-1]:
        rule = f"a table that covers the run from {begin:g} to {end:g} s; extend it or shorten the run"
        raise InvalidParameterError(place, "time", rule, (time[0], time[-1]))


def points_and_middles(time: Sequence[float]) -> tuple[float, ...]:
    """Return the times of a table and the middles between them [s]."""
    return tuple(sorted((*time, *(0.5 * (a + b) for a, b in pairwise(time)))))


def cubics(
    time: Sequence[float],
    values: Sequence[float],
    interpolation: Interpolation | Literal["smooth"],
    periodic: bool = False,
) -> tuple[float, ...]:
    """Return a curve for kernels: times, then four coefficients for each interval.

    Args:
        time: Strictly increasing [s].
        values: One for each.
        interpolation: "linear", or "cubic" (monotone between points: no overshoot; its slope is continuous),
            or "smooth" (a spline whose second derivative is continuous, too; its third at the second and the
            last but one point).
        periodic: Whether a smooth one comes again after its last point, and is smooth there too.
    """
    t, y = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if interpolation == "cubic":
        from scipy.interpolate import PchipInterpolator

        with np.errstate(over="ignore"):  # the reciprocal of a slope that is nearly none
            coefficients = PchipInterpolator(t, y).c.T
    elif interpolation == "smooth":
        from scipy.interpolate import CubicSpline
        from scipy.linalg import LinAlgWarning

        with warnings.catch_warnings():
            # Of three points; its rows differ in size by that of the steps, which does no harm.
            warnings.simplefilter("ignore", LinAlgWarning)
            coefficients = CubicSpline(t, y, bc_type="periodic" if periodic else "not-a-knot").c.T
    else:
        coefficients = np.zeros((t.size - 1, 4))
        coefficients[:, 2] = np.diff(y) / np.diff(t)
        coefficients[:, 3] = y[:-1]
    assert math.isfinite(float(coefficients.sum()))
    return (*t.tolist(), *coefficients.ravel().tolist())


def areas(curve: Sequence[float], points: int) -> tuple[float, ...]:
    """Return the integral of a curve (:func:`cubics`) up to each point, (points,)."""
    found = [0.0]
    for k in range(points - 1):
        s = curve[k + 1] - curve[k]
        a, b, c, d = curve[points + 4 * k : points + 4 * k + 4]
        found.append(found[-1] + (((a / 4.0 * s + b / 3.0) * s + c / 2.0) * s + d) * s)
    return tuple(found)


# --- swept sine in pieces -----------------------------------------------------------------------------------


class SweptPiece(NamedTuple):
    """A stretch of a sweep; the displacement is ``height`` / omega^power sin(phase)."""

    start: float  # [s]
    begin: float  # angular frequency at the start [rad/s]
    growth: float  # of it: [1/s] in octaves, [rad/s^2] of a linear sweep
    octaves: int  # 1: logarithmic
    phase: float  # at the start, less whole turns [rad]
    height: float  # amplitude of the displacement, velocity or acceleration
    power: int  # 0, 1 or 2

    def omega(self, t: Any) -> Any:
        """Return the angular frequency at a time, or at times [rad/s]."""
        s = t - self.start
        return self.begin * np.exp(self.growth * s) if self.octaves else self.begin + self.growth * s

    def turned(self, t: Any) -> Any:
        """Return the phase at a time, or at times [rad]."""
        s = t - self.start
        if self.octaves and self.growth:
            return self.phase + self.begin * np.expm1(self.growth * s) / self.growth
        return self.phase + (self.begin + 0.5 * self.growth * s) * s


def sines_of(
    pieces: Sequence[SweptPiece], time: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return frequency [Hz] and phase [rad] of a sweep at times [s], (n,) each.

    From one piece to the next the phase jumps by whole turns only.
    """
    t = np.asarray(time, dtype=float)
    own = np.searchsorted([piece.start for piece in pieces[1:]], t, side="right")
    frequency, phase = np.zeros(t.shape), np.zeros(t.shape)
    for k, piece in enumerate(pieces):
        here = own == k
        frequency[here] = piece.omega(t[here]) / (2.0 * math.pi)
        phase[here] = piece.turned(t[here])
    return frequency, phase
