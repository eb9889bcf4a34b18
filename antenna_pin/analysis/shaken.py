"""Shaken base: its link, motions, force and moment."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import AXES, RunLike, data_of, floats, label_of, sample_times
from antenna_pin.analysis.bodies import joint_loads, mechanism_of
from antenna_pin.analysis.closures import drives_of
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.mechanism import WORLD, link_motion
from antenna_pin.trajectory.quantities import dataset_of


@takes()
def shakes_of(run: RunLike) -> dict[str, dict[str, Any]]:
    """Return the motions of a shaken base by name: ``joint``, ``slides`` and ``shakes``.

    Args:
        run: A run, or its data; there are none where no base is shaken.
    """
    return {name: one for name, one in drives_of(run).items() if "shakes" in one}


@takes()
def shaken_link(run: RunLike) -> str:
    """Return the name of the link that is a run's shaken base.

    Raises:
        InvalidParameterError: It has none.
    """
    data = data_of(run)
    joints = {str(one["joint"]) for one in shakes_of(data).values()}
    if not joints:
        raise InvalidParameterError("base", "run", "one with a shaken base ([shake.NAME])", label_of(data))
    mounts = joints | {f"{name}_mount" for name in joints}
    below = {one.parent: one.child for one in mechanism_of(data).urdf.robot.joints if one.name in mounts}
    link = WORLD
    while link in below:
        link = below[link]
    return link


@takes()
def way_of(run: RunLike, shake: str | None = None) -> tuple[str, Array]:
    """Return the name of a translation of the base, and its direction, (3,).

    Args:
        run: A run, or its data.
        shake: Name of the motion; the first one along a direction if left out.

    Raises:
        UnknownNameError: There is no such motion along a direction.
    """
    data = data_of(run)
    shaken_link(data)
    known = {name: one["shakes"] for name, one in shakes_of(data).items() if one["slides"]}
    if shake is None and known:
        shake = next(iter(known))
    if shake is None or shake not in known:
        raise UnknownNameError("base", "motion along a direction", str(shake), known)
    along = np.asarray(known[shake]["along"], dtype=float)
    return shake, np.asarray(along / np.linalg.norm(along))


@takes()
def base_wrench(data: xr.Dataset) -> Array:
    """Return force and moment on the base at its frame, (n, 6), own axes."""
    link, mechanism = shaken_link(data), mechanism_of(data)
    joints = [str(one["joint"]) for one in shakes_of(data).values()]
    # The one that carries the base itself comes last in the tree.
    last = max(joints, key=lambda name: mechanism.joint(name).joint_id)
    loads = joint_loads(data).sel(moving_joint=last)
    force, moment = (floats(loads[name]) for name in ("force", "torque"))
    q, v, a = (floats(data[name]) for name in "qva")
    turned, motion = link_motion(mechanism, link, q, v, a)
    # The load is about the joint's frame on its child, which a mount leads on from.
    _, about = link_motion(mechanism, mechanism.urdf.joint(last).child, q, v, a)
    moment = moment - np.cross(motion[:, 0] - about[:, 0], force)
    return np.hstack([np.einsum("nji,nj->ni", turned, one) for one in (force, moment)])


@takes()
def base_loads(run: RunLike) -> xr.Dataset:
    """Return force and moment on the base of a run, as a fixture measures.

    They are what the base link with all that it carries needs to move as it does, its own mass included,
    and its weight.

    Returns:
        ``force`` [N] and ``moment`` [N m] about the origin of the base link's frame, (time, axis), in its
        axes.
    """
    data = data_of(run)
    wrench = base_wrench(data)
    columns = {"force": wrench[:, :3], "moment": wrench[:, 3:]}
    coords = {"time": sample_times(data, "base_loads"), "axis": list(AXES)}
    return dataset_of("base loads", columns, coords, {"base": shaken_link(data)})


# --- links that respond -------------------------------------------------------------------------------------


@takes()
def base_quantity(run: RunLike, shake: str | None = None) -> str:
    """Return the name of the base's acceleration along the axis of its motion.

    Args:
        run: A run whose base is shaken, or its data.
        shake: Name of the motion; the first one along a direction if left out.
    """
    data = data_of(run)
    return f"body_acceleration[{shaken_link(data)}].{_axis(data, shake)}"


@takes()
def shaken_target(run: RunLike, shake: str | None = None) -> str:
    """Return the name of the acceleration of the last link, along that axis.

    Args:
        run: A run whose base is shaken, or its data.
        shake: Name of the motion; the first one along a direction if left out.
    """
    data = data_of(run)
    shaken_link(data)
    last = mechanism_of(data).urdf.robot.links[-1].name
    return f"body_acceleration[{last}].{_axis(data, shake)}"


def _axis(data: RunLike, shake: str | None) -> str:
    """Return the world's axis nearest to a motion's direction; z where all turn."""
    if shake is None and not any(one["slides"] for one in shakes_of(data).values()):
        return "z"
    _, way = way_of(data, shake)
    return AXES[int(np.argmax(np.abs(way)))]
