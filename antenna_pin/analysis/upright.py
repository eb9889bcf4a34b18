"""Which way is up in a bearing: against gravity."""

from __future__ import annotations

import json

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import RunLike, choose, data_of
from antenna_pin.analysis.bodies import body_poses
from antenna_pin.analysis.journal import clearance_shapes
from antenna_pin.base.arguments import takes
from antenna_pin.base.directions import unit
from antenna_pin.errors import FileFormatError
from antenna_pin.trajectory import series

__all__ = ["STEADY", "bearing_up", "steady_up"]

#: The mean of unit vectors this long or longer: they keep within some 30 degrees of it [-].
STEADY = 0.87
_LOOKED_AT = 200  # samples


@takes()
def bearing_up(run: RunLike, joint: str, times: ArrayLike | None = None) -> NDArray[np.float64] | None:
    """Return the unit vectors against gravity in a bearing's axes, (n, 3) [-], or None without gravity.

    Args:
        run: A run with a clearance joint, or its data.
        joint: Name of the clearance joint.
        times: Indices of samples; all if left out.

    Raises:
        UnknownNameError: There is no such joint.
        FileFormatError: The run does not carry what its bodies were.
    """
    data = data_of(run)
    if "mechanism" not in data.attrs:
        raise FileFormatError("run: it must carry its gravity, got data without the attribute mechanism")
    gravity = np.asarray(json.loads(data.attrs["mechanism"])["gravity"], dtype=float)
    shapes = clearance_shapes(data)
    place = shapes[choose("bearing_up", "clearance joint", joint, list(shapes))[0]]
    if not gravity.any():
        return None
    turn = Rotation.from_quat(np.asarray(place["bearing_placement"], dtype=float)[3:])
    attitude = body_poses(data, times, [place["bearing_body"]])["attitude"][:, 0]
    body = Rotation.from_quat(np.asarray(attitude.values, dtype=float))
    return np.asarray((body * turn).apply(-unit(gravity), inverse=True))


@takes()
def steady_up(run: RunLike, joint: str) -> NDArray[np.float64] | None:
    """Return the mean direction against gravity in a bearing's axes, (3,) [-], for pictures of the bearing.

    Args:
        run: A run with a clearance joint, or its data.
        joint: Name of the clearance joint.

    Returns:
        A unit vector; None without gravity, where the bearing turns so far that no direction is up for long,
        or where the data do not carry their mechanism.
    """
    data = data_of(run)
    if not {"mechanism", "urdf"} <= data.attrs.keys() or "q" not in data:
        return None
    count = series(data, "up").sizes["time"]
    up = bearing_up(data, joint, np.unique(np.linspace(0, count - 1, min(_LOOKED_AT, count)).astype(int)))
    if up is None:
        return None
    mean = up.mean(axis=0)
    size = float(np.linalg.norm(mean))
    return mean / size if size >= STEADY else None
