"""Motion of a free-floating base in world axes."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._motion import motion_dataset
from antenna_pin.analysis._run import RunLike, data_of, label_of, variable
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError

__all__ = ["base_motion"]

_RATES = ("vx", "vy", "vz", "wx", "wy", "wz")


@takes()
def base_motion(run: RunLike) -> xr.Dataset:
    r"""Return position, attitude, velocities and accelerations of the base, all in world axes.

    A run records its base's velocity and acceleration as the generalized ones, along axes that turn with it.
    Here they are those of the base's origin as seen from the world: :math:`R v` and
    :math:`R (a + \omega \times v)`.

    Args:
        run: A run with a free base, or its data.

    Returns:
        Over time and axis: ``position`` [m], ``rotation`` since the first sample as a rotation vector [rad]
        (unwrapped beyond pi), ``velocity`` [m/s], ``angular_velocity`` [rad/s], ``acceleration`` [m/s^2],
        ``angular_acceleration`` [rad/s^2]; and ``attitude`` (time, quaternion), xyzw.
    """
    data = data_of(run)
    if "base_position" not in data:
        raise InvalidParameterError("base_motion", "run", "one with a free base", label_of(data))
    attitude = np.asarray(variable(data, "base_attitude", "base_motion").values, dtype=float)
    turn = Rotation.from_quat(attitude)
    v, a = (
        np.asarray(
            variable(data, name, "base_motion").sel(coordinate=[f"base.{part}" for part in _RATES]).values,
            dtype=float,
        )
        for name in ("v", "a")
    )
    linear = a[:, :3] + np.cross(v[:, 3:], v[:, :3])
    return motion_dataset(
        data,
        "base",
        attitude,
        position=np.asarray(data["base_position"].values, dtype=float),
        velocity=turn.apply(v[:, :3]),
        angular_velocity=turn.apply(v[:, 3:]),
        acceleration=turn.apply(linear),
        angular_acceleration=turn.apply(a[:, 3:]),
    )
