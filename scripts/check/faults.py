#!/usr/bin/env python3
"""Random faults: is every result whole, or as it was, whatever befalls a command on its way?

Every command that works or writes is started again and again. At a random moment of its time it is killed, or
sent Ctrl-C, SIGTERM or SIGHUP, or its inputs, its output's folder or the folder that it works in vanish; or
the disk it writes to is full at a random place, or read-only, or nobody may write there; memory or open files
run out; nobody reads what it prints. Where it writes there is an older result in every other trial. What must
hold:

- every file at the output's place is whole: the older one, byte for byte, or a new one, which is read;
- the exit code is the documented one; what is not done says so in one line, and nothing in a traceback;
- a result for which there was no room is elsewhere and whole, if there is any room;
- no temporary file is left, but of what was killed, and of that none once another command has written there;
- given again without a fault the same command is done, and leaves what it leaves on a sound machine.

Then random bits of a result are flipped, one at a time: each must be noticed when it is loaded::

    scripts/check/faults.py                            # 200 trials, 200 bits
    scripts/check/faults.py --trials 1000 --seed 7
    scripts/check/faults.py --fault "full disk" --trials 60 --bits 0
    scripts/check/faults.py --only 137                 # one again

Commands are started by ``fork`` after all imports, so that faults hit their work; what comes before has
tests of its own (``tests/test_signals.py``). Exit code 1 on any failure.
"""

from __future__ import annotations

import argparse
import contextlib
import random
import shutil
import signal
import sys
import tempfile
import time
import zipfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
from faults_of import FAULTS, Fault
from forked import Ended, ended, started, unsaid
from fuzzing.made import COMMANDS, made

from antenna_pin import AntennaPinError, Trajectory, Urdf
from antenna_pin.base.files import check_writable, has_whole_seal

TEMPORARY = ".antenna-pin-"  # how names of files begin that are being written


def is_whole(path: Path) -> bool:
    """Whether a file is a whole one of its kind."""
    try:
        if path.suffix == ".nc":
            with h5py.File(path, "r") as file:
                runs = "trajectory" in str(file.attrs.get("format"))
            return bool(has_whole_seal(path)) and (not runs or Trajectory.load(path) is not None)
        if path.suffix == ".urdf":
            return Urdf.load(path) is not None
    except (AntennaPinError, OSError):
        return False
    content = path.read_bytes()
    if path.suffix == ".png":
        return content.startswith(b"\x89PNG") and content.endswith(b"IEND\xaeB`\x82")
    if path.suffix == ".fmu":
        return zipfile.is_zipfile(path) and zipfile.ZipFile(path).testzip() is None
    if path.suffix == ".html":
        return content.startswith(b"<!") and content.rstrip().endswith(b"</html>")
    return path.suffix != ".csv" or content.endswith(b"\n")


def files_in(place: Path) -> dict[str, bytes]:
    """Return what stands at an output's place: a file, or the files of a folder, temporary ones apart."""
    if place.is_dir():
        return {path.name: path.read_bytes() for path in sorted(place.glob("[!.]*")) if path.is_file()}
    return {place.name: place.read_bytes()} if place.exists() else {}


@dataclass(frozen=True)
class Trial:
    """One command and what befalls it.

    Attributes:
        name: Of the command.
        fault: What befalls it.
        moment: Of the command's own time, or of its output's size, when it comes [-].
        older: Whether there is an older result in its place.
    """

    name: str
    fault: str
    moment: float
    older: bool


def drawn(seed: int, number: int, faults: Sequence[str] = tuple(FAULTS)) -> Trial:
    """Return the trial of a number: commands and faults are dealt, so that soon all have met."""
    chance = random.Random(f"{seed}/{number}")
    names = [*COMMANDS]
    fault = faults[number % len(faults)]
    name = names[(number // len(faults) + 7 * (number % len(faults))) % len(names)]
    return Trial(name, fault, chance.uniform(0.0, 1.1), chance.random() < 0.5)


class Bench:
    """The commands' own times and outputs, and the trials.

    Args:
        folder: An empty one.
    """

    def __init__(self, folder: Path) -> None:
        """Make what the commands read."""
        self.folder = folder
        self.seconds: dict[str, float] = {}
        self.older: dict[str, dict[str, bytes]] = {}

    def _learn(self, name: str) -> None:
        """Let a command end by itself, to know how long it takes and what it leaves."""
        if name in self.seconds:
            return
        words, output = COMMANDS[name]
        for _ in range(2):  # the first warms up
            place = self._prepared(f"own-{name}")
            found = ended(*started(words, place), time.monotonic())
            assert found.code == 0, f"{name}: {found.code} {found.said}"
        self.seconds[name] = found.seconds
        self.older[name] = files_in(place / "out" / output)

    def _prepared(self, name: str) -> Path:
        place = self.folder / name
        shutil.rmtree(place, ignore_errors=True)
        for file, content in made().items():
            (place / file).parent.mkdir(parents=True, exist_ok=True)
            (place / file).write_bytes(content)
        for sub in ("out", "home"):
            (place / sub).mkdir()
        return place

    def _put_older(self, name: str, out: Path) -> None:
        output = COMMANDS[name][1]
        for file, content in self.older[name].items():
            path = out / file if file == output else out / output / file
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(content)

    def problem_of(self, trial: Trial) -> str | None:
        """Return what of all that must hold does not; None if all does."""
        self._learn(trial.name)
        words, output = COMMANDS[trial.name]
        place = self._prepared("trial")
        out = place / "out"
        size = sum(map(len, self.older[trial.name].values()))
        with contextlib.ExitStack() as stack:
            room = size if trial.older else 0
            fault = stack.enter_context(FAULTS[trial.fault](place, trial.moment, size, room))
            if trial.older:
                self._put_older(trial.name, out)
            fault.armed()
            before = files_in(out / output)
            at = trial.moment * self.seconds[trial.name]
            found = ended(*started(words, place, fault.hook), time.monotonic(), at, fault.act)
            problem = self._fault(trial, fault, place, before, found)
            fault.mended()
            if problem is None and place.is_dir():
                problem = self._again(trial, place)
        return problem

    def _fault(
        self, trial: Trial, fault: Fault, place: Path, before: dict[str, bytes], found: Ended
    ) -> str | None:
        if wrong := unsaid(found, set(fault.codes)):
            return wrong
        out = place / "out" / COMMANDS[trial.name][1]
        after = files_in(out)
        for name in after:
            path = out / name if out.is_dir() else out
            if path.read_bytes() != before.get(name) and not is_whole(path):
                return f"{name} is torn"
        if not fault.takes_away:
            if not set(before) <= set(after):
                return "the older result is gone"
            if found.code == 0 and self.older[trial.name] and not after:
                return f"nothing written: {found.said!r}"
        if "the result is in " in found.said and not any(map(is_whole, self._elsewhere(place))):
            return f"the result that should be elsewhere is not whole: {found.said!r}"
        if found.code != -signal.SIGKILL and (left := self._left(place)):
            return f"left behind: {left}"
        return None

    def _again(self, trial: Trial, place: Path) -> str | None:
        """Give the command once more, without a fault; return what is not as after a sound one."""
        for file, content in made().items():
            if not (place / file).exists():
                (place / file).parent.mkdir(parents=True, exist_ok=True)
                (place / file).write_bytes(content)
        for sub in ("out", "home"):
            (place / sub).mkdir(exist_ok=True)
        words, output = COMMANDS[trial.name]
        found = ended(*started(words, place), time.monotonic())
        if wrong := unsaid(found, {0}):
            return f"given again: {wrong}"
        after = files_in(place / "out" / output)
        if after.keys() != self.older[trial.name].keys():
            return f"given again it leaves {', '.join(after)}"
        for name in after:
            path = place / "out" / (output if name == output else f"{output}/{name}")
            if not is_whole(path):
                return f"given again: {name} is torn"
        for folder in (place, place / "out", place / "out" / output):
            if folder.is_dir():
                check_writable(folder / "another")  # a command that writes there sweeps
        return f"left behind for ever: {left}" if (left := self._left(place)) else None

    @staticmethod
    def _left(place: Path) -> list[str]:
        return [str(path.relative_to(place)) for path in place.rglob(f"{TEMPORARY}*")]

    @staticmethod
    def _elsewhere(place: Path) -> Iterator[Path]:
        yield from (path for path in place.glob("*.nc") if path.name not in made())
        yield from (place / "home").glob("*.nc")


def unnoticed_bits(run: bytes, folder: Path, count: int, chance: random.Random) -> int:
    """Return how many of so many flipped bits are not noticed."""
    path = folder / "flipped.nc"
    unnoticed = 0
    for _ in range(count):
        bit = chance.randrange(8 * len(run))
        flipped = bytearray(run)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        with contextlib.suppress(AntennaPinError):
            Trajectory.load(path)
            unnoticed += 1
            print(f"bit {bit} of {8 * len(run)}: not noticed")
    return unnoticed


def main() -> int:
    """Make the trials and tell of those that fail."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--bits", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--fault", choices=FAULTS, action="append", help="all if left out")
    parser.add_argument("--only", type=int, metavar="NUMBER", help="of one trial")
    asked = parser.parse_args()
    numbers = range(asked.trials) if asked.only is None else [asked.only]
    failed = unnoticed = 0
    tried: Counter[str] = Counter()
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        bench = Bench(Path(name))
        for number in numbers:
            trial = drawn(asked.seed, number, asked.fault or tuple(FAULTS))
            tried[trial.fault] += 1
            problem = bench.problem_of(trial)
            if problem is not None:
                failed += 1
                print(f"--seed {asked.seed} --only {number}: {trial}: {problem}", flush=True)
        if asked.only is None:
            unnoticed = unnoticed_bits(made()["run.nc"], Path(name), asked.bits, random.Random(asked.seed))
    print(", ".join(f"{count} {fault}" for fault, count in tried.items()))
    print(f"{len(numbers)} faults over {len(COMMANDS)} commands, {failed} lost, torn, left behind or untold")
    print(f"{asked.bits} bits flipped, {unnoticed} not noticed")
    return 1 if failed or unnoticed else 0


if __name__ == "__main__":
    sys.exit(main())
