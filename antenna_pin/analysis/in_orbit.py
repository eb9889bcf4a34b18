"""How a link stands in the axes that turn with an orbit."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import RunLike, data_of, sample_times
from antenna_pin.analysis.bodies import body_poses
from antenna_pin.analysis.orbit import Orbit
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError

__all__ = ["orbit_angles", "orbit_of"]


@takes()
def orbit_angles(run: RunLike, body: str | None = None, orbit: Orbit | None = None) -> xr.Dataset:
    r"""Return pitch, roll and yaw of a link from the orbit-fixed axes over time.

    These axes are those of :class:`Orbit`: z to the centre, y against the orbit's normal, x along the
    velocity. Turned by pitch about y, then by roll about the new x, then by yaw about the new z they are the
    link's own:

    .. math:: R_{OB} = R_y(\text{pitch})\, R_x(\text{roll})\, R_z(\text{yaw})

    Pitch, first, counts whole turns, as yaw does; roll stays within a quarter of a turn.

    Args:
        run: A run, or its data.
        body: The link; the base if not given.
        orbit: The orbit; that of the run's gravity gradient if not given.

    Returns:
        ``pitch``, ``roll`` and ``yaw``, (time,) [rad].

    Raises:
        InvalidParameterError: No orbit is given, and the run has none.
    """
    data = data_of(run)
    time = sample_times(data, "orbit_angles")
    found = orbit if orbit is not None else orbit_of(data)
    if found is None:
        rule = "given, for no gravity gradient in the run tells it"
        raise InvalidParameterError("orbit_angles", "orbit", rule, said="none")
    poses = body_poses(data, bodies=None if body is None else [body])
    attitude = Rotation.from_quat(poses["attitude"].isel(body=0).values)
    angles = (found.axes(time).inv() * attitude).as_euler("YXZ")
    pitch, roll, yaw = np.unwrap(angles[:, 0]), angles[:, 1], np.unwrap(angles[:, 2])
    columns = {"pitch": pitch, "roll": roll, "yaw": yaw}
    said = "of the link from orbit-fixed axes"
    return xr.Dataset(
        {
            name: (("time",), values, {"units": "rad", "long_name": f"{name} {said}"})
            for name, values in columns.items()
        },
        coords={"time": data["time"]},
    )


def orbit_of(data: xr.Dataset) -> Orbit | None:
    """Return the orbit of a run's gravity gradient; None if it has none."""
    for one in json.loads(data.attrs.get("forces", "{}")).values():
        if one["kind"] == "GravityGradient":
            told = one["numbers"]
            normal, nadir = (tuple(told[f"{name}_{axis}"] for axis in "xyz") for name in ("normal", "nadir"))
            return Orbit(rate=told["rate"], normal=normal, nadir=nadir)
    return None
