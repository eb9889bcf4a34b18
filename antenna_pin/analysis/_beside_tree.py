"""What acts on links of a run beside the joints of the tree: closures, springs between points, forces."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.mechanism import Mechanism, link_poses

__all__ = ["Passed", "applied_wrenches", "passed_by_closures", "passed_by_forces", "passed_by_springs"]

Array = NDArray[np.float64]


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
