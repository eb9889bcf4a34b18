"""A command in a process of its own, forked after all imports: started, waited for, and what it has said."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from antenna_pin._entry import main as command

__all__ = ["Ended", "ended", "started", "unsaid"]

PATIENCE = 120.0  # [s]; a command that takes longer hangs


@dataclass(frozen=True)
class Ended:
    """How a command ended: its exit code, or minus the signal that ended it, what it said, and when [s]."""

    code: int
    said: str
    seconds: float


def started(words: Sequence[str], folder: Path, hook: Callable[[], None] | None = None) -> tuple[int, int]:
    """Start a command in a folder; return its process and where its words can be read.

    Args:
        words: Of the command.
        folder: The current one.
        hook: What is done in the process first.
    """
    ours, theirs = os.pipe()
    process = os.fork()
    if process:
        os.close(theirs)
        return process, ours
    code = 70
    try:
        os.setpgid(0, 0)
        os.close(ours)
        os.chdir(folder)
        for stream in (1, 2):
            os.dup2(theirs, stream)
        # As Python has them where it starts so.
        sys.stdout = sys.__stdout__ = open(1, "w", closefd=False)  # type: ignore[misc]
        sys.stderr = sys.__stderr__ = open(2, "w", buffering=1, closefd=False)  # type: ignore[misc]
        os.environ.update(HOME=str(folder / "home"), TMPDIR=str(folder / "home"))
        tempfile.tempdir = None
        sys.argv = ["antenna-pin", *words]
        if hook is not None:
            hook()
        command()
        sys.stdout.flush()
        code = 0
    except SystemExit as ended:
        code = int(ended.code or 0)
    except BaseException:  # what Python would do in a process of its own
        traceback.print_exc()
        code = 1
    finally:
        with contextlib.suppress(OSError, ValueError):
            sys.stderr.flush()
        os._exit(code)


def ended(
    process: int, words: int, began: float, at: float | None = None, act: Callable[[int], None] | None = None
) -> Ended:
    """Wait for a command's end, and do something to it at some time after its start [s]."""
    said = b""
    sent = at is None or act is None
    with open(words, "rb", buffering=0) as stream:
        while True:
            now = time.monotonic() - began
            if not sent and at is not None and act is not None and now >= at:
                with contextlib.suppress(ProcessLookupError):
                    act(process)
                sent = True
            if now > PATIENCE:
                os.kill(process, signal.SIGKILL)
            wait = 0.1 if sent or at is None else max(at - now, 0.0)
            if select.select([stream], [], [], wait)[0]:
                found = stream.read(65536)
                if not found:
                    break
                said += found
    _, status = os.waitpid(process, 0)
    return Ended(os.waitstatus_to_exitcode(status), said.decode(errors="replace"), time.monotonic() - began)


def unsaid(found: Ended, codes: set[int]) -> str | None:
    """Return what a command has not said or done as documented; None if all is.

    Args:
        found: How it ended.
        codes: Exit codes that it may have.
    """
    if "Traceback" in found.said or "Error:" in found.said.replace("antenna-pin: ", "")[:9]:
        return f"a traceback: {found.said[-400:]!r}"
    lines = [line for line in found.said.splitlines() if line.startswith("antenna-pin: ")]
    lines = [line for line in lines if not line.startswith("antenna-pin: note")]
    if found.code == 2 and len(lines) != 1:
        return f"exit code {found.code} and {len(lines)} lines: {found.said[-400:]!r}"
    return None if found.code in codes else f"exit code {found.code}: {found.said[-400:]!r}"
