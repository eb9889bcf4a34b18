"""Why processes that were to make runs did not start: how they ended, and what may be the cause."""

from __future__ import annotations

import contextlib
import logging
import re
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

__all__ = ["ends_of_processes", "said_of_start"]

_ENDED = re.compile(r"Worker process \d+ (?:was killed by signal (\d+)|exited with status (\d+))")


class _Ends(logging.Handler):
    """Takes how processes have ended from what Dask logs of them."""

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self.codes: list[int] = []

    def emit(self, record: logging.LogRecord) -> None:
        found = _ENDED.search(record.getMessage())
        if found:
            self.codes.append(-int(found[1]) if found[1] else int(found[2]))


@contextlib.contextmanager
def ends_of_processes() -> Iterator[list[int]]:
    """Yield a list of exit codes of processes that end meanwhile; of a signal its number, negative."""
    logger, ends = logging.getLogger("distributed.nanny"), _Ends()
    before = logger.level, logger.propagate
    logger.setLevel(logging.INFO)
    logger.propagate = False
    logger.addHandler(ends)
    try:
        yield ends.codes
    finally:
        logger.removeHandler(ends)
        logger.setLevel(before[0])
        logger.propagate = before[1]


def said_of_start(codes: list[int], error: str) -> str:
    """Return in words why processes did not start, and what to do.

    Args:
        codes: Of those that have ended, by :func:`ends_of_processes`.
        error: What Dask says.
    """
    if not codes:
        return error
    if codes[0] < 0:
        try:
            name = signal.Signals(-codes[0]).name
        except ValueError:
            name = f"signal {-codes[0]}"
        why = (
            "; so ends what takes more memory than there is or than a queue allows: take fewer --workers"
            if name == "SIGKILL"
            else ""
        )
        return f"one was ended by {name} before it took work{why}"
    unguarded = (
        "; a script that starts them does so under if __name__ == '__main__': only, as they read it too"
    )
    return f"one ended with exit code {codes[0]} before it took work{unguarded if _is_unguarded() else ''}"


def _is_unguarded() -> bool:
    """Whether the script that runs does the same where another process reads it."""
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    if script is None:
        return False
    try:
        return "__main__" not in Path(script).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
