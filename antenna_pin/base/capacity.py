"""Capacity: limits of counts, and memory that arrays need on this machine.

Asked before anything is allocated, so that what does not fit is refused by its name, in one line, and not by
the system after minutes, with no word of what to make less.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from antenna_pin.errors import InvalidParameterError, TooLargeError

#: Most of what is counted: samples and points of a run, intervals, runs of a study, values of a parameter.
MOST = 10_000_000

# What is left to the system, and to what an estimate does not know.
_SHARE = 0.9
_CGROUP = Path("/sys/fs/cgroup")


def check_count(place: object, name: str, count: float, least: int = 1) -> None:
    """Refuse a count that is too small, or too large to come to an end.

    Raises:
        InvalidParameterError: It says from where to where it may be.
    """
    if isinstance(count, bool) or not count >= least:
        raise InvalidParameterError(place, name, f"{least} or more", count)
    if count > MOST:
        raise InvalidParameterError(place, name, f"at most {MOST}", count)


def check_fits(place: str, what: str, size: float, way_out: str) -> None:
    """Refuse what needs more memory than there is.

    Args:
        place: Whose it is, for the message.
        what: What needs it.
        size: How much [bytes].
        way_out: What would need less.

    Raises:
        TooLargeError: It does not fit.
    """
    free = free_memory()
    if free is not None and size > _SHARE * free:
        raise TooLargeError(
            f"{place}: {what} would need {size / 1e9:.3g} GB of memory, and this machine has "
            f"{free / 1e9:.3g} GB free; {way_out}"
        )


def cores() -> int:
    """Return the number of processor cores that this process may use."""
    usable = getattr(os, "sched_getaffinity", None)  # of Linux
    return len(usable(0)) if usable else os.cpu_count() or 1


def free_memory() -> float | None:
    """Return the memory that this process may still allocate [bytes]; None if unknown."""
    found = []
    with contextlib.suppress(OSError, ValueError, IndexError, StopIteration):
        lines = Path("/proc/meminfo").read_text().splitlines()
        found.append(1024.0 * int(next(line for line in lines if line.startswith("MemAvailable")).split()[1]))
    with contextlib.suppress(OSError, ValueError):  # of a container; "max" is none
        most = int((_CGROUP / "memory.max").read_text())
        found.append(float(most - int((_CGROUP / "memory.current").read_text())))
    with contextlib.suppress(OSError, ValueError, IndexError, ImportError):
        import resource  # not on Windows

        most, _ = resource.getrlimit(resource.RLIMIT_AS)
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        if most != resource.RLIM_INFINITY:
            found.append(float(most - pages * resource.getpagesize()))
    return max(min(found), 0.0) if found else None
