"""Random faults: every result must be whole, or as it was, whatever befalls a command on its way.

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

    scripts/check/robustness.py faults                               # 200 trials, 200 bits
    scripts/check/robustness.py faults --count 1000 --seed 7
    scripts/check/robustness.py faults --fault "full disk" --count 60 --bits 0
    scripts/check/robustness.py faults --only 137                    # one again

Commands are started by ``fork`` after all imports, so that faults hit their work; what comes before has
tests of its own (``tests/test_signals.py``).
"""

from __future__ import annotations

import argparse
import contextlib
import random
import signal
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fuzzing.made import COMMANDS, made

from antenna_pin import AntennaPinError, Trajectory
from antenna_pin.base.files import check_writable
from robust.children import Child, Ended, is_whole, judge, prepared, temporary_files
from robust.fault_kinds import FAULTS, At, Fault, fault
from robust.trials import Report, flipped, must, write_files

SEED = 1
OPTIONS = {
    "--count": {"type": int, "default": 200, "help": "of trials [%(default)s]"},
    "--bits": {"type": int, "default": 200, "help": "of a result that are flipped [%(default)s]"},
    "--fault": {"choices": FAULTS, "action": "append", "help": "all if left out"},
    "--only": {"type": int, "metavar": "NUMBER", "help": "of one trial"},
}


def files_in(place: Path) -> dict[str, bytes]:
    """Return what stands at an output's place: a file, or the files of a folder, temporary ones apart."""
    if place.is_dir():
        return {path.name: path.read_bytes() for path in sorted(place.glob("[!.]*")) if path.is_file()}
    return {place.name: place.read_bytes()} if place.exists() else {}


@dataclass(frozen=True)
class Trial:
    """One command and what befalls it."""

    name: str  # of the command
    fault: str  # kind of the fault
    moment: float  # part of the command's own time, or of its output's size, at which it comes [-]
    older: bool  # whether there is an older result in its place


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
        """Begin with no command known."""
        self.folder = folder
        self.seconds: dict[str, float] = {}
        self.older: dict[str, dict[str, bytes]] = {}

    def _learn(self, name: str) -> None:
        """Let a command end by itself, to know how long it takes and what it leaves."""
        if name in self.seconds:
            return
        words, output = COMMANDS[name]
        for _ in range(2):  # the first warms up
            place = prepared(self.folder / f"own-{name}", made())
            end = Child(words, place).ended()
            assert end.code == 0, f"{name}: {end.code} {end.said}"
        self.seconds[name] = end.seconds
        self.older[name] = files_in(place / "out" / output)

    def check(self, trial: Trial) -> None:
        """Raise what of all that must hold does not."""
        self._learn(trial.name)
        words, output = COMMANDS[trial.name]
        place, older = prepared(self.folder / "trial", made()), self.older[trial.name]
        out = place / "out"
        size = sum(map(len, older.values()))
        with fault(trial.fault, At(place, trial.moment, size, size if trial.older else 0)) as one:
            if trial.older:
                write_files(out, {n if n == output else f"{output}/{n}": older[n] for n in older})
            one.armed()
            before = files_in(out / output)
            end = Child(words, place, one.hook).ended(trial.moment * self.seconds[trial.name], one.act)
            self._check_end(trial, one, place, before, end)
            one.mended()
            if place.is_dir():
                self._check_again(trial, place)

    def _check_end(
        self, trial: Trial, fault: Fault, place: Path, before: dict[str, bytes], end: Ended
    ) -> None:
        judge(end, fault.codes)
        out = place / "out" / COMMANDS[trial.name][1]
        after = files_in(out)
        for name in after:
            path = out / name if out.is_dir() else out
            must(path.read_bytes() == before.get(name) or is_whole(path), f"{name} is torn")
        if not fault.takes_away:
            must(set(before) <= set(after), "the older result is gone")
            done = end.code == 0 and self.older[trial.name]
            must(after or not done, f"nothing written: {end.said!r}")
        if "the result is in " in end.said:
            elsewhere = {*place.glob("*.nc"), *(place / "home").glob("*.nc")}
            whole = any(is_whole(path) for path in elsewhere if path.name not in made())
            must(whole, f"the result that should be elsewhere is not whole: {end.said!r}")
        left = temporary_files(place)
        must(not left or end.code == -signal.SIGKILL, f"left behind: {left}")

    def _check_again(self, trial: Trial, place: Path) -> None:
        """Give the command once more, without a fault; raise what is not as after a sound one."""
        write_files(place, {name: one for name, one in made().items() if not (place / name).exists()})
        for sub in ("out", "home"):
            (place / sub).mkdir(exist_ok=True)
        words, output = COMMANDS[trial.name]
        judge(Child(words, place).ended(), {0})
        out = place / "out" / output
        after = files_in(out)
        must(after.keys() == self.older[trial.name].keys(), f"given again it leaves {', '.join(after)}")
        for name in after:
            must(is_whole(out if name == output else out / name), f"given again: {name} is torn")
        for folder in (place, place / "out", out):
            if folder.is_dir():
                check_writable(folder / "another")  # a command that writes there sweeps
        left = temporary_files(place)
        must(not left, f"left behind for ever: {left}")


def run(given: argparse.Namespace, report: Report, folder: Path) -> None:
    """Make the trials."""
    bench = Bench(folder)
    for number in range(given.count) if given.only is None else [given.only]:
        trial = drawn(given.seed, number, given.fault or tuple(FAULTS))
        with report.trial(trial.fault, f"--seed {given.seed} --only {number}: {trial}"):
            bench.check(trial)
    whole, chance, path = made()["run.nc"], random.Random(given.seed), folder / "flipped.nc"
    for _ in range(given.bits if given.only is None else 0):
        bit = chance.randrange(8 * len(whole))
        path.write_bytes(flipped(whole, bit))
        with report.trial("bit", f"bit {bit} of {8 * len(whole)}"), contextlib.suppress(AntennaPinError):
            Trajectory.load(path)
            must(False, "not noticed")
