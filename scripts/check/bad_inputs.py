#!/usr/bin/env python3
"""Bad inputs, hundreds of them: is each refused in one line, with exit code 2 and no traceback?

URDF files, scenario files, quantities, options of commands, result files, and calls in Python. Each is tried
in an empty folder by the command, or by the call, in a process of its own that others of its kind follow in::

    scripts/check/bad_inputs.py                        # all
    scripts/check/bad_inputs.py --only urdf            # of one kind
    scripts/check/bad_inputs.py --only "two masses"    # by a part of its name

One that takes longer than ``--wall`` seconds has failed, like one that says too much. Exit code 1 on any
failure.
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path

import bad_inputs_options
import bad_inputs_python
import bad_inputs_results
import bad_inputs_toml
import bad_inputs_urdf
from bad_input_case import Case, problem_of

_ROOMS = (bad_inputs_urdf, bad_inputs_toml, bad_inputs_options, bad_inputs_results, bad_inputs_python)


def all_cases() -> list[Case]:
    """Return every bad input."""
    return [case for room in _ROOMS for case in room.cases()]


def problems(cases: list[Case], wall: float) -> Iterator[tuple[Case, str]]:
    """Yield those that are not refused as they must be, and how.

    Args:
        cases: What to try.
        wall: Seconds that each may take; the first of a process has a minute more, to import.
    """
    context = multiprocessing.get_context("spawn")
    number = 0
    while number < len(cases):
        ours, theirs = context.Pipe()
        worker = context.Process(target=_work, args=(theirs, number), daemon=True)
        worker.start()
        theirs.close()
        patience = wall + 60.0
        while number < len(cases):
            case = cases[number]
            number += 1
            try:
                if not ours.poll(patience):
                    yield case, f"takes longer than {wall:g} s"
                    break
                problem = ours.recv()
            except EOFError:
                worker.join()
                yield case, f"the process ended with code {worker.exitcode}"
                break
            patience = wall
            if problem is not None:
                yield case, problem
        worker.kill()
        worker.join()


def _work(pipe: Connection, first: int) -> None:
    for case in all_cases_wanted()[first:]:
        with tempfile.TemporaryDirectory(prefix="bad-inputs-") as folder:
            pipe.send(problem_of(case, Path(folder)))


def all_cases_wanted() -> list[Case]:
    """Return the bad inputs that the command line asks for."""
    wanted = _arguments().only
    return [case for case in all_cases() if wanted is None or wanted in (case.room, case.name)]


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--only", metavar="NAME", help="a kind, or the name of one")
    parser.add_argument("--wall", type=float, default=20.0, help="seconds that each may take [%(default)s]")
    return parser.parse_args()


def main() -> int:
    """Try them and tell of those that fail."""
    cases = all_cases_wanted()
    failed = 0
    for case, problem in problems(cases, _arguments().wall):
        failed += 1
        print(f"{case.room}: {case.name}: {problem}", flush=True)
    tried = Counter(case.room for case in cases)
    print(", ".join(f"{count} {room}" for room, count in tried.items()))
    print(f"{len(cases)} bad inputs, {failed} not refused as they must be")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
