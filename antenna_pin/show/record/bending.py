r"""Placements of bodies with bending links: elastic parts at a multiple of their deflection.

The deflection x of an elastic part moves its body by :math:`\exp(x S)` in the hub's frame, with the unit
twist S of its joint. Drawn is :math:`\exp(M x S)`. A shape that several parts move is moved by all of them,
:math:`\exp(M \sum_i x_i S_i)`, as the effective masses of one dish do.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import body_poses, elastic_parts_of, mechanism_of
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import Mechanism
from antenna_pin.trajectory import Trajectory

Array = NDArray[np.float64]

# What a magnification that is chosen for a picture makes of the largest deflection: an angle [rad], or a way
# over the size of the mechanism.
_ANGLE, _WAY = 0.1, 0.04


def check_bending(run: Trajectory, magnify: float | None) -> float:
    """Return the magnification of deflections, 1 if left out.

    Raises:
        InvalidParameterError: It is no positive number, or the run has no elastic parts.
    """
    if magnify is None:
        return 1.0
    if not elastic_parts_of(run):
        rule = "left out in the view of a mechanism without flexible links"
        raise InvalidParameterError("recording", "magnify", rule, magnify)
    if not 0.0 < magnify < 1e9:
        raise InvalidParameterError("recording", "magnify", "a positive number", magnify)
    return float(magnify)


@takes()
def bending_magnification(run: Trajectory) -> float | None:
    """Return a magnification that makes the bending of a run visible; None without elastic parts.

    1, 2 or 5 times a power of ten, at least 1, by the largest deflections of the run.
    """
    about = elastic_parts_of(run)
    if not about:
        return None
    places = np.asarray(body_poses(run, times=[0])["position"].values[0], dtype=float)
    size = float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0
    peaks = np.asarray(run.data["peak_deflection"].values, dtype=float)
    shares = [
        peak / (_WAY * size if one["slides"] else _ANGLE)
        for peak, one in zip(peaks, about.values(), strict=True)
    ]
    most = 1.0 / max(*shares, 1e-6, 0.0)
    power = 10.0 ** np.floor(np.log10(max(most, 1.0)))
    return float(
        max(step * power for step in (1.0, 2.0, 5.0) if step * power <= max(most, 1.0) * (1.0 + 1e-12))
    )


def bending_note(run: Trajectory, magnify: float) -> str:
    """Return a note on magnified deflections, or nothing."""
    if magnify == 1.0 or not elastic_parts_of(run):
        return ""
    return f"deflections of flexible links are drawn {magnify:g} times as large"


def drawn_poses(run: Trajectory, times: NDArray[np.int64], magnify: float) -> xr.Dataset:
    """Return the drawn poses of bodies, as of :func:`antenna_pin.analysis.body_poses`.

    Deflections are drawn ``magnify`` times as large [-].
    """
    about = elastic_parts_of(run)
    if not about:
        return body_poses(run, times=times)
    data = run.data.isel(time=np.asarray(times, dtype=int))
    mechanism = mechanism_of(run)
    q = np.array(data["q"].values, dtype=float)
    deflections = {name: magnify * q[:, mechanism.joint(name).q.start] for name in about}
    for name, deflection in deflections.items():
        q[:, mechanism.joint(name).q.start] = deflection
    poses = body_poses(data.assign(q=(data["q"].dims, q)))
    names = [str(body) for body in poses["body"].values]
    position, attitude = (np.array(poses[key].values, dtype=float) for key in ("position", "attitude"))
    for name, one in about.items():
        if "with" in one:
            hub, body = names.index(one["hub"]), names.index(one["body"])
            twist = sum(
                deflections[part][:, None] * _unit_twist(mechanism, part) for part in (name, *one["with"])
            )
            turned, moved = _exponential(np.asarray(twist))
            origin = mechanism.urdf.placement(name)[:3, 3]
            frame = Rotation.from_quat(attitude[:, hub])
            position[:, body] = position[:, hub] + frame.apply(moved + turned.apply(origin))
            attitude[:, body] = (frame * turned).as_quat()
    return poses.assign(
        position=(poses["position"].dims, position), attitude=(poses["attitude"].dims, attitude)
    )


def _unit_twist(mechanism: Mechanism, part: str) -> Array:
    """Return a part's twist for a unit rate, in the hub's frame, (6,)."""
    joint, axis = mechanism.urdf.joint(part), mechanism.urdf.axis(part)
    if joint.type == "prismatic":
        return np.concatenate([axis, np.zeros(3)])
    return np.concatenate([np.cross(mechanism.urdf.placement(part)[:3, 3], axis), axis])


def _exponential(twists: Array) -> tuple[Rotation, Array]:
    """Return rotations and shifts (n, 3) of constant twists (n, 6) in unit time."""
    linear, angular = twists[:, :3], twists[:, 3:]
    angle = np.linalg.norm(angular, axis=1)[:, None]
    small = angle < 1e-4  # where the series is exact to round-off
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    second = np.where(small, 1.0 / 6.0 - angle**2 / 120.0, (safe - np.sin(safe)) / safe**3)
    across = np.cross(angular, linear)
    shift = linear + first * across + second * np.cross(angular, across)
    return Rotation.from_rotvec(angular), shift
