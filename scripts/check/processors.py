#!/usr/bin/env python3
"""Run the numeric tests as other processors would: a result that hangs on one is no result.

    scripts/test processors                        every setting below, the folders below
    scripts/test processors nehalem haswell        some settings
    scripts/test processors haswell -- tests/nonlinear -x      the rest goes to pytest

A setting takes away what this processor can do: OpenBLAS and NumPy take other code at run time, Numba
compiles for a processor without anything (once, for some minutes; it keeps machine code of each apart). All
have one thread. It says which setting failed which test; what fails under one setting is not to be answered
by a wider tolerance before it is known why.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from pathlib import Path

from numpy._core import _multiarray_umath as numpy_core

ROOT = Path(__file__).resolve().parents[2]

#: Of tests: those whose numbers come of linear algebra, of compiled kernels and of long runs.
FOLDERS = ("nonlinear", "linear", "constraints", "integrate", "analysis")


def _without_numpys() -> str:
    """Return what NumPy is to do without: all that it has another version for, and this processor has."""
    has = numpy_core.__cpu_features__
    return " ".join(name for name in numpy_core.__cpu_dispatch__ if has.get(name))


#: By name, what a setting sets. OpenBLAS takes the name of a processor's generation.
SETTINGS = {
    "as-it-is": {},
    "nehalem": {"OPENBLAS_CORETYPE": "Nehalem"},  # no AVX, no fused multiplication
    "haswell": {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": _without_numpys()},
    "zen": {"OPENBLAS_CORETYPE": "Zen"},
    "skylakex": {"OPENBLAS_CORETYPE": "SkylakeX"},  # AVX-512
    "generic": {
        "OPENBLAS_CORETYPE": "Prescott",
        "NPY_DISABLE_CPU_FEATURES": _without_numpys(),
        "NUMBA_CPU_NAME": "generic",
        "NUMBA_CPU_FEATURES": "",
    },
}
_NEEDS = {"skylakex": "AVX512_SKX", "zen": "AVX2", "haswell": "AVX2"}


def failed_tests(name: str, arguments: list[str]) -> list[str]:
    """Return the tests that fail under a setting, or how pytest ended if it ran none."""
    more = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", **SETTINGS[name]}
    shown = " ".join(f"{key}={value!r}" for key, value in SETTINGS[name].items())
    print(f"== {name}: {shown or 'nothing set'}", flush=True)
    began = time.perf_counter()
    command = [sys.executable, "-m", "pytest", "-q", "-rfE", "-p", "no:cacheprovider", *arguments]
    run = subprocess.run(command, cwd=ROOT, env=os.environ | more, capture_output=True, text=True)
    found = re.findall(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.MULTILINE)
    last = (run.stdout.strip() or run.stderr.strip() or "nothing said").splitlines()[-1]
    print(f"   {last} ({time.perf_counter() - began:.0f} s)", flush=True)
    if found:
        print(run.stdout, flush=True)
    return found or ([] if run.returncode == 0 else [f"pytest ended with {run.returncode}: {last}"])


def main(arguments: list[str]) -> int:
    """Run the settings that are named, or all that this processor can imitate; return the exit code."""
    names, rest = arguments, []
    if "--" in arguments:
        at = arguments.index("--")
        names, rest = arguments[:at], arguments[at + 1 :]
    unknown = [name for name in names if name not in SETTINGS]
    if unknown:
        print(f"processors: {', '.join(unknown)} must be of {', '.join(SETTINGS)}", file=sys.stderr)
        return 2
    has = numpy_core.__cpu_features__
    failed: dict[str, list[str]] = {}
    for name in names or list(SETTINGS):
        if name in _NEEDS and not has.get(_NEEDS[name]):
            print(f"== {name}: left out, as this processor has no {_NEEDS[name]}")
            continue
        failed[name] = failed_tests(name, rest or [f"tests/{folder}" for folder in FOLDERS])
    print("== settings and what failed under them")
    for name, tests in failed.items():
        print(f"{name:10s} {len(tests) or 'none'}", *(f"\n    {test}" for test in tests))
    return int(any(failed.values()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
