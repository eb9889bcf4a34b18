"""Which directions of neighbours are their own over the intervals of a motion, and which are left."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from antenna_pin.base.state import State
from antenna_pin.errors import InvalidParameterError
from antenna_pin.nonlinear.chart import Chart
from antenna_pin.nonlinear.flow import Flow
from antenna_pin.nonlinear.frames import Frame, own_state
from antenna_pin.nonlinear.kept import Kept

__all__ = ["Ahead", "left_of", "mechanical"]

Array = NDArray[np.float64]


class Ahead:
    """A motion after each interval, run before its neighbours are: which contacts last is known of its end.

    Args:
        flow: The flow.
        start: From where.
        interval: [s].
        count: How many intervals to run at once, if there are contacts.
        progress: Called with zero and no number after each of these.
    """

    def __init__(
        self,
        flow: Flow,
        start: State,
        interval: float,
        count: int,
        progress: Callable[[int, float], None] | None,
    ) -> None:
        """Run."""
        self._flow, self._interval, self._states = flow, interval, [start]
        self._kept = [(k, one.key) for k, one in enumerate(Kept(flow.system).numbers) if one.of_rate]
        #: Contacts that touch at the end, and since when [s].
        self.onsets: dict[int, float] = {}
        known = flow.system.contact_names or self._kept
        for k in range(count if known else 0):
            self.after(k + 1)
            if progress is not None:
                progress(0, math.nan)
        if len(self._states) > count:
            self.onsets = {one.contact: one.onset for one in self._states[-1].contacts}

        #: Numbers that elements keep to the end, of rates, and since when at the latest [s].
        self.kept: dict[int, float] = {}
        for k, key in self._kept if len(self._states) > count else ():
            values = [dict(one.adjusted).get(key) for one in self._states]
            since = next(j for j in range(len(values)) if all(one == values[-1] for one in values[j:]))
            self.kept[k] = self._states[since].time

    def after(self, count: int) -> State:
        """Return the state after so many intervals."""
        while len(self._states) <= count:
            self._states.append(self._flow.after(self._states[-1], self._interval))
        return self._states[count]

    def own(self, frame: Frame, size: int, time: float) -> NDArray[np.bool_]:
        """Return which coordinates at a time [s] are a neighbour's own, (size,)."""
        lasting = [c for c, onset in self.onsets.items() if onset <= time]
        return own_state(frame, size, lasting, [k for k, since in self.kept.items() if since <= time])


def mechanical(chart: Chart) -> NDArray[np.bool_]:
    """Return which coordinates are not of contacts' memory, nor of stops': along these neighbours begin."""
    remembered = [contact for contact, _ in chart.frame.remembered]
    return own_state(chart.frame, chart.size, remembered, chart.of_rates)


def left_of(matrix: Array, rank: int, time: float) -> NDArray[Any]:
    """Return which displacements are independent still, (rank,), in order.

    Raises:
        InvalidParameterError: None is.
    """
    if rank == matrix.shape[1]:
        return np.arange(rank)
    if rank == 0:
        rule = "a motion whose neighbours do not all come onto it, where joints come to rest"
        said = f"no direction is left at t = {time:.6g} s"
        raise InvalidParameterError("Lyapunov exponents", "start", rule, said=said)
    order = np.asarray(qr(matrix, mode="r", pivoting=True)[1])
    return np.sort(order[:rank])
