"""How one frame moves in world axes, as a dataset; and how far two such motions are apart."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import Array
from antenna_pin.analysis.attitude import interpolate_attitude
from antenna_pin.analysis.sampled import resampled

# Each quantity with its derivative, which makes its interpolation better.
_DERIVATIVES = {
    "position": "velocity",
    "velocity": "acceleration",
    "acceleration": None,
    "angular_velocity": "angular_acceleration",
    "angular_acceleration": None,
}


def motion_dataset(
    data: xr.Dataset,
    whose: str,
    attitude: Array,
    position: Array,
    velocity: Array,
    angular_velocity: Array,
    acceleration: Array,
    angular_acceleration: Array,
) -> xr.Dataset:
    """Return the motion of a frame, all in world axes.

    Args:
        data: The run it is of.
        whose: Whose frame, for the long names: "base".
        attitude: Quaternions xyzw, (n, 4) [-].
        position: Of its origin [m], (n, 3) as all that follow.
        velocity: [m/s].
        angular_velocity: [rad/s].
        acceleration: Of its origin as seen from the world [m/s^2].
        angular_acceleration: [rad/s^2].

    Returns:
        Over time and axis: ``position`` [m], ``rotation`` since the first sample as a rotation vector [rad]
        (unwrapped beyond pi), ``velocity`` [m/s], ``angular_velocity`` [rad/s], ``acceleration`` [m/s^2],
        ``angular_acceleration`` [rad/s^2]; and ``attitude`` (time, quaternion), xyzw.
    """
    turn = Rotation.from_quat(attitude)
    since_start = _unwrapped((turn * turn[0].inv()).as_rotvec())
    columns = {
        "position": (position, "m", f"{whose}'s origin"),
        "rotation": (
            since_start,
            "rad",
            f"{whose}'s rotation since the start",
        ),
        "velocity": (velocity, "m/s", f"velocity of the {whose}'s origin"),
        "angular_velocity": (angular_velocity, "rad/s", f"{whose}'s angular velocity"),
        "acceleration": (acceleration, "m/s^2", f"acceleration of the {whose}'s origin"),
        "angular_acceleration": (angular_acceleration, "rad/s^2", f"{whose}'s angular acceleration"),
    }
    variables = {
        name: (("time", "axis"), values, {"units": units, "long_name": f"{meaning}, world axes"})
        for name, (values, units, meaning) in columns.items()
    }
    variables["attitude"] = (
        ("time", "quaternion"),
        attitude,
        {"units": "1", "long_name": f"{whose} in the world, quaternion"},
    )
    coords = {name: data.coords[name] for name in ("time", "axis", "quaternion") if name in data.coords}
    return xr.Dataset(variables, coords=coords, attrs={"case": data.attrs.get("case", "")})


def motion_deviation(run: xr.Dataset, ideal: xr.Dataset, whose: str) -> dict[str, xr.Variable]:
    """Return how far one motion is from another, at its own samples, in world axes.

    Args:
        run: The motion to judge, of :func:`motion_dataset`.
        ideal: The motion to judge it by; it is interpolated and must cover the run's time.
        whose: Whose they are, for the long names.

    Returns:
        ``position`` [m], ``attitude`` (rotation vector from the ideal to the run's) [rad], and the rates.
    """
    at, own = run["time"].values, ideal["time"].values
    found = {}
    for name, derivative in _DERIVATIVES.items():
        slope = None if derivative is None else ideal[derivative].values
        found[name] = xr.Variable(
            ("time", "axis"),
            np.asarray(run[name].values - resampled(own, ideal[name].values, at, slope)),
            {
                "units": str(run[name].attrs.get("units", "")),
                "long_name": f"deviation of the {whose}'s {name.replace('_', ' ')}, world axes",
            },
        )
    turn = Rotation.from_quat(ideal["attitude"].values)
    body_rate = turn.inv().apply(ideal["angular_velocity"].values)
    attitude = interpolate_attitude(at, own, turn, body_rate)
    turned = (Rotation.from_quat(run["attitude"].values) * attitude.inv()).as_rotvec()
    words = {"units": "rad", "long_name": "rotation from the ideal to the run's attitude, world axes"}
    return {
        "position": found.pop("position"),
        "attitude": xr.Variable(("time", "axis"), np.asarray(turned), words),
        **found,
    }


def _unwrapped(vectors: Array) -> Array:
    """Return rotation vectors that go on beyond pi instead of jumping to the other side."""
    result = vectors.copy()
    if np.linalg.norm(vectors, axis=1).max(initial=0.0) < 3.0:
        return result
    for i in range(1, len(result)):
        angle = np.linalg.norm(result[i])
        if angle == 0.0:
            continue
        axis = result[i] / angle
        turns = np.round((axis @ result[i - 1] - angle) / (2.0 * np.pi))
        result[i] += 2.0 * np.pi * turns * axis
    return result
