r"""Motion of the journal in its bearing, and the load around the bore.

At a place on the bearing's axis the journal's axis pierces the bearing's cross section in the point

.. math:: \mathbf{e} = \mathbf{p} + \frac{s - p_z}{z_z} \mathbf{z}, \qquad s = \pm L_i / 2,

with the journal's centre p and axis z in bearing axes: the eccentricity there. The circle of radius
:math:`C_r = R_i - R_j` is what rigid parts leave it. The gap at that end of the bore is C_r less the
eccentricity except for terms of :math:`R_i \theta^2 / 2` in the tilt (0.3 um of 200 at the largest tilt of
the antenna's joint).
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import AXES, RunLike, blocks, choose, data_of, floats, label_of, variable
from antenna_pin.analysis.bodies import body_poses
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.directions import unit
from antenna_pin.base.rules import AtLeastOne
from antenna_pin.errors import FileFormatError, InvalidParameterError
from antenna_pin.joints.geometry import LOOKS
from antenna_pin.trajectory import contact_ends, contacts_of, names_along, series
from antenna_pin.trajectory.quantities import dataset_of


@takes()
def clearance_shapes(run: RunLike) -> dict[str, dict[str, Any]]:
    """Return kind, dimensions and placements of every clearance joint of a run.

    Returns:
        By joint: ``kind`` (revolute, planar, spherical or prismatic), ``dimensions`` [m], ``bearing_body``,
        ``journal_body``, and ``bearing_placement`` and ``journal_placement``, position [m] and quaternion
        (xyzw) in that link's frame. Empty if no joint has clearance.
    """
    data = data_of(run)
    if not names_along(data, "clearance_joint"):
        return {}
    if "clearance_joints" not in data.attrs:
        raise FileFormatError(
            "run: must contain its joints' dimensions, got data without the attribute clearance_joints"
        )
    return dict(json.loads(data.attrs["clearance_joints"]))


@takes()
def journal_motion(run: RunLike, joint: str | None = None) -> xr.Dataset:
    """Return the motion of journal (or ball) in bearing (or socket), bearing axes.

    The joint is the first one with play by default.

    Returns:
        Over time: ``offset`` (time, place, axis) [m], where the journal's axis pierces the cross section at
        each end of the bore ("+" and "-"); of a planar or spherical joint at its "centre", of a ball the
        offset of its centre; of a slider its axis at its own ends. ``eccentricity`` (time, place) [m] and
        ``eccentricity_ratio`` [-], over the radial clearance, of a slider the greater of those over the
        plays to either side; ``tilt`` [rad], ``twist`` [rad], from -pi to pi about the bearing's axis, and
        ``axial`` (time), the journal's centre along the axis [m].
        Attributes: ``joint``, ``kind``, ``spatial`` (whether offsets along the axis count),
        ``radial_clearance`` [m], the ``outline`` (n, 2) [m] of what rigid parts leave the offset across the
        axis, with its ``outline_name``, and how far they let a centred journal go, NaN if there is no limit:
        ``axial_limit`` [m], ``tilt_limit`` and ``twist_limit`` [rad].

    Raises:
        UnknownNameError: There is no such joint, or its kind is not known here.
    """
    data = data_of(run)
    joint = _joint(data, joint, "journal_motion")
    kind, size = _kind(data, joint, "journal_motion")
    p, attitude = (
        floats(variable(data, name, "journal_motion").sel(clearance_joint=joint))
        for name in ("journal_position", "journal_attitude")
    )
    tilt = np.asarray(variable(data, "journal_tilt", "journal_motion").sel(clearance_joint=joint).values)
    seen = LOOKS[kind].across(size, p, Rotation.from_quat(attitude).apply([0.0, 0.0, 1.0]))
    twist = 2.0 * np.arctan2(attitude[:, 2], attitude[:, 3])
    twist -= 2.0 * np.pi * np.round(twist / (2.0 * np.pi))
    columns = {"offset": seen.offset, "eccentricity": seen.eccentricity, "eccentricity_ratio": seen.ratio}
    columns |= {"tilt": tilt, "twist": twist, "axial": p[:, 2]}
    return dataset_of(
        "journal motion",
        columns,
        {"time": data["time"], "place": list(seen.places), "axis": list(AXES)},
        {
            "joint": joint,
            "kind": kind,
            "spatial": LOOKS[kind].spatial,
            "radial_clearance": seen.clearance,
            "outline": seen.outline,
            "outline_name": LOOKS[kind].outline,
            "axial_limit": seen.axial,
            "tilt_limit": seen.tilt,
            "twist_limit": seen.twist,
        },
    )


def _joint(data: xr.Dataset, joint: str | None, place: str) -> str:
    """Return a clearance joint by name, or the first one."""
    known = names_along(data, "clearance_joint")
    if not known:
        raise InvalidParameterError(place, "run", "one with a clearance joint", label_of(data))
    return choose(place, "clearance joint", joint or known[0], known)[0]


def _kind(data: xr.Dataset, joint: str, place: str) -> tuple[str, dict[str, float]]:
    """Return kind and dimensions of a joint."""
    shape = clearance_shapes(data)[joint]
    return choose(place, "kind of joint", shape["kind"], list(LOOKS))[0], shape["dimensions"]


@takes()
def bore_load(run: RunLike, joint: str | None = None, sectors: AtLeastOne = 36) -> xr.Dataset:
    """Return the impulse of the normal force on each sector of the bore.

    Between two samples the impulse of a contact belongs to the direction of its contact point, the mean of
    both samples' weighted by their normal forces. Impacts shorter than the output step are in it whole, for a
    run samples their begin, their end and their largest force, and records the impulse itself.

    Args:
        run: A run with a clearance joint, or its data.
        joint: Name of the clearance joint; the first one if left out.
        sectors: Number of equal sectors around the bearing's axis.

    Returns:
        ``impulse`` (contact, sector) [N s] of the contacts in the bore; ``angle`` (sector), the sector's
        middle from the bearing's x towards its y [rad], of the bearing's surface as seen from its centre. A
        socket's sectors are counted about its z, a guide's load lies in the middle of its walls.
    """
    data = data_of(run)
    joint = _joint(data, joint, "bore_load")
    contacts = contacts_of(data, joint, flanges=False)
    kind, size = _kind(data, joint, "bore_load")
    faces, ends = LOOKS[kind].faces, contact_ends(data)
    # Directions of the contacts as complex numbers, where the shape fixes them.
    fixed = None if faces is None else np.array([faces(size, ends[name]) for name in contacts])
    width = 2.0 * np.pi / sectors
    taken = np.zeros((len(contacts), sectors))
    for part in blocks(data.sel(contact=contacts), overlap=1):
        sector, gained = _sector_impulses(part, fixed, width)
        for row, (where, more) in enumerate(zip(sector.T % sectors, gained.T, strict=True)):
            np.add.at(taken[row], where, more)
    angle = ("sector", width * (np.arange(sectors) + 0.5), {"units": "rad"})
    return dataset_of(
        "bore load", {"impulse": taken}, {"contact": contacts, "angle": angle}, {"joint": joint}
    )


def _sector_impulses(part: xr.Dataset, fixed: Array | None, width: float) -> tuple[Array, Array]:
    """Return sector and impulse [N s] of each contact between two samples."""
    point, force, impulse = (
        floats(variable(part, name, "bore_load"))
        for name in ("contact_point", "normal_force", "normal_impulse")
    )
    direction = point[..., 0] + 1j * point[..., 1]
    if fixed is not None:
        direction[:] = fixed
    direction = direction / np.where(direction == 0.0, 1.0, np.abs(direction))
    loaded = force[:-1] + force[1:] > 0.0
    first, second = (np.where(loaded, weight, 1.0) for weight in (force[:-1], force[1:]))
    angle = np.angle(first * direction[:-1] + second * direction[1:])
    return np.floor(np.mod(angle, 2.0 * np.pi) / width).astype(int), np.diff(impulse, axis=0)


# --- direction of gravity in a bearing ----------------------------------------------------------------------

#: The mean of unit vectors this long or longer: they keep within some 30 degrees of it [-].
STEADY = 0.87
_LOOKED_AT = 200  # samples


@takes()
def bearing_up(run: RunLike, joint: str, times: ArrayLike | None = None) -> Array | None:
    """Return unit vectors against gravity in bearing axes, (n, 3) [-], or None.

    Raises:
        UnknownNameError: There is no such joint.
        FileFormatError: The run does not carry what its bodies were.
    """
    data = data_of(run)
    if "mechanism" not in data.attrs:
        raise FileFormatError("run: must contain its gravity, got data without the attribute mechanism")
    gravity = np.asarray(json.loads(data.attrs["mechanism"])["gravity"], dtype=float)
    shapes = clearance_shapes(data)
    place = shapes[choose("bearing_up", "clearance joint", joint, list(shapes))[0]]
    if not gravity.any():
        return None
    turn = Rotation.from_quat(np.asarray(place["bearing_placement"], dtype=float)[3:])
    attitude = body_poses(data, times, [place["bearing_body"]])["attitude"][:, 0]
    body = Rotation.from_quat(floats(attitude))
    return np.asarray((body * turn).apply(-unit(gravity), inverse=True))


@takes()
def steady_up(run: RunLike, joint: str) -> Array | None:
    """Return the mean direction against gravity in bearing axes, (3,) [-], or None.

    Returns:
        A unit vector; None without gravity, where the bearing turns so far that no direction is up for long,
        or where the data do not carry their mechanism.
    """
    data = data_of(run)
    if not {"mechanism", "urdf"} <= data.attrs.keys() or "q" not in data:
        return None
    count = series(data, "up").sizes["time"]
    up = bearing_up(data, joint, np.unique(np.linspace(0, count - 1, min(_LOOKED_AT, count)).astype(int)))
    if up is None:
        return None
    mean = up.mean(axis=0)
    size = float(np.linalg.norm(mean))
    return mean / size if size >= STEADY else None
