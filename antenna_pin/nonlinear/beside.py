"""A system beside the given one, some of whose numbers are farther: displaced in place, or else built."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import System
from antenna_pin.mechanism import BODY
from antenna_pin.nonlinear.near import Near
from antenna_pin.nonlinear.numbers import Numbers

__all__ = ["Beside"]


class Beside:
    """A system's own copy that stands, one at a time, for its neighbours along parameters.

    What is told of states goes by the arrays that rates go by, so that a copy with these displaced has its
    derivatives; a neighbour's other digits are of second order. Two things are in no array, and there the
    neighbour is built: what Python is asked for, and the axes of joints in Pinocchio's model.

    Args:
        system: The system.
        settings: Of the run whose engine evaluates its rates.
        numbers: How its numbers go with the parameters.
        built: What builds a neighbour, ``(parameter, s)`` in its scale.
    """

    def __init__(
        self, system: System, settings: RunSettings, numbers: Numbers, built: Callable[[int, float], System]
    ) -> None:
        """Copy the system."""
        self._settings, self._built = settings, built
        self._near = near = Near(system, settings, numbers, whole=True)
        bodies = numbers.slopes["tree"].view(BODY)
        asked = bool(near.workspace.paths or near.system.callables)
        #: Of each parameter, whether its neighbours are built.
        self.builds = (bodies["axis"] != 0.0).any(axis=(1, 2)) | asked
        others = [one.any(axis=1) for key, one in numbers.slopes.items() if key != "program"]
        #: Of each, whether its neighbours differ in their programs alone, which go with their states.
        self.by_program = ~(np.any(others, axis=0) | self.builds)

    @contextmanager
    def at(self, k: int, s: float) -> Iterator[Near]:
        """Let the copy be the system with a parameter so many scales farther; yield what evaluates it."""
        if s != 0.0 and self.builds[k]:
            yield Near(self._built(k, s), self._settings)
            return
        own, far = self._near.numbers, np.zeros(len(self.builds))
        assert own is not None
        far[k] = s
        back = own.displace(far)
        try:
            yield self._near
        finally:
            back()
