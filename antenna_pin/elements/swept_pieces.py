"""A swept sine in pieces: of each the frequency as a function of time, and the phase that it makes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["SweptPiece", "sines_of"]


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
