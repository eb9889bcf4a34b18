r"""Error indices of ECSS-E-ST-60-10C (2008), Space engineering: Control performance.

Of an error e(t) with the mean :math:`\bar e(s) = \frac1\Delta \int_s^{s+\Delta} e\,dt` over a window of
length :math:`\Delta` at s:

.. math::
    \mathrm{APE} = e(t), \quad \mathrm{MPE} = \bar e(s), \quad
    \mathrm{RPE} = e(t) - \bar e(s),\; s \le t \le s + \Delta, \quad
    \mathrm{PDE} = \bar e(s + D) - \bar e(s), \quad \mathrm{PRE} = \bar e(s_2) - \bar e(s_1)

for the PDE with both windows in one observation period, for the PRE in two different ones. Windows slide over
all places, and t over all times in the window.

An error may be a number or a vector, such as the two components that turn a boresight. Of a vector the means
and differences are vectors; its index is the *length* of the vector that results: the half-cone RPE is the
length of the error vector's departure from its mean, not the departure of the half-cone angle from its own.

Between samples an error is straight. The largest magnitude is exact for that polygon. The level at a
confidence is the least that the magnitude does not exceed with that probability; of what, the statistical
interpretation says:

- temporal: of the time, in the worst run;
- ensemble: of the runs, at the worst time;
- mixed: of time and runs together.

"Time" is, for each index, its places: t for the APE, s for the MPE and PDE, both of them in the RPE, and
both windows' places, independently, for the PRE; all are equally likely.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.analysis._indices import (
    Absolute,
    Drift,
    Index,
    Period,
    Polygon,
    Relative,
    Reproducibility,
    WindowMean,
    extremes,
)
from antenna_pin.analysis._run import floats
from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.rules import AtLeastOne, NumberRule
from antenna_pin.errors import InvalidParameterError

#: The indices and what they are, in one line each.
DEFINITIONS = {
    "APE": "absolute error: the instantaneous error",
    "MPE": "mean error: its mean over a window",
    "RPE": "relative error: the instantaneous error less its mean over a window that contains that time",
    "PDE": "drift error: difference of the means over two windows a given time apart, in one observation "
    "period",
    "PRE": "reproducibility error: difference of the means over two windows in different observation periods",
}

#: Statistical interpretations of a level, and what each counts.
INTERPRETATIONS = {
    "temporal": "share of the time, in the worst run",
    "ensemble": "share of the runs, at the worst time",
    "mixed": "share of time and runs together",
}

_PLACE = "pointing_indices"


@takes()
def error_components(errors: xr.Dataset) -> dict[str, Array]:
    """Return a pointing error as components for :func:`pointing_indices`.

    Args:
        errors: What :func:`antenna_pin.analysis.pointing_error` found.

    Returns:
        ``boresight`` (clocking; absent where no ``up`` is commanded), ``cross`` and ``up``, (n,), and
        ``half-cone``, (n, 2): the smallest rotation between the boresights, whose length is their angle.
    """
    found = {
        str(axis): floats(errors["error"].sel(pointing_axis=axis)) for axis in errors["pointing_axis"].values
    }
    return found | {"half-cone": floats(errors["boresight_error"])}


@takes(window="s", drift_spacing="s")
def pointing_indices(
    time: ArrayLike | Sequence[ArrayLike],
    error: ArrayLike | Mapping[str, ArrayLike] | Sequence[ArrayLike] | Sequence[Mapping[str, ArrayLike]],
    *,
    window: float | None = None,
    drift_spacing: float | None = None,
    periods: float | Sequence[Period] | None = None,
    confidence: Annotated[float, NumberRule("above 0 and at most 1")] = 0.997,
    resolution: AtLeastOne = 1000,
) -> xr.Dataset:
    """Return the error indices of a signal from one run or several.

    Args:
        time: Sample times, not decreasing, (n,) [s]; two samples at one time make a jump. A list of such
            arrays for several runs.
        error: The error, (n,), or components by name, each a number (n,) or a vector (n, 2); a list of
            these for several runs. Their unit is that of the result.
        window: Length of the windows [s]; without it there is the APE only.
        drift_spacing: Time from the start of one window to that of the other [s]; without it no PDE.
        periods: Observation periods: their common length, if they follow one another from the start (what
            remains at the end belongs to none) [s], or start and end of each [s]; without them no PRE, and
            the whole run is the PDE's one period. APE, MPE and RPE are of the whole run.
        confidence: Of the levels, above 0 and at most 1 [-].
        resolution: Number N of places of a window, and of times in it, that levels of the RPE are taken
            from; of the PRE, 1000 N pairs of places; of the others, 100 N places.

    Returns:
        ``extreme`` (index, component): largest magnitude, over all runs; ``lowest`` and ``highest``, NaN for
        vectors; ``level`` (interpretation, index, component); ``definition`` (index). Attributes tell
        windows, confidence and the number of runs.

    Raises:
        InvalidParameterError: Samples that are none, or windows that do not fit into a run.
    """
    runs = _signals(time, error)
    names = list(runs[0])
    plan = _Plan(window, drift_spacing, periods)
    per_run = [{name: plan.indices(signal) for name, signal in run.items()} for run in runs]
    kinds = list(per_run[0][names[0]])
    shape = (len(kinds), len(names))
    lowest, highest, level = np.full(shape, np.nan), np.full(shape, np.nan), np.zeros((3, *shape))
    extreme = np.zeros(shape)
    for i, kind in enumerate(kinds):
        for j, name in enumerate(names):
            indices = [found[name][kind] for found in per_run]
            ends = np.array([extremes(one, runs[0][name].values.shape[1]) for one in indices])
            worst = np.abs(ends).max(axis=1)
            extreme[i, j] = worst.max()
            if runs[0][name].values.shape[1] == 1:
                lowest[i, j], highest[i, j] = ends[:, 0].min(), ends[:, 1].max()
            sizes = [np.linalg.norm(one.samples(resolution), axis=1) for one in indices]
            level[:, i, j] = (
                max(_level([size], confidence) for size in sizes),
                _level([worst], confidence),
                _level(sizes, confidence),
            )
    dims = ("index", "component")
    return xr.Dataset(
        {
            "extreme": (dims, extreme, {"long_name": "largest magnitude"}),
            "lowest": (dims, lowest, {"long_name": "lowest value"}),
            "highest": (dims, highest, {"long_name": "highest value"}),
            "level": (("interpretation", *dims), level, {"long_name": "level at the confidence"}),
            "definition": (("index",), [DEFINITIONS[kind] for kind in kinds]),
        },
        coords={"index": kinds, "component": names, "interpretation": list(INTERPRETATIONS)},
        attrs={"confidence": confidence, "runs": len(runs), "resolution": resolution} | plan.attributes(),
    )


@dataclass(frozen=True, slots=True)
class _Plan:
    """Windows, and the indices of a signal with them."""

    window: float | None
    spacing: float | None
    periods: float | Sequence[Period] | None

    def __post_init__(self) -> None:
        for name, value in (
            ("window", self.window),
            ("drift_spacing", self.spacing),
            ("periods", self.periods if not isinstance(self.periods, Sequence) else None),
        ):
            check_number(_PLACE, name, value, "positive", "s")
        if self.window is None and not (self.spacing is None and self.periods is None):
            raise InvalidParameterError(
                _PLACE, "window", "given with drift_spacing or periods, which separate windows"
            )

    def attributes(self) -> dict[str, Any]:
        """Return the given windows as attributes."""
        periods: Any = self.periods
        if isinstance(periods, Sequence):
            periods = np.ravel(np.array(periods, dtype=float)).tolist()
        found = {"window": self.window, "drift_spacing": self.spacing, "periods": periods}
        return {name: value for name, value in found.items() if value is not None}

    def indices(self, signal: Polygon) -> dict[str, Index]:
        """Return the indices of a signal.

        Raises:
            InvalidParameterError: Windows that do not fit into it.
        """
        found: dict[str, Index] = {"APE": Absolute(signal)}
        if self.window is None:
            return found
        length = signal.end - signal.start
        self._check_fit("window", self.window, length, "the run")
        last = max(signal.start, signal.end - self.window)
        found["MPE"] = WindowMean(signal, self.window, signal.start, last)
        found["RPE"] = Relative(signal, self.window)
        periods = self._periods_of(signal)
        if self.spacing is not None:
            for low, high in periods or [(signal.start, signal.end)]:
                where = "an observation period" if periods else "the run"
                fit = self.window + self.spacing
                self._check_fit("window + drift_spacing", fit, high - low, where)
            found["PDE"] = Drift(signal, self.window, self.spacing, periods or [(signal.start, signal.end)])
        if periods:
            for low, high in periods:
                self._check_fit("window", self.window, high - low, "an observation period")
            found["PRE"] = Reproducibility(signal, self.window, periods)
        return found

    def _check_fit(self, name: str, value: float, length: float, where: str) -> None:
        if value > length * (1.0 + 1e-9):
            raise InvalidParameterError(_PLACE, name, f"at most {where}'s {length:g} s", value)

    def _periods_of(self, signal: Polygon) -> list[Period]:
        if self.periods is None:
            return []
        if isinstance(self.periods, Sequence):
            periods = sorted((float(low), float(high)) for low, high in self.periods)
            slack = 1e-9 * (signal.end - signal.start)
            for low, high in periods:
                if not signal.start - slack <= low < high <= signal.end + slack:
                    rule = f"start and end within the run, {signal.start:g} s to {signal.end:g} s"
                    raise InvalidParameterError(_PLACE, "periods", rule, (low, high))
            for one, other in zip(periods, periods[1:], strict=False):
                if other[0] < one[1] - slack:
                    raise InvalidParameterError(_PLACE, "periods", "apart from one another", (one, other))
        else:
            length = signal.end - signal.start
            count = int(math.floor(length / self.periods * (1.0 + 1e-9)))
            periods = [
                (signal.start + k * self.periods, min(signal.end, signal.start + (k + 1) * self.periods))
                for k in range(count)
            ]
        if len(periods) < 2:
            raise InvalidParameterError(
                _PLACE,
                "periods",
                f"such that two of them fit into the run's {signal.end - signal.start:g} s",
                self.periods,
            )
        return periods


def _level(sizes: Sequence[Array], confidence: float) -> float:
    """Return the level of a share of all values; each set has equal weight."""
    if all(size.size == sizes[0].size for size in sizes):
        pooled = np.concatenate(sizes)
        rank = max(1, math.ceil(confidence * pooled.size * (1.0 - 1e-12)))
        return float(np.partition(pooled, rank - 1)[rank - 1])
    pooled = np.concatenate(sizes)
    weight = np.concatenate([np.full(size.size, 1.0 / (size.size * len(sizes))) for size in sizes])
    order = np.argsort(pooled)
    rank = int(np.searchsorted(np.cumsum(weight[order]), confidence * (1.0 - 1e-12)))
    return float(pooled[order[min(rank, pooled.size - 1)]])


def _signals(time: Any, error: Any) -> list[dict[str, Polygon]]:
    """Return the components of each run as polygons."""
    several = isinstance(time, (list, tuple)) and len(time) > 0 and np.ndim(time[0]) == 1
    if several and not isinstance(error, (list, tuple)):
        raise InvalidParameterError(_PLACE, "error", f"a list, one for each of {len(time)} runs", error)
    times, errors = (list(time), list(error)) if several else ([time], [error])
    if len(times) != len(errors):
        raise InvalidParameterError(_PLACE, "error", f"one for each of {len(times)} runs", len(errors))
    runs = []
    for own, found in zip(times, errors, strict=True):
        t = np.asarray(own, dtype=float)
        if t.ndim != 1 or t.size == 0 or not np.isfinite(t).all() or np.any(np.diff(t) < 0.0):
            raise InvalidParameterError(_PLACE, "time", "finite and not decreasing, one sample at least", t)
        components = found if isinstance(found, Mapping) else {"error": found}
        runs.append({str(name): _polygon(str(name), t, values) for name, values in components.items()})
    for run in runs[1:]:
        if list(run) != list(runs[0]):
            raise InvalidParameterError(_PLACE, "error", f"of components {list(runs[0])}", list(run))
    return runs


def _polygon(name: str, time: Array, values: ArrayLike) -> Polygon:
    x = np.asarray(values, dtype=float)
    if x.ndim == 1:
        x = x[:, None]
    if x.ndim != 2 or x.shape[0] != time.size or x.shape[1] not in (1, 2):
        rule = f"({time.size},) or ({time.size}, 2)"
        raise InvalidParameterError(_PLACE, name, f"of shape {rule}", np.shape(values))
    if not np.isfinite(x).all():
        raise InvalidParameterError(_PLACE, name, "finite", float(x[~np.isfinite(x)][0]))
    return Polygon(time, x)
