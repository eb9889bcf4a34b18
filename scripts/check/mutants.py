#!/usr/bin/env python3
"""Break the package on purpose, one small change at a time, and see whether the tests notice.

``mutants/<room>.toml`` say what is broken and which tests must fail then (``mutant_list.py``). Every mutant
is made in a copy of the tree in a temporary folder, never in the checkout::

    scripts/check/mutants.py                  # all: two hours or so
    scripts/check/mutants.py --list
    scripts/check/mutants.py --only 7 12      # these, by their numbers in the list
    scripts/check/mutants.py --room sweep     # those of one file of the list

A mutant is *killed* if its tests fail or take longer than ``--timeout`` seconds, *alive* if they pass,
*equivalent* if the list says why nothing can notice it, *stale* if its text does not stand exactly once in
its file any more, and *broken* if its tests fail without it too or cannot be run. Exit code 1 if any is
alive, stale or broken.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import time
from collections import Counter
from functools import cache
from pathlib import Path

from mutant_list import MUTANTS, Mutant
from random_breaks import copied, run_tests

ROOT = Path(__file__).resolve().parents[2]
PASSED, FAILED = 0, 1  # exit codes of pytest


class Tree:
    """A copy of the tree in which tests run, for at most a time each [s]."""

    def __init__(self, folder: Path, timeout: float) -> None:
        """Copy what the tests need."""
        self.root, self.timeout = copied(folder), timeout
        self._compiled = folder / "numba"
        self.intact = cache(lambda tests, compiled: self.run(tests, compiled, "intact") == PASSED)

    def run(self, tests: tuple[str, ...], compiled: bool, cache_name: str) -> int | None:
        """Return pytest's exit code on some tests, as the tree stands; None if it took too long."""
        os.environ["NUMBA_CACHE_DIR"] = str(self._compiled / cache_name)
        return run_tests(self.root, list(tests), not compiled, self.timeout)

    def verdict(self, mutant: Mutant) -> str:
        """Make a mutant, run its tests, and put the tree right again."""
        if mutant.equivalent:
            return "equivalent"
        path = self.root / mutant.file
        text = path.read_text(encoding="utf-8")
        if not self.intact(mutant.tests, mutant.compiled):
            return "broken"
        name = "mutant" if path.name.endswith("kernels.py") else "intact"
        path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
        try:
            code = self.run(mutant.tests, mutant.compiled, name)
        finally:
            path.write_text(text, encoding="utf-8")
            shutil.rmtree(self._compiled / "mutant", ignore_errors=True)
        return {PASSED: "alive", FAILED: "killed", None: "killed (time)"}.get(code, "broken")


def is_stale(mutant: Mutant) -> bool:
    """Return whether the text of a mutant does not stand exactly once in its file."""
    return (ROOT / mutant.file).read_text(encoding="utf-8").count(mutant.old) != 1


def main() -> int:
    """Run the mutants that are asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--only", type=int, nargs="+", metavar="N", help="numbers in the list")
    parser.add_argument("--list", action="store_true", help="say what there is, and run nothing")
    parser.add_argument("--timeout", type=float, default=300.0, help="of one mutant's tests [s]")
    parser.add_argument("--room", choices=sorted({mutant.room for mutant in MUTANTS}), help="those of a room")
    asked = parser.parse_args()
    numbers = asked.only or [
        number for number, mutant in enumerate(MUTANTS, start=1) if asked.room in (None, mutant.room)
    ]
    if not all(1 <= number <= len(MUTANTS) for number in numbers):
        parser.error(f"--only takes numbers from 1 to {len(MUTANTS)}")
    if asked.list:
        for number in numbers:
            mutant = MUTANTS[number - 1]
            print(f"{number:3}  {mutant.file}: {mutant.note}")
        return 0
    seen: Counter[str] = Counter()
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        tree = Tree(Path(folder), asked.timeout)
        for number in numbers:
            mutant = MUTANTS[number - 1]
            began = time.perf_counter()
            verdict = "stale" if is_stale(mutant) else tree.verdict(mutant)
            seen[verdict] += 1
            reason = f" ({mutant.equivalent})" if mutant.equivalent else ""
            took = time.perf_counter() - began
            print(f"{number:3}  {verdict:13} {took:5.0f} s  {mutant.file}: {mutant.note}{reason}", flush=True)
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(seen.items())))
    return 1 if seen["alive"] or seen["stale"] or seen["broken"] else 0


if __name__ == "__main__":
    sys.exit(main())
