#!/usr/bin/env python3
"""Random interruptions of a run that leaves checkpoints: does it end as if it had never been stopped?

``run --checkpoint`` is killed (SIGKILL), or sent SIGTERM or SIGINT, at a random moment of its time, and
gone on with by ``run --resume``, which is interrupted again, one to four times; or the disk it writes to is
full at a random place (a small file system in memory), and gets room. What must hold:

- the result is that of a run never stopped, bit for bit: every variable, the counts but for the wall time;
- the exit code is the documented one, at most one line is said in refusal, and no traceback;
- nothing is left beside the result.

Then checkpoints are cut off or have one bit flipped: each must be refused in one line, and stay as it is::

    scripts/check/resume_faults.py                     # 50 trials of each fault
    scripts/check/resume_faults.py --trials 5 --seed 7

Exit code 1 on any failure.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from faults_of import small_disk
from forked import Ended, ended, unsaid

from antenna_pin import Trajectory

FAULTS = ("SIGKILL", "SIGTERM", "SIGINT", "full")
RUN = ("run", "bai2020", "--case", "case3", "--set", "clearance.elevation.geometry=closed-form")
RUN += ("--set", "output.rate=20 kHz", "--duration", "0.5", "--out", "out/run.nc")
HOW = ("--checkpoint", "0.2 s", "--no-progress", "--no-summary")
COMMAND = "from antenna_pin._entry import main; main()"
GO_ON = ("run", "--resume", "out/run.nc")


def prepared(folder: Path) -> Path:
    """Return an empty folder with a place for outputs."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("out", "home"):
        (folder / name).mkdir(parents=True)
    return folder


def is_stopped(place: Path) -> bool:
    """Whether there is a run to go on with."""
    return (place / "out" / "run.nc.parts" / "checkpoint").is_file()


def gone_on(place: Path, at: float | None = None, number: int = 0) -> Ended:
    """Start a run, or go on with the one that is there; send it a signal at a time [s]."""
    words = (*(GO_ON if is_stopped(place) else RUN), *HOW)
    ours, theirs = os.pipe()
    begun = [sys.executable, "-c", COMMAND, *words]
    process = subprocess.Popen(begun, cwd=place, stdout=theirs, stderr=theirs)
    os.close(theirs)
    return ended(process.pid, ours, time.monotonic(), at, lambda alive: os.kill(alive, number))


def difference(one: Path, other: Path) -> str | None:
    """Return what differs between two results besides wall times; None if nothing does."""
    a, b = Trajectory.load(one), Trajectory.load(other)
    if set(a.data.variables) != set(b.data.variables):
        return "other variables"
    for name in a.data.variables:
        x, y = a.data[name].values, b.data[name].values
        same = x.shape == y.shape and (
            x.tobytes() == y.tobytes() if x.dtype != object else np.array_equal(x, y)
        )
        if not same:
            return f"another {name}"
    for name in a.data.attrs.keys() - {"finished", "counts"}:
        if a.data.attrs[name] != b.data.attrs[name]:
            return f"another attribute {name}"
    counts = [json.loads(run.data.attrs["counts"]) | {"wall_seconds": 0.0} for run in (a, b)]
    return None if counts[0] == counts[1] else f"other counts {counts}"


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
            found = gone_on(prepared(folder / "whole"))
            assert found.code == 0, found.said
        self.whole = folder / "whole" / "out" / "run.nc"
        self.seconds = found.seconds
        self.stops = 0

    def stopped(self, fault: str) -> str | None:
        """Interrupt a run some times, let it come to its end; return what does not hold."""
        place, number = prepared(self.folder / "trial"), signal.Signals[fault]
        for _ in range(self.chance.randrange(1, 5)):
            found = gone_on(place, self.chance.uniform(0.0, 1.05) * self.seconds, number)
            wrong = unsaid(found, {0, -number, 128 + number})
            if wrong or found.code == 0:
                break
            self.stops += 1
        else:
            found = gone_on(place)
            wrong = unsaid(found, {0})
        return wrong or self._end(place)

    def full(self) -> str | None:
        """Let the disk be full at some place, then make room; return what does not hold."""
        place = prepared(self.folder / "trial")
        room = 4096 + int(self.chance.uniform(0.0, 2.2) * self.whole.stat().st_size)
        with small_disk(place / "out", room) as mounted:
            if not mounted:
                return "no small file system can be mounted here"
            found = gone_on(place)
            wrong = unsaid(found, {0, 2})
            if wrong or found.code == 0:
                return wrong or self._end(place)
            self.stops += 1
            for path in place.glob("*.nc"):  # where it went instead
                if difference(path, self.whole):
                    return f"{path.name}: {difference(path, self.whole)}"
            subprocess.run(["mount", "-o", "remount,size=1g", str(place / "out")], check=True)
            found = gone_on(place)
            return unsaid(found, {0}) or self._end(place)

    def _end(self, place: Path) -> str | None:
        left = sorted(path.name for path in (place / "out").iterdir())
        left = [name for name in left if name != "run.nc" and not name.startswith(".antenna-pin-")]
        return f"left behind: {left}" if left else difference(place / "out" / "run.nc", self.whole)

    def damaged(self, count: int) -> int:
        """Return how many damaged checkpoints, of twice so many, are not refused as they must be."""
        place, accepted = prepared(self.folder / "damaged"), 0
        while not is_stopped(place):
            gone_on(place, 0.5 * self.seconds, signal.SIGTERM)
        path = place / "out" / "run.nc.parts" / "checkpoint"
        content = path.read_bytes()
        spoiled = [content[: self.chance.randrange(len(content))] for _ in range(count)]
        for _ in range(count):
            bit = self.chance.randrange(8 * len(content))
            flipped = bytearray(content)
            flipped[bit // 8] ^= 1 << bit % 8
            spoiled.append(bytes(flipped))
        for number, one in enumerate(spoiled):
            path.write_bytes(one)
            found = gone_on(place)
            wrong = unsaid(found, {2})
            if wrong or path.read_bytes() != one:
                accepted += 1
                print(f"damage {number}: {wrong or 'it was changed'}", flush=True)
        return accepted


def main() -> int:
    """Make the trials and tell of those that fail."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--trials", type=int, default=50, help="of each fault")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory(prefix="resume-") as name, contextlib.suppress(KeyboardInterrupt):
        bench = Bench(Path(name), random.Random(asked.seed))
        for number in range(asked.trials):
            for fault in FAULTS:
                problem = bench.full() if fault == "full" else bench.stopped(fault)
                if problem is not None:
                    failed += 1
                    print(f"{number}: {fault}: {problem}", flush=True)
        print(f"{asked.trials} runs for each of {', '.join(FAULTS)}, interrupted {bench.stops} times")
        print(f"{failed} did not end as the run that was never stopped")
        accepted = bench.damaged(asked.trials)
        print(f"{2 * asked.trials} checkpoints cut off or flipped, {accepted} not refused in one line")
    return 1 if failed or accepted else 0


if __name__ == "__main__":
    sys.exit(main())
