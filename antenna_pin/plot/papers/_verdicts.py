"""Whether runs show what a paper says that its figures show."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from antenna_pin.analysis import deviation, load_statistics
from antenna_pin.errors import AntennaPinError
from antenna_pin.plot.papers._figure import Cases

__all__ = ["higher_axial_peaks", "rising_accelerations", "rising_deviations"]

# By how much one number has to exceed another to be seen in a figure.
_SEEN = 1.05


def rising_deviations(runs: Cases, of: str, cases: Sequence[str]) -> bool:
    """Return whether the largest deviation from the first run grows from each case to the next."""
    ideal = next(iter(runs.values()))
    try:
        return _rises([deviation(runs[case], ideal)[of].maximum for case in cases])
    except AntennaPinError:
        return False


def rising_accelerations(runs: Cases, joint: str, cases: Sequence[str]) -> bool:
    """Return whether the largest acceleration of a joint grows from each case to the next."""
    found = (runs[case]["motion_acceleration"].sel(joint=joint).values for case in cases)
    return _rises([float(np.nanmax(np.abs(values))) for values in found])


def higher_axial_peaks(runs: Cases, case: str, than: str) -> bool:
    """Return whether the largest force along the axis is higher in one case than in another."""
    peaks = []
    for name in (than, case):
        loads = load_statistics(runs[name])
        axial = [one for one in loads["contact"].values if ".axial" in str(one)]
        peaks.append(float(loads["peak_force"].sel(contact=axial).max()) if axial else 0.0)
    return _rises(peaks)


def _rises(values: Sequence[float]) -> bool:
    return all(after > _SEEN * before for before, after in pairwise(values))
