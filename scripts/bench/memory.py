#!/usr/bin/env python3
"""Memory and time that a long run and the commands that read its result take.

Case 3 of the antenna by the compiled engine, 40, 160 and 320 s sampled at 10 kHz: results of half a gigabyte
to four. Each command is a process of its own; what counts is its peak resident memory: for commands that read
all of it, imports included, for the run what is above that of a run of 1 ms, which has loaded the same code::

    scripts/bench/memory.py
    scripts/bench/memory.py --span 80       # a result of 1 GB
    scripts/bench/memory.py --quick         # 1 s
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from bench_tools import CLOSED_FORM, Report

OWN = """
import sys
from antenna_pin._entry import main

try:
    main()
except SystemExit as ended:
    if ended.code:
        raise
line = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
print(int(line.split()[1]) / 1024.0, file=sys.stderr)
"""
RUN = ("run", "bai2020", "--case", "case3", "--set", CLOSED_FORM, "--engine", "compiled")
RUN += (
    "--set",
    "integrator.accuracy=1e-3",
    "--set",
    "output.rate=10 kHz",
    "--out",
    "run.nc",
    "--no-progress",
)
IDEAL = ("run", "bai2020", "--case", "case1", "--out", "ideal.nc", "--no-progress")
READERS = {
    "info": ("info", "run.nc"),
    "impacts": ("impacts", "run.nc"),
    "impacts --csv": ("impacts", "run.nc", "--csv", "impacts.csv"),
    "phase": (
        "phase",
        "run.nc",
        "-x",
        "motion_angle[elevation]",
        "-y",
        "motion_rate[elevation]",
        "--out",
        "p.nc",
    ),
    "record": ("record", "run.nc", "--out", "run.html"),
    "analyse": ("analyse", "run.nc"),
    "plot": ("plot", "run.nc", "--out", "figures"),
    "pointing": ("pointing", "run.nc", "--ideal", "ideal.nc"),
    "report": ("report", "run.nc", "--out", "report.html"),
}


def peak(words: tuple[str, ...], folder: str) -> tuple[float, float]:
    """Return the peak memory of a command [MB], and its time [s]."""
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", OWN, *words], cwd=folder, check=True, capture_output=True, text=True
    )
    return float(done.stderr.splitlines()[-1]), time.perf_counter() - began


def main() -> int:
    """Measure all of it."""
    report = Report("memory", __doc__ or "")
    report.parser.add_argument("--span", action="append", help="of a run [s]; 40, 160 and 320 if left out")
    asked = report.parse()
    spans = ("1",) if asked.quick else asked.span or ("40", "160", "320")
    with tempfile.TemporaryDirectory() as folder:
        least, _ = peak((*RUN, "--duration", "1 ms"), folder)
    report.add("a run of 1 ms: imports and kernels", least, "MB")
    for span in spans:
        with tempfile.TemporaryDirectory() as folder:
            megabytes, seconds = peak((*RUN, "--duration", span), folder)
            report.add(f"{span} s at 10 kHz: run, above that", megabytes - least, "MB", 300.0)
            report.add(f"{span} s at 10 kHz: run, time", seconds, "s")
            report.add(f"{span} s at 10 kHz: result", (Path(folder) / "run.nc").stat().st_size / 1e6, "MB")
            peak((*IDEAL, "--duration", span), folder)
            for name, words in READERS.items():
                megabytes, seconds = peak(words, folder)
                report.add(f"{span} s at 10 kHz: {name}", megabytes, "MB", 600.0)
                report.add(f"{span} s at 10 kHz: {name}, time", seconds, "s")
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
