"""How a slider touches its guide: at points, along lines, with a surface."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis._run import RunLike, choose, data_of, variable
from antenna_pin.analysis.journal import clearance_shapes, journal_motion
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import contact_ends, contacts_of

__all__ = ["slider_scenarios"]

_NAMES = ("none", "one_point", "two_points", "line", "surface")
_NONE, _ONE, _TWO, _LINE, _SURFACE = range(5)
_KINDS = ("prismatic", "cylindrical")


@takes()
def slider_scenarios(run: RunLike, joint: str | None = None) -> xr.Dataset:
    """Return how a slider presses on each wall of its guide over time, and for how long.

    Of a rectangular one, of each of four walls: one corner (or mouth's edge) is a point, two at one end or
    along one edge a line, three or four a surface. Of a round one, whose one wall is ``bore``: one end is a
    point, both ends are a line if the middle between them presses as well, else two points.

    Args:
        run: A run with a slider in a guide, or its data.
        joint: Name of that joint; the first one if left out.

    Returns:
        ``scenario`` (time, wall), numbers with their names in ``flag_meanings``, and ``share`` (wall, kind)
        [-] of the time; between two samples that differ each takes half.

    Raises:
        InvalidParameterError: The run has no such joint.
    """
    data = data_of(run)
    known = [name for name, shape in clearance_shapes(data).items() if shape["kind"] in _KINDS]
    if not known:
        raise InvalidParameterError("slider_scenarios", "run", "one with a slider in a guide", "none")
    joint = choose("slider_scenarios", "slider", joint or known[0], known)[0]
    shape = clearance_shapes(data)[joint]
    names = contacts_of(data, joint)
    gaps = np.asarray(variable(data, "gap", "slider_scenarios").sel(contact=names).values, dtype=float)
    ends = [contact_ends(data)[name] for name in names]
    if shape["kind"] == "cylindrical":
        walls, found = ["bore"], _round(data, joint, shape["dimensions"], gaps)[:, None]
    else:
        walls = ["+x", "-x", "+y", "-y"]
        found = np.stack([_flat(gaps, ends, wall) for wall in walls], axis=1)
    time = np.asarray(data["time"].values, dtype=float)
    weights = np.zeros(time.size)
    weights[:-1] += 0.5 * np.diff(time)
    weights[1:] += 0.5 * np.diff(time)
    weights = weights / weights.sum() if weights.sum() > 0.0 else np.full(time.size, 1.0 / time.size)
    share = np.stack([[weights[column == k].sum() for k in range(len(_NAMES))] for column in found.T])
    return xr.Dataset(
        {
            "scenario": (
                ("time", "wall"),
                found.astype(np.int8),
                {
                    "units": "1",
                    "long_name": "contact scenario at a wall of the guide",
                    "flag_values": np.arange(len(_NAMES), dtype=np.int8),
                    "flag_meanings": " ".join(_NAMES),
                },
            ),
            "share": (("wall", "kind"), share, {"units": "1", "long_name": "share of the time"}),
        },
        coords={"time": data["time"], "wall": walls, "kind": list(_NAMES)},
        attrs={"joint": joint},
    )


def _flat(gaps: NDArray[np.float64], ends: list[str], wall: str) -> NDArray[np.int_]:
    """Return the scenario at a flat wall: of its four corners two on a diagonal are two points."""
    own = [k for k, end in enumerate(ends) if end.startswith(wall)]
    signs = np.array([[1 if ends[k][n] == "+" else -1 for n in (2, 4)] for k in own])
    pressed = gaps[:, own] < 0.0
    count = pressed.sum(axis=1)
    found = np.select([count == 0, count == 1, count == 2], [_NONE, _ONE, _LINE], _SURFACE)
    opposite = np.all(pressed @ signs == 0, axis=1)  # of two: both of their signs differ
    return np.where((count == 2) & opposite, _TWO, found)


def _round(
    data: xr.Dataset, joint: str, size: dict[str, float], gaps: NDArray[np.float64]
) -> NDArray[np.int_]:
    """Return the scenario in a round guide, from its two ends and the middle between them."""
    pressed = gaps[:, :2] < 0.0
    offset = journal_motion(data, joint)["offset"].values
    middle = np.linalg.norm(offset.mean(axis=1)[:, :2], axis=1)
    both = np.where(middle > size["bearing_radius"] - size["journal_radius"], _LINE, _TWO)
    return np.select([pressed.all(axis=1), pressed.any(axis=1)], [both, _ONE], _NONE)
