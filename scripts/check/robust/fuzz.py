"""Inputs of every format with something changed: each must end with a result, or a refusal in one line.

Scenarios, studies, diagrams, URDF files, tables, result files, options of every command, calls in Python: of
each format a sound input is taken, and something in it changed that the package declares, so that a new
key, kind, option or function is tried as soon as it is there. An input follows from the seed, its format and
its number::

    scripts/check/robustness.py fuzz --count 20000                  # of all formats
    scripts/check/robustness.py fuzz --format urdf --count 500      # of one
    scripts/check/robustness.py fuzz --seed 1 --only scenario:137   # one again

What must hold:

- a command ends with exit code 0 or 3 and no word but notes, or with 2 and one plain line that says why; a
  call returns, or raises an error of the package's own with such a line;
- what breaks a declared rule is refused, and the line names the place;
- nothing is left behind by what was refused;
- no warning of NumPy, no traceback, no process that dies, and none that computes longer than ``--seconds``.

Of what fails the changes are tried one by one, and the least that fails too is printed with how to repeat it.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from random import Random

from fuzzing import FORMATS
from fuzzing.made import made

from robust.inputs import Draft, problem_apart
from robust.trials import Report, tried

SEED = 1
OPTIONS = {
    "--count": {"type": int, "default": 1000, "help": "of inputs [%(default)s]"},
    "--format": {"choices": FORMATS, "action": "append", "help": "all if left out"},
    "--only": {"metavar": "FORMAT:NUMBER", "action": "append", "help": "one again"},
    "--seconds": {"type": float, "default": 30.0, "help": "of CPU time that each may take [%(default)s]"},
    "--jobs": {"type": int, "default": 1, "help": "processes at a time [%(default)s]"},
}


def drawn(seed: int, name: str) -> Draft:
    """Return an input by ``FORMAT:NUMBER``."""
    kind, _, _ = name.partition(":")
    return FORMATS[kind](Random(f"{seed}/{name}"))


def inputs_of(formats: Sequence[str], count: int, first: int = 0) -> list[str]:
    """Return the names of so many inputs, of the formats in turn."""
    return [f"{formats[k % len(formats)]}:{k // len(formats)}" for k in range(first, first + count)]


def least_problem(draft: Draft) -> tuple[Draft, str] | None:
    """Return an input that fails, with as few of a draft's changes as do, and how; None if it does not."""
    problem = problem_apart(draft)
    if problem is None or len(draft.changes) < 2:
        return None if problem is None else (draft, problem)
    for change in draft.changes:
        single = replace(draft, changes=(change,))
        if (other := problem_apart(single)) is not None:
            return single, other
    return draft, problem


def _description(seed: int, name: str) -> str | None:
    problem = least_problem(drawn(seed, name))
    return problem and f"{problem[0].name}: {problem[1]}"


def run(given: argparse.Namespace, report: Report, folder: Path) -> None:
    """Try the inputs."""
    names = given.only or inputs_of(given.format or [*FORMATS], given.count)
    act = partial(_description, given.seed)
    for name, problem, fault, seconds in tried(act, names, given.seconds, given.jobs, setup=made):
        problem = f"{drawn(given.seed, name).name}: {fault}" if fault else problem
        report.add(name.partition(":")[0], f"--seed {given.seed} --only {name}", problem, seconds)
