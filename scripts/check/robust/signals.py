"""Signals at random times of the life of every long command, which must end it in one line.

    scripts/check/robustness.py signals --count 300 --seed 0
    scripts/check/robustness.py signals --only sweep-2 --only fit-2 --count 20

Commands are dealt in turn. The signal comes to the command alone, as by ``kill``, or to all its processes at
once, as from a terminal or a batch queue. One that SIGINT or SIGTERM has ended exits with 130 or 143, and no
signal is lost; it prints one line of why and no traceback; what it was asked to write is whole or not there,
and no temporary file is left, but of SIGKILL. Its processes end with it, whichever signal it was.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import os
import random
import re
import shlex
import shutil
import signal
import sys
import time
from pathlib import Path

import psutil

from robust.children import ANEW, ROOT, Child, Ended, is_whole, judge, temporary_files
from robust.trials import Report, TrialError, must

_STUDY = """scenario = "pendulum"
[parameters.span]
key = "duration"
start = "1 s"
stop = "2 s"
count = 4000
[responses.error]
measure = "energy_error"
"""
_SWEEP = "sweep s.study.toml --out s.study --no-progress --workers"
_FIT = "fit hinge.fit.toml --profile --draws 200 --out fit.nc --no-progress"
_DIAGRAM = "bifurcation slider_crank/friction --out diagram.nc --no-progress --workers"
_MOTOR = "drives.motor={joint='hinge', kind='sine', amplitude='1 N*m', frequency='0.625 Hz'}"
_ORBIT = f"orbit pendulum --case ideal --set {shlex.quote(_MOTOR)} --over drives.motor.amplitude"
_RUN = "run bai2020 --case case3 --no-progress"

#: Long commands by name; each reads from its working folder, and writes there.
COMMANDS = {
    "run": f"{_RUN} --duration 100 --out long.nc",
    "sweep-1": f"{_SWEEP} 1",
    "sweep-2": f"{_SWEEP} 2",
    "fit-1": _FIT,
    "fit-2": f"{_FIT} --workers 2",
    "bifurcation-1": f"{_DIAGRAM} 1",
    "bifurcation-2": f"{_DIAGRAM} 2",
    "bifurcation-python": f"{_DIAGRAM} 2 --set integrator.engine=pinocchio",
    "poincare": "poincare slider_crank -q journal_position[pin].x --count 2000 --out points.nc",
    "orbit": f"{_ORBIT} --values '11 N*m:13 N*m' --arc 0.01 --out branch.nc --no-progress",
    "lyapunov": "lyapunov chen2021 --out exponents.nc --no-progress",
    "sensitivity": "sensitivity bai2020 clearance.elevation.radial_clearance --out slopes.nc",
    "modes": "modes bai2020 --case flexible-ideal --record modes.html",
    "plot": "plot run.nc --out figures",
    "report": "report run.nc --out report.html",
    "study": "study report few.study --out study.html",
    "record": "record run.nc --out page.html",
    "film": "record run.nc --speed 1/10 --out film.mp4 --no-progress",
    "frames": "record run.nc --speed 1/10 --out frames --no-progress",
    "explore": "explore bai2020 --no-browser",
    "docs": "",
}
SEED = 0
OPTIONS = {
    "--count": {"type": int, "default": 40, "help": "of signals over all commands [%(default)s]"},
    "--only": {"choices": COMMANDS, "action": "append", "help": "all if left out"},
}
_KINDS = tuple(itertools.product((signal.SIGINT, signal.SIGTERM), (False, True)))
_KINDS += ((signal.SIGKILL, False),)  # and whether it comes to all
_LONGEST = 20.0  # [s] of a command's life within which a signal is sent
_FIRST_LINE = 2.0  # [s] within which the command has surely begun
_AFTERWARDS = 10.0  # [s] that its processes have to follow it
_PATIENCE = 60.0  # [s] that a command has to end
_BEGUN = r"build_site\.py|_entry\.py|antenna-pin:"
_NOISE = re.compile(r"Traceback|Error\b|Exception|Warning|distributed|leaked|resource_tracker|unraisable")


def prepare(folder: Path) -> None:
    """Write into a folder what commands read."""
    folder.mkdir()
    (folder / "s.study.toml").write_text(_STUDY)
    for name in ("hinge.fit.toml", "hinge.csv"):
        shutil.copy(ROOT / "scripts" / "examples" / name, folder)
    (folder / "few.study.toml").write_text(_STUDY.replace("4000", "10"))
    for words in (f"{_RUN} --duration 1 --out run.nc", "sweep few.study.toml --out few.study --workers 0"):
        end = Child(shlex.split(words), folder, program=ANEW).ended()
        assert end.code == 0, end.said


def check(name: str, number: signal.Signals, to_all: bool, after: float, folder: Path) -> bool:
    """Send a signal to a command after a time [s]; return whether it was sent, raise what went wrong."""
    inputs = set(folder.rglob("*"))
    program = (sys.executable, str(ROOT / "scripts" / "pages" / "build_site.py")) if name == "docs" else ANEW
    child = Child(shlex.split(COMMANDS[name]), folder, program=program)
    sent = []

    def send(process: int) -> None:
        if os.waitid(os.P_PID, process, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:  # it has not ended
            (os.killpg if to_all else os.kill)(process, number)
            sent.append(number)

    try:
        end = child.ended(after, send, after + _PATIENCE)
    except TrialError as error:
        raise TrialError(f"{error}; processes then: {_left(child)}") from None
    left = _left(child)
    if not sent:
        must(end.code == 0, f"ended by itself with {end.code}: {end.said[-300:]}")
    if not sent or _is_pythons_own(end, number):
        return False
    codes = {128 + number, -number} | ({0} if name == "explore" else set())
    noise = re.compile("Traceback") if number == signal.SIGKILL else _NOISE  # Python tells of what it cleans
    judge(end, codes, in_one_line=(128 + number,), noise=noise)
    must(not left, f"left processes behind: {left}")
    left_files = temporary_files(folder)
    for path in set(folder.rglob("*")) - inputs:
        is_begun = str(path.relative_to(folder)) in left_files
        must(is_begun or not path.is_file() or is_whole(path), f"left {path.name}, which is not whole")
    must(not left_files or number == signal.SIGKILL, f"left {left_files}")
    return True


def _is_pythons_own(end: Ended, number: int) -> bool:
    """Return whether Python has said that it is interrupted, on its way to the first line of the command."""
    early = end.code in (1, -number) and "KeyboardInterrupt" in end.said
    return early and not re.search(_BEGUN, end.said)


def _left(child: Child) -> list[str]:
    """Return the processes that a command has left behind, after a while, and end them."""
    until = time.monotonic() + _AFTERWARDS
    while (left := child.processes()) and time.monotonic() < until:
        time.sleep(0.1)
    named = []
    for one in left:
        with contextlib.suppress(psutil.NoSuchProcess):
            process = psutil.Process(one)
            named.append(" ".join(process.cmdline())[:80])
            process.kill()
    return named


def run(given: argparse.Namespace, report: Report, folder: Path) -> None:
    """Send the signals."""
    report.verbose = True
    life = dict.fromkeys(COMMANDS, _LONGEST)  # [s], at most
    prepare(folder / "inputs")
    for trial, name in zip(range(given.count), itertools.cycle(given.only or COMMANDS), strict=False):
        chance = random.Random(f"{given.seed} {name} {trial}")
        number, to_all = chance.choice(_KINDS)
        sent = False
        while not sent:
            after = chance.uniform(0.05, life[name])
            place = folder / f"{trial} {after}"
            shutil.copytree(folder / "inputs", place)
            problem = None
            try:
                sent = check(name, number, to_all, after, place)
            except TrialError as error:
                sent, problem = True, str(error)
            shutil.rmtree(place, ignore_errors=True)
            life[name] = life[name] if sent or after < _FIRST_LINE else after
        whom = " to all" if to_all else ""
        report.add(name, f"{name}, {number.name}{whom} after {after:.2f} s", problem, after)
