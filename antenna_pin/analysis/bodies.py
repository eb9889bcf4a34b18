"""Poses and velocities of links, and loads of joints."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import AXES, RunLike, data_of, entries_in, floats, variable
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.files import path_of_text
from antenna_pin.errors import FileFormatError
from antenna_pin.mechanism import (
    Mechanism,
    Urdf,
    build_mechanism,
    link_poses,
    link_twists,
    transmitted_wrenches,
)
from antenna_pin.trajectory import series
from antenna_pin.trajectory.quantities import dataset_of

_UPRIGHT = (0.0, 0.0, 0.0, 1.0)  # quaternion of a placement that is a point


@dataclass(frozen=True, slots=True, eq=False)
class ConnectionLoad:
    """Load of a closure, spring or force, which connects two links beside the tree."""

    name: str
    first: str  # link, or the world
    second: str
    point: Array  # on the second link, in the world, (n, 3) [m]
    force: Array  # on the second link, world axes, (n, 3) [N]
    moment: Array  # about the point, (n, 3) [N m]


# By attribute of a result: dimension of its entries; force, and moment if there is one, of each; keys of the
# links, without the first of what acts from the world, and of the place on the second link.
_CONNECTIONS: dict[str, tuple[str, tuple[str, ...], tuple[str, ...], str]] = {
    "closures": (
        "closure",
        ("closure_force", "closure_moment"),
        ("first_body", "second_body"),
        "second_placement",
    ),
    "point_springs": ("point_spring", ("spring_force",), ("first_body", "second_body"), "second_point"),
    "force_places": ("force_place", ("applied_force", "applied_torque"), ("link",), "point"),
}


def connection_loads(data: xr.Dataset, mechanism: Mechanism, attribute: str) -> list[ConnectionLoad]:
    """Return the loads of closures, point springs or forces on links, in world axes.

    A closure that holds a joint of the tree is left out: it is that joint's own load.
    """
    dim, variables, keys, place = _CONNECTIONS[attribute]
    entries = entries_in(data, attribute)
    entries = {name: one for name, one in entries.items() if name not in mechanism.joints or dim != "closure"}
    if not entries:
        return []
    frame_of = _frames(data, mechanism)
    found = []
    for name, one in entries.items():
        first, second = ("world", *(one[key] for key in keys))[-2:]
        point, _ = frame_of(second, np.array([*one[place], *_UPRIGHT][:7]))
        parts = [floats(data[key].sel({dim: name})) for key in variables]
        if dim == "closure":  # in the axes of its first side
            _, axes = frame_of(first, np.array(one["first_placement"]))
            parts = [axes.apply(part) for part in parts]
        force, moment = (*parts, np.zeros_like(parts[0]))[:2]
        found.append(ConnectionLoad(name, first, second, point, force, moment))
    return found


def applied_wrenches(mechanism: Mechanism, loads: list[ConnectionLoad]) -> Iterator[tuple[str, Array]]:
    """Yield links with force and moment about the world's origin, (n, 6)."""
    links = {link.name for link in mechanism.urdf.robot.links}
    for one in loads:
        wrench = np.hstack([one.force, one.moment + np.cross(one.point, one.force)])
        for link, sign in ((one.first, -1.0), (one.second, 1.0)):
            if link in links:
                yield link, sign * wrench


def _frames(data: xr.Dataset, mechanism: Mechanism) -> Callable[[str, Array], tuple[Array, Rotation]]:
    """Return a function for origin and attitude of a frame on a link."""
    links = [link.name for link in mechanism.urdf.robot.links]
    positions, attitudes = link_poses(mechanism, floats(data["q"]))

    def frame_of(link: str, local: Array) -> tuple[Array, Rotation]:
        if link not in links:  # the world
            n = len(positions)
            return np.tile(local[:3], (n, 1)), Rotation.from_quat(np.tile(local[3:], (n, 1)))
        k = links.index(link)
        axes = Rotation.from_quat(attitudes[:, k])
        return positions[:, k] + axes.apply(local[:3]), axes * Rotation.from_quat(local[3:])

    return frame_of


@takes()
def mechanism_of(run: RunLike) -> Mechanism:
    """Return the mechanism that a run simulated: from the URDF that it carries.

    Raises:
        FileFormatError: It carries none.
    """
    data = data_of(run)
    if "urdf" not in data.attrs:
        raise FileFormatError(
            "run: must contain its mechanism to locate bodies, got data without the attribute urdf"
        )
    about = json.loads(data.attrs["mechanism"])
    urdf = Urdf.from_text(
        data.attrs["urdf"],
        str(data.attrs.get("title") or "run"),
        allow_impossible_inertia=about["allow_impossible_inertia"],
        folder=path_of_text(data.attrs["urdf_folder"]) if data.attrs["urdf_folder"] else None,
        package_path=about.get("package_path", ()),
    )
    return build_mechanism(urdf, about["base"], about["gravity"], regular=False)


def _selected(run: RunLike, times: ArrayLike | None) -> xr.Dataset:
    data = series(data_of(run), "poses and loads of bodies")
    return data if times is None else data.isel(time=np.asarray(times, dtype=int))


def _array(data: xr.Dataset, name: str) -> Array:
    return floats(variable(data, name, "run"))


@takes()
def body_poses(
    run: RunLike, times: ArrayLike | None = None, bodies: Sequence[str] | None = None
) -> xr.Dataset:
    """Return the poses of link frames in the world.

    They are at indices ``times`` of samples, and of links ``bodies``; all by default.

    Returns:
        ``position`` (time, body, axis) [m] and ``attitude`` (time, body, quaternion), xyzw.
    """
    data, mechanism, names = _inputs(run, times, bodies)
    position, attitude = link_poses(mechanism, _array(data, "q"), names)
    coords = {"time": data["time"], "body": names, "axis": list(AXES), "quaternion": [*AXES, "w"]}
    return dataset_of("poses", {"position": position, "attitude": attitude}, coords)


def _inputs(
    run: RunLike, times: ArrayLike | None, bodies: Sequence[str] | None
) -> tuple[xr.Dataset, Mechanism, list[str]]:
    """Return the selected samples, the mechanism and the names of the links."""
    mechanism = mechanism_of(run)
    every = [link.name for link in mechanism.urdf.robot.links]
    return _selected(run, times), mechanism, every if bodies is None else list(bodies)


@takes()
def body_twists(
    run: RunLike, times: ArrayLike | None = None, bodies: Sequence[str] | None = None
) -> xr.Dataset:
    """Return the velocities of link frames relative to the world, in link axes.

    They are at indices ``times`` of samples, and of links ``bodies``; all by default.

    Returns:
        ``velocity`` [m/s] and ``angular_velocity`` [rad/s], (time, body, axis).
    """
    data, mechanism, names = _inputs(run, times, bodies)
    twists = link_twists(mechanism, _array(data, "q"), _array(data, "v"), names)
    columns = {"velocity": twists[..., :3], "angular_velocity": twists[..., 3:]}
    return dataset_of("twists", columns, {"time": data["time"], "body": names, "axis": list(AXES)})


@takes()
def joint_loads(run: RunLike, times: ArrayLike | None = None) -> xr.Dataset:
    """Return the loads of moving joints, by inverse dynamics of the recorded motion.

    It holds for ideal joints and joints with play alike, in closed loops and beside springs between points
    too: constraint or contact forces and motor torques. Behind the joints of the tree stand the closures of
    loops, with what they pass from their first link to the second. Where a loop has redundant equations, what
    its joints share is that of the result's ``closure_force`` and ``closure_moment``, which are the least.

    They are at indices ``times`` of samples; all by default.

    Returns:
        ``force`` [N] and ``torque`` [N m], (time, moving_joint, axis), world axes; the torque about the joint
        frame's origin on the child, of a closure about its second side's point.
    """
    data = _selected(run, times)
    mechanism = mechanism_of(run)
    closures, springs, forces = (connection_loads(data, mechanism, attribute) for attribute in _CONNECTIONS)
    applied = applied_wrenches(mechanism, closures + springs + forces)
    q, v, a = (_array(data, name) for name in "qva")
    of_closures = [np.hstack([one.force, one.moment])[:, None] for one in closures]
    wrenches = np.concatenate([transmitted_wrenches(mechanism, q, v, a, applied), *of_closures], axis=1)
    names = [*mechanism.joints, *(one.name for one in closures)]
    columns = {"force": wrenches[..., :3], "torque": wrenches[..., 3:]}
    coords = {"time": data["time"], "moving_joint": names, "axis": list(AXES)}
    return dataset_of("transmitted loads", columns, coords)
