"""Interrupted runs and studies: given again they must end as if nothing had been.

A run with checkpoints is killed (SIGKILL), or sent SIGTERM or SIGINT, at a random moment of its time, and
continued by ``run --resume``, which is interrupted again, one to four times. Of a study a process that makes
runs, a worker, the scheduler, the driver are killed, and the same command is given again. The disk that
either writes to is full at a random place (a small file system in memory, as root), and gets room. What is
stored is cut off or has one bit flipped. What must hold:

- the result of a run is that of one never stopped, bit for bit: every variable, the counts but for the wall
  time; the dataset of a study is that of one never stopped, byte for byte; no run in its journal is lost;
- the exit code is the documented one, at most one line is said in refusal, and no traceback;
- nothing is left beside the result, and no process of a driver that was killed;
- a damaged checkpoint is refused in one line, and stays as it is; a damaged store is made whole::

    scripts/check/robustness.py interruptions                      # 50 trials of each kind
    scripts/check/robustness.py interruptions --of run --count 5 --seed 7
    scripts/check/robustness.py interruptions --of study --only worker --only scheduler
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import json
import os
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Collection
from pathlib import Path

import numpy as np
import psutil

from antenna_pin import Trajectory
from robust.children import ANEW, TEMPORARY, Child, Ended, judge, prepared, remount, small_disk
from robust.trials import Report, ends_with, flipped, must

RUN = ("run", "bai2020", "--case", "case3", "--set", "clearance.elevation.geometry=closed-form")
RUN += ("--set", "output.rate=20 kHz", "--duration", "0.5", "--out", "out/run.nc")
RESUME, HOW = ("run", "--resume", "out/run.nc"), ("--checkpoint", "0.2 s", "--no-progress", "--no-summary")
SWEEP = ("sweep", "trial.study.toml", "--out", "out/trial.study", "--no-progress", "--quiet")
STUDY = b"""
scenario = "impact_pair"
set = {integrator.engine="compiled", clearance.bore.geometry="closed-form"}
sampling = {method="random", count=250}
parameters.restitution = {key="clearance.bore.normal.restitution", between=[0.3, 0.9]}
[responses]
impacts = {measure="impacts"}
impulse = {measure="impulse"}
dissipated = {measure="dissipated"}
"""


class Work:
    """Work that is interrupted and given again, beside the same never stopped."""

    kinds: tuple[str, ...]
    options: tuple[str, ...] = ()  # of the command, if no others are given

    def __init__(self, folder: Path, chance: random.Random) -> None:
        """Do the work without an interruption."""
        self.folder, self.chance, self.stops = folder, chance, 0
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        for _ in range(2):  # the first warms up
            self.whole = self.prepared("whole")
            self.seconds = self.give(self.whole).seconds

    def prepared(self, name: str) -> Path:
        """Return a folder in which nothing has been done."""
        return prepared(self.folder / f"{name} {type(self).__name__}", {"trial.study.toml": STUDY})

    def give(
        self,
        place: Path,
        *options: str,
        codes: Collection[int] = (0,),
        due: Callable[[], bool] | float = 0.0,
        act: Callable[[int], object] | None = None,
    ) -> Ended:
        """Give the command that begins the work in a folder, or continues it; judge its end."""
        words = (*self.words(place), *(options or self.options))
        end = Child(words, place, program=ANEW).ended(due, act, patience=600.0)
        self.stops += end.code != 0
        if end.code != -signal.SIGKILL or end.code not in codes:
            judge(end, codes)
            plain = all(re.match(r"antenna-pin: |saved |\s*$", line) for line in end.said.splitlines())
            must(plain, f"said {end.said[-400:]!r}")
        return end

    def words(self, place: Path) -> tuple[str, ...]:
        """Return the command."""
        return SWEEP

    def finished(self, place: Path) -> set[bytes]:
        """Return the parts of the work that are done."""
        return set()

    def continue_(self, place: Path, *options: str) -> None:
        """Give the command again, to the end of the work."""
        before = self.finished(place)
        self.give(place, *options)
        must(before <= self.finished(place), "a finished run was lost")

    def fill(self, place: Path, room: int) -> None:
        """Let the disk be full at some place, then make room."""
        with small_disk(place / "out", room) as mounted:
            must(mounted, "no small file system can be mounted here")
            if self.give(place, codes={0, 2}).code:
                for path in place.glob("*.nc"):  # where it went instead
                    check_same(path, self.whole / "out" / "run.nc")
                remount(place / "out", "size=1g")
                self.continue_(place)
            self.check_end(place)

    def spoiled(self, content: bytes) -> bytes:
        """Return a file's content cut off or with one bit flipped."""
        place, bit = self.chance.randrange(len(content)), self.chance.randrange(8)
        return content[:place] if self.chance.random() < 0.5 else flipped(content, 8 * place + bit)

    def kill(self, name: str) -> None:
        """Kill a process that was started."""
        process = self.processes.pop(name)
        process.kill()
        process.wait()

    def close(self) -> None:
        """End what was started."""
        for name in list(self.processes):
            self.kill(name)


class Run(Work):
    """A run with checkpoints."""

    kinds = ("SIGKILL", "SIGTERM", "SIGINT", "disk", "damage")

    def stored(self, place: Path) -> Path:
        """Return the file of a run that was stopped."""
        return place / "out" / "run.nc.parts" / "checkpoint"

    def words(self, place: Path) -> tuple[str, ...]:
        """Return the command that begins the run, or continues the one that is there."""
        return (*(RESUME if self.stored(place).is_file() else RUN), *HOW)

    def check_end(self, place: Path) -> None:
        """Raise what differs from the run never stopped."""
        names = sorted(path.name for path in (place / "out").iterdir())
        left = [name for name in names if name != "run.nc" and not name.startswith(TEMPORARY)]
        must(not left, f"left behind: {left}")
        check_same(place / "out" / "run.nc", self.whole / "out" / "run.nc")

    def check(self, kind: str) -> None:
        """Interrupt the run some times, or damage its checkpoint, and raise what is wrong then."""
        place = self.prepared("trial")
        if kind == "disk":
            room = self.chance.uniform(0.0, 2.2) * (self.whole / "out" / "run.nc").stat().st_size
            self.fill(place, 4096 + int(room))
        elif kind == "damage":
            shutil.copytree(self.stopped, place, dirs_exist_ok=True)
            content = self.spoiled(self.stored(place).read_bytes())
            self.stored(place).write_bytes(content)
            self.give(place, codes={2})
            must(self.stored(place).read_bytes() == content, "the checkpoint was changed")
        else:
            for _ in range(self.chance.randrange(1, 5)):
                if self._stop(place, signal.Signals[kind], self.chance.uniform(0.0, 1.05)).code == 0:
                    break
            else:
                self.continue_(place)
            self.check_end(place)

    @functools.cached_property
    def stopped(self) -> Path:
        """Folder of a run that was stopped behind its first checkpoint."""
        place = self.prepared("stopped")
        while not self.stored(place).is_file():
            self._stop(place, signal.SIGTERM, self.chance.uniform(0.3, 1.0))
        return place

    def _stop(self, place: Path, number: signal.Signals, moment: float) -> Ended:
        codes, due = {0, -number, 128 + number}, moment * self.seconds
        return self.give(place, codes=codes, due=due, act=lambda process: os.kill(process, number))


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


class Study(Work):
    """A study, by itself, with processes of its own, or with a scheduler and two workers."""

    kinds = ("process", "worker", "scheduler", "driver", "disk", "damage")
    options = ("--workers", "0")

    @functools.cached_property
    def port(self) -> int:
        """Port of the scheduler."""
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            return int(free.getsockname()[1])

    def finished(self, place: Path) -> set[bytes]:
        """Return the whole lines of the journal."""
        journal = place / "out" / "trial.study" / "journal"
        return set(journal.read_bytes().split(b"\n")[:-1]) if journal.is_file() else set()

    def check_end(self, place: Path) -> None:
        """Raise that the dataset differs from that of the study never stopped."""
        one, other = ((of / "out" / "trial.study" / "runs.nc").read_bytes() for of in (place, self.whole))
        must(one == other, "the store differs")

    def check(self, kind: str) -> None:
        """Interrupt or damage the study, bring it to its end, and raise what is wrong then."""
        place = self.prepared("trial")
        if kind == "disk":
            self.fill(place, self.chance.randrange(60, 200) << 10)
            return
        if kind == "damage":
            self.give(place)
            name = self.chance.choice(("journal", "runs.nc", "study.json"))
            path, before = place / "out" / "trial.study" / name, self.finished(place)
            path.write_bytes(self.spoiled(path.read_bytes()))
            self.give(place)
            must(name == "journal" or self.finished(place) == before, "a finished run was lost")
        else:
            self._kill(kind, place)
        self.check_end(place)

    def _kill(self, kind: str, place: Path) -> None:
        """Kill something at a random moment of the study, which is then brought to its end."""
        local = kind in ("process", "driver")
        if not local:
            self.start_all()
        options = ("--workers", "2") if local else ("--scheduler", f"tcp://127.0.0.1:{self.port}")
        runs, children = self.chance.randrange(240), list[psutil.Process]()

        def act(driver: int) -> None:
            time.sleep(self.chance.random() * 0.1)
            with contextlib.suppress(psutil.NoSuchProcess, IndexError):
                children.extend(psutil.Process(driver).children(recursive=True))
                if kind == "driver":
                    os.kill(driver, signal.SIGKILL)
                elif kind == "process":
                    makers = [one for one in children if "spawn_main" in " ".join(one.cmdline())]
                    self.chance.choice(makers).kill()
                else:
                    self.kill("scheduler" if kind == "scheduler" else "one")
                    if kind == "worker":
                        self.start_all()

        codes = {"driver": (0, -signal.SIGKILL), "scheduler": range(256)}.get(kind, (0,))
        self.give(place, *options, codes=codes, due=lambda: len(self.finished(place)) >= runs, act=act)
        if kind == "driver":
            _, alive = psutil.wait_procs(children, timeout=60)
            must(not alive, "processes of a killed driver live on")
        if kind == "scheduler":
            for name in ("one", "two"):
                self.kill(name)
        if not local:
            self.start_all()
        self.continue_(place, *options)

    # --- a scheduler and two workers of its own ---

    def start_all(self) -> None:
        """Have a scheduler and two workers."""
        own = ("--host", "127.0.0.1", "--port", str(self.port))
        its = (f"tcp://127.0.0.1:{self.port}", "--nthreads", "1", "--no-nanny")
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        for name, module in (("scheduler", "scheduler"), ("one", "worker"), ("two", "worker")):
            if name not in self.processes or self.processes[name].poll() is not None:
                dask = [sys.executable, "-m", f"distributed.cli.dask_{module}", "--no-dashboard"]
                dask += own if name == "scheduler" else its
                with_us = functools.partial(ends_with, os.getpid())
                self.processes[name] = subprocess.Popen(
                    dask, **quiet, start_new_session=True, preexec_fn=with_us
                )
        while True:  # a machine that is busy may take longer to start it than a command waits for an answer
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", self.port), 1.0):
                return
            time.sleep(0.1)


WORKS = {"run": Run, "study": Study}
SEED = 1
OPTIONS = {
    "--count": {"type": int, "default": 50, "help": "of trials of each kind [%(default)s]"},
    "--of": {"choices": WORKS, "action": "append", "help": "both if left out"},
    "--only": {"choices": (*Run.kinds, *Study.kinds), "action": "append", "help": "all if left out"},
}


def run(given: argparse.Namespace, report: Report, folder: Path) -> None:
    """Make the trials."""
    for name in given.of or WORKS:
        work = WORKS[name](folder, random.Random(given.seed))
        # Only root may mount a disk.
        root = os.geteuid() == 0
        kinds = [one for one in given.only or work.kinds if one in work.kinds and (one != "disk" or root)]
        with contextlib.closing(work):
            report.each(kinds, given.count, work.check)
        print(f"{name}: interrupted {work.stops} times")
