#!/usr/bin/env python3
"""How long the command line takes to answer, and which rooms it loads for that.

Each command is a process of its own, as a shell starts it, after one that is dropped; beside it stands
Python doing nothing. What a command does not need it must not import: mechanics, figures and recordings are
loaded when they are used. Ratios are of CPU time, of the same round, over that of importing what a run cannot
do without. At last what a run costs beside its steps, in this process: one of a microsecond. Kernels have
been compiled before (``scripts/compile_kernels.py``), and Python's own code too.
"""

from __future__ import annotations

import compileall
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from bench_tools import Report

import antenna_pin

LIMIT = 0.5  # [s]
COMMAND = ("-c", "from antenna_pin.apps._entry import main; main()")
LOOKS = ("--direction", "1,0,0", "--body", "bar", "--boresight", "1,0,0")
BARE = "import numpy, xarray"
RUNNING = "import numpy, pinocchio, coal, numba, xarray"
#: Over RUNNING: command, limit.
RATIOS = {
    "antenna-pin run of 1 ms": 1.5,
    "antenna-pin info bai2020": 1.0,
}
#: Of a run beside its steps [ms].
FIXED = 8.0
SHORT = "run bai2020 --case case3 --duration 0.001 --out short.nc -q --no-progress".split()
COMMANDS = {
    "antenna-pin --help": (["-m", "antenna_pin.apps.cli", "--help"], LIMIT),
    "antenna-pin list": (["-m", "antenna_pin.apps.cli", "list"], LIMIT),
    "antenna-pin record --help": (["-m", "antenna_pin.apps.cli", "record", "--help"], LIMIT),
    "antenna-pin contact list": (["-m", "antenna_pin.apps.cli", "contact", "list"], None),
    "antenna-pin info run.nc": ([*COMMAND, "info", "run.nc"], None),
    "antenna-pin analyse run.nc": ([*COMMAND, "analyse", "run.nc"], None),
    "antenna-pin pointing run.nc": ([*COMMAND, "pointing", "run.nc", *LOOKS], None),
    "antenna-pin urdf bai2020": ([*COMMAND, "urdf", "bai2020", "--out", "antenna.urdf"], None),
    "antenna-pin run of 1 ms": ([*COMMAND, *SHORT], None),
    "antenna-pin info bai2020": ([*COMMAND, "info", "bai2020"], None),
    RUNNING: (["-c", RUNNING], None),
    BARE: (["-c", BARE], None),
    "import antenna_pin": (["-c", "import antenna_pin"], None),
    "python doing nothing": (["-c", "pass"], None),
}


def seconds(arguments: list[str]) -> tuple[float, float]:
    """Return how long a Python process takes, and its processor [s]."""
    began, worked = time.perf_counter(), _worked()
    subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began, _worked() - worked


def _worked() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def fixed_cost(model: str, case: str, rounds: int) -> tuple[float, float]:
    """Return the processor's time of a run of next to no steps, in a process that has made one [ms].

    And that of making its labelled data, which happens where they are first read.
    """
    scenario = antenna_pin.load_scenario(model, case=case)
    times = []
    for _ in range(rounds + 3):
        began = time.process_time()
        run = antenna_pin.simulate(scenario, duration=1e-6)
        made = time.process_time()
        assert "time" in run.data.sizes
        times.append((1e3 * (made - began), 1e3 * (time.process_time() - made)))
    cost, labelled = np.median(times[3:], axis=0).tolist()
    return cost, labelled


def modules(arguments: list[str]) -> int:
    """Return how many modules a Python process imports."""
    told = subprocess.run(
        [sys.executable, "-X", "importtime", *arguments], check=True, capture_output=True, text=True
    )
    return sum(line.startswith("import time:") for line in told.stderr.splitlines()) - 1  # the head


def main() -> int:
    """Time all commands in turns."""
    report = Report("startup", __doc__ or "")
    arguments = report.parse()
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    compileall.compile_dir(Path(antenna_pin.__file__).parent, quiet=1)
    folder = tempfile.TemporaryDirectory()
    os.chdir(folder.name)
    seconds([*COMMAND, *"run pendulum --case ideal --duration 0.2 --out run.nc -q --no-progress".split()])
    rounds = [
        {name: seconds(command) for name, (command, _) in COMMANDS.items()}
        for _ in range((2 if arguments.quick else 12) + 1)
    ]
    for name, (_, limit) in COMMANDS.items():
        report.add(name, np.median([one[name][0] for one in rounds[1:]]), "s", limit)
    for name, (command, limit) in COMMANDS.items():
        if limit is not None:
            report.add(f"{name}, modules", modules(command))
        if name.endswith(("run.nc", "urdf bai2020")):
            report.add(f"{name}, over {BARE}", np.median([one[name][1] / one[BARE][1] for one in rounds[1:]]))
    for name, limit in RATIOS.items():
        ratios = [one[name][1] / one[RUNNING][1] for one in rounds[1:]]
        report.add(f"{name}, over {RUNNING}", np.median(ratios), "-", limit)
    for model, case in (("pendulum", "ideal"), ("bai2020", "case3")):
        cost, labelled = fixed_cost(model, case, 5 if arguments.quick else 40)
        report.add(f"a run of {model} {case}, beside its steps", cost, "ms", FIXED)
        report.add(f"a run of {model} {case}, its data labelled", labelled, "ms")
    folder.cleanup()
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
