"""Where the bodies of a finished run were, and what its joints carried."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.base.arguments import takes
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
from antenna_pin.trajectory import Trajectory, series

__all__ = ["body_poses", "body_twists", "joint_loads", "mechanism_of"]


Array = NDArray[np.float64]


# --- what acts on links of a run beside the joints of the tree: closures, springs between points, forces ---


@dataclass(frozen=True, slots=True, eq=False)
class Passed:
    """What passes from one link to another beside the tree.

    Attributes:
        name: Of the closure or spring.
        first: A link, or the world.
        second: The other.
        point: Where it acts on the second, in the world, (n, 3) [m].
        force: On the second link, world axes, (n, 3) [N].
        moment: About that point, (n, 3) [N m].
    """

    name: str
    first: str
    second: str
    point: Array
    force: Array
    moment: Array


def passed_by_closures(data: xr.Dataset, mechanism: Mechanism) -> list[Passed]:
    """Return what the closures of loops pass; not those that hold a joint of the tree: it is its own load."""
    found = []
    closures = json.loads(data.attrs.get("closures", "{}"))
    closures = {name: one for name, one in closures.items() if name not in mechanism.joints}
    placed = _placing(data, mechanism) if closures else None
    for name, one in closures.items():
        assert placed is not None
        _, axes = placed(one["first_body"], np.array(one["first_placement"]))
        point, _ = placed(one["second_body"], np.array(one["second_placement"]))
        force, moment = (axes.apply(_values(data, f"closure_{what}", closure=name)) for what in _PARTS)
        found.append(Passed(name, one["first_body"], one["second_body"], point, force, moment))
    return found


def passed_by_springs(data: xr.Dataset, mechanism: Mechanism) -> list[Passed]:
    """Return what springs and dampers between points pass."""
    found = []
    springs = json.loads(data.attrs.get("point_springs", "{}"))
    placed = _placing(data, mechanism) if springs else None
    for name, one in springs.items():
        assert placed is not None
        point, _ = placed(one["second_body"], np.array([*one["second_point"], 0.0, 0.0, 0.0, 1.0]))
        force = _values(data, "spring_force", point_spring=name)
        found.append(Passed(name, one["first_body"], one["second_body"], point, force, np.zeros_like(force)))
    return found


def passed_by_forces(data: xr.Dataset, mechanism: Mechanism) -> list[Passed]:
    """Return what forces on links do, place by place, as passed on from the world."""
    found = []
    places = json.loads(data.attrs.get("force_places", "{}"))
    placed = _placing(data, mechanism) if places else None
    for name, one in places.items():
        assert placed is not None
        point, _ = placed(one["link"], np.array([*one["point"], 0.0, 0.0, 0.0, 1.0]))
        force, torque = (_values(data, f"applied_{what}", force_place=name) for what in ("force", "torque"))
        found.append(Passed(name, "world", one["link"], point, force, torque))
    return found


def applied_wrenches(mechanism: Mechanism, passed: list[Passed]) -> Iterator[tuple[str, Array]]:
    """Yield what that does to links, for :func:`antenna_pin.mechanism.transmitted_wrenches`.

    Links, each with force [N] and moment about the world's origin [N m], (n, 6), world axes.
    """
    links = {link.name for link in mechanism.urdf.robot.links}
    for one in passed:
        wrench = np.hstack([one.force, one.moment + np.cross(one.point, one.force)])
        for link, sign in ((one.first, -1.0), (one.second, 1.0)):
            if link in links:
                yield link, sign * wrench


_PARTS = ("force", "moment")


def _values(data: xr.Dataset, name: str, **at: Any) -> Array:
    return np.asarray(data[name].sel(at).values, dtype=float)


def _placing(data: xr.Dataset, mechanism: Mechanism) -> Callable[[str, Array], tuple[Array, Rotation]]:
    """Return what gives origin (n, 3) and attitude of a frame on a link at all samples."""
    links = [link.name for link in mechanism.urdf.robot.links]
    positions, attitudes = link_poses(mechanism, np.asarray(data["q"].values, dtype=float))

    def placed(link: str, local: Array) -> tuple[Array, Rotation]:
        if link not in links:  # the world
            n = len(positions)
            return np.tile(local[:3], (n, 1)), Rotation.from_quat(np.tile(local[3:], (n, 1)))
        k = links.index(link)
        axes = Rotation.from_quat(attitudes[:, k])
        return positions[:, k] + axes.apply(local[:3]), axes * Rotation.from_quat(local[3:])

    return placed


_AXES = ("x", "y", "z")


@takes()
def mechanism_of(run: Trajectory | xr.Dataset) -> Mechanism:
    """Return the mechanism that a run simulated: from the URDF that it carries.

    Raises:
        FileFormatError: It carries none.
    """
    data = run.data if isinstance(run, Trajectory) else run
    if "urdf" not in data.attrs:
        raise FileFormatError(
            "run: it must carry its mechanism to tell where bodies are, got data without the attribute urdf"
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


def _picked(run: Trajectory | xr.Dataset, times: ArrayLike | None) -> xr.Dataset:
    data = run.data if isinstance(run, Trajectory) else run
    series(data, "poses and loads of bodies")
    return data if times is None else data.isel(time=np.asarray(times, dtype=int))


def _array(data: xr.Dataset, name: str) -> NDArray[np.float64]:
    if name not in data:
        raise FileFormatError(f"run: no variable {name!r}; is it an antenna_pin result?")
    return np.asarray(data[name].values, dtype=float)


@takes()
def body_poses(
    run: Trajectory | xr.Dataset, times: ArrayLike | None = None, bodies: Sequence[str] | None = None
) -> xr.Dataset:
    """Return the pose of every link's frame in the world, or of those that are named.

    Args:
        run: A run, or its data.
        times: Indices of samples; all if not given.
        bodies: Names of links; all if not given.

    Returns:
        ``position`` (time, body, axis) [m] and ``attitude`` (time, body, quaternion), xyzw.
    """
    data, mechanism, names = _asked(run, times, bodies)
    position, attitude = link_poses(mechanism, _array(data, "q"), names)
    return xr.Dataset(
        {
            "position": (
                ("time", "body", "axis"),
                position,
                {"units": "m", "long_name": "link's frame in the world"},
            ),
            "attitude": (
                ("time", "body", "quaternion"),
                attitude,
                {"units": "1", "long_name": "link's frame in the world, quaternion"},
            ),
        },
        coords={
            "time": data["time"],
            "body": names,
            "axis": list(_AXES),
            "quaternion": ["x", "y", "z", "w"],
        },
    )


def _asked(
    run: Trajectory | xr.Dataset, times: ArrayLike | None, bodies: Sequence[str] | None
) -> tuple[xr.Dataset, Mechanism, list[str]]:
    """Return the samples that are asked for, the mechanism, and the links that are."""
    mechanism = mechanism_of(run)
    every = [link.name for link in mechanism.urdf.robot.links]
    return _picked(run, times), mechanism, every if bodies is None else list(bodies)


@takes()
def body_twists(
    run: Trajectory | xr.Dataset, times: ArrayLike | None = None, bodies: Sequence[str] | None = None
) -> xr.Dataset:
    """Return the velocity of every link's frame relative to the world, in the link's own axes.

    Args:
        run: A run, or its data.
        times: Indices of samples; all if not given.
        bodies: Names of links; all if not given.

    Returns:
        ``velocity`` [m/s] and ``angular_velocity`` [rad/s], (time, body, axis).
    """
    data, mechanism, names = _asked(run, times, bodies)
    twists = link_twists(mechanism, _array(data, "q"), _array(data, "v"), names)
    dims = ("time", "body", "axis")
    return xr.Dataset(
        {
            "velocity": (dims, twists[..., :3], {"units": "m/s", "long_name": "of the link's frame"}),
            "angular_velocity": (dims, twists[..., 3:], {"units": "rad/s", "long_name": "of the link"}),
        },
        coords={
            "time": data["time"],
            "body": names,
            "axis": list(_AXES),
        },
    )


@takes()
def joint_loads(run: Trajectory | xr.Dataset, times: ArrayLike | None = None) -> xr.Dataset:
    """Return what each moving joint passes from parent to child, by inverse dynamics of the recorded motion.

    It holds for ideal joints and joints with play alike, in closed loops and beside springs between points
    too: constraint or contact forces and motor torques. Behind the joints of the tree stand the closures of
    loops, with what they pass from their first link to the second. Where a loop has redundant equations, what
    its joints share is that of the result's ``closure_force`` and ``closure_moment``, which are the least.

    Args:
        run: A run, or its data.
        times: Indices of samples; all if not given.

    Returns:
        ``force`` [N] and ``torque`` [N m], (time, moving_joint, axis), world axes; the torque about the joint
        frame's origin on the child, of a closure about its second side's point.
    """
    data = _picked(run, times)
    mechanism = mechanism_of(run)
    closures = passed_by_closures(data, mechanism)
    others = passed_by_springs(data, mechanism) + passed_by_forces(data, mechanism)
    applied = applied_wrenches(mechanism, closures + others)
    q, v, a = (_array(data, name) for name in "qva")
    of_closures = [np.hstack([one.force, one.moment])[:, None] for one in closures]
    wrenches = np.concatenate([transmitted_wrenches(mechanism, q, v, a, applied), *of_closures], axis=1)
    dims = ("time", "moving_joint", "axis")
    return xr.Dataset(
        {
            "force": (dims, wrenches[..., :3], {"units": "N", "long_name": "force through the joint"}),
            "torque": (dims, wrenches[..., 3:], {"units": "N m", "long_name": "torque through the joint"}),
        },
        coords={
            "time": data["time"],
            "moving_joint": [*mechanism.joints, *(one.name for one in closures)],
            "axis": list(_AXES),
        },
    )
