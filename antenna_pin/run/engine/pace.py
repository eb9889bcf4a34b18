"""The sizes of steps: what is given of them, and what a run remembers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.run.engine import pace_kernels as kernels

_ROOM = 16  # initial capacity, in patterns


class Pace:
    """Numbers of the step size control.

    Args:
        adaptive: Whether step sizes follow errors.
        power: Order of the error in the step size.
        control: Integral and proportional gain of the method.
        step: Size of all steps, if not adaptive [s].
        least: Least step size [s].
        end: End of the run [s].

    Attributes:
        numbers: ``PACE`` for kernels, (1,).
        breaks: Times at which steps must end, increasing [s].
    """

    def __init__(
        self,
        *,
        adaptive: bool,
        power: int,
        control: tuple[float, float],
        step: float,
        least: float,
        end: float,
    ) -> None:
        """Begin without instants."""
        self.numbers = np.zeros(1, kernels.PACE)
        self.breaks = self._instants = np.zeros(0)
        self._series = 0.0, np.inf
        given: dict[str, Any] = {"adaptive": adaptive, "power": power, "step": step, "least": least}
        given |= {"end": end, "integral": control[0], "proportional": control[1]}
        for name, value in given.items():
            self.numbers[name] = value
        self.numbers["longest"] = np.inf

    def end_at(self, instants: Iterable[float]) -> None:
        """Let steps end at further instants [s]."""
        self._instants = np.array(sorted({*self._instants.tolist(), *(t for t in instants if t > 0.0)}))
        self._renew()

    def move_end(self, end: float) -> None:
        """Let the run end at another time [s]."""
        self.numbers["end"] = end
        self._renew()

    def end_next_at(self, here: float, instant: float) -> None:
        """Add a time of a series as a step end, replacing its predecessor.

        Args:
            here: Present time [s].
            instant: The time; infinity after the last one [s].
        """
        self._series = here, instant
        self._renew()

    def _renew(self) -> None:
        """Write the instants ahead, each series by its next one only."""
        end, (here, instant) = float(self.numbers["end"][0]), self._series
        self.numbers["next"] = 0
        if instant < end:
            first, last = np.searchsorted(self._instants, [here, instant], side="right")
            self.breaks = np.append(self._instants[first:last], instant)
        else:
            self.breaks = self._instants[: np.searchsorted(self._instants, end)]


class Sizes:
    """Step sizes by pattern of touching contacts: similar impacts need similar steps.

    Args:
        memory: Contact memory, MEMORY, (contacts,), with the present pattern.

    Attributes:
        table: Arrays for kernels.
    """

    def __init__(self, memory: NDArray[Any]) -> None:
        """Begin without patterns."""
        self._memory = memory
        self.table = kernels.StepSizeArrays(
            patterns=np.zeros((_ROOM, len(memory)), dtype=np.uint8),
            sizes=np.zeros(_ROOM),
            count=np.zeros(1, dtype=np.int64),
        )

    def make_room(self) -> None:
        """Let there be room for a pattern more."""
        room = len(self.table.sizes)
        if int(self.table.count[0]) < room:
            return
        patterns = np.zeros((2 * room, len(self._memory)), dtype=np.uint8)
        sizes = np.zeros(2 * room)
        patterns[:room], sizes[:room] = self.table.patterns, self.table.sizes
        self.table = self.table._replace(patterns=patterns, sizes=sizes)

    def value(self) -> tuple[tuple[str, float], ...]:
        """Return all of them: which contacts touch, as ones and zeros, and the size [s]."""
        count = int(self.table.count[0])
        names = ("".join(map(str, pattern)) for pattern in self.table.patterns[:count].tolist())
        return tuple(zip(names, self.table.sizes[:count].tolist(), strict=True))

    def take_up(self, sizes: Iterable[tuple[str, float]]) -> None:
        """Go on with what another run has left."""
        self.table.count[0] = 0
        for name, size in sizes:
            self.make_room()
            count = int(self.table.count[0])
            self.table.patterns[count] = [int(one) for one in name]
            self.table.sizes[count] = size
            self.table.count[0] = count + 1
