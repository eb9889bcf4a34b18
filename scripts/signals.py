"""Sends signals at random times of the life of every long command, and reports what none of them should do.

    python scripts/signals.py --count 20 --seed 0
    python scripts/signals.py --only sweep-2 --count 5

A command that SIGINT or SIGTERM has ended exits with 130 or 143, and no signal is lost; it prints one line of
why and no traceback; what it was asked to write is whole or not there; its processes end with it.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from antenna_pin import Trajectory
from antenna_pin.errors import AntennaPinError

_ENTRY = "import sys; from antenna_pin._entry import main; sys.argv[0] = 'antenna-pin'; sys.exit(main())"
_FAST = ("--set", "integrator.engine=compiled")
_STUDY = """scenario = "pendulum"
[parameters.span]
key = "duration"
start = "1 s"
stop = "2 s"
count = 4000
[responses.error]
measure = "energy_error"
"""

#: Long commands by name; each writes into its working folder.
COMMANDS: dict[str, tuple[str, ...]] = {
    "run": ("run", "bai2020", "--case", "case3", "--duration", "100", "--out", "run.nc", *_FAST),
    "sweep-1": ("sweep", "s.study.toml", "--workers", "1", "--out", "s.study"),
    "sweep-2": ("sweep", "s.study.toml", "--workers", "2", "--out", "s.study"),
    "poincare": ("poincare", "chen2021", "--out", "points.nc"),
    "lyapunov": ("lyapunov", "chen2021", "--out", "exponents.nc"),
    "sensitivity": ("sensitivity", "bai2020", "duration", "--out", "slopes.nc"),
    "explore": ("explore", "bai2020", "--no-browser"),
}
_LONGEST = 12.0  # [s] of a command's life within which a signal is sent
_AFTERWARDS = 10.0  # [s] that its processes have to follow it
_PATIENCE = 60.0  # [s] that a command has to end


def tried(name: str, number: signal.Signals, after: float, folder: Path) -> list[str]:
    """Return what a command did wrong that was sent a signal after a time [s]."""
    (folder / "s.study.toml").write_text(_STUDY)
    command = [sys.executable, "-c", _ENTRY, *COMMANDS[name]]
    with subprocess.Popen(
        command,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        text=True,
    ) as process:
        try:
            said, _ = process.communicate(timeout=after)
            return (
                []
                if process.returncode == 0
                else [f"ended by itself with {process.returncode}: {said[-300:]}"]
            )
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        try:
            said, _ = process.communicate(timeout=_PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return [f"did not end within {_PATIENCE:g} s"]
    wrong = []
    own = {0} if name == "explore" else set()
    if process.returncode not in {128 + number, -number} | own:
        wrong.append(f"exit code {process.returncode}")
    if "Traceback" in said or "Error" in said:
        wrong.append(f"said {said[-600:]!r}")
    until = time.monotonic() + _AFTERWARDS
    while left_over(process.pid) and time.monotonic() < until:
        time.sleep(0.1)
    if left_over(process.pid):
        wrong.append("left processes behind")
        os.killpg(process.pid, signal.SIGKILL)
    for path in folder.glob("run.nc"):
        try:
            Trajectory.load(path)
        except AntennaPinError as error:
            wrong.append(f"left a result that is not whole: {error}")
    return wrong


def left_over(group: int) -> bool:
    """Return whether a process of a group is still there."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def main() -> int:
    """Try, print what went wrong, and return 1 if anything did."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=20, help="signals a command")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=COMMANDS, action="append")
    chosen = parser.parse_args()
    faults = 0
    for name in chosen.only or COMMANDS:
        random_ = random.Random(f"{chosen.seed} {name}")
        for _ in range(chosen.count):
            number = random_.choice([signal.SIGINT, signal.SIGTERM])
            after = random_.uniform(0.05, _LONGEST)
            folder = Path(tempfile.mkdtemp(prefix="antenna-pin-signals-"))
            try:
                wrong = tried(name, number, after, folder)
            finally:
                shutil.rmtree(folder, ignore_errors=True)
            faults += bool(wrong)
            print(
                f"{name:12} {number.name:8} {after:6.2f} s  {'; '.join(wrong) or 'as it should'}", flush=True
            )
    print(f"{faults} faults")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
