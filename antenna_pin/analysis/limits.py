"""Joint positions of a run beyond the limits of its URDF."""

from __future__ import annotations

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, blocks, data_of, floats
from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.scenario import joint_limits
from antenna_pin.trajectory import elements_of, is_lean, names_along

# Dimension; variable over time, and at the end; unit.
_KINDS = (
    ("joint", "motion_angle", "final_angle", "rad"),
    ("sliding_joint", "slide_position", "final_position", "m"),
)


@takes()
def said_of_limits(run: RunLike) -> tuple[str, ...]:
    """Return a line for each joint beyond a ``<limit>`` of the URDF.

    By how much at most, and since when, are those of samples. A joint with play has no limits, for it is free
    in the URDF that is simulated; one with an end stop is held by that. A lean result has joint positions at
    the end only, so a limit passed during the run is not reported, nor any in a result without a URDF.
    """
    data = data_of(run)
    urdf = str(data.attrs.get("urdf", ""))
    stated = joint_limits(urdf, continuous=True)
    limits = joint_limits(urdf) | stated
    stopped = {one["joint"] for place, one in elements_of(data).items() if place.startswith("stops.")}
    limits = {name: pair for name, pair in limits.items() if name not in stopped}
    lean = is_lean(data)
    lines = []
    for dim, over_time, final, unit in _KINDS:
        for name in names_along(data, dim) if limits else ():
            if name not in limits:
                continue
            lower, upper = limits[name]
            found = _beyond(data, final if lean else over_time, {dim: name}, lower, upper)
            if found is None:
                continue
            since, passed, most = found
            side = upper if passed > upper else lower
            why = "it is continuous, which has none" if name in stated else "limits are not simulated"
            if lean:
                lines.append(
                    f"joint {name!r} ends beyond its limit of {number(side, 4)} {unit}, by "
                    f"{number(most, 3)} {unit}: {why}"
                )
            else:
                lines.append(
                    f"joint {name!r} passes its limit of {number(side, 4)} {unit} at "
                    f"{number(since, 4)} s, by up to "
                    f"{number(most, 3)} {unit}: {why}"
                )
    return tuple(lines)


def _beyond(
    data: xr.Dataset, variable: str, place: dict[str, str], lower: float, upper: float
) -> tuple[float, float, float] | None:
    """Return time [s] and position of first passing a limit, and the largest excess.

    Of a lean result the time means nothing.
    """
    lean = is_lean(data)
    first: tuple[float, float] | None = None
    most = -np.inf
    span = upper - lower if np.isfinite(upper - lower) else 1.0
    for part in [data] if lean else blocks(data):
        values = np.atleast_1d(floats(part[variable].sel(place)))
        beyond = np.maximum(values - upper, lower - values)
        most = max(most, float(beyond.max()))
        # What stands at its limit may be over it by round-off.
        passed = np.flatnonzero(beyond > 1e-9 * max(span, 1e-3))
        if first is None and passed.size:
            since = 0.0 if lean else float(part["time"].values[passed[0]])
            first = since, float(values[passed[0]])
    return None if first is None else (*first, most)
