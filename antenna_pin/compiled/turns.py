"""Turns of processes that need the same kernel: one compiles, the others wait.

Each process locks a byte of a file beside the kernels while it compiles one. The system releases the lock
when a process ends, for any reason; where files cannot be locked, each process compiles for itself.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import time
from functools import lru_cache

# Longest wait for a process that hangs [s], and time between two checks [s].
_LONGEST, _LOOK = 300.0, 0.02


class Turn:
    """Turn of a kernel in this process."""

    def __init__(self, kernel: str) -> None:
        """Name the kernel."""
        self.kernel = kernel
        # Below 4 GB: some systems cannot lock bytes beyond.
        self._byte = int.from_bytes(hashlib.sha256(kernel.encode()).digest()[:4], "little")
        self._file: int | None = None

    @property
    def is_held(self) -> bool:
        """Return whether this process has the turn."""
        return self._file is not None

    def begin(self, folder: str) -> None:
        """Take the turn to compile the kernel into a folder, after whoever has it."""
        if self.is_held:
            return
        end = time.monotonic() + _LONGEST
        with contextlib.suppress(OSError, AttributeError):  # Windows has no lockf
            file = _file_in(folder)
            while time.monotonic() < end:
                try:
                    _move(file, self._byte)
                    os.lockf(file, os.F_TLOCK, 1)
                except BlockingIOError:
                    time.sleep(_LOOK)
                else:
                    self._file = file
                    break

    def end(self) -> None:
        """Let others have it."""
        file, self._file = self._file, None  # once, whichever thread ends it
        if file is not None:
            with contextlib.suppress(OSError):
                _move(file, self._byte)
                os.lockf(file, os.F_ULOCK, 1)


@lru_cache
def _file_in(folder: str) -> int:
    """Return the open lock file of a folder; closing it releases all turns."""
    return os.open(os.path.join(folder, "kernels.turns"), os.O_RDWR | os.O_CREAT, 0o644)


def _move(file: int, byte: int) -> None:
    os.lseek(file, byte, os.SEEK_SET)
