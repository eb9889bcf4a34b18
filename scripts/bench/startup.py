#!/usr/bin/env python3
"""How long the command line takes to answer, and which rooms it loads for that.

Each command is a process of its own, as a shell starts it, after one that is dropped; beside it stands
Python doing nothing. What a command does not need it must not import: mechanics, figures and recordings are
loaded when they are used.
"""

from __future__ import annotations

import subprocess
import sys
import time

import numpy as np
from bench_tools import Report

LIMIT = 0.5  # [s]
COMMANDS = {
    "antenna-pin --help": (["-m", "antenna_pin.cli", "--help"], LIMIT),
    "antenna-pin list": (["-m", "antenna_pin.cli", "list"], LIMIT),
    "antenna-pin record --help": (["-m", "antenna_pin.cli", "record", "--help"], LIMIT),
    "antenna-pin contact list": (["-m", "antenna_pin.cli", "contact", "list"], None),
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
    rounds = [
        {name: seconds(command) for name, (command, _) in COMMANDS.items()}
        for _ in range((2 if arguments.quick else 12) + 1)
    ]
    for name, (_, limit) in COMMANDS.items():
        report.add(name, np.median([one[name] for one in rounds[1:]]), "s", limit)
    for name, (command, limit) in COMMANDS.items():
        if limit is not None:
            report.add(f"{name}, modules", modules(command))
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
