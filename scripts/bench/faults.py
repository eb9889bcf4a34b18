#!/usr/bin/env python3
"""Random faults: is every result whole, or as it was, whatever kills a command on its way?

``run``, ``record``, ``report``, ``plot`` and ``urdf`` are started again and again. At a random moment of its
time each is killed, or sent Ctrl-C, SIGTERM or SIGHUP; or the disk that it writes to is full at a random
place (a small file system in memory where this may mount one, a limit on the size of files elsewhere). Where
it writes there is an older result in every other trial. What must hold:

- every file at the output's place is whole: the older one, byte for byte, or the new one, which is read;
- a run that Ctrl-C, SIGTERM or SIGHUP has stopped on its way has saved what it had, and says so;
- a result for which there was no room is elsewhere and whole, if there is any room;
- the exit code is the documented one, at most one line is said in refusal, and no traceback;
- no temporary file is left, not even of the killed, once another command has written there.

Then random bits of a result are flipped, one at a time: each must be noticed when it is loaded::

    scripts/bench/faults.py                            # 200 trials, 200 bits
    scripts/bench/faults.py --trials 1000 --seed 7

Commands are started by ``fork`` after all imports, so that faults hit their work; what comes before has
tests of its own (``tests/test_signals.py``). Exit code 1 on any failure.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from antenna_pin import AntennaPinError, Trajectory, Urdf, load_scenario, simulate
from antenna_pin._entry import main as command
from antenna_pin.files import check_writable

SIGNALS = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
PATIENCE = 120.0  # [s]; a command that takes longer hangs
CASE = ("bai2020", "--set", "clearance.elevation.geometry=closed-form")

# The words of each command but for its output, and that output's name.
COMMANDS: dict[str, tuple[tuple[str, ...], str]] = {
    "run": (("run", *CASE, "--duration", "0.3", "--no-progress", "--no-summary"), "new.nc"),
    "record": (("record", "run.nc"), "page.html"),
    "report": (("report", "run.nc", "--no-figures"), "page.html"),
    "plot": (("plot", "run.nc", "--figure", "energy", "--figure", "contact_forces"), "figures"),
    "urdf": (("urdf", *CASE), "new.urdf"),
}


@dataclass(frozen=True)
class Trial:
    """One command and what befalls it.

    Attributes:
        name: Of the command.
        fault: A signal's name, or ``full``.
        moment: Of the command's own time, or of its output's size, when it comes [-].
        older: Whether there is an older result in its place.
    """

    name: str
    fault: str
    moment: float
    older: bool


@dataclass(frozen=True)
class Ended:
    """How a command ended: its exit code, or minus the signal that ended it, what it said, and when [s]."""

    code: int
    said: str
    seconds: float


def started(words: tuple[str, ...], folder: Path, limit: int | None = None) -> tuple[int, int]:
    """Start a command in a folder; return its process and where its words can be read."""
    ours, theirs = os.pipe()
    process = os.fork()
    if process:
        os.close(theirs)
        return process, ours
    code = 70
    try:
        os.setpgid(0, 0)
        os.chdir(folder)
        for stream in (1, 2):
            os.dup2(theirs, stream)
        os.environ.update(HOME=str(folder / "home"), TMPDIR=str(folder / "home"))
        tempfile.tempdir = None
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        sys.argv = ["antenna-pin", *words]
        command()
    except SystemExit as ended:
        code = int(ended.code or 0)
    except BaseException:  # what Python would do in a process of its own
        traceback.print_exc()
    finally:
        with contextlib.suppress(OSError, ValueError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def ended(process: int, words: int, began: float, at: float | None = None, number: int = 0) -> Ended:
    """Wait for a command's end, and send it a signal at some time after its start [s]."""
    said = b""
    sent = at is None
    with open(words, "rb", buffering=0) as stream:
        while True:
            now = time.monotonic() - began
            if not sent and at is not None and now >= at:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, number)
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
            subprocess.run(["umount", str(folder)], check=True)


def is_whole(path: Path) -> bool:
    """Whether a file is a whole result of its kind."""
    if path.suffix == ".nc":
        try:
            Trajectory.load(path)
        except AntennaPinError:
            return False
        return True
    if path.suffix == ".urdf":
        try:
            Urdf.load(path)
        except AntennaPinError:
            return False
        return True
    content = path.read_bytes()
    if path.suffix == ".png":
        return content.startswith(b"\x89PNG") and content.endswith(b"IEND\xaeB`\x82")
    return content.startswith(b"<!") and content.rstrip().endswith(b"</html>")


def files_in(place: Path) -> dict[str, bytes]:
    """Return what stands at an output's place: a file, or the files of a folder, temporary ones apart."""
    if place.is_dir():
        return {path.name: path.read_bytes() for path in sorted(place.glob("[!.]*"))}
    return {place.name: place.read_bytes()} if place.exists() else {}


class Bench:
    """The commands' own times and outputs, and the trials.

    Args:
        folder: An empty one.
    """

    def __init__(self, folder: Path) -> None:
        """Make the result that the commands read, and let each of them end by itself."""
        self.folder = folder
        self.run = simulate(load_scenario("bai2020"), duration=0.02).save(folder / "run.nc")
        self.seconds: dict[str, float] = {}
        self.older: dict[str, dict[str, bytes]] = {}
        for name, (words, output) in COMMANDS.items():
            for _ in range(2):  # the first warms up
                place = self._prepared(f"own-{name}")
                found = ended(*started((*words, "--out", f"out/{output}"), place), time.monotonic())
                assert found.code == 0, found.said
            self.seconds[name] = found.seconds
            self.older[name] = files_in(place / "out" / output)

    def _prepared(self, name: str) -> Path:
        place = self.folder / name
        shutil.rmtree(place, ignore_errors=True)
        for sub in ("out", "home"):
            (place / sub).mkdir(parents=True)
        shutil.copy(self.run, place / "run.nc")
        return place

    def _put_older(self, name: str, out: Path) -> None:
        output = COMMANDS[name][1]
        for file, content in self.older[name].items():
            path = out / output / file if output == "figures" else out / file
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(content)

    def problem_of(self, trial: Trial) -> str | None:
        """Return what of all that must hold does not; None if all does."""
        words, output = COMMANDS[trial.name]
        words = (*words, "--out", f"out/{output}")
        place = self._prepared("trial")
        out = place / "out"
        with contextlib.ExitStack() as stack:
            limit, at, number = None, None, 0
            if trial.fault == "full":
                written = max(map(len, self.older[trial.name].values()))
                # Beside an older result, which takes its room, there is as much as the moment says.
                room = int(trial.moment * written) + 4096
                older = sum(map(len, self.older[trial.name].values())) if trial.older else 0
                if not stack.enter_context(small_disk(out, room + older + 8192 * trial.older)):
                    limit = room
            else:
                at, number = trial.moment * self.seconds[trial.name], signal.Signals[trial.fault]
            if trial.older:
                self._put_older(trial.name, out)
            before = files_in(out / output)
            found = ended(*started(words, place, limit), time.monotonic(), at, number)
            return self._fault(trial, place, before, found)

    def _fault(self, trial: Trial, place: Path, before: dict[str, bytes], found: Ended) -> str | None:
        out = place / "out" / COMMANDS[trial.name][1]
        for name in files_in(out):
            path = out / name if out.is_dir() else out
            if path.read_bytes() != before.get(name) and not is_whole(path):
                return f"{name} is torn"
        if not set(before) <= set(files_in(out)):
            return "the older result is gone"
        if "Traceback" in found.said:
            return f"a traceback: {found.said[-400:]!r}"
        refusals = [line for line in found.said.splitlines() if line.startswith("antenna-pin: ")]
        if len([line for line in refusals if not line.startswith("antenna-pin: note")]) > 1:
            return f"more than one line: {found.said!r}"
        if found.code not in self._codes(trial):
            return f"exit code {found.code}: {found.said[-300:]!r}"
        if found.code == 0 and not files_in(out):
            return "nothing written"
        if "instead" in found.said and not any(map(is_whole, self._elsewhere(place))):
            return f"the result that should be elsewhere is not whole: {found.said!r}"
        if found.code > 128 and f"saved out/{out.name}" in found.said and not is_whole(out):
            return "what is said to be saved is not"
        for folder in {out if out.is_dir() else out.parent, out.parent, place}:
            with contextlib.suppress(AntennaPinError):  # there is no room for a block
                check_writable(folder / "another")
            left = [path.name for path in folder.glob(".antenna-pin-*")]
            if left:
                return f"left behind: {left}"
        return None

    @staticmethod
    def _elsewhere(place: Path) -> Iterator[Path]:
        yield from (path for path in place.glob("*.nc") if path.name != "run.nc")
        yield from (place / "home").glob("*.nc")

    @staticmethod
    def _codes(trial: Trial) -> set[int]:
        if trial.fault == "full":
            return {0, 2}
        number = signal.Signals[trial.fault]
        # Before its first line and after its last a command is ended by the signal itself.
        return {0, -number} if number == signal.SIGKILL else {0, -number, 128 + number}


def unnoticed_bits(run: Path, count: int, chance: random.Random) -> int:
    """Return how many of so many flipped bits are not noticed."""
    content = run.read_bytes()
    path = run.with_name("flipped.nc")
    unnoticed = 0
    for _ in range(count):
        bit = chance.randrange(8 * len(content))
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        with contextlib.suppress(AntennaPinError):
            Trajectory.load(path)
            unnoticed += 1
            print(f"bit {bit} of {8 * len(content)}: not noticed")
    return unnoticed


def draw(chance: random.Random) -> Trial:
    """Return a random trial."""
    fault = chance.choice(["full", *(number.name for number in SIGNALS)])
    return Trial(chance.choice([*COMMANDS]), fault, chance.uniform(0.0, 1.1), chance.random() < 0.5)


def main() -> int:
    """Make the trials and tell of those that fail."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--bits", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    chance = random.Random(asked.seed)
    failed = 0
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        bench = Bench(Path(name))
        tried: Counter[tuple[str, str]] = Counter()
        for number in range(asked.trials):
            trial = draw(chance)
            tried[trial.name, trial.fault] += 1
            problem = bench.problem_of(trial)
            if problem is not None:
                failed += 1
                print(f"{number}: {trial}: {problem}", flush=True)
        unnoticed = unnoticed_bits(bench.run, asked.bits, chance)
    faults = [*dict.fromkeys(fault for _, fault in sorted(tried))]
    print("        " + "".join(f"{fault:>9}" for fault in faults))
    for name in COMMANDS:
        print(f"{name:8}" + "".join(f"{tried[name, fault]:9}" for fault in faults))
    print(f"{asked.trials} faults, {failed} results not whole or commands that ended as they must not")
    print(f"{asked.bits} bits flipped, {unnoticed} not noticed")
    return 1 if failed or unnoticed else 0


if __name__ == "__main__":
    sys.exit(main())
