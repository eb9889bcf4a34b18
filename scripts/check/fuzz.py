#!/usr/bin/env python3
"""Inputs of every format with something changed: does each end with a result, or a refusal in one line?

Scenarios, studies, diagrams, URDF files, tables, result files, options of every command, calls in Python: of
each format a sound input is taken, and something in it changed that the package declares, so that a new
key, kind, option or function is tried as soon as it is there. An input follows from the seed, its format and
its number::

    scripts/check/fuzz.py --count 20000                    # of all formats
    scripts/check/fuzz.py --format urdf --count 500        # of one
    scripts/check/fuzz.py --seed 1 --only scenario:137     # one again

What must hold:

- a command ends with exit code 0 or 3 and no word but notes, or with 2 and one plain line that says why; a
  call returns, or raises an error of the package's own with such a line;
- what breaks a declared rule is refused, and the line names the place;
- nothing is left behind by what was refused;
- no warning of NumPy's, no traceback, no process that dies, and nothing that takes longer than ``--wall``.

Of what fails the changes are tried one by one, and the least that fails too is printed with how to repeat it.
Exit code 1 on any failure.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from multiprocessing.connection import Connection, wait
from pathlib import Path
from random import Random

from fuzzing import FORMATS
from fuzzing.inputs import Draft, problem_of
from fuzzing.made import made

__all__ = ["drawn", "inputs_of", "least_problem"]

_MEMORY = 8 << 30  # bytes that a process may have
_START = 90.0  # seconds more for the first input of a process, which imports


def drawn(seed: int, name: str) -> Draft:
    """Return an input by ``FORMAT:NUMBER``."""
    kind, _, _ = name.partition(":")
    return FORMATS[kind](Random(f"{seed}/{name}"))


def inputs_of(formats: Sequence[str], count: int, first: int = 0) -> list[str]:
    """Return the names of so many inputs, of the formats in turn."""
    return [f"{formats[k % len(formats)]}:{k // len(formats)}" for k in range(first, first + count)]


def least_problem(draft: Draft) -> tuple[Draft, str] | None:
    """Return an input that fails, with as few of a draft's changes as do, and how; None if it does not."""
    problem = _tried(draft)
    if problem is None or len(draft.changes) < 2:
        return None if problem is None else (draft, problem)
    for change in draft.changes:
        single = replace(draft, changes=(change,))
        if (found := _tried(single)) is not None:
            return single, found
    return draft, problem


def _tried(draft: Draft) -> str | None:
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
        return problem_of(draft, Path(folder))


# --- processes of their own --------------------------------------------------------------------------------


def _work(pipe: Connection, seed: int, names: Sequence[str]) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    made()  # once, before any time is taken
    with tempfile.TemporaryDirectory(prefix="fuzz-home-") as home:
        os.environ["HOME"] = home
        for name in names:
            began = time.monotonic()
            found = least_problem(drawn(seed, name))
            pipe.send((None if found is None else (found[0].name, found[1]), time.monotonic() - began))


class _Worker:
    """A process that tries inputs one after the other, from some place in a list on."""

    def __init__(self, seed: int, names: Sequence[str]) -> None:
        """Start it."""
        context = multiprocessing.get_context("spawn")
        self.names = list(names)
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_work, args=(theirs, seed, self.names), daemon=True)
        self.process.start()
        theirs.close()
        self.until = time.monotonic() + _START

    def end(self) -> int | None:
        """End it; return how it ended."""
        self.process.join(0.5)
        self.process.kill()
        self.process.join()
        return self.process.exitcode


def problems(
    seed: int, names: Sequence[str], wall: float, jobs: int
) -> Iterator[tuple[str, str, str | None, float]]:
    """Yield of each input its name, its changes, what is wrong if anything is, and how long it took [s]."""
    workers = [_Worker(seed, part) for k in range(jobs) if (part := names[k::jobs])]
    try:
        for worker in workers:
            worker.until += wall
        while workers:
            ready = wait([worker.pipe for worker in workers], timeout=1.0)
            for worker in list(workers):
                fault = ""
                if worker.pipe in ready:
                    try:
                        found, seconds = worker.pipe.recv()
                    except EOFError:
                        fault = f"the process ended with code {worker.end()}"
                elif time.monotonic() > worker.until:
                    fault = f"takes longer than {wall:g} s"
                else:
                    continue
                name, rest = worker.names[0], worker.names[1:]
                if fault:
                    worker.end()
                    yield name, drawn(seed, name).name, fault, wall
                else:
                    yield (name, *(found or ("", None)), seconds)
                if fault or not rest:
                    workers.remove(worker)
                    worker.end()
                    if rest:
                        workers.append(_Worker(seed, rest))
                        workers[-1].until += wall
                else:
                    worker.names, worker.until = rest, time.monotonic() + wall
    finally:
        for worker in workers:
            worker.process.kill()


def main() -> int:
    """Try them and tell of those that fail."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="of inputs [%(default)s]")
    parser.add_argument("--seed", type=int, default=1, help="[%(default)s]")
    parser.add_argument("--format", choices=FORMATS, action="append", help="all if left out")
    parser.add_argument("--only", metavar="FORMAT:NUMBER", action="append", help="one again, here")
    parser.add_argument("--wall", type=float, default=30.0, help="seconds that each may take [%(default)s]")
    parser.add_argument("--jobs", type=int, default=1, help="processes at a time [%(default)s]")
    asked = parser.parse_args()
    names = asked.only or inputs_of(asked.format or [*FORMATS], asked.count)
    tried: Counter[str] = Counter()
    failed: Counter[str] = Counter()
    slowest: dict[str, tuple[float, str]] = {}
    for name, changes, problem, seconds in problems(asked.seed, names, asked.wall, asked.jobs):
        kind = name.partition(":")[0]
        tried[kind] += 1
        slowest[kind] = max(slowest.get(kind, (0.0, "")), (seconds, name))
        if problem is not None:
            failed[kind] += 1
            print(f"--seed {asked.seed} --only {name}: {changes}: {problem}", flush=True)
    for kind, count in tried.items():
        seconds, name = slowest[kind]
        print(f"{kind}: {count} inputs, {failed[kind]} failed; the slowest, {name}, took {seconds:.1f} s")
    print(f"{tried.total()} inputs, {failed.total()} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
