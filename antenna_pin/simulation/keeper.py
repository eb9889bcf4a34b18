"""Keeps the record of a run on the disk while it goes on: parts of samples, and checkpoints to go on from."""

from __future__ import annotations

import math
import os
import secrets
import time
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from antenna_pin.dynamics import System
from antenna_pin.errors import OutputError
from antenna_pin.simulation.checkpoint import Checkpoint
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.parts import Parts, folder_of

__all__ = ["CheckpointsWaitedWarning", "Keeper", "NotKeptWarning"]

_PART = 16_000_000  # bytes of samples that make a part
_TIMES = 9.0  # what a checkpoint took: so long the run goes on before the next: a tenth of its time
_AGAIN = 10.0  # [s] of wall time from one vain try to write to the next


class NotKeptWarning(UserWarning):
    """What a run has recorded cannot be put on the disk; it stays in memory, and the run goes on."""


class CheckpointsWaitedWarning(UserWarning):
    """Checkpoints took so long that they were made more rarely than was asked."""


class Keeper:
    """Puts what a run has recorded on the disk.

    A run whose record is small, and whose checkpoints are never due, does not touch the disk.

    Args:
        path: Of the run's result.
        system: The system.
        about: What the run is of, for its checkpoints.
        interval: Wall time from one checkpoint to the next [s], and at least nine times what the last one
            took, which is said at the end; infinity for none but at an interruption.
        checkpoint: That the run goes on from.

    Attributes:
        path: Of the run's result.
        parts: What is on the disk.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        system: System,
        about: Mapping[str, Any],
        interval: float = math.inf,
        checkpoint: Checkpoint | None = None,
    ) -> None:
        """Begin, or go on, with the parts that the checkpoint knows of."""
        found = {} if checkpoint is None else checkpoint.about
        identity = found.get("run", secrets.token_hex(8))
        self.path = Path(path)
        self.parts = Parts(folder_of(path), system.program, identity)
        self.parts.rows[:] = found.get("rows", ())
        self._about = {**about, "run": identity}
        self._interval = interval
        self._asked = self._due = math.nan
        self._wait = -math.inf
        self._dearest, self._waited = 0.0, False
        self._goes_on = checkpoint is not None

    def __enter__(self) -> Self:
        """Lock the folder of a run that goes on."""
        if self._goes_on:
            self.parts.open()
            self.parts.drop_others()
        return self

    def __exit__(self, *error: object) -> None:
        """Unlock the folder."""
        self.parts.close()

    def look(self, run: Run) -> None:
        """Write what is due."""
        wall = run.wall
        if math.isnan(self._due):
            self._asked = self._due = wall + self._interval
        self._waited |= self._asked <= wall < self._due
        large = run.samples.size > _PART
        if not (large or wall >= self._due) or wall < self._wait:
            return
        try:
            if large:
                self.parts.append(run.samples.held_but_last)
                run.samples.hand_out()
            if wall >= self._due:
                cost = self.write(run)
                self._dearest = max(self._dearest, cost)
                self._asked = wall + cost + self._interval
                self._due = wall + cost + max(self._interval, _TIMES * cost)
        except OutputError as error:
            if self._wait == -math.inf:
                warnings.warn(
                    f"{error}; the run goes on and keeps it in memory", NotKeptWarning, stacklevel=2
                )
            self._wait = wall + _AGAIN

    def end(self, run: Run) -> None:
        """Keep a run that may go on, or whose record is in parts; say if checkpoints waited."""
        if run.outcome.may_go_on or self.parts.rows:
            try:
                self.write(run)
            except OutputError as error:
                warnings.warn(f"{error}; the run cannot be gone on with", NotKeptWarning, stacklevel=2)
        if self._waited:
            warnings.warn(
                f"checkpoints took up to {self._dearest:.2g} s each, and so waited for up to "
                f"{_TIMES * self._dearest:.2g} s instead of the {self._interval:.3g} s asked: they take a "
                "tenth of the time at most",
                CheckpointsWaitedWarning,
                stacklevel=2,
            )

    def write(self, run: Run) -> float:
        """Write a checkpoint, and return the time that it took [s].

        Raises:
            OutputError: It cannot be written.
        """
        began = time.perf_counter()
        self.parts.open()
        Checkpoint.of(run, {**self._about, "rows": self.parts.rows}).write(self.parts.folder)
        return time.perf_counter() - began
