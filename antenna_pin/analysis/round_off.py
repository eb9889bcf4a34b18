"""Numbers of a run that are zero to round-off, by the run's own scales.

Sums of large numbers that cancel leave some 1e-16 of them, and a run carries that on: forces of piconewtons
across a plane that nothing leaves, accelerations of picoradians per second squared. A number is zero to
round-off below :data:`ROUND_OFF` of the largest that the run has in its unit, those of other units counted
by way of the mechanism's length and of one radian: a force at the length's end is a moment, a rate there a
velocity. What a run stores is not touched by this.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from xml.etree import ElementTree

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, blocks, data_of
from antenna_pin.base.arguments import takes
from antenna_pin.trajectory import is_lean
from antenna_pin.trajectory.columns import ROUND_OFF

ROUND_OFF_WORDS = f"≈ 0: zero to round-off, less than {ROUND_OFF:g} of the run's largest in its unit"

# Each unit and that of the same quantity about an axis, which the length of the mechanism is between.
_PAIRS = (("m", "rad"), ("m/s", "rad/s"), ("m/s^2", "rad/s^2"), ("N m", "N"), ("N m s", "N s"))
# Variables that hold what went wrong, or mixed units.
_NO_SCALE = {"q", "v", "a", "energy_error"}


@takes()
def round_off_scales(*runs: RunLike) -> dict[str, float]:
    """Return the largest size in each unit over several runs."""
    found: dict[str, float] = {}
    for run in runs:
        for unit, size in _of_one(data_of(run)).items():
            found[unit] = max(found.get(unit, 0.0), size)
    return found


@takes()
def is_round_off(size: float | None, unit: str, scales: Mapping[str, float]) -> bool:
    """Return whether a number is zero to round-off, but not exactly.

    Scales are those of :func:`round_off_scales`.
    """
    if size is None or not math.isfinite(size) or size == 0.0:
        return False
    return abs(size) < ROUND_OFF * scales.get(_plain(unit), 0.0)


def _plain(unit: str) -> str:
    """Return a unit in one spelling: ``rad/s**2`` and rad/s² as ``rad/s^2``."""
    return unit.replace("**", "^").replace("*", " ").replace("²", "^2").replace("\N{NO-BREAK SPACE}", " ")


def _of_one(data: xr.Dataset) -> dict[str, float]:
    length = _length(data)
    found = {"rad": 1.0, "m": length}
    names = [str(name) for name in data.data_vars if name not in _NO_SCALE]
    names = [name for name in names if data[name].dtype.kind == "f" and "units" in data[name].attrs]
    series = set() if is_lean(data) else {name for name in names if "time" in data[name].dims}
    for part in blocks(data) if series else ():
        for name in series:
            _raise(found, data[name].attrs["units"], part[name].values)
    for name in set(names) - series:
        if "time" not in data[name].dims:
            _raise(found, data[name].attrs["units"], data[name].values)
    for linear, angular in _PAIRS:
        for one, other, lever in ((linear, angular, length), (angular, linear, 1.0 / length)):
            if linear[0] == "N" and one == angular:
                continue  # what a moment makes of a force hangs on levers that may be far shorter
            if other in found:
                found[one] = max(found.get(one, 0.0), lever * found[other])
    return found


def _raise(scales: dict[str, float], units: str, values: np.ndarray) -> None:
    sizes = np.abs(values[np.isfinite(values)])
    scales[_plain(units)] = max(scales.get(_plain(units), 0.0), float(sizes.max(initial=0.0)))


def _length(data: xr.Dataset) -> float:
    """Return the length of a mechanism along its tree [m]."""
    try:
        robot = ElementTree.fromstring(str(data.attrs.get("urdf", "<robot/>")))
    except ElementTree.ParseError:
        return 1.0
    offsets = [origin.get("xyz", "0 0 0") for origin in robot.iterfind("./joint/origin")]
    offsets += [origin.get("xyz", "0 0 0") for origin in robot.iterfind("./link/inertial/origin")]
    return math.fsum(math.hypot(*map(float, text.split())) for text in offsets) or 1.0
