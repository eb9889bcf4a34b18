"""Where the journal passes in its bearing, of a long run part by part."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from antenna_pin.analysis import LONG, blocks, journal_motion
from antenna_pin.plot._runs import LabelledRun
from antenna_pin.plot._style import Array

__all__ = ["JournalPath", "farthest"]


def farthest(run: LabelledRun, joint: str) -> float:
    """Return the largest eccentricity of the journal in a run [m]."""
    parts = (journal_motion(part, joint)["eccentricity"].values for part in blocks(run.data))
    return float(np.nanmax([np.nanmax(part) for part in parts]))


class JournalPath:
    """Where the journal's axis or centre passes, at one place.

    Args:
        run: Its samples.
        motion: Of the journal in the first part of them, which is all of a run that is not long.
        joint: The joint with clearance.
        place: Number of the place.
        turn: Turns offsets to the axes that are shown, and scales them, (3, 3).
    """

    def __init__(self, run: LabelledRun, motion: xr.Dataset, joint: str, place: int, turn: Array) -> None:
        self._run, self._motion, self._joint, self._place, self._turn = run, motion, joint, place, turn
        self.long = run.time.size > LONG

    def parts(self) -> Iterator[tuple[Array, Array]]:
        """Yield offsets (m, 3) and times (m,) [s], each part from the last sample of the one before on."""
        if not self.long:
            yield self._motion["offset"].values[:, self._place] @ self._turn.T, self._run.time
            return
        for part in blocks(self._run.data, overlap=1):
            offset = journal_motion(part, self._joint)["offset"].values[:, self._place]
            yield offset @ self._turn.T, part["time"].values

    @property
    def whole(self) -> Array:
        """All offsets, (n, 3)."""
        found = [offset for offset, _ in self.parts()]
        return np.concatenate([*(offset[:-1] for offset in found[:-1]), found[-1]])
