#!/usr/bin/env python3
"""Robustness of every command and of the calls in Python: inputs, faults and signals that may befall them.

    scripts/check/robustness.py fuzz --help      # of one check: what must hold, and its options

Each check prints a line for what fails, with what repeats it, and counts at the end. Told to stop (Ctrl-C) it
sums up what it has. Exit code 1 on any failure.
"""

from __future__ import annotations

import argparse
import importlib
import signal
import sys
import tempfile
from pathlib import Path

from robust.trials import Report

CHECKS = {
    "fuzz": "inputs of every format with something changed that the package declares",
    "bad-inputs": "hundreds of bad inputs, with what must be said of each",
    "odd-urdfs": "random URDFs as exporters write them, as hands, or with a slip",
    "faults": "random faults of every command that works or writes",
    "interruptions": "runs with checkpoints and studies that are killed, starved and damaged",
    "signals": "signals at random times of the life of every long command",
}


def main() -> int:
    """Run a check and return its exit code."""
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    checks = parser.add_subparsers(metavar="CHECK", required=True)
    for name, summary in CHECKS.items():
        if name in sys.argv[1:2]:  # the others are not imported
            check = importlib.import_module(f"robust.{name.replace('-', '_')}")
            options = checks.add_parser(name, help=summary, description=check.__doc__, formatter_class=plain)
            if check.SEED is not None:
                options.add_argument("--seed", type=int, default=check.SEED, help="of draws [%(default)s]")
            for option, how in check.OPTIONS.items():
                options.add_argument(option, **how)
        else:
            checks.add_parser(name, help=summary)
    given = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGTERM):  # shells have background jobs ignore the first
        signal.signal(number, signal.default_int_handler)
    report, code = Report(), None
    with tempfile.TemporaryDirectory(prefix="robust-") as folder:
        try:
            code = check.run(given, report, Path(folder))
        except KeyboardInterrupt:
            print("interrupted")
    return report.close() if code is None else code


if __name__ == "__main__":
    sys.exit(main())
