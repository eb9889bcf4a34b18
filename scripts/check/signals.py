"""Sends signals at random times of the life of every long command, and reports what none of them should do.

    python scripts/check/signals.py --count 300 --seed 0
    python scripts/check/signals.py --only sweep-2 --only fit-2 --count 20

Commands are dealt in turn. One that SIGINT or SIGTERM has ended exits with 130 or 143, and no signal is lost;
it prints one line of why and no traceback; what it was asked to write is whole or not there, and no temporary
file is left; its processes end with it.
"""

from __future__ import annotations

import argparse
import itertools
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from faults import TEMPORARY, is_whole

_ROOT = Path(__file__).parents[2]
_OWN = os.environ | {"PYTHONPATH": str(_ROOT)}  # this checkout, wherever they work
_ENTRY = "import sys; from antenna_pin._entry import main; sys.argv[0] = 'antenna-pin'; sys.exit(main())"
_QUIET = "--no-progress"
_STUDY = """scenario = "pendulum"
[parameters.span]
key = "duration"
start = "1 s"
stop = "2 s"
count = 4000
[responses.error]
measure = "energy_error"
"""
_MOTOR = "drives.motor={joint='hinge', kind='sine', amplitude='1 N*m', frequency='0.625 Hz'}"
_FIT = ("fit", "hinge.fit.toml", "--profile", "--draws", "200", "--out", "fit.nc", _QUIET)
_DIAGRAM = ("bifurcation", "slider_crank/friction", "--out", "diagram.nc", _QUIET)

#: Long commands by name; each reads from its working folder, and writes there.
COMMANDS: dict[str, tuple[str, ...]] = {
    "run": ("run", "bai2020", "--case", "case3", "--duration", "100", "--out", "long.nc", _QUIET),
    "sweep-1": ("sweep", "s.study.toml", "--workers", "1", "--out", "s.study", _QUIET),
    "sweep-2": ("sweep", "s.study.toml", "--workers", "2", "--out", "s.study", _QUIET),
    "fit-1": _FIT,
    "fit-2": (*_FIT, "--workers", "2"),
    "bifurcation-1": (*_DIAGRAM, "--workers", "1"),
    "bifurcation-2": (*_DIAGRAM, "--workers", "2"),
    "poincare": (
        *("poincare", "slider_crank", "-q", "journal_position[pin].x", "--count", "2000"),
        *("--out", "points.nc"),
    ),
    "orbit": (
        *("orbit", "pendulum", "--case", "ideal", "--set", _MOTOR, "--over", "drives.motor.amplitude"),
        *("--values", "11 N*m:13 N*m", "--arc", "0.01", "--out", "branch.nc", _QUIET),
    ),
    "lyapunov": ("lyapunov", "chen2021", "--out", "exponents.nc", _QUIET),
    "sensitivity": ("sensitivity", "bai2020", "clearance.elevation.radial_clearance", "--out", "slopes.nc"),
    "modes": ("modes", "bai2020", "--case", "flexible-ideal", "--record", "modes.html"),
    "report": ("report", "run.nc", "--out", "report.html"),
    "record": ("record", "run.nc", "--out", "page.html"),
    "film": ("record", "run.nc", "--speed", "1/10", "--out", "film.mp4", _QUIET),
    "frames": ("record", "run.nc", "--speed", "1/10", "--out", "frames", _QUIET),
    "explore": ("explore", "bai2020", "--no-browser"),
    "docs": (),
}
_MADE = ("run", "bai2020", "--case", "case3", "--duration", "1", "--out", "run.nc", _QUIET)
_LONGEST = 20.0  # [s] of a command's life within which a signal is sent
_AFTERWARDS = 10.0  # [s] that its processes have to follow it
_PATIENCE = 60.0  # [s] that a command has to end
_NOISE = re.compile(r"Traceback|Error\b|Exception|Warning|distributed|leaked|resource_tracker|unraisable")
_LINE = re.compile(r"antenna-pin: (?!note: )|docs: ")


def command_of(name: str) -> list[str]:
    """Return a command's words."""
    if name == "docs":
        return [sys.executable, str(_ROOT / "scripts" / "pages" / "build_site.py")]
    return [sys.executable, "-c", _ENTRY, *COMMANDS[name]]


def prepared(folder: Path) -> None:
    """Write into a folder what commands read."""
    (folder / "s.study.toml").write_text(_STUDY)
    for name in ("hinge.fit.toml", "hinge.csv"):
        shutil.copy(_ROOT / "scripts" / "examples" / name, folder)
    subprocess.run([sys.executable, "-c", _ENTRY, *_MADE], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def tried(name: str, number: signal.Signals, after: float, folder: Path) -> list[str] | None:
    """Return what a command did wrong on a signal after a time [s]; None if it had ended by then."""
    inputs = set(folder.iterdir())
    with subprocess.Popen(
        command_of(name),
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        env=_OWN,
        text=True,
        errors="replace",
    ) as process:
        try:
            said, _ = process.communicate(timeout=after)
            code = process.returncode
            return None if code == 0 else [f"ended by itself with {code}: {said[-300:]}"]
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        try:
            said, _ = process.communicate(timeout=_PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return [f"did not end within {_PATIENCE:g} s"]
    wrong = []
    code = process.returncode
    own = {0} if name == "explore" else set()
    if code not in {128 + number, -number} | own:
        wrong.append(f"exit code {code}")
    lines = sum(bool(_LINE.match(line)) for line in said.splitlines())
    if _NOISE.search(said) or (lines != 1 and code == 128 + number):
        wrong.append(f"said {said!r}")
    until = time.monotonic() + _AFTERWARDS
    while left_over(process.pid) and time.monotonic() < until:
        time.sleep(0.1)
    if left_over(process.pid):
        wrong.append("left processes behind")
        os.killpg(process.pid, signal.SIGKILL)
    wrong += [
        f"left {path.name}, which is not whole"
        for path in set(folder.iterdir()) - inputs
        if path.is_file() and not is_whole(path)
    ]
    wrong += [f"left {path.name}" for path in folder.rglob(f"{TEMPORARY}*")]
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
    parser.add_argument("--count", type=int, default=40, help="signals over all commands [%(default)s]")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=COMMANDS, action="append")
    chosen = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # which shells have background jobs ignore
    began = time.monotonic()
    faults: Counter[str] = Counter()
    sent: Counter[str] = Counter()
    life = dict.fromkeys(COMMANDS, _LONGEST)  # [s], at most
    with tempfile.TemporaryDirectory(prefix="antenna-pin-signals-") as place:
        inputs = Path(place) / "inputs"
        inputs.mkdir()
        prepared(inputs)
        for trial, name in zip(range(chosen.count), itertools.cycle(chosen.only or COMMANDS), strict=False):
            drawn = random.Random(f"{chosen.seed} {name} {trial}")
            number = drawn.choice([signal.SIGINT, signal.SIGTERM])
            wrong = None
            while wrong is None:
                after = drawn.uniform(0.05, life[name])
                folder = Path(place) / f"{trial} {after}"
                shutil.copytree(inputs, folder)
                wrong = tried(name, number, after, folder)
                shutil.rmtree(folder, ignore_errors=True)
                life[name] = after if wrong is None else life[name]
            sent[name] += 1
            faults[name] += bool(wrong)
            verdict = "; ".join(wrong) or "as it should"
            print(f"{name:13} {number.name:8} {after:6.2f} s  {verdict}", flush=True)
    print(f"{sent.total()} signals over {len(sent)} commands, {faults.total()} faults", end=" ")
    print(f"in {(time.monotonic() - began) / 60.0:.0f} min")
    return bool(faults.total())


if __name__ == "__main__":
    sys.exit(main())
