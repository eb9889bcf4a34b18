#!/usr/bin/env python3
"""Cost of a recording: case 3 over 5 s, both views, from the run in memory to the page on disk.

Each view is made in a process of its own, which first imports what a recording needs and holds the run; its
memory then is the base that the largest memory of the recording is set against (Linux).
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

CHILD = """
import json, resource, sys, time
from antenna_pin.trajectory import Trajectory
from antenna_pin.show.record import record
from antenna_pin.show.record.scene import viewer_script

def resident():
    with open("/proc/self/status", encoding="ascii") as lines:
        return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1e3

run, ideal = Trajectory.load(sys.argv[1]), Trajectory.load(sys.argv[2])
view, out = sys.argv[3], sys.argv[4]
base = resident()
began = time.perf_counter()
recording = record(run, ideal if view == "mechanism" else None, view=view)
path = recording.save(out)
seconds = time.perf_counter() - began
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
print(json.dumps([seconds, peak - base, path.stat().st_size / 1e6, len(recording.frames.indices)]))
"""


def main() -> int:
    """Record both views."""
    report = Report("recording", __doc__ or "")
    arguments = report.parse()
    span = 0.2 if arguments.quick else SPAN
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = []
        for case in ("case3", "case1"):
            files.append(str(simulate(scenario(case), duration=span).save(folder / f"{case}.nc")))
        for view in ("mechanism", "joint"):
            command = [sys.executable, "-c", CHILD, *files, view, str(folder / f"{view}.html")]
            done = subprocess.run(command, check=True, capture_output=True, text=True)
            seconds, megabytes, size, frames = json.loads(done.stdout)
            report.add(f"{view}, time to write", seconds, "s", 10.0)
            report.add(f"{view}, memory above imports and run", megabytes, "MB", 300.0)
            report.add(f"{view}, size of the page", size, "MB", 5.0)
            report.add(f"{view}, key frames", frames)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
