"""How far a run is, and how its user stops it."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType

__all__ = ["Progress", "interruptible"]


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


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Turn Ctrl-C into a flag that the loop reads between steps, so that nothing is left half done.

    An impatient second one changes nothing; a third interrupts at once.
    """
    presses = 0

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal presses
        presses += 1
        if presses > 2:
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    before = signal.signal(signal.SIGINT, note)
    try:
        yield lambda: presses > 0
    finally:
        signal.signal(signal.SIGINT, before)
