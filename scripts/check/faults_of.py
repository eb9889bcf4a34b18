"""What may befall a command: signals, disks, folders, memory, streams."""

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

__all__ = ["FAULTS", "Fault", "small_disk"]

_DONE_OR_REFUSED = (0, 2)
_NOBODY = 65534


def _nothing() -> None:
    """Do nothing."""


@dataclass
class Fault:
    """What befalls one command.

    Attributes:
        codes: Exit codes that are right then.
        hook: What is done in its process before it begins.
        act: What is done at its moment, to a process.
        armed: What is done when all is ready for it.
        mended: What makes all well again.
        takes_away: Whether files at the output's place may be gone because of it.
    """

    codes: tuple[int, ...] = _DONE_OR_REFUSED
    hook: Callable[[], None] | None = None
    act: Callable[[int], None] | None = None
    armed: Callable[[], object] = field(default=_nothing)
    mended: Callable[[], object] = field(default=_nothing)
    takes_away: bool = False


Maker = Callable[[Path, float, int, int], AbstractContextManager[Fault]]
"""Makes a fault of: the folder worked in, its moment, the output's size, and that of an older one."""

FAULTS: dict[str, Maker] = {}
"""By name."""


def fault(make: Callable[[Path, float, int, int], Iterator[Fault]]) -> None:
    """Add a kind of fault."""
    FAULTS[make.__name__.replace("_", " ")] = contextlib.contextmanager(make)


@contextlib.contextmanager
def small_disk(folder: Path, size: int) -> Iterator[bool]:
    """Mount a file system of so many bytes at a folder; yield whether that could be done."""
    option = f"size={size},mode=700"
    done = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", option, "tmpfs", str(folder)], capture_output=True, check=False
    )
    try:
        yield done.returncode == 0
    finally:
        if done.returncode == 0:
            subprocess.run(["umount", "-l", str(folder)], check=True)


def _remount(folder: Path, option: str) -> None:
    subprocess.run(["mount", "-o", f"remount,{option}", str(folder)], check=True)


# --- signals -----------------------------------------------------------------------------------------------


def _signalled(name: str) -> Maker:
    number = signal.Signals[name]

    @contextlib.contextmanager
    def make(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
        # Before its first line and after its last a command is ended by the signal itself.
        codes = (0, -number) if number == signal.SIGKILL else (0, -number, 128 + number)
        yield Fault(codes, act=lambda process: os.kill(process, number))

    return make


for _name in ("SIGKILL", "SIGINT", "SIGTERM", "SIGHUP"):
    FAULTS[_name] = _signalled(_name)


# --- disks and folders -------------------------------------------------------------------------------------


@fault
def full_disk(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """There is room for a part of the output only."""
    # Beside an older result, which takes its room, there is as much as the moment says.
    room = int(moment * size) + 4096
    with small_disk(place / "out", room + older + 8192 * (older > 0)) as mounted:
        if mounted:
            yield Fault(mended=lambda: _remount(place / "out", "size=1g"))
        else:
            yield Fault(hook=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)))


@fault
def longest_file(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """No file may be longer than a part of the output."""
    room = int(moment * size)
    yield Fault(hook=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room)))


@fault
def read_only(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """Nothing can be written, from a moment on."""
    with small_disk(place / "out", 1 << 30) as mounted:
        if not mounted:
            yield Fault()
            return

        def protect(process: int) -> None:
            with contextlib.suppress(subprocess.CalledProcessError):  # while a file is open it is busy
                _remount(place / "out", "ro")

        yield Fault(act=protect, mended=lambda: _remount(place / "out", "rw"))


@fault
def nobody(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """A user works there who may write nowhere, not even beside the sources."""

    def become() -> None:
        if os.geteuid() == 0:
            os.setgid(_NOBODY)
            os.setuid(_NOBODY)

    def open_all() -> None:
        for path in (place, *place.parents[:1]):
            path.chmod(0o755)

    yield Fault(hook=become, armed=open_all)


@fault
def vanished_inputs(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """What is read is gone at some moment, or was never there."""

    def take(process: int) -> None:
        for path in place.iterdir():
            if path.is_file():
                path.unlink()

    yield Fault(act=take)


@fault
def vanished_output(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """The folder that is written to is gone at some moment."""
    yield Fault(act=lambda process: shutil.rmtree(place / "out", ignore_errors=True), takes_away=True)


@fault
def vanished_folder(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """The folder that is worked in is gone at some moment."""
    yield Fault(act=lambda process: shutil.rmtree(place, ignore_errors=True), takes_away=True)


# --- memory and streams ------------------------------------------------------------------------------------


@fault
def little_memory(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """There is hardly more memory than the process has when it starts."""

    def limit() -> None:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + int(moment**4 * 30e6)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))

    # Code that is loaded into memory, by LLVM, ends the process where there is none, with a word of its own.
    yield Fault((0, 2, -signal.SIGABRT), hook=limit)


@fault
def few_files(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """Hardly a file more can be opened."""

    def limit() -> None:
        most = max(map(int, os.listdir("/proc/self/fd"))) + 1 + int(4 * moment)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))

    yield Fault(hook=limit)


@fault
def full_output(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """What is printed goes to a device that is full."""

    def turn() -> None:
        full = os.open("/dev/full", os.O_WRONLY)
        os.dup2(full, 1)
        os.close(full)

    yield Fault(hook=turn)


@fault
def closed_output(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """There is nothing to print to."""

    def close() -> None:
        os.close(1)
        sys.stdout = None  # type: ignore[assignment]  # as Python has it where it starts so

    yield Fault(hook=close)


@fault
def gone_reader(place: Path, moment: float, size: int, older: int) -> Iterator[Fault]:
    """What is printed goes into a pipe that nobody reads: the command ends without a word."""

    def part() -> None:
        ours, theirs = os.pipe()
        os.dup2(theirs, 1)
        os.close(ours)
        os.close(theirs)

    yield Fault(codes=(0, 1, 2), hook=part)
