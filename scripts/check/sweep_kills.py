"""A study that is killed, starved and damaged in every way: its store must end as if nothing had been.

    python scripts/check/sweep_kills.py [TIMES] [--only run,worker,scheduler,driver,disk,damage]

At TIMES random moments each, a process that makes runs, a worker, the scheduler, the driver are killed by
``kill -9``; a disk fills up (a small tmpfs, as root); files of the store are cut off or have a bit flipped.
After each, the same command is given again, and the store's dataset must equal that of an uninterrupted study
byte for byte. No entry that was in the journal may be lost; what is said must be lines without a traceback.
"""

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
from pathlib import Path

import psutil

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
COMMAND = [sys.executable, "-c", "from antenna_pin._entry import main; main()", "sweep"]


class Bed:
    """Where studies are run: a folder, a study, a scheduler with workers."""

    def __init__(self, folder: Path) -> None:
        """Write the study."""
        self.folder, self.study = folder, folder / "trial.study.toml"
        self.study.write_text(STUDY)
        self.processes: dict[str, subprocess.Popen] = {}
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{free.getsockname()[1]}"

    def sweep(self, store: Path, *options: str) -> subprocess.Popen:
        """Start the command of the study."""
        words = [*COMMAND, str(self.study), "--out", str(store), "--no-progress", "--quiet", *options]
        return subprocess.Popen(words, stderr=subprocess.PIPE, text=True, start_new_session=True)

    def start(self, name: str) -> None:
        """Start the scheduler, or a worker."""
        port = self.address.rpartition(":")[2]
        dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", port]
        if name != "scheduler":
            dask = [sys.executable, "-m", "distributed.cli.dask_worker", self.address, "--nthreads", "1"]
            dask += ["--no-nanny"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.processes[name] = subprocess.Popen([*dask, "--no-dashboard"], **quiet, start_new_session=True)

    def start_all(self) -> None:
        """Have a scheduler and two workers."""
        for name in ("scheduler", "one", "two"):
            if name not in self.processes or self.processes[name].poll() is not None:
                self.start(name)
        port = int(self.address.rpartition(":")[2])
        while True:  # a machine that is busy may take longer to start it than a command waits for an answer
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
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


def finished(store: Path) -> set[bytes]:
    """Return the whole lines of a journal."""
    journal = store / "journal"
    return set(journal.read_bytes().split(b"\n")[:-1]) if journal.is_file() else set()


def ended(process: subprocess.Popen, said: list[str]) -> int:
    """Wait for a command, and keep what it has said."""
    errors = process.communicate(timeout=600)[1]
    lines = [line for line in errors.splitlines() if line.strip()]
    said += lines
    assert "Traceback" not in errors, errors
    assert all(line.startswith("antenna-pin: ") for line in lines), errors
    return process.returncode


def wait_for_lines(store: Path, process: subprocess.Popen, lines: int) -> None:
    """Wait until so many runs are finished, or the command has ended."""
    while process.poll() is None and len(finished(store)) < lines:
        time.sleep(0.005)


def killed(bed: Bed, what: str, store: Path, chance: random.Random, said: list[str]) -> None:
    """Kill something at a random moment of a study, which is then brought to its end."""
    local = what in ("run", "driver")
    if not local:
        bed.start_all()
    options = ["--workers", "2"] if local else ["--scheduler", bed.address]
    process = bed.sweep(store, *options)
    wait_for_lines(store, process, chance.randrange(240))
    time.sleep(chance.random() * 0.1)
    if what == "driver":
        children = psutil.Process(process.pid).children(recursive=True)
        process.kill()
        process.communicate()
        _, alive = psutil.wait_procs(children, timeout=60)
        assert not alive, "processes of a killed driver live on"
    elif what == "run":
        with contextlib.suppress(psutil.NoSuchProcess, IndexError):
            workers = [
                one
                for one in psutil.Process(process.pid).children(recursive=True)
                if "spawn_main" in " ".join(one.cmdline())
            ]
            chance.choice(workers).kill()
        assert ended(process, said) == 0, said[-1:]
    else:
        bed.kill("scheduler" if what == "scheduler" else "one")
        if what == "worker":
            bed.start("one")
        code = ended(process, said)
        assert code == 0 or what == "scheduler", (code, said[-1:])
    before = finished(store)
    if what == "scheduler":
        for name in ("one", "two"):
            bed.kill(name)
    bed.start_all() if not local else None
    again = bed.sweep(store, *options)
    assert ended(again, said) == 0, said[-1:]
    assert before <= finished(store), "a finished run was lost"


def full_disk(bed: Bed, store: Path, chance: random.Random, said: list[str]) -> None:
    """Let the disk of the store fill up, then make room."""
    place = store.parent / f"{store.stem}-disk"
    place.mkdir()
    size = chance.randrange(60, 200)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs", str(place)], check=True)
    try:
        small = place / "trial.study"
        code = ended(bed.sweep(small, "--workers", "0"), said)
        before = finished(small)
        assert code == 2, f"{size} kB were enough"
        subprocess.run(["mount", "-o", "remount,size=20m", str(place)], check=True)
        assert ended(bed.sweep(small, "--workers", "0"), said) == 0
        assert before <= finished(small)
        shutil.copytree(small, store)
    finally:
        subprocess.run(["umount", str(place)], check=True)


def damaged(bed: Bed, whole: Path, store: Path, chance: random.Random, said: list[str]) -> None:
    """Cut a file of a whole store off, or flip a bit of it."""
    shutil.copytree(whole, store)
    target = store / chance.choice(("journal", "runs.nc", "study.json"))
    content = bytearray(target.read_bytes())
    place = chance.randrange(len(content))
    if chance.random() < 0.5:
        content[place] ^= 1 << chance.randrange(8)
    else:
        del content[place:]
    before = finished(store)
    target.write_bytes(content)
    assert ended(bed.sweep(store, "--workers", "0"), said) == 0
    if target.name != "journal":
        assert finished(store) == before


def main() -> int:
    """Do all of it."""
    every = ("run", "worker", "scheduler", "driver", "disk", "damage")
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("times", nargs="?", type=int, default=50)
    parser.add_argument("--only", default=",".join(every))
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    with tempfile.TemporaryDirectory() as name, contextlib.closing(Bed(Path(name))) as bed:
        whole = bed.folder / "whole.study"
        assert ended(bed.sweep(whole, "--workers", "0"), []) == 0
        wanted = (whole / "runs.nc").read_bytes()
        for what in given.only.split(","):
            said: list[str] = []
            began = time.perf_counter()
            for number in range(given.times):
                store = bed.folder / f"{what}-{number}.study"
                if what == "disk":
                    if os.geteuid() != 0:
                        break
                    full_disk(bed, store, chance, said)
                elif what == "damage":
                    damaged(bed, whole, store, chance, said)
                else:
                    killed(bed, what, store, chance, said)
                assert (store / "runs.nc").read_bytes() == wanted, f"{what} {number}: the store differs"
                shutil.rmtree(store)
            else:
                kinds = {line.replace(str(bed.folder), "").partition("study")[2][:60] for line in said}
                spent = time.perf_counter() - began
                print(f"{what}: {given.times} times, stores equal; {len(said)} lines said; {spent:.0f} s")
                for example in sorted(kinds)[:3]:
                    print(f"    ...{example}")
                continue
            print(f"{what}: left out, for mounting a small disk takes root")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
