"""The attitude of a link in the ideal run, at the samples of another, of long runs part by part."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import Array
from antenna_pin.analysis.attitude import interpolate_attitude, interpolation_error
from antenna_pin.analysis.bodies import body_poses, body_twists
from antenna_pin.analysis.piecewise import beside, blocks
from antenna_pin.errors import InvalidParameterError


def ideal_attitude(ideal: xr.Dataset, body: str, time: Array) -> Rotation:
    """Return a link's attitude in the ideal run at some times, (n,) [s]."""
    found = [
        interpolate_attitude(time[some], *_knots(data, body)).as_quat() for some, data in beside(ideal, time)
    ]
    return Rotation.from_quat(found[0] if len(found) == 1 else np.concatenate(found))


def ideal_doubt(ideal: xr.Dataset, body: str, time: Array) -> float:
    """Return an estimate of the largest error of :func:`ideal_attitude` [rad].

    Raises:
        InvalidParameterError: The ideal run does not cover the times.
    """
    knots = np.asarray(ideal["time"].values, dtype=float)
    slack = 1e-9 * (knots[-1] - knots[0])
    if time[0] < knots[0] - slack or time[-1] > knots[-1] + slack:
        raise InvalidParameterError(
            "pointing_error",
            "ideal",
            f"a run that covers the time of the other, {time[0]:g} s to {time[-1]:g} s",
            f"{knots[0]:g} s to {knots[-1]:g} s",
        )
    # Every other sample is compared with its neighbours: parts have two in common.
    parts = blocks(ideal, overlap=2)
    return float(np.max([interpolation_error(*_knots(part, body)) for part in parts]))


def _knots(data: xr.Dataset, body: str) -> tuple[Array, Rotation, Array]:
    """Return times of samples, a link's attitudes, and its angular velocities in its own axes [rad/s]."""
    poses = body_poses(data, bodies=[body]).sel(body=body)
    spin = body_twists(data, bodies=[body])["angular_velocity"].sel(body=body)
    attitude = Rotation.from_quat(poses["attitude"].values)
    return np.asarray(data["time"].values, dtype=float), attitude, np.asarray(spin.values, dtype=float)
