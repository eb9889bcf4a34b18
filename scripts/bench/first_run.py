#!/usr/bin/env python3
"""First, second and third run of a package that has just been installed.

Each wheel is installed into an environment of its own, a plain one with its extra ``compile``; what pip takes
is left out. A wheel of another version, or one with machine code (``scripts/check/release_check.py --code
FOLDER``), stands beside it::

    python scripts/bench/first_run.py plain=dist/antenna_pin-0.3.0-py3-none-any.whl code=FOLDER/NAME.whl

Processor time includes that of all processes.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from bench_tools import Report

ROOT = Path(__file__).parents[2]
RUN = "run bai2020 --case case3 --duration 0.001 --out run.nc -q --no-progress".split()
LIMITS = {"code": 10.0}  # of the first run, by the label of the wheel [s]
LARGEST = {"code": 25.0}  # wheel, by its label [MB]


def size_of(folder: Path) -> float:
    """Return the size of a folder's files [MB]."""
    return sum(one.lstat().st_size for one in folder.rglob("*") if not one.is_dir()) / 1e6


def seconds(command: list[str], folder: Path) -> tuple[float, float]:
    """Return wall and processor time of a command [s]."""
    without = {
        name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "NUMBA_CACHE_DIR")
    }
    began, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, env=without, check=True)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> int:
    """Install and run."""
    report = Report("first_run", __doc__ or "")
    report.parser.add_argument("wheels", nargs="+", metavar="LABEL=WHEEL")
    for given in report.parse().wheels:
        label, _, wheel = given.partition("=")
        with tempfile.TemporaryDirectory() as made:
            folder = Path(made)
            seconds([sys.executable, "-m", "venv", "env"], folder)
            there = str(folder / "env" / "bin" / "python")
            install = ("-m", "pip", "install", "-q", "-c", str(ROOT / "constraints.txt"))
            extra = "[compile]" if wheel.endswith("-none-any.whl") else ""
            empty = size_of(folder / "env")
            seconds([there, *install, f"{Path(wheel).resolve()}{extra}"], folder)
            report.add(f"{label}: wheel", Path(wheel).stat().st_size / 1e6, "MB", LARGEST.get(label))
            report.add(f"{label}: installed, with all it needs", size_of(folder / "env") - empty, "MB")
            for number in ("first", "second", "third"):
                wall, processor = seconds([str(folder / "env" / "bin" / "antenna-pin"), *RUN], folder)
                limit = LIMITS.get(label) if number == "first" else None
                report.add(f"{label}: {number} run, wall", wall, "s", limit)
                report.add(f"{label}: {number} run, processor", processor, "s")
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
