"""Faults that may befall a command: signals, disks, folders, memory, streams."""

from __future__ import annotations

import contextlib
import os
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path

from robust.children import remount, small_disk
from robust.trials import ends_with

_DONE_OR_REFUSED = (0, 2)
_NOBODY = 65534


@dataclass
class Fault:
    """One fault of one command."""

    codes: tuple[int, ...] = _DONE_OR_REFUSED  # exit codes that are right then
    hook: Callable[[], object] | None = None  # called in the command's process before it begins
    act: Callable[[int], object] | None = None  # called at the moment of the fault, with the process
    armed: Callable[[], object] = field(default=lambda: None)  # called when all is ready
    mended: Callable[[], object] = field(default=lambda: None)  # called to make all well again
    takes_away: bool = False  # whether files at the output's place may be gone because of it


@dataclass(frozen=True)
class At:
    """Place and size of a fault."""

    folder: Path  # of the command
    moment: float  # part of the command's time, or of its output's size, at which the fault comes [-]
    size: int  # of the output [B]
    older: int  # size of an older output in its place [B]

    def limit(self, what: int, least: int = 0) -> None:
        """Limit a resource of this process to a part of the output's size."""
        most = least + int(self.moment * self.size)
        resource.setrlimit(what, (most, most))


def _signal(number: signal.Signals) -> Fault:
    # Before its first line and after its last a command is ended by the signal itself.
    codes = (0, -number) if number == signal.SIGKILL else (0, -number, 128 + number)
    return Fault(codes, act=lambda process: os.kill(process, number))


@contextlib.contextmanager
def _full_disk(at: At) -> Iterator[Fault]:
    # Beside an older result, which takes its room, there is as much as the moment says.
    room = int(at.moment * at.size) + 4096 + at.older + 8192 * (at.older > 0)
    with small_disk(at.folder / "out", room) as mounted:
        if mounted:
            yield Fault(mended=lambda: remount(at.folder / "out", "size=1g"))
        else:
            yield Fault(hook=lambda: at.limit(resource.RLIMIT_FSIZE, 4096))


@contextlib.contextmanager
def _read_only(at: At) -> Iterator[Fault]:
    def protect(process: int) -> None:
        with contextlib.suppress(subprocess.CalledProcessError):  # while a file is open it is busy
            remount(at.folder / "out", "ro")

    with small_disk(at.folder / "out", 1 << 30) as mounted:
        yield Fault(act=protect, mended=lambda: remount(at.folder / "out", "rw")) if mounted else Fault()


def _nobody(at: At) -> Fault:
    def become() -> None:
        if os.geteuid() == 0:
            os.setgid(_NOBODY)
            os.setuid(_NOBODY)
            ends_with(os.getppid())  # which a change of the user has undone

    return Fault(hook=become, armed=lambda: [path.chmod(0o755) for path in (at.folder, at.folder.parent)])


def _vanished(folder: Path) -> Fault:
    return Fault(act=lambda process: shutil.rmtree(folder, ignore_errors=True), takes_away=True)


def _little_memory(at: At) -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + int(at.moment**4 * 30e6)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _few_files(at: At) -> None:
    most = max(map(int, os.listdir("/proc/self/fd"))) + 1 + int(4 * at.moment)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


def _closed_output() -> None:
    os.close(1)
    sys.stdout = None  # type: ignore[assignment]  # as Python has it where it starts so


def _gone_reader() -> None:
    ours, theirs = os.pipe()
    os.dup2(theirs, 1)
    os.close(ours)
    os.close(theirs)


#: Makers of faults, by name; what a fault lasts for is a context.
FAULTS: dict[str, Callable[[At], Fault | AbstractContextManager[Fault]]] = {
    **{
        number.name: lambda at, number=number: _signal(number)  # type: ignore[misc]
        for number in (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    },
    # There is room for a part of the output only.
    "full disk": _full_disk,
    "longest file": lambda at: Fault(hook=lambda: at.limit(resource.RLIMIT_FSIZE)),
    # Nothing can be written, from a moment on.
    "read only": _read_only,
    # A user works there who may write nowhere, not even beside the sources.
    "nobody": _nobody,
    # What is read, written or worked in is gone at some moment, or was never there.
    "vanished inputs": lambda at: Fault(
        act=lambda process: [path.unlink() for path in at.folder.iterdir() if path.is_file()]
    ),
    "vanished output": lambda at: _vanished(at.folder / "out"),
    "vanished folder": lambda at: _vanished(at.folder),
    # Hardly more than the process has when it starts. Code that is loaded into memory, by LLVM, ends the
    # process where there is none, with a word of its own.
    "little memory": lambda at: Fault((0, 2, -signal.SIGABRT), hook=lambda: _little_memory(at)),
    "few files": lambda at: Fault(hook=lambda: _few_files(at)),
    # What is printed goes to a device that is full, to nothing, or into a pipe that nobody reads.
    "full output": lambda at: Fault(hook=lambda: os.dup2(os.open("/dev/full", os.O_WRONLY), 1)),
    "closed output": lambda at: Fault(hook=_closed_output),
    "gone reader": lambda at: Fault((0, 1, 2), hook=_gone_reader),
}


@contextlib.contextmanager
def fault(kind: str, at: At) -> Iterator[Fault]:
    """Have a fault of some kind as long as the body of a ``with`` statement lasts."""
    made = FAULTS[kind](at)
    with contextlib.nullcontext(made) if isinstance(made, Fault) else made as one:
        yield one
