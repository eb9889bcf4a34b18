"""A study that is killed, starved and damaged in every way: its store must end as if nothing had been.

    scripts/check/robustness.py kills --count 50 [--only run --only disk]

At random moments a process that makes runs, a worker, the scheduler, the driver are killed by ``kill -9``; a
disk fills up (a small tmpfs, as root); files of the store are cut off or have a bit flipped. After each, the
same command is given again, and the store's dataset must equal that of an uninterrupted study byte for byte.
No entry that was in the journal may be lost; what is said must be lines without a traceback.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Collection
from pathlib import Path

import psutil

from robust.children import ANEW, Child, judge, remount, small_disk
from robust.trials import Report, flipped, must

WHAT = "trials"
KINDS = ("run", "worker", "scheduler", "driver", "disk", "damage")
STUDY = """
scenario = "impact_pair"
set.integrator.engine = "compiled"
set.clearance.bore.geometry = "closed-form"
[sampling]
method = "random"
count = 250
[parameters.restitution]
key = "clearance.bore.normal.restitution"
between = [0.3, 0.9]
[responses]
impacts = { measure = "impacts" }
impulse = { measure = "impulse" }
dissipated = { measure = "dissipated" }
"""


class Bed:
    """Where studies are run: a folder, a study, a scheduler with workers."""

    def __init__(self, folder: Path, chance: random.Random) -> None:
        """Write the study, and make its store without an interruption."""
        self.folder, self.chance, self.study = folder, chance, folder / "trial.study.toml"
        self.study.write_text(STUDY)
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.whole = folder / "whole.study"
        self.sweep(self.whole)

    def sweep(
        self,
        store: Path,
        *options: str,
        codes: Collection[int] = (0,),
        due: Callable[[], bool] | float = 0.0,
        act: Callable[[int], object] | None = None,
    ) -> None:
        """Give the command of the study; raise what is wrong with its end."""
        words = ["sweep", str(self.study), "--out", str(store), "--no-progress", "--quiet"]
        child = Child([*words, *(options or ("--workers", "0"))], self.folder, program=ANEW)
        end = child.ended(due, act, patience=600.0)
        if end.code == -signal.SIGKILL and end.code in codes:
            return
        judge(end, codes, in_one_line=())
        lines = [line for line in end.said.splitlines() if line.strip()]
        must(all(line.startswith("antenna-pin: ") for line in lines), f"said {end.said[-400:]!r}")

    # --- a scheduler and two workers of its own ---

    def start_all(self) -> None:
        """Have a scheduler and two workers."""
        own = ["--host", "127.0.0.1", "--port", str(self.port)]
        for name in ("scheduler", "one", "two"):
            if name not in self.processes or self.processes[name].poll() is not None:
                module = "scheduler" if name == "scheduler" else "worker"
                options = own if name == "scheduler" else [self.address, "--nthreads", "1", "--no-nanny"]
                dask = [sys.executable, "-m", f"distributed.cli.dask_{module}", *options, "--no-dashboard"]
                self.processes[name] = subprocess.Popen(
                    dask, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
                )
        while True:  # a machine that is busy may take longer to start it than a command waits for an answer
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", self.port), 1.0):
                return
            time.sleep(0.1)

    def kill(self, name: str) -> None:
        """Kill one of them."""
        process = self.processes.pop(name)
        process.kill()
        process.wait()

    def close(self) -> None:
        """End what was started."""
        for name in list(self.processes):
            self.kill(name)

    # --- trials ---

    def check(self, kind: str, store: Path) -> None:
        """Interrupt or damage a study, bring it to its end, and raise what is wrong then."""
        if kind == "disk":
            self._fill(store)
        elif kind == "damage":
            self._damage(store)
        else:
            self._kill(kind, store)
        wanted = (self.whole / "runs.nc").read_bytes()
        must((store / "runs.nc").read_bytes() == wanted, "the store differs")
        shutil.rmtree(store)

    def _kill(self, kind: str, store: Path) -> None:
        local = kind in ("run", "driver")
        if not local:
            self.start_all()
        options = ("--workers", "2") if local else ("--scheduler", self.address)
        lines, children = self.chance.randrange(240), list[psutil.Process]()

        def act(driver: int) -> None:
            time.sleep(self.chance.random() * 0.1)
            with contextlib.suppress(psutil.NoSuchProcess, IndexError):
                children.extend(psutil.Process(driver).children(recursive=True))
                if kind == "driver":
                    os.kill(driver, signal.SIGKILL)
                elif kind == "run":
                    workers = [one for one in children if "spawn_main" in " ".join(one.cmdline())]
                    self.chance.choice(workers).kill()
                else:
                    self.kill("scheduler" if kind == "scheduler" else "one")
                    if kind == "worker":
                        self.start_all()

        codes = {"driver": (0, -signal.SIGKILL), "scheduler": range(256)}.get(kind, (0,))
        self.sweep(store, *options, codes=codes, due=lambda: len(finished(store)) >= lines, act=act)
        if kind == "driver":
            _, alive = psutil.wait_procs(children, timeout=60)
            must(not alive, "processes of a killed driver live on")
        before = finished(store)
        if kind == "scheduler":
            for name in ("one", "two"):
                self.kill(name)
        if not local:
            self.start_all()
        self.sweep(store, *options)
        must(before <= finished(store), "a finished run was lost")

    def _fill(self, store: Path) -> None:
        """Let the disk of the store fill up, then make room."""
        place = store.with_suffix(".disk")
        place.mkdir()
        size = self.chance.randrange(60, 200)
        with small_disk(place, size << 10) as mounted:
            must(mounted, "no small file system can be mounted here")
            small = place / "trial.study"
            self.sweep(small, codes=(2,))
            before = finished(small)
            remount(place, "size=20m")
            self.sweep(small)
            must(before <= finished(small), "a finished run was lost")
            shutil.copytree(small, store)

    def _damage(self, store: Path) -> None:
        """Cut a file of a whole store off, or flip a bit of it."""
        shutil.copytree(self.whole, store)
        target = store / self.chance.choice(("journal", "runs.nc", "study.json"))
        content = target.read_bytes()
        place, before = self.chance.randrange(len(content)), finished(store)
        flip = self.chance.random() < 0.5
        bit = 8 * place + self.chance.randrange(8)
        target.write_bytes(flipped(content, bit) if flip else content[:place])
        self.sweep(store)
        must(target.name == "journal" or finished(store) == before, "a finished run was lost")


def finished(store: Path) -> set[bytes]:
    """Return the whole lines of a journal."""
    journal = store / "journal"
    return set(journal.read_bytes().split(b"\n")[:-1]) if journal.is_file() else set()


def arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--count", type=int, default=50, help="of trials of each kind [%(default)s]")
    parser.add_argument("--only", choices=KINDS, action="append", help="all if left out")


def run(given: argparse.Namespace, report: Report) -> None:
    """Make the trials."""
    chance = random.Random(given.seed)
    with tempfile.TemporaryDirectory() as name, contextlib.closing(Bed(Path(name), chance)) as bed:
        for kind in given.only or KINDS:
            if kind == "disk" and os.geteuid():
                print("disk: left out, for mounting a small disk takes root")
                continue
            for number in range(given.count):
                with report.trial(kind, f"{kind} {number}"):
                    bed.check(kind, bed.folder / f"{kind}-{number}.study")
