#!/usr/bin/env python3
"""Cost of recordings and reports: case 3 over 5 s, with case 1, from the runs in memory to the page on disk.

Recordings in both views; reports with figures and recordings, with figures only, and with tables only. Each
is made in a process of its own, which first imports what it needs and holds the runs; its memory then is the
base that the largest memory of the page is set against (Linux).
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from bench_tools import Report, scenario

from antenna_pin import simulate

SPAN = 5.0  # [s]
PAGES = {
    "mechanism": "record(runs[0], runs[1])",
    "joint": "record(runs[0], view='joint')",
    "report": "report(runs[::-1])",
    "report without recordings": "report(runs[::-1], recordings=False)",
    "report, tables only": "report(runs[::-1], figures=False, recordings=False)",
}

CHILD = """
import json, resource, sys, time
import antenna_pin.show.plot
from antenna_pin.show.record import record
from antenna_pin.show.record.scene import viewer_script
from antenna_pin.show.report import report
from antenna_pin.trajectory import Trajectory

def resident():
    with open("/proc/self/status", encoding="ascii") as lines:
        return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1e3

runs = [Trajectory.load(path) for path in sys.argv[2:]]
base = resident()
began = time.perf_counter()
path = {page}.save(sys.argv[1])
seconds = time.perf_counter() - began
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
print(json.dumps([seconds, peak - base, path.stat().st_size / 1e6]))
"""


def main() -> int:
    """Make the pages of the same two runs."""
    report = Report("pages", __doc__ or "")
    span = 0.2 if report.parse().quick else SPAN
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = [
            str(simulate(scenario(case), duration=span).save(folder / f"{case}.nc"))
            for case in ("case3", "case1")
        ]
        for label, page in PAGES.items():
            command = [sys.executable, "-c", CHILD.replace("{page}", page), str(folder / "page.html"), *files]
            done = subprocess.run(command, check=True, capture_output=True, text=True)
            seconds, megabytes, size = json.loads(done.stdout)
            report.add(f"{label}, time to write", seconds, "s", 10.0)
            report.add(f"{label}, memory above imports and runs", megabytes, "MB", 300.0)
            report.add(f"{label}, size of the page", size, "MB", 5.0)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
