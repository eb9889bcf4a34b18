"""Target processor of machine code: one for a whole family, for identical code and results.

Numba compiles for the present processor. Code for the third level of x86-64 (AVX2 and FMA, in use since 2013)
runs on every processor that has it, with the same results to the last bit, and takes as long: kernels are
scalar. So it can be installed with the package. ``NUMBA_CPU_NAME`` takes precedence.
"""

from __future__ import annotations

import platform
from functools import cache
from pathlib import Path

BASELINE = "x86-64-v3"

# Names of features in Linux.
_NEEDED = set("avx avx2 bmi1 bmi2 cx16 f16c fma abm movbe popcnt sse4_2 xsave".split())
_FEATURES = Path("/proc/cpuinfo")


@cache
def baseline_runs() -> bool:
    """Return whether this processor runs what is made for the baseline; of Linux only."""
    if platform.machine() != "x86_64" or not _FEATURES.exists():
        return False
    lines = _FEATURES.read_text(encoding="ascii", errors="replace").splitlines()
    return _NEEDED <= set(next((line for line in lines if line.startswith("flags")), "").split())


def aim_at_baseline() -> None:
    """Have Numba compile for the baseline if available and no processor is named.

    Where a script has had Numba compile something of its own before, that continues for the processor at
    hand. Numba rereads its settings when a variable ``NUMBA_*`` changes, which resets this one.
    """
    import numba

    numba.core.config.reload_config()
    if baseline_runs() and getattr(numba.config, "CPU_NAME", "") is None:
        numba.config.CPU_NAME, numba.config.CPU_FEATURES = BASELINE, ""
