"""Commands in processes of their own: started, waited for, and judged by exit code, words and files."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import zipfile
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import psutil

from antenna_pin import AntennaPinError, Trajectory, Urdf
from antenna_pin.apps._entry import main as command
from antenna_pin.base.files import has_whole_seal
from robust.trials import ends_with, must, write_files

ROOT = Path(__file__).parents[3]
TEMPORARY = ".antenna-pin-"  # how names of files begin that are being written

_ENTRY = "import sys; from antenna_pin.apps._entry import main; sys.argv[0] = 'antenna-pin'; sys.exit(main())"
#: Program of the command in a new interpreter.
ANEW = (sys.executable, "-c", _ENTRY)

#: Variable of the environment by which the processes of a command are found, whoever has started them.
MARK = "ROBUST_COMMAND"

_NUMBERS = itertools.count()
_LINE = re.compile(r"antenna-pin: (?!note)|docs: ")
_TRACEBACK = re.compile(r"Traceback|\A(antenna-pin: )?.{0,4}Error:")


@dataclass(frozen=True)
class Ended:
    """The end of a command."""

    code: int  # exit code, or minus the signal that ended it
    said: str  # standard output and error stream
    seconds: float  # time from its start [s]
    acted: bool  # whether something was done to it before


class Child:
    """A command in a process and a process group of its own.

    Args:
        words: Of the command.
        folder: The current one; a folder ``home`` in it is that of the user.
        hook: Called in the process before anything else.
        program: Given the words; without one the command runs in a fork, after all imports.
    """

    def __init__(
        self,
        words: Sequence[str],
        folder: Path,
        hook: Callable[[], None] | None = None,
        program: Sequence[str] = (),
    ) -> None:
        """Start it."""
        self._pipe, theirs = os.pipe()
        parent = os.getpid()
        self._mark = f"{parent}-{next(_NUMBERS)}"
        self.pid = os.fork()
        if not self.pid:
            os.environ[MARK] = self._mark
            _become(parent, theirs, words, folder, hook, program)
        os.close(theirs)
        self.began = time.monotonic()

    def ended(
        self,
        due: float | Callable[[], bool] = 0.0,
        act: Callable[[int], object] | None = None,
        patience: float = 120.0,
    ) -> Ended:
        """Wait for the end, and act on the process once.

        Args:
            due: Time from the start [s], or a function that returns whether it is time.
            act: Is given the process.
            patience: Time from the start that it may take [s].

        Raises:
            TrialError: It takes longer.
        """
        said, acted = b"", False
        with contextlib.ExitStack() as unfinished, open(self._pipe, "rb", buffering=0) as stream:
            unfinished.callback(lambda: (os.killpg(self.pid, signal.SIGKILL), os.waitpid(self.pid, 0)))
            while True:
                seconds = time.monotonic() - self.began
                if act is not None and not acted and (due() if callable(due) else seconds >= due):
                    with contextlib.suppress(ProcessLookupError):
                        act(self.pid)
                    acted = True
                must(seconds <= patience, f"did not end within {patience:g} s: {said[-400:]!r}")
                if select.select([stream], [], [], 0.1 if acted or act is None else 0.005)[0]:
                    block = stream.read(65536)
                    if not block:
                        break
                    said += block
            unfinished.pop_all()
        _, status = os.waitpid(self.pid, 0)
        seconds = time.monotonic() - self.began
        return Ended(os.waitstatus_to_exitcode(status), said.decode(errors="replace"), seconds, acted)

    def processes(self) -> list[int]:
        """Return its processes, and those that they have started: those of a ``program`` alone."""
        mark = f"{MARK}={self._mark}".encode()
        return [number for number in psutil.pids() if mark in _environment(number).split(b"\0")]


def _environment(process: int) -> bytes:
    """Return the environment that a process was started with; none of one that has ended."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{process}/environ").read_bytes()
    return b""


def _become(
    parent: int, output: int, words: Sequence[str], folder: Path, hook: Any, program: Sequence[str]
) -> None:
    """Make this process, which was forked, that of a command, and end it."""
    code = 70
    try:
        os.setpgid(0, 0)
        ends_with(parent)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        os.chdir(folder)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        for stream in (1, 2):
            os.dup2(output, stream)
        os.environ["PYTHONPATH"] = str(ROOT)  # this checkout, wherever the command works
        if (folder / "home").is_dir():
            os.environ.update(HOME=str(folder / "home"), TMPDIR=str(folder / "home"))
            tempfile.tempdir = None
        # As Python has them where it starts so.
        sys.stdout = sys.__stdout__ = open(1, "w", closefd=False)  # type: ignore[misc]
        sys.stderr = sys.__stderr__ = open(2, "w", buffering=1, closefd=False)  # type: ignore[misc]
        if hook is not None:
            hook()
        if program:
            os.execv(program[0], [*program, *words])
        sys.argv = ["antenna-pin", *words]
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


def judge(
    end: Ended,
    codes: Collection[int],
    in_one_line: Collection[int] = (2,),
    noise: re.Pattern[str] = _TRACEBACK,
) -> None:
    """Raise what is wrong with the exit code and the words of a command.

    Args:
        end: Of the command.
        codes: Exit codes that it may have.
        in_one_line: Exit codes with which it says why in one line.
        noise: What it must not say.
    """
    must(not noise.search(end.said), f"said {end.said[-400:]!r}")
    lines = sum(bool(_LINE.match(line)) for line in end.said.splitlines())
    must(end.code in codes, f"exit code {end.code}: {end.said[-400:]!r}")
    brief = lines == 1 or end.code not in in_one_line
    must(brief, f"exit code {end.code} and {lines} lines: {end.said[-400:]!r}")


# --- files and disks ---------------------------------------------------------------------------------------


def prepared(folder: Path, files: Mapping[str, bytes] | None = None) -> Path:
    """Return a folder with files alone, and with folders ``out`` for outputs and ``home`` for the user."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("out", "home"):
        (folder / name).mkdir(parents=True)
    write_files(folder, files or {})
    return folder


def temporary_files(folder: Path) -> list[str]:
    """Return the files of a folder that somebody has begun to write, and not put in their place."""
    return [str(path.relative_to(folder)) for path in folder.rglob(f"{TEMPORARY}*")]


def is_whole(path: Path) -> bool:
    """Return whether a file is a whole one of its kind."""
    content = path.read_bytes()
    try:
        match path.suffix:
            case ".nc":
                with h5py.File(path, "r") as file:
                    runs = "trajectory" in str(file.attrs.get("format"))
                return bool(has_whole_seal(path)) and (not runs or Trajectory.load(path) is not None)
            case ".urdf":
                return Urdf.load(path) is not None
            case ".png":
                return content.startswith(b"\x89PNG") and content.endswith(b"IEND\xaeB`\x82")
            case ".fmu":
                return zipfile.is_zipfile(path) and zipfile.ZipFile(path).testzip() is None
            case ".html":
                return content.startswith(b"<!") and content.rstrip().endswith(b"</html>")
            case ".csv":
                return content.endswith(b"\n")
    except (AntennaPinError, OSError):
        return False
    return True


@contextlib.contextmanager
def small_disk(folder: Path, size: int) -> Iterator[bool]:
    """Mount a file system of so many bytes at a folder; yield whether that could be done."""
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size},mode=700", "tmpfs", str(folder)]
    mounted = subprocess.run(mount, capture_output=True, check=False).returncode == 0
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", "-l", str(folder)], check=True)


def remount(folder: Path, option: str) -> None:
    """Give a file system that is mounted another option."""
    subprocess.run(["mount", "-o", f"remount,{option}", str(folder)], check=True)
