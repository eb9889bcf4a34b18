#!/usr/bin/env python3
"""Memory that a long run and the commands that read its result take, above what their imports take.

Case 3 of the antenna by the compiled engine, 40 s sampled at 10 kHz: a result of half a gigabyte. Each
command is a process of its own, which first loads all that commands load; what counts is its peak resident
memory less that::

    scripts/bench/memory.py
    scripts/bench/memory.py --quick         # 1 s
"""

from __future__ import annotations

import subprocess
import sys
import tempfile

from bench_tools import CLOSED_FORM, Report

OWN = """
import sys
sys.modules.setdefault("dask", None)
import antenna_pin.analysis, antenna_pin.cli, antenna_pin.simulation
if sys.argv[1] != "run":
    from antenna_pin import plot, record, report
    for room in (plot, record, report):
        [getattr(room, name) for name in room.__all__]
from antenna_pin._entry import main

def memory(what):
    line = next(line for line in open("/proc/self/status") if line.startswith(what))
    return int(line.split()[1]) / 1024.0

before = memory("VmRSS")
try:
    main()
except SystemExit as ended:
    if ended.code:
        raise
print(memory("VmHWM") - before, file=sys.stderr)
"""
RUN = ("run", "bai2020", "--case", "case3", "--set", CLOSED_FORM, "--engine", "compiled")
RUN += ("--set", "output.rate=10 kHz", "--out", "run.nc", "--no-progress")
IDEAL = ("run", "bai2020", "--case", "case1", "--out", "ideal.nc", "--no-progress")
READERS = {
    "info": ("info", "run.nc"),
    "impacts": ("impacts", "run.nc"),
    "record": ("record", "run.nc", "--out", "run.html"),
    "analyse": ("analyse", "run.nc"),
    "plot": ("plot", "run.nc", "--out", "figures"),
    "pointing": ("pointing", "run.nc", "--ideal", "ideal.nc"),
    "report": ("report", "run.nc", "--out", "report.html"),
}


def above_imports(words: tuple[str, ...], folder: str) -> float:
    """Return the peak memory of a command above its imports [MB]."""
    done = subprocess.run(
        [sys.executable, "-c", OWN, *words], cwd=folder, check=True, capture_output=True, text=True
    )
    return float(done.stderr.splitlines()[-1])


def main() -> int:
    """Measure all of it."""
    report = Report("memory", __doc__ or "")
    quick = report.parse().quick
    span = "1" if quick else "40"
    with tempfile.TemporaryDirectory() as folder:
        report.add(f"run, {span} s at 10 kHz", above_imports((*RUN, "--duration", span), folder), "MB", 300.0)
        above_imports((*IDEAL, "--duration", span), folder)
        for name, words in READERS.items():
            report.add(name, above_imports(words, folder), "MB", 600.0)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
