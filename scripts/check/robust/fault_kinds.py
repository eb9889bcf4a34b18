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

_DONE_OR_REFUSED = (0, 2)
_NOBODY = 65534


@dataclass
class Fault:
    """One fault of one command.

    Attributes:
        codes: Exit codes that are right then.
        hook: Called in the command's process before it begins.
        act: Called at the moment of the fault, with the process.
        armed: Called when all is ready.
        mended: Called to make all well again.
        takes_away: Whether files at the output's place may be gone because of it.
    """

    codes: tuple[int, ...] = _DONE_OR_REFUSED
    hook: Callable[[], object] | None = None
    act: Callable[[int], object] | None = None
    armed: Callable[[], object] = field(default=lambda: None)
    mended: Callable[[], object] = field(default=lambda: None)
    takes_away: bool = False


@dataclass(frozen=True)
class At:
    """Place and size of a fault.

    Attributes:
        folder: Of the command.
        moment: Part of the command's time, or of its output's size, at which the fault comes [-].
        size: Of the output [B].
        older: Size of an older output in its place [B].
    """

    folder: Path
    moment: float
    size: int
    older: int

    @property
    def out(self) -> Path:
        """Folder of the output."""
        return self.folder / "out"

    def limit(self, what: int, least: int = 0) -> None:
        """Limit a resource of this process to a part of the output's size."""
        most = least + int(self.moment * self.size)
        resource.setrlimit(what, (most, most))


FAULTS: dict[str, Callable[[At], AbstractContextManager[Fault]]] = {}
"""Makers of faults, by name."""


def fault(make: Callable[[At], Iterator[Fault]]) -> None:
    """Add a kind of fault."""
    FAULTS[make.__name__.replace("_", " ")] = contextlib.contextmanager(make)


def in_process(*codes: int) -> Callable[[Callable[[At], None]], None]:
    """Add a kind of fault that is made in the command's process before it begins."""

    def add(hook: Callable[[At], None]) -> None:
        def make(at: At) -> Iterator[Fault]:
            yield Fault(codes or _DONE_OR_REFUSED, hook=lambda: hook(at))

        make.__name__ = hook.__name__
        fault(make)

    return add


def _add_signal(name: str) -> None:
    number = signal.Signals[name]
    # Before its first line and after its last a command is ended by the signal itself.
    codes = (0, -number) if number == signal.SIGKILL else (0, -number, 128 + number)

    def make(at: At) -> Iterator[Fault]:
        yield Fault(codes, act=lambda process: os.kill(process, number))

    make.__name__ = name
    fault(make)


for _name in ("SIGKILL", "SIGINT", "SIGTERM", "SIGHUP"):
    _add_signal(_name)


# --- disks and folders -------------------------------------------------------------------------------------


@fault
def full_disk(at: At) -> Iterator[Fault]:
    """There is room for a part of the output only."""
    # Beside an older result, which takes its room, there is as much as the moment says.
    room = int(at.moment * at.size) + 4096 + at.older + 8192 * (at.older > 0)
    with small_disk(at.out, room) as mounted:
        if mounted:
            yield Fault(mended=lambda: remount(at.out, "size=1g"))
        else:
            yield Fault(hook=lambda: at.limit(resource.RLIMIT_FSIZE, 4096))


@in_process()
def longest_file(at: At) -> None:
    """No file may be longer than a part of the output."""
    at.limit(resource.RLIMIT_FSIZE)


@fault
def read_only(at: At) -> Iterator[Fault]:
    """Nothing can be written, from a moment on."""
    with small_disk(at.out, 1 << 30) as mounted:

        def protect(process: int) -> None:
            with contextlib.suppress(subprocess.CalledProcessError):  # while a file is open it is busy
                remount(at.out, "ro")

        yield Fault(act=protect, mended=lambda: remount(at.out, "rw")) if mounted else Fault()


@fault
def nobody(at: At) -> Iterator[Fault]:
    """A user works there who may write nowhere, not even beside the sources."""

    def become() -> None:
        if os.geteuid() == 0:
            os.setgid(_NOBODY)
            os.setuid(_NOBODY)

    def open_all() -> None:
        for path in (at.folder, at.folder.parent):
            path.chmod(0o755)

    yield Fault(hook=become, armed=open_all)


@fault
def vanished_inputs(at: At) -> Iterator[Fault]:
    """What is read is gone at some moment, or was never there."""
    yield Fault(act=lambda process: [path.unlink() for path in at.folder.iterdir() if path.is_file()])


@fault
def vanished_output(at: At) -> Iterator[Fault]:
    """The folder that is written to is gone at some moment."""
    yield Fault(act=lambda process: shutil.rmtree(at.out, ignore_errors=True), takes_away=True)


@fault
def vanished_folder(at: At) -> Iterator[Fault]:
    """The folder that is worked in is gone at some moment."""
    yield Fault(act=lambda process: shutil.rmtree(at.folder, ignore_errors=True), takes_away=True)


# --- memory and streams ------------------------------------------------------------------------------------


# Code that is loaded into memory, by LLVM, ends the process where there is none, with a word of its own.
@in_process(0, 2, -signal.SIGABRT)
def little_memory(at: At) -> None:
    """There is hardly more memory than the process has when it starts."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + int(at.moment**4 * 30e6)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


@in_process()
def few_files(at: At) -> None:
    """Hardly a file more can be opened."""
    most = max(map(int, os.listdir("/proc/self/fd"))) + 1 + int(4 * at.moment)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


@in_process()
def full_output(at: At) -> None:
    """What is printed goes to a device that is full."""
    full = os.open("/dev/full", os.O_WRONLY)
    os.dup2(full, 1)
    os.close(full)


@in_process()
def closed_output(at: At) -> None:
    """There is nothing to print to."""
    os.close(1)
    sys.stdout = None  # type: ignore[assignment]  # as Python has it where it starts so


@in_process(0, 1, 2)
def gone_reader(at: At) -> None:
    """What is printed goes into a pipe that nobody reads: the command ends without a word."""
    ours, theirs = os.pipe()
    os.dup2(theirs, 1)
    os.close(ours)
    os.close(theirs)
