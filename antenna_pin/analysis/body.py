"""Motion of any body of a run, in world axes, and how far it is from that of the ideal run."""

from __future__ import annotations

import numpy as np
import xarray as xr

from antenna_pin.analysis._motion import motion_dataset, motion_deviation
from antenna_pin.analysis._run import RunLike, data_of, label_of, sample_times, variable
from antenna_pin.analysis.bodies import mechanism_of
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import link_motion, quaternions

__all__ = ["body_deviation", "body_motion", "moved_body"]


@takes()
def moved_body(run: RunLike, joint: str) -> str:
    """Return the name of the body that a joint moves.

    Args:
        run: A run, or its data.
        joint: Name of a moving joint.
    """
    mechanism = mechanism_of(run)
    return mechanism.bodies[mechanism.joint(joint).joint_id - 1]


@takes()
def body_motion(run: RunLike, body: str) -> xr.Dataset:
    """Return position, attitude, velocities and accelerations of a link's frame, all in world axes.

    Args:
        run: A run, or its data.
        body: Name of the link.

    Returns:
        Over time and axis: ``position`` [m], ``rotation`` since the first sample as a rotation vector [rad]
        (unwrapped beyond pi), ``velocity`` [m/s], ``angular_velocity`` [rad/s], ``acceleration`` of the
        origin [m/s^2], ``angular_acceleration`` [rad/s^2]; and ``attitude`` (time, quaternion), xyzw.
    """
    data = data_of(run)
    q, v, a = (np.asarray(variable(data, name, "body_motion").values, dtype=float) for name in "qva")
    attitudes, motion = link_motion(mechanism_of(data), body, q, v, a)
    position, velocity, angular_velocity, acceleration, angular_acceleration = np.moveaxis(motion, 1, 0)
    return motion_dataset(
        data,
        body,
        quaternions(attitudes),
        position=position,
        velocity=velocity,
        angular_velocity=angular_velocity,
        acceleration=acceleration,
        angular_acceleration=angular_acceleration,
    )


@takes()
def body_deviation(run: RunLike, ideal: RunLike, body: str) -> xr.Dataset:
    """Return how far a body is from where it would be in the ideal run, at the run's own samples.

    The ideal run is smooth and is interpolated, by derivatives where there are any; the run is not.

    Args:
        run: The run to judge.
        ideal: A run of the same mechanism without any contact.
        body: Name of the link.

    Returns:
        Over time and axis, in world axes: ``position`` [m], ``attitude`` (rotation vector from the ideal to
        the run's attitude) [rad], ``velocity`` [m/s], ``angular_velocity`` [rad/s], ``acceleration`` [m/s^2],
        ``angular_acceleration`` [rad/s^2], while both runs last.

    Raises:
        InvalidParameterError: The ideal run has contacts, or the runs share less than two samples' time.
    """
    data, reference = data_of(run), data_of(ideal)
    if reference.sizes.get("contact", 0):
        rule = "a run without contacts (a case whose joints are all ideal)"
        raise InvalidParameterError("body_deviation", "ideal", rule, label_of(reference))
    time, own = sample_times(data, "body_deviation"), sample_times(reference, "body_deviation")
    common = (time >= own[0]) & (time <= own[-1])
    if own.size < 2 or np.count_nonzero(common) < 2:
        rule = "of two samples or more while the ideal lasts"
        raise InvalidParameterError("body_deviation", "run", rule, label_of(data))
    motion = body_motion(data.isel(time=common), body)
    apart = motion_deviation(motion, body_motion(reference, body), body)
    coords = {name: motion.coords[name] for name in ("time", "axis") if name in motion.coords}
    about = {"case": str(data.attrs.get("case", "")), "ideal": str(reference.attrs.get("case", ""))}
    return xr.Dataset(apart, coords=coords, attrs=about)
