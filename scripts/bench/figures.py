#!/usr/bin/env python3
"""Cost of all figures of two runs: cases 1 and 3 over 5 s, by ``antenna-pin plot`` and ``report``.

Each beside what nobody can go without, in turns: importing Matplotlib, and importing it and saving one figure
of four bare panels as often as there are figures, placed as ours are. A checkout of an earlier state can be
measured in the same turns (``--beside FOLDER``). Cores that other work takes give nothing.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from bench_tools import Report, scenario

from antenna_pin import simulate

SPAN = 5.0  # [s]
FIGURES = 21  # that the command draws of these runs

COMMAND = [sys.executable, "-m", "antenna_pin.apps.cli"]
IMPORTS = "import matplotlib.figure, matplotlib.backends.backend_agg"
BARE = f"""{IMPORTS}
import numpy as np
x = np.linspace(0.0, 1.0, 5000)
for number in range({FIGURES}):
    figure = matplotlib.figure.Figure(figsize=(7.1, 4.7), layout="constrained")
    for axes in figure.subplots(2, 2).flat:
        axes.plot(x, np.sin(50.0 * x), label="a")
    figure.savefig("bare.png", dpi=300)
"""


def main() -> int:
    """Time the commands in turns."""
    report = Report("figures", __doc__ or "")
    report.parser.add_argument("--beside", type=Path, metavar="FOLDER", help="another checkout")
    arguments = report.parse()
    span, rounds = (0.2, 1) if arguments.quick else (SPAN, 5)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        runs = [
            str(simulate(scenario(case), duration=span).save(folder / f"{case}.nc"))
            for case in ("case1", "case3")
        ]
        commands = {"imports": [sys.executable, "-c", IMPORTS], "bare figures": [sys.executable, "-c", BARE]}
        there = {} if arguments.beside is None else {" there": str(arguments.beside.resolve())}
        for where in ("", *there):
            for verb, out in (("plot", "figures"), ("report", "report.html")):
                commands[verb + where] = [*COMMAND, verb, *runs, "--out", out]
        seconds: dict[str, list[float]] = {label: [] for label in commands}
        for _ in range(rounds):
            for label, command in commands.items():
                began = time.perf_counter()
                found = next((place for where, place in there.items() if label.endswith(where)), None)
                environment = os.environ | ({} if found is None else {"PYTHONPATH": found})
                subprocess.run(command, check=True, capture_output=True, cwd=folder, env=environment)
                seconds[label].append(time.perf_counter() - began)
    measured = {label: np.array(found) for label, found in seconds.items()}
    for label in commands:
        report.add(f"{label}, time", float(np.median(measured[label])), "s")
    for label in commands:
        for bare in ("imports", "bare figures"):
            if label not in ("imports", "bare figures"):
                ratio = float(np.median(measured[label] / measured[bare]))
                report.add(f"{label}, over {bare}", ratio)
    if arguments.beside is not None:
        for verb in ("plot", "report"):
            ratio = measured[verb] / measured[f"{verb} there"]
            report.add(f"{verb}, over that there", float(np.median(ratio)))
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
