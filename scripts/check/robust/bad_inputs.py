"""Bad inputs, hundreds of them: each must be refused in one line, with exit code 2 and no traceback.

URDF files, scenario files, quantities, options of commands, result files, and calls in Python. Each is tried
in an empty folder by the command, or by the call, in a process of its own that others follow in::

    scripts/check/robustness.py bad-inputs                       # all
    scripts/check/robustness.py bad-inputs --only urdf           # of one kind
    scripts/check/robustness.py bad-inputs --only "two masses"   # by its name

One that computes for more than ``--seconds`` has failed, like one that says too much.
"""

from __future__ import annotations

import argparse
import functools
from pathlib import Path

from bad_inputs import options, python, results, toml, urdf
from bad_inputs.case import Case

from robust.inputs import problem_apart
from robust.trials import Report, tried

SEED = None  # nothing is drawn
OPTIONS = {
    "--only": {"metavar": "NAME", "help": "a kind, or the name of one"},
    "--seconds": {"type": float, "default": 20.0, "help": "of CPU time that each may take [%(default)s]"},
}


@functools.cache
def all_cases() -> tuple[Case, ...]:
    """Return every bad input."""
    return tuple(case for kind in (urdf, toml, options, results, python) for case in kind.cases())


def _problem_of(number: int) -> str | None:
    return problem_apart(all_cases()[number].draft)


def run(given: argparse.Namespace, report: Report, folder: Path) -> None:
    """Try the inputs."""
    cases = all_cases()
    numbers = [k for k, case in enumerate(cases) if given.only in (None, case.room, case.name)]
    for number, problem, fault, seconds in tried(_problem_of, numbers, given.seconds):
        case = cases[number]
        report.add(case.room, f"{case.room}: {case.name}", fault or problem, seconds)
