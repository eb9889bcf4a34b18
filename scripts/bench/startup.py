#!/usr/bin/env python3
"""How long the command line takes to answer, and which rooms it loads for that.

Each command is a process of its own, as a shell starts it, after one that is dropped; beside it stands
Python doing nothing. What a command does not need it must not import: mechanics, figures and recordings are
loaded when they are used.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from bench_tools import Report

LIMIT = 0.5  # [s]
COMMAND = ("-c", "from antenna_pin._entry import main; main()")
LOOKS = ("--direction", "1,0,0", "--body", "bar", "--boresight", "1,0,0")
BARE = "import numpy, xarray"
COMMANDS = {
    "antenna-pin --help": (["-m", "antenna_pin.cli", "--help"], LIMIT),
    "antenna-pin list": (["-m", "antenna_pin.cli", "list"], LIMIT),
    "antenna-pin record --help": (["-m", "antenna_pin.cli", "record", "--help"], LIMIT),
    "antenna-pin contact list": (["-m", "antenna_pin.cli", "contact", "list"], None),
    "antenna-pin info run.nc": ([*COMMAND, "info", "run.nc"], None),
    "antenna-pin analyse run.nc": ([*COMMAND, "analyse", "run.nc"], None),
    "antenna-pin pointing run.nc": ([*COMMAND, "pointing", "run.nc", *LOOKS], None),
    "antenna-pin urdf bai2020": ([*COMMAND, "urdf", "bai2020", "--out", "antenna.urdf"], None),
    BARE: (["-c", "import numpy, xarray"], None),
    "import antenna_pin": (["-c", "import antenna_pin"], None),
    "python doing nothing": (["-c", "pass"], None),
}


def seconds(arguments: list[str]) -> float:
    """Return how long a Python process takes [s]."""
    began = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


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
    folder = tempfile.TemporaryDirectory()
    os.chdir(folder.name)
    seconds([*COMMAND, *"run pendulum --case ideal --duration 0.2 --out run.nc -q --no-progress".split()])
    rounds = [
        {name: seconds(command) for name, (command, _) in COMMANDS.items()}
        for _ in range((2 if arguments.quick else 12) + 1)
    ]
    for name, (_, limit) in COMMANDS.items():
        report.add(name, np.median([one[name] for one in rounds[1:]]), "s", limit)
    for name, (command, limit) in COMMANDS.items():
        if limit is not None:
            report.add(f"{name}, modules", modules(command))
        if name.endswith(("run.nc", "bai2020")):
            report.add(f"{name}, over {BARE}", np.median([one[name] / one[BARE] for one in rounds[1:]]), "-")
    folder.cleanup()
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
