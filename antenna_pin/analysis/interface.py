"""Disturbance at the interface: force and moment of a mechanism on its base."""

from __future__ import annotations

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import AXES, RunLike, data_of, floats, sample_times
from antenna_pin.analysis.bodies import applied_wrenches, connection_loads, joint_loads, mechanism_of
from antenna_pin.base.arguments import takes
from antenna_pin.mechanism import link_motion
from antenna_pin.trajectory.quantities import dataset_of


@takes()
def interface_loads(run: RunLike) -> xr.Dataset:
    """Return force and moment of a mechanism on its root link.

    They follow by inverse dynamics from the recorded motion: the sum over all joints that the root link
    carries, and over closures and springs between it and other links; its own inertia and weight take no
    part. On a fixed base they are what the interface has to hold, less that weight.

    Returns:
        ``force`` [N] and ``moment`` [N m] about the origin of the root link's frame, (time, axis), in its
        axes.
    """
    data = data_of(run)
    times = sample_times(data, "interface_loads")
    mechanism = mechanism_of(data)
    root = mechanism.urdf.root
    q, v, a = (floats(data[name]) for name in "qva")
    turned, motion = link_motion(mechanism, root, q, v, a)
    origin = motion[:, 0]
    loads = joint_loads(data)
    force, moment = np.zeros((len(times), 3)), np.zeros((len(times), 3))
    for joint in mechanism.urdf.robot.joints:
        if joint.parent != root or joint.name not in mechanism.joints:
            continue
        one = loads.sel(moving_joint=joint.name)
        _, of_child = link_motion(mechanism, joint.child, q, v, a)
        arm = of_child[:, 0] - origin
        passed = floats(one["force"])
        force -= passed
        moment -= floats(one["torque"]) + np.cross(arm, passed)
    beside = [
        load for kind in ("closures", "point_springs") for load in connection_loads(data, mechanism, kind)
    ]
    for link, wrench in applied_wrenches(mechanism, beside):
        if link == root:
            force += wrench[:, :3]
            moment += wrench[:, 3:] - np.cross(origin, wrench[:, :3])
    columns = {
        "force": np.einsum("nji,nj->ni", turned, force),
        "moment": np.einsum("nji,nj->ni", turned, moment),
    }
    return dataset_of("base loads", columns, {"time": times, "axis": list(AXES)}, {"base": root})
