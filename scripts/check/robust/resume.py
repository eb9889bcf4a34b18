"""Random interruptions of a run with checkpoints: it must end as if it had never been stopped.

``run --checkpoint`` is killed (SIGKILL), or sent SIGTERM or SIGINT, at a random moment of its time, and
gone on with by ``run --resume``, which is interrupted again, one to four times; or the disk it writes to is
full at a random place (a small file system in memory), and gets room. What must hold:

- the result is that of a run never stopped, bit for bit: every variable, the counts but for the wall time;
- the exit code is the documented one, at most one line is said in refusal, and no traceback;
- nothing is left beside the result.

Then checkpoints are cut off or have one bit flipped: each must be refused in one line, and stay as it is::

    scripts/check/robustness.py resume                     # 50 trials of each fault
    scripts/check/robustness.py resume --count 5 --seed 7
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import tempfile
from pathlib import Path

import numpy as np

from antenna_pin import Trajectory
from robust.children import ANEW, TEMPORARY, Child, Ended, judge, prepared, remount, small_disk
from robust.trials import Report, flipped, must

WHAT = "trials"
FAULTS = ("SIGKILL", "SIGTERM", "SIGINT", "full")
RUN = ("run", "bai2020", "--case", "case3", "--set", "clearance.elevation.geometry=closed-form")
RUN += ("--set", "output.rate=20 kHz", "--duration", "0.5", "--out", "out/run.nc")
HOW = ("--checkpoint", "0.2 s", "--no-progress", "--no-summary")
RESUME = ("run", "--resume", "out/run.nc")


def checkpoint(place: Path) -> Path:
    """Return the file of a run that was stopped."""
    return place / "out" / "run.nc.parts" / "checkpoint"


def continued(place: Path, at: float = 0.0, number: int | None = None) -> Ended:
    """Start a run, or continue the one that is there; send it a signal at a time [s]."""
    words = (*(RESUME if checkpoint(place).is_file() else RUN), *HOW)
    act = None if number is None else lambda process: os.kill(process, number)
    return Child(words, place, program=ANEW).ended(at, act)


def check_same(one: Path, other: Path) -> None:
    """Raise what differs between two results besides wall times."""
    a, b = (Trajectory.load(path).data for path in (one, other))
    must(set(a.variables) == set(b.variables), f"{one.name}: other variables")
    for name in a.variables:
        x, y = a[name].values, b[name].values
        same = x.tobytes() == y.tobytes() if x.dtype != object else np.array_equal(x, y)
        must(x.shape == y.shape and same, f"{one.name}: another {name}")
    for name in a.attrs.keys() - {"finished", "counts"}:
        must(a.attrs[name] == b.attrs[name], f"{one.name}: another attribute {name}")
    counts = [json.loads(run.attrs["counts"]) | {"wall_seconds": 0.0} for run in (a, b)]
    must(counts[0] == counts[1], f"{one.name}: other counts {counts}")


class Bench:
    """A run that was never stopped, and the trials.

    Args:
        folder: An empty one.
        chance: Of moments and places.
    """

    def __init__(self, folder: Path, chance: random.Random) -> None:
        """Make the run that is never stopped."""
        self.folder, self.chance = folder, chance
        for _ in range(2):  # the first warms up
            end = continued(prepared(folder / "whole"))
            assert end.code == 0, end.said
        self.whole = folder / "whole" / "out" / "run.nc"
        self.seconds = end.seconds
        self.stops = 0

    def check(self, fault: str) -> None:
        """Interrupt a run some times and let it come to its end, or give its disk no room and then some."""
        place = prepared(self.folder / "trial")
        if fault == "full":
            self._fill(place)
            return
        number = signal.Signals[fault]
        for _ in range(self.chance.randrange(1, 5)):
            end = continued(place, self.chance.uniform(0.0, 1.05) * self.seconds, number)
            judge(end, {0, -number, 128 + number})
            if end.code == 0:
                break
            self.stops += 1
        else:
            judge(continued(place), {0})
        self._check_end(place)

    def _fill(self, place: Path) -> None:
        room = 4096 + int(self.chance.uniform(0.0, 2.2) * self.whole.stat().st_size)
        with small_disk(place / "out", room) as mounted:
            must(mounted, "no small file system can be mounted here")
            end = continued(place)
            judge(end, {0, 2})
            if end.code:
                self.stops += 1
                for path in place.glob("*.nc"):  # where it went instead
                    check_same(path, self.whole)
                remount(place / "out", "size=1g")
                judge(continued(place), {0})
            self._check_end(place)

    def _check_end(self, place: Path) -> None:
        names = sorted(path.name for path in (place / "out").iterdir())
        left = [name for name in names if name != "run.nc" and not name.startswith(TEMPORARY)]
        must(not left, f"left behind: {left}")
        check_same(place / "out" / "run.nc", self.whole)

    def check_damage(self, count: int, report: Report) -> None:
        """Have so many checkpoints cut off, and as many of which a bit is flipped."""
        place = prepared(self.folder / "damaged")
        path = checkpoint(place)
        while not path.is_file():
            continued(place, 0.5 * self.seconds, signal.SIGTERM)
        content = path.read_bytes()
        spoiled = [content[: self.chance.randrange(len(content))] for _ in range(count)]
        spoiled += [flipped(content, self.chance.randrange(8 * len(content))) for _ in range(count)]
        for number, one in enumerate(spoiled):
            path.write_bytes(one)
            with report.trial("damage", f"damage {number}"):
                judge(continued(place), {2})
                must(path.read_bytes() == one, "the checkpoint was changed")


def arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--count", type=int, default=50, help="of trials of each fault [%(default)s]")


def run(given: argparse.Namespace, report: Report) -> None:
    """Make the trials."""
    with tempfile.TemporaryDirectory(prefix="resume-") as name:
        bench = Bench(Path(name), random.Random(given.seed))
        for number in range(given.count):
            for fault in FAULTS:
                with report.trial(fault, f"{number}: {fault}"):
                    bench.check(fault)
        print(f"interrupted {bench.stops} times")
        bench.check_damage(given.count, report)
