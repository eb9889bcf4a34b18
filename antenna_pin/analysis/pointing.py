r"""Boresight of an antenna, its pointing error, and the axes of a circular orbit.

The antenna's axes are the boresight, the part of ``up`` that is perpendicular to it, and ``cross``, which
completes them: boresight x cross = up. With :math:`R_i` the commanded or ideal attitude of these axes and
:math:`R` the true one, the error is the rotation vector

.. math:: \varepsilon = \log(R_i^T R)

in the ideal antenna's axes: its component about the boresight is a clocking error, those about ``cross`` and
``up`` turn the boresight. The half-cone angle is the angle between the two boresights; with
:math:`R_i^T R` as the quaternion :math:`(x, y, z, w)`, x along the boresight, it is

.. math:: \theta = 2\, \mathrm{atan2}\!\left(\sqrt{y^2 + z^2},\, \sqrt{x^2 + w^2}\right)

to the relative precision of the quaternion at any angle (an arc cosine of the boresights' product would lose
all below 1e-8 rad).
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import (
    AXES,
    RunLike,
    blocks,
    data_of,
    entries_in,
    floats,
    label_of,
    sample_times,
    samples_around,
)
from antenna_pin.analysis.bodies import body_poses, body_twists, mechanism_of
from antenna_pin.analysis.body_motion import interpolate_attitude, interpolation_error
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.directions import unit
from antenna_pin.base.rules import Positive
from antenna_pin.errors import FileFormatError, InvalidParameterError, UnknownNameError
from antenna_pin.scenario import OrbitSpec, PointingSpec
from antenna_pin.trajectory import Trajectory
from antenna_pin.trajectory.quantities import dataset_of

#: Gravitational parameter of the Earth [m^3/s^2] (WGS 84).
EARTH_MU = 3.986004418e14
#: Equatorial radius of the Earth [m] (WGS 84).
EARTH_RADIUS = 6378137.0

Vector3 = tuple[float, float, float]


@takes(rate="rad/s")
@dataclass(frozen=True, slots=True, kw_only=True)
class Orbit:
    r"""A circular orbit, and the world's axes in it.

    Orbit-fixed axes: z to nadir, y against the orbit's normal, x completes them and so lies along the
    velocity. They turn about the normal :math:`n` at the orbital rate :math:`\omega`:

    .. math:: R_{WO}(t) = \exp(\omega t\, [n]_\times)\, R_{WO}(0)

    The world's axes do not turn. The motion itself depends on the orbit by ``[forces.NAME]``'s gravity
    gradient only.
    """

    rate: Positive  # orbital rate [rad/s]
    # orbit's normal, along the orbital angular momentum, in world axes, any length [-]
    normal: Vector3 = (0.0, 1.0, 0.0)
    # direction to the Earth's centre at t = 0, in world axes, perpendicular to it, any length [-]
    nadir: Vector3 = (0.0, 0.0, -1.0)

    def __post_init__(self) -> None:
        # The rules of directions are those of a scenario.
        OrbitSpec(rate=self.rate, normal=self.normal, nadir=self.nadir)

    @classmethod
    def from_spec(cls, spec: OrbitSpec) -> Orbit:
        r"""Return the orbit of a scenario.

        Of an altitude h the rate is :math:`\sqrt{\mu / (R_E + h)^3}`, of a period P it is :math:`2 \pi / P`.
        """
        if spec.rate is not None:
            rate = spec.rate
        elif spec.period is not None:
            rate = 2.0 * math.pi / spec.period
        else:
            assert spec.altitude is not None
            rate = math.sqrt(EARTH_MU / (EARTH_RADIUS + spec.altitude) ** 3)
        return cls(rate=rate, normal=spec.normal, nadir=spec.nadir)

    @property
    def period(self) -> float:
        """Time of one revolution [s]."""
        return 2.0 * math.pi / self.rate

    def axes(self, times: ArrayLike) -> Rotation:
        """Return the orbit-fixed axes in the world at times (n,) [s]."""
        normal, z = unit(self.normal), unit(self.nadir)
        x = unit(np.cross(z, normal))
        start = Rotation.from_matrix(np.column_stack([x, -normal, np.cross(x, -normal)]))
        turn = Rotation.from_rotvec(
            self.rate * np.atleast_1d(np.asarray(times, dtype=float))[:, None] * normal
        )
        return turn * start


# --- attitude of a link in orbit axes -----------------------------------------------------------------------


@takes()
def orbit_angles(run: RunLike, body: str | None = None, orbit: Orbit | None = None) -> xr.Dataset:
    r"""Return pitch, roll and yaw of a link from the orbit-fixed axes over time.

    These axes are those of :class:`Orbit`: z to the centre, y against the orbit's normal, x along the
    velocity. Turned by pitch about y, then by roll about the new x, then by yaw about the new z they are the
    link's own:

    .. math:: R_{OB} = R_y(\text{pitch})\, R_x(\text{roll})\, R_z(\text{yaw})

    Pitch, first, counts whole turns, as yaw does; roll stays within a quarter of a turn.

    Link and orbit are by default the base and that of the run's gravity gradient.

    Returns:
        ``pitch``, ``roll`` and ``yaw``, (time,) [rad].

    Raises:
        InvalidParameterError: No orbit is given, and the run has none.
    """
    data = data_of(run)
    time = sample_times(data, "orbit_angles")
    found = orbit if orbit is not None else orbit_of(data)
    if found is None:
        rule = "given, because the run has no gravity gradient from which it follows"
        raise InvalidParameterError("orbit_angles", "orbit", rule, said="none")
    poses = body_poses(data, bodies=None if body is None else [body])
    attitude = Rotation.from_quat(poses["attitude"].isel(body=0).values)
    angles = (found.axes(time).inv() * attitude).as_euler("YXZ")
    columns = {"pitch": np.unwrap(angles[:, 0]), "roll": angles[:, 1], "yaw": np.unwrap(angles[:, 2])}
    return dataset_of("orbit angles", columns, {"time": data["time"]})


def orbit_of(data: xr.Dataset) -> Orbit | None:
    """Return the orbit of a run's gravity gradient; None if it has none."""
    for one in entries_in(data, "forces").values():
        if one["kind"] == "GravityGradient":
            numbers = one["numbers"]
            normal, nadir = (tuple(numbers[f"{key}_{axis}"] for axis in AXES) for key in ("normal", "nadir"))
            return Orbit(rate=numbers["rate"], normal=normal, nadir=nadir)
    return None


# --- the attitude of a link in the ideal run, at the samples of another, of long runs part by part ---


def ideal_attitude(ideal: xr.Dataset, body: str, time: Array) -> Rotation:
    """Return a link's attitude in the ideal run at some times, (n,) [s]."""
    found = [
        interpolate_attitude(time[some], *_knots(data, body)).as_quat()
        for some, data in samples_around(ideal, time)
    ]
    return Rotation.from_quat(found[0] if len(found) == 1 else np.concatenate(found))


def ideal_doubt(ideal: xr.Dataset, body: str, time: Array) -> float:
    """Return an estimate of the largest error of :func:`ideal_attitude` [rad].

    Raises:
        InvalidParameterError: The ideal run does not cover the times.
    """
    knots = floats(ideal["time"])
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
    """Return sample times, attitudes and angular velocities [rad/s] of a link, own axes."""
    poses = body_poses(data, bodies=[body]).sel(body=body)
    spin = body_twists(data, bodies=[body])["angular_velocity"].sel(body=body)
    attitude = Rotation.from_quat(poses["attitude"].values)
    return floats(data["time"]), attitude, floats(spin)


_POINTING_AXES = ("boresight", "cross", "up")

_ALONG = 0.9  # cosine of the angle from which on a boresight counts as lying along z


@dataclass(frozen=True, slots=True, kw_only=True)
class Antenna:
    """Antenna: the link that carries it, and its axes."""

    body: str  # link that looks
    boresight: Vector3  # axis it looks along, in the link's frame, any length [-]
    # second axis in the link's frame, of which the part perpendicular to the boresight counts [-]; None for
    # the link's z axis, or its x axis where the boresight lies within 26 deg of z
    up: Vector3 | None = None

    def __post_init__(self) -> None:
        # The rules are those of a scenario.
        PointingSpec(body=self.body, boresight=self.boresight, up=self.up)

    @classmethod
    def of(cls, run: RunLike) -> Antenna:
        """Return the antenna that the run's scenario names.

        Raises:
            FileFormatError: It names none.
        """
        spec = pointing_spec(run)
        if spec is None:
            raise FileFormatError(
                f"{label_of(data_of(run))}: its scenario must have a table [pointing], got none; add it and "
                f"run again, or name the body and its boresight"
            )
        return cls(body=spec.body, boresight=spec.boresight, up=spec.up)

    @property
    def axes(self) -> Rotation:
        """Rotation from the axes boresight, cross, up to the link's frame."""
        return _frame(self.boresight, self.up)


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """A commanded direction of the boresight."""

    direction: Vector3  # in the frame's axes, any length [-]
    # commanded direction of the antenna's ``up`` in them [-]; None where turns about the boresight do not
    # matter: then the frame's z axis serves (x near z), as for an antenna's ``up``
    up: Vector3 | None = None
    # axes in which it stands still: the ``world``'s or the ``orbit``'s
    frame: Literal["world", "orbit"] = "world"

    def __post_init__(self) -> None:
        if self.frame not in ("world", "orbit"):
            raise UnknownNameError("Command", "frame", str(self.frame), ("world", "orbit"))
        PointingSpec(
            body="", boresight=(1, 0, 0), commanded="world", direction=self.direction, direction_up=self.up
        )


@takes()
def boresight(
    run: RunLike, antenna: Antenna | None = None, orbit: Orbit | None = None, times: ArrayLike | None = None
) -> xr.Dataset:
    """Return the boresight of an antenna.

    Azimuth is the angle of the direction's projection on the x-y plane from x, about z; elevation the angle
    from that plane towards z. In orbit-fixed axes z is nadir and x along the velocity. At an elevation of
    +-90 deg azimuth is undefined; it is continuous along time elsewhere.

    Args:
        run: A run, or its data.
        antenna: What looks; the scenario's if left out.
        orbit: The orbit; the scenario's, if any, if left out.
        times: Indices of samples; all if not given.

    Returns:
        ``direction`` (time, axis), unit vectors in the world [-]; ``azimuth``, ``elevation`` (time) [rad];
        ``origin`` (time, axis), the link's frame in the world [m]; ``attitude`` (time, quaternion), the
        antenna's axes boresight, cross, up in the world, xyzw; with an orbit also ``orbit_direction``,
        ``orbit_azimuth`` and ``orbit_elevation`` in orbit-fixed axes.

    Raises:
        FileFormatError: No antenna is known, or the run carries no mechanism.
        UnknownNameError: The mechanism has no such link.
    """
    antenna = Antenna.of(run) if antenna is None else antenna
    orbit = _orbit_of(run) if orbit is None else orbit
    link = _link(run, antenna)
    poses = body_poses(run, times, [link]).sel(body=link)
    time = floats(poses["time"])
    attitude = Rotation.from_quat(poses["attitude"].values) * antenna.axes
    direction = attitude.apply([1.0, 0.0, 0.0])
    found = _directions(direction, "", "in the world")
    found["origin"] = (("time", "axis"), poses["position"].values, _about("m", "link's frame in the world"))
    found["attitude"] = (
        ("time", "quaternion"),
        attitude.as_quat(),
        _about("1", "axes boresight, cross, up in the world, quaternion"),
    )
    if orbit is not None:
        found |= _directions(orbit.axes(time).inv().apply(direction), "orbit_", "in orbit-fixed axes")
    return xr.Dataset(
        found,
        coords={"time": ("time", time, _about("s", "time")), "axis": list(AXES), "quaternion": [*AXES, "w"]},
        attrs={"body": antenna.body},
    )


@takes()
def pointing_error(
    run: RunLike,
    ideal: RunLike | None = None,
    *,
    antenna: Antenna | None = None,
    command: Command | None = None,
    orbit: Orbit | None = None,
) -> xr.Dataset:
    """Return the pointing error of an antenna at the run's samples.

    The ideal run's attitude is interpolated to them (:mod:`antenna_pin.analysis.body_motion`).

    Args:
        run: A run, or its data.
        ideal: The run that points as it should; it covers the time of ``run``.
        antenna: What looks, in both runs; the scenario's if left out.
        command: Instead of an ideal run; the scenario's if both are left out.
        orbit: Needed where the command stands still in orbit-fixed axes; the scenario's if left out.

    Returns:
        ``error`` (time, pointing_axis): rotation vector of the error, in the ideal antenna's axes; the
        shortest one [rad]. Without ``boresight`` where no ``up`` is commanded.
        ``boresight_error`` (time, cross_axis): the smallest rotation that takes the ideal boresight to the
        true one, about ``cross`` and ``up`` [rad]. Its length is
        ``half_cone`` (time): angle between both boresights [rad].
        Attribute ``interpolation_error``: estimate of the largest error of the ideal attitude between its
        samples [rad]; 0 against a command.

    Raises:
        FileFormatError: Nothing to compare with.
        InvalidParameterError: The ideal run does not cover the time of ``run``.
    """
    antenna = Antenna.of(run) if antenna is None else antenna
    if ideal is not None and command is not None:
        raise InvalidParameterError(
            "pointing_error", "command", "left out where an ideal run is given", command
        )
    if ideal is None and command is None:
        command = _command_of(run)
    if command is not None and command.frame == "orbit":
        orbit = _orbit_of(run) if orbit is None else orbit
        if orbit is None:
            raise FileFormatError(
                "run: a direction in orbit axes must come with an orbit, got none; give one or set "
                "pointing.orbit"
            )
    if ideal is None and command is None:
        raise FileFormatError(
            "run: a reference is needed, got neither an ideal run nor a commanded direction; pass an ideal "
            "run, or set pointing.commanded and pointing.direction"
        )
    for one in (run, ideal):
        if one is not None:
            _link(one, antenna)
    time = floats(data_of(run)["time"])
    estimate = 0.0 if ideal is None else ideal_doubt(data_of(ideal), antenna.body, time)
    known = command is None or command.up is not None
    axes = _POINTING_AXES if known else _POINTING_AXES[1:]
    error, swing, half_cone = np.empty((time.size, len(axes))), np.empty((time.size, 2)), np.empty(time.size)
    begin = 0
    for part in blocks(data_of(run)):
        some = slice(begin, begin + part.sizes["time"])
        begin = some.stop
        relative = _wanted(time[some], ideal, command, orbit, antenna).inv() * _attitude(part, antenna)
        swing[some], half_cone[some] = _swing(relative)
        error[some] = relative.as_rotvec() if known else swing[some]
    versus = "ideal run" if command is None else f"direction in {command.frame} axes"
    return dataset_of(
        "pointing error",
        {"error": error, "boresight_error": swing, "half_cone": half_cone},
        {
            "time": ("time", time, _about("s", "time")),
            "pointing_axis": list(axes),
            "cross_axis": list(_POINTING_AXES[1:]),
        },
        {"body": antenna.body, "against": versus, "interpolation_error": estimate},
    )


def _attitude(data: xr.Dataset, antenna: Antenna) -> Rotation:
    """Return the antenna's axes in the world, at all samples."""
    attitude = body_poses(data, bodies=[antenna.body])["attitude"].sel(body=antenna.body)
    # There and back, as a dataset holds them: quaternions of length 1 to round-off.
    return Rotation.from_quat((Rotation.from_quat(attitude.values) * antenna.axes).as_quat())


def _wanted(
    time: Array, ideal: RunLike | None, command: Command | None, orbit: Orbit | None, antenna: Antenna
) -> Rotation:
    """Return the wanted attitude of the antenna's axes at some times."""
    if ideal is not None:
        return ideal_attitude(data_of(ideal), antenna.body, time) * antenna.axes
    assert command is not None
    wanted = _frame(command.direction, command.up)
    if command.frame == "orbit":
        assert orbit is not None
        wanted = orbit.axes(time) * wanted
    return wanted


def _swing(relative: Rotation) -> tuple[Array, Array]:
    """Return the smallest rotations of the first axis, (n, 2), and their angles, (n,)."""
    x, y, z, w = relative.as_quat().T
    half_cone = 2.0 * np.arctan2(np.hypot(y, z), np.hypot(x, w))
    # The first axis goes to (., 2 (x y + w z), 2 (x z - w y)); the turn's axis is square to both.
    about = np.column_stack([2.0 * (w * y - x * z), 2.0 * (x * y + w * z)])
    length = np.linalg.norm(about, axis=1)
    scale = np.divide(half_cone, length, out=np.zeros_like(length), where=length > 0.0)
    return about * scale[:, None], half_cone


def _frame(direction: Vector3, second: Vector3 | None) -> Rotation:
    """Return axes with x along one direction and z towards another."""
    x = unit(direction)
    up = unit(second if second is not None else (1, 0, 0) if abs(x[2]) > _ALONG else (0, 0, 1))
    y = unit(np.cross(up, x))
    return Rotation.from_matrix(np.column_stack([x, y, np.cross(x, y)]))


def _directions(direction: Array, prefix: str, where: str) -> dict[str, object]:
    x, y, z = direction.T
    azimuth, elevation = np.unwrap(np.arctan2(y, x)), np.arctan2(z, np.hypot(x, y))
    return {
        f"{prefix}direction": (("time", "axis"), direction, _about("1", f"boresight {where}")),
        f"{prefix}azimuth": (("time",), azimuth, _about("rad", f"azimuth of the boresight {where}")),
        f"{prefix}elevation": (("time",), elevation, _about("rad", f"elevation of the boresight {where}")),
    }


def _about(units: str, name: str) -> dict[str, str]:
    return {"units": units, "long_name": name}


def _link(run: RunLike, antenna: Antenna) -> str:
    known = [link.name for link in mechanism_of(run).urdf.robot.links]
    if antenna.body not in known:
        raise UnknownNameError("Antenna", "link", antenna.body, known)
    return antenna.body


@takes()
def pointing_spec(run: RunLike) -> PointingSpec | None:
    """Return the table ``pointing`` of the run's scenario, or None.

    Raises:
        FileFormatError: What the run carries is no scenario.
    """
    if isinstance(run, Trajectory) and run.scenario is not None:
        return run.scenario.pointing
    text = data_of(run).attrs.get("scenario")
    try:
        table = json.loads(text).get("pointing") if text else None
        return None if table is None else PointingSpec.model_validate(table)
    except (AttributeError, TypeError, ValueError, RecursionError) as error:
        told = " ".join(str(error).split())
        raise FileFormatError(f"{label_of(data_of(run))}: its scenario cannot be read ({told})") from None


def _orbit_of(run: RunLike) -> Orbit | None:
    spec = pointing_spec(run)
    return None if spec is None or spec.orbit is None else Orbit.from_spec(spec.orbit)


def _command_of(run: RunLike) -> Command | None:
    spec = pointing_spec(run)
    if spec is None or spec.commanded == "ideal":
        return None
    assert spec.direction is not None
    return Command(direction=spec.direction, up=spec.direction_up, frame=spec.commanded)
