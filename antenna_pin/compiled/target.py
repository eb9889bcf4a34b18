"""Target processor of machine code: one for a whole family, for identical code and results.

Numba makes code for the processor at hand. What is made for the third level of x86-64 (AVX2 and FMA, in use
since 2013) runs on every processor that has it, with the same results to the last bit, and takes as long:
kernels are scalar. So it can be installed with the package. ``NUMBA_CPU_NAME`` has its own way.
"""

from __future__ import annotations

from functools import cache

import numba
from llvmlite import binding

__all__ = ["BASELINE", "aim_at_baseline", "baseline_runs"]

BASELINE = "x86-64-v3"

_NEEDED = ("avx", "avx2", "bmi", "bmi2", "cx16", "f16c", "fma", "lzcnt", "movbe", "popcnt", "sse4.2", "xsave")


@cache
def baseline_runs() -> bool:
    """Return whether this processor runs what is made for the baseline."""
    try:
        features = binding.get_host_cpu_features()
    except RuntimeError:  # LLVM knows none of this processor
        return False
    return binding.get_process_triple().startswith("x86_64") and all(features.get(one) for one in _NEEDED)


def aim_at_baseline() -> None:
    """Have Numba make code for the baseline where it runs, unless a processor is named.

    Where a script has had Numba compile something of its own before, that continues for the processor at
    hand.
    """
    if baseline_runs() and getattr(numba.config, "CPU_NAME", "") is None:
        numba.config.CPU_NAME, numba.config.CPU_FEATURES = BASELINE, ""
