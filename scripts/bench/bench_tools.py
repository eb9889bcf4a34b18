"""What the benchmarks share: interleaved timing, a table of numbers against their limits, a file of them."""

from __future__ import annotations

import argparse
import json
import os
import platform
import time
import timeit
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin import Scenario, load_scenario
from antenna_pin.trajectory import library_versions

Array = NDArray[np.float64]

CLOSED_FORM = "clearance.elevation.geometry=closed-form"


def scenario(case: str = "case3", *overrides: str) -> Scenario:
    """Return a case of the shipped antenna with some entries changed."""
    return load_scenario("bai2020", case=case, overrides=overrides)


def off_centre(joint: str, count: int) -> list[str]:
    """Return initial positions of a journal: the centre, then places off it by up to 10 um."""
    places = np.random.default_rng(1).uniform(-1e-5, 1e-5, (count, 2))
    places[0] = 0.0
    return [f"initial.joints.{joint}.journal_position=[{x:.9f}, {y:.9f}, 0]" for x, y in places]


def print_table(rows: Sequence[str], columns: Mapping[str, Array], column_width: int) -> None:
    """Print a row per quantity and a column per case; a dash for NaN."""
    width = max(map(len, rows))
    print(" " * width, *(f"{label:>{column_width}}" for label in columns))
    for k, row in enumerate(rows):
        texts = [f"{column[k]:.3g}" if np.isfinite(column[k]) else "-" for column in columns.values()]
        print(f"{row:<{width}}", *(f"{text:>{column_width}}" for text in texts))


def interleaved(
    statements: Mapping[str, tuple[str, Mapping[str, Any]]], repeats: int, number: int
) -> dict[str, Array]:
    """Take processor times of statements in turns, so that what slows the machine down slows all of them.

    Args:
        statements: Code and the names it needs, by label.
        repeats: Rounds; one more is made first and dropped.
        number: Executions in a round.

    Returns:
        Seconds per execution, one for each round, by label.
    """
    timers = {
        label: timeit.Timer(code, timer=time.process_time, globals=dict(names))
        for label, (code, names) in statements.items()
    }
    rounds = [
        {label: timer.timeit(number) / number for label, timer in timers.items()} for _ in range(repeats + 1)
    ]
    return {label: np.array([one[label] for one in rounds[1:]]) for label in timers}


@dataclass(frozen=True, slots=True)
class Figure:
    """One number of a benchmark."""

    name: str  # what it is
    value: float  # the number
    unit: str = "-"  # its unit, "-" for a ratio
    limit: float | None = None  # what it must not exceed; None where nothing is promised

    @property
    def kept(self) -> bool:
        """Whether it is within its limit."""
        return self.limit is None or self.value <= self.limit


class Report:
    """The numbers of one benchmark: printed, saved and compared.

    Args:
        name: Of the benchmark.
        description: What it measures, for ``--help``.
    """

    def __init__(self, name: str, description: str) -> None:
        """Prepare the command line; add arguments to ``parser`` before ``parse``."""
        self.name = name
        self.figures: list[Figure] = []
        self.parser = argparse.ArgumentParser(description=description)
        add = self.parser.add_argument
        add("--save", type=Path, metavar="FILE.json", help="write the numbers to a file")
        add("--compare", type=Path, metavar="FILE.json", help="set the numbers beside saved ones")
        add("--quick", action="store_true", help="less of everything, to see that it works")
        self.arguments = argparse.Namespace()

    def parse(self) -> argparse.Namespace:
        """Read the command line."""
        self.arguments = self.parser.parse_args()
        return self.arguments

    def add(self, name: str, value: float, unit: str = "-", limit: float | None = None) -> None:
        """Add a number."""
        self.figures.append(Figure(name, float(value), unit, limit))

    def finish(self) -> int:
        """Print, save and compare the numbers; return the exit code: 1 if a limit is exceeded."""
        before = self._before()
        width = max(len(figure.name) for figure in self.figures)
        head = f"{self.name:<{width}}  {'value':>10}  {'unit':<5}  {'limit':>7}"
        print(head + (f"  {'before':>10}  {'now/before':>10}" if before else ""))
        for figure in self.figures:
            limit = "" if figure.limit is None else f"{figure.limit:g}"
            line = f"{figure.name:<{width}}  {figure.value:>10.4g}  {figure.unit:<5}  {limit:>7}"
            if figure.name in before:
                old = before[figure.name]
                line += f"  {old:>10.4g}  " + (f"{figure.value / old:>10.3f}" if old else f"{'-':>10}")
            print(line + ("" if figure.kept else "  MISSED"))
        if self.arguments.save is not None:
            self._save(self.arguments.save)
        return 0 if all(figure.kept for figure in self.figures) else 1

    def _before(self) -> dict[str, float]:
        path = self.arguments.compare
        if path is None:
            return {}
        saved = json.loads(path.read_text(encoding="utf-8"))
        if saved.get("benchmark") != self.name:
            self.parser.error(f"{path}: must hold results of {self.name}, has {saved.get('benchmark')!r}")
        return {name: entry["value"] for name, entry in saved["figures"].items()}

    def _save(self, path: Path) -> None:
        figures = {f.name: {"value": f.value, "unit": f.unit, "limit": f.limit} for f in self.figures}
        machine = {"processor": _processor(), "cores": os.cpu_count(), "system": platform.system()}
        content = {
            "benchmark": self.name,
            "machine": machine,
            "versions": library_versions(),
            "figures": figures,
        }
        path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
        print(f"saved {path}")


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor()
    names = [line.partition(":")[2].strip() for line in text.splitlines() if line.startswith("model name")]
    return names[0] if names else platform.processor()
