#!/usr/bin/env python3
"""Cost of a report: cases 1 and 3 over 5 s, from the runs in memory to the page on disk.

With figures and recordings, with figures only, and with tables only; each in a process of its own, which
first imports what a report needs and holds the runs; its memory then is the base that the largest memory of
the report is set against (Linux).
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
CONTENTS = {
    "all": {},
    "without recordings": {"recordings": False},
    "tables only": {"figures": False, "recordings": False},
}

CHILD = """
import json, resource, sys, time
import antenna_pin.show.plot, antenna_pin.show.record
from antenna_pin.show.report import report
from antenna_pin.trajectory import Trajectory

def resident():
    with open("/proc/self/status", encoding="ascii") as lines:
        return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1e3

runs = [Trajectory.load(path) for path in sys.argv[3:]]
base = resident()
began = time.perf_counter()
path = report(runs, **json.loads(sys.argv[1])).save(sys.argv[2])
seconds = time.perf_counter() - began
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
print(json.dumps([seconds, peak - base, path.stat().st_size / 1e6]))
"""


def main() -> int:
    """Write reports of the same two runs."""
    report = Report("report", __doc__ or "")
    arguments = report.parse()
    span = 0.2 if arguments.quick else SPAN
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = [
            str(simulate(scenario(case), duration=span).save(folder / f"{case}.nc"))
            for case in ("case1", "case3")
        ]
        for label, options in CONTENTS.items():
            command = [sys.executable, "-c", CHILD, json.dumps(options), str(folder / "report.html"), *files]
            done = subprocess.run(command, check=True, capture_output=True, text=True)
            seconds, megabytes, size = json.loads(done.stdout)
            report.add(f"{label}, time to write", seconds, "s", 10.0)
            report.add(f"{label}, memory above imports and runs", megabytes, "MB", 300.0)
            report.add(f"{label}, size of the page", size, "MB", 5.0)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
