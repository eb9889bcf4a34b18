"""The size of a step, for both engines."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from antenna_pin.engine import _pace_kernels as _kernels

__all__ = ["Pace"]


class Pace:
    """What decides how long the next step is.

    Args:
        adaptive: Whether sizes follow errors.
        power: The order of the error in the step's size.
        step: Size of all steps, if they are not adaptive [s].
        least: Step not to be fallen below [s].
        end: Of the run [s].

    Attributes:
        numbers: As the kernels take them, ``PACE``, (1,).
        breaks: Instants at which steps must end, increasing [s].
    """

    def __init__(self, *, adaptive: bool, power: int, step: float, least: float, end: float) -> None:
        """Begin without instants."""
        self.numbers = np.zeros(1, _kernels.PACE)
        self.breaks = np.zeros(0)
        given = {"adaptive": adaptive, "power": power, "step": step, "least": least, "end": end}
        for name, value in given.items():
            self.numbers[name] = value
        self.numbers["longest"] = np.inf

    def end_at(self, instants: Iterable[float]) -> None:
        """Let steps end at further instants [s]."""
        end = float(self.numbers["end"][0])
        self.breaks = np.array(sorted({*self.breaks.tolist(), *(t for t in instants if 0.0 < t < end)}))
        self.numbers["next"] = 0

    def cut(self, t: float, h: float) -> tuple[float, bool]:
        """Return a step's size from t [s], cut to what it may be, and whether the run's end has cut it."""
        size, by_end = _kernels.cut(self.numbers, self.breaks, t, h)
        return float(size), bool(by_end)

    def following(self, wished: float, tried: float, error: float, rejected: bool) -> float:
        """Return the step to try after one that passed [s]."""
        return float(_kernels.following(self.numbers, wished, tried, error, rejected))

    def shortened(self, tried: float, error: float) -> float:
        """Return the step to try after one with too large an error [s]."""
        return float(_kernels.shortened(self.numbers, tried, error))

    def hopeless(self, h: float) -> bool:
        """Whether a step shortened to h [s] is not to be tried."""
        return bool(_kernels.hopeless(self.numbers, h))
