#!/usr/bin/env python3
"""Memory and time that a long run and the commands that read its result take.

Case 3 of the antenna by the compiled engine, 40, 160 and 320 s sampled at 10 kHz: results of half a gigabyte
to four; and two bodies that bounce in a bore without a loss, each time an episode of contact. Each command
is a process of its own; what counts is the peak resident memory of it, or of a process that it starts if that
has more: for commands that read all of it, imports included, for the run what is above that of a run of 1 ms,
which has loaded the same code::

    scripts/bench/memory.py
    scripts/bench/memory.py --span 80 --episodes 0       # a result of 1 GB
    scripts/bench/memory.py --episodes 100000            # one of 100,000 episodes, of 400 MB
    scripts/bench/memory.py --quick                      # 1 s, 1000 episodes
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from bench_tools import CLOSED_FORM, Report

OWN = """
import resource, sys
from antenna_pin.apps._entry import main

try:
    main()
except SystemExit as ended:
    if ended.code:
        raise
line = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
others = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
print(max(int(line.split()[1]), others) / 1024.0, file=sys.stderr)
"""
Words = tuple[str, ...]
AS_FILE = ("--out", "run.nc", "--no-progress")
RUN: Words = (
    "run",
    "bai2020",
    "--case",
    "case3",
    "--set",
    CLOSED_FORM,
    "--set",
    "integrator.engine=compiled",
)
RUN += ("--set", "integrator.accuracy=1e-3", "--set", "output.rate=10 kHz", *AS_FILE)
IDEAL: Words = ("run", "bai2020", "--case", "case1", "--out", "ideal.nc", "--no-progress")
BOUNCES: Words = ("run", "impact_pair", "--set", "clearance.bore.geometry=closed-form", "--set")
BOUNCES += ("clearance.bore.normal.restitution=1", "--set", "integrator.rtol=1e-7", "--set")
BOUNCES += ("output.rate=1 kHz", *AS_FILE)
EPISODE = 2.2e-3  # [s] from one to the next
READERS: Mapping[str, Words] = {
    "info": ("info", "run.nc"),
    "info --all": ("info", "--all", "run.nc"),
    "impacts": ("impacts", "run.nc"),
    "impacts --csv": ("impacts", "run.nc", "--csv", "impacts.csv"),
    "analyse": ("analyse", "run.nc"),
    "record": ("record", "run.nc", "--out", "run.html"),
    "record --view joint": ("record", "run.nc", "--view", "joint", "--out", "joint.html"),
    "plot": ("plot", "run.nc", "--out", "figures"),
    "report": ("report", "run.nc", "--out", "report.html"),
}
ACCELERATION = "body_acceleration[body].x"
PHASE = ("phase", "run.nc", "-x")
OF_ANTENNA: Mapping[str, Words] = {
    "phase": (*PHASE, "motion_angle[elevation]", "-y", "motion_rate[elevation]", "--out", "p.nc"),
    "pointing": ("pointing", "run.nc", "--ideal", "ideal.nc"),
    "vibration density": ("vibration", "density", "run.nc", "--of", ACCELERATION),
    "vibration shock": ("vibration", "shock", "run.nc", "--of", ACCELERATION),
}
OF_BOUNCES: Mapping[str, Words] = {
    "phase": (*PHASE, "journal_position[bore].x", "-y", "journal_position[bore].y", "--out", "p.nc"),
}


def peak(words: Words, folder: str) -> tuple[float, float]:
    """Return the peak memory of a command [MB], and its time [s]."""
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", OWN, *words], cwd=folder, check=True, capture_output=True, text=True
    )
    return float(done.stderr.splitlines()[-1]), time.perf_counter() - began


def measure(report: Report, name: str, run: Words, readers: Mapping[str, Words], least: float) -> None:
    """Make a result, and measure that and its readers."""
    with tempfile.TemporaryDirectory() as folder:
        megabytes, seconds = peak(run, folder)
        report.add(f"{name}: run, above that", megabytes - least, "MB", 300.0)
        report.add(f"{name}: run, time", seconds, "s")
        report.add(f"{name}: result", (Path(folder) / "run.nc").stat().st_size / 1e6, "MB")
        if "pointing" in readers:
            peak((*IDEAL, *run[-2:]), folder)
        for reader, words in (READERS | dict(readers)).items():
            megabytes, seconds = peak(words, folder)
            report.add(f"{name}: {reader}", megabytes, "MB", 600.0)
            report.add(f"{name}: {reader}, time", seconds, "s")


def main() -> int:
    """Measure all of it."""
    report = Report("memory", __doc__ or "")
    add = report.parser.add_argument
    add("--span", action="append", help="of a run [s]; 40, 160 and 320 if left out")
    add("--episodes", type=int, default=100_000, help="of contact, at least; 0 for no such run [%(default)s]")
    asked = report.parse()
    spans = ("1",) if asked.quick else asked.span or ("40", "160", "320")
    episodes = min(asked.episodes, 1000) if asked.quick else asked.episodes
    with tempfile.TemporaryDirectory() as folder:
        least, _ = peak((*RUN, "--duration", "1 ms"), folder)
    report.add("a run of 1 ms: imports and kernels", least, "MB")
    for span in spans:
        measure(report, f"{span} s at 10 kHz", (*RUN, "--duration", span), OF_ANTENNA, least)
    if episodes:
        bounces = (*BOUNCES, "--duration", f"{EPISODE * episodes:g}")
        measure(report, f"{episodes} episodes", bounces, OF_BOUNCES, least)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
