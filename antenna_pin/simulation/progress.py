"""How far a run is."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Progress"]


@dataclass(frozen=True, slots=True)
class Progress:
    """Where a run is.

    Attributes:
        time: Simulated so far [s].
        end: To be simulated [s].
        step: Size of the last step [s].
        steps: Steps accepted.
        wall: Wall time so far [s].
    """

    time: float
    end: float
    step: float
    steps: int
    wall: float
