"""Motion of base and links in world axes, and attitudes between samples."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import RunLike, data_of, floats, label_of, sample_times, variable
from antenna_pin.analysis.bodies import mechanism_of
from antenna_pin.analysis.sampled import resampled
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import link_motion, quaternions
from antenna_pin.trajectory import names_along
from antenna_pin.trajectory.quantities import TABLES, dataset_of

# --- attitude between samples -------------------------------------------------------------------------------
#
# Within an interval the attitude is :math:`R(t) = R_k \exp([\varphi(t)]_\times)`, with the cubic
# :math:`\varphi` that has the right values and slopes at both ends:
#
# .. math::
#     \varphi(t_k) = 0, \quad \dot\varphi(t_k) = \omega_k, \quad
#     \varphi(t_{k+1}) = \log(R_k^T R_{k+1}), \quad
#     \dot\varphi(t_{k+1}) = J_r^{-1}(\varphi(t_{k+1}))\, \omega_{k+1}
#
# :math:`\omega` is the angular velocity in body axes and :math:`J_r^{-1}` the inverse of the right Jacobian
# of the exponential. The error falls with the fourth power of the spacing; slerp, without the rates, is of
# second order. The interpolant passes through the samples exactly, and its rate is continuous.


@takes()
def interpolate_attitude(
    times: ArrayLike, knots: ArrayLike, attitude: Rotation, angular_velocity: ArrayLike
) -> Rotation:
    """Return the attitude at given times.

    Args:
        times: Where it is wanted, (m,) [s]; within the samples' span to a billionth of it.
        knots: Times of the samples, (n,), not decreasing [s]; of equal ones the first counts.
        attitude: At the samples, body in world, (n,).
        angular_velocity: At the samples, in body axes, (n, 3) [rad/s].

    Raises:
        InvalidParameterError: Times outside the samples' span.
    """
    wanted = np.atleast_1d(np.asarray(times, dtype=float))
    t, first = np.unique(np.asarray(knots, dtype=float), return_index=True)
    slack = 1e-9 * (t[-1] - t[0])
    outside = wanted[(wanted < t[0] - slack) | (wanted > t[-1] + slack)]
    if outside.size:
        raise InvalidParameterError(
            "interpolate_attitude", "times", f"from {t[0]:g} s to {t[-1]:g} s", float(outside[0])
        )
    at = attitude[first]
    if t.size == 1:
        return at[np.zeros(wanted.size, dtype=int)]
    omega = np.asarray(angular_velocity, dtype=float)[first]
    turn = (at[:-1].inv() * at[1:]).as_rotvec()
    h = np.diff(t)[:, None]
    start, end = h * omega[:-1], h * _chart_rate(turn, omega[1:])
    k = np.clip(np.searchsorted(t, wanted, side="right") - 1, 0, t.size - 2)
    s = np.clip((wanted - t[k]) / (t[k + 1] - t[k]), 0.0, 1.0)[:, None]
    phi = s * (1.0 - s) ** 2 * start[k] + s**2 * (3.0 - 2.0 * s) * turn[k] - s**2 * (1.0 - s) * end[k]
    return at[k] * Rotation.from_rotvec(phi)


@takes()
def interpolation_error(knots: ArrayLike, attitude: Rotation, angular_velocity: ArrayLike) -> float:
    """Return an estimate of the largest error of :func:`interpolate_attitude` [rad].

    Every other sample is left out and compared with what the rest gives there; at twice the spacing the error
    is 16 times as large. NaN for less than three samples.
    """
    t, first = np.unique(np.asarray(knots, dtype=float), return_index=True)
    if t.size < 3:
        return float("nan")
    at, omega = attitude[first], np.asarray(angular_velocity, dtype=float)[first]
    left_out = np.arange(1, t.size - 1, 2)
    found = interpolate_attitude(t[left_out], t[::2], at[::2], omega[::2])
    return float((found.inv() * at[left_out]).magnitude().max()) / 16.0


def _chart_rate(phi: Array, omega: Array) -> Array:
    r"""Return :math:`J_r^{-1}(\varphi)\, \omega`, (n, 3): the rotation vector's rate at a body rate."""
    half = 0.5 * np.linalg.norm(phi, axis=1)
    small = half < 1e-3
    safe = np.where(small, 1.0, half)
    # (1 - x cot x) / (4 x^2) with x half the angle, 1/12 + x^2/180 + ...
    factor = np.where(small, 1.0 / 12.0 + half**2 / 180.0, (1.0 - safe / np.tan(safe)) / (4.0 * safe**2))
    cross = np.cross(phi, omega)
    result: Array = omega + 0.5 * cross + factor[:, None] * np.cross(phi, cross)
    return result


# --- motion of a frame --------------------------------------------------------------------------------------

# Each quantity with its derivative, which makes its interpolation better.
_DERIVATIVES = {
    "position": "velocity",
    "velocity": "acceleration",
    "acceleration": None,
    "angular_velocity": "angular_acceleration",
    "angular_acceleration": None,
}


def motion_dataset(data: xr.Dataset, whose: str, attitude: Array, **columns: Array) -> xr.Dataset:
    """Return the motion of a frame, with its rotation since the start.

    Columns are ``position``, ``velocity``, ``acceleration`` of its origin, ``angular_velocity`` and
    ``angular_acceleration``, (n, 3) each; attitudes are quaternions xyzw, (n, 4).
    """
    turn = Rotation.from_quat(attitude)
    columns |= {"rotation": _unwrapped((turn * turn[0].inv()).as_rotvec()), "attitude": attitude}
    coords = {name: data.coords[name] for name in ("time", "axis", "quaternion") if name in data.coords}
    columns = {name: columns[name] for name in TABLES["frame motion"]}
    return dataset_of("frame motion", columns, coords, {"case": data.attrs.get("case", "")}, whose=whose)


def common_samples(data: xr.Dataset, reference: xr.Dataset, place: str) -> slice:
    """Return the samples of a run while the ideal run lasts."""
    if reference.sizes.get("contact", 0):
        touching = ", ".join(names_along(reference, "clearance_joint"))
        rule = "a run without contacts (a case whose joints are all ideal)"
        raise InvalidParameterError(place, "ideal", rule, f"{label_of(reference)} with play in {touching}")
    time, own = sample_times(data, place), sample_times(reference, place)
    if own.size < 2:
        rule = "a run of two samples or more"
        raise InvalidParameterError(place, "ideal", rule, f"{label_of(reference)} with {own.size}")
    first, last = np.searchsorted(time, own[0], "left"), np.searchsorted(time, own[-1], "right")
    if last - first < 2:
        span = f"{label_of(data)} with {last - first} samples from {own[0]:g} to {own[-1]:g} s"
        raise InvalidParameterError(place, "run", "of two samples or more while the ideal lasts", span)
    return slice(int(first), int(last))


def motion_deviation(run: xr.Dataset, ideal: xr.Dataset, whose: str) -> dict[str, xr.Variable]:
    """Return the deviation of one motion from another at its own samples, in world axes.

    The ideal motion is interpolated, and must cover the run's time.

    Returns:
        ``position`` [m], ``attitude`` (rotation vector from the ideal to the run's) [rad], and the rates.
    """
    at, own = run["time"].values, ideal["time"].values
    found = {}
    for name, derivative in _DERIVATIVES.items():
        slope = None if derivative is None else ideal[derivative].values
        found[name] = xr.Variable(
            ("time", "axis"),
            np.asarray(run[name].values - resampled(own, ideal[name].values, at, slope)),
            {
                "units": str(run[name].attrs.get("units", "")),
                "long_name": f"deviation of the {whose}'s {name.replace('_', ' ')}, world axes",
            },
        )
    turn = Rotation.from_quat(ideal["attitude"].values)
    body_rate = turn.inv().apply(ideal["angular_velocity"].values)
    attitude = interpolate_attitude(at, own, turn, body_rate)
    turned = (Rotation.from_quat(run["attitude"].values) * attitude.inv()).as_rotvec()
    words = {"units": "rad", "long_name": "rotation from the ideal to the run's attitude, world axes"}
    return {
        "position": found.pop("position"),
        "attitude": xr.Variable(("time", "axis"), np.asarray(turned), words),
        **found,
    }


def _unwrapped(vectors: Array) -> Array:
    """Return rotation vectors that go on beyond pi instead of jumping to the other side."""
    result = vectors.copy()
    if np.linalg.norm(vectors, axis=1).max(initial=0.0) < 3.0:
        return result
    for i in range(1, len(result)):
        angle = np.linalg.norm(result[i])
        if angle == 0.0:
            continue
        axis = result[i] / angle
        turns = np.round((axis @ result[i - 1] - angle) / (2.0 * np.pi))
        result[i] += 2.0 * np.pi * turns * axis
    return result


# --- free-floating base -------------------------------------------------------------------------------------


@takes()
def base_motion(run: RunLike) -> xr.Dataset:
    r"""Return position, attitude, velocities and accelerations of the base, all in world axes.

    A run records its base's velocity and acceleration as the generalized ones, along axes that turn with it.
    Here they are those of the base's origin as seen from the world: :math:`R v` and
    :math:`R (a + \omega \times v)`.

    Returns:
        Over time and axis: ``position`` [m], ``rotation`` since the first sample as a rotation vector [rad]
        (unwrapped beyond pi), ``velocity`` [m/s], ``angular_velocity`` [rad/s], ``acceleration`` [m/s^2],
        ``angular_acceleration`` [rad/s^2]; and ``attitude`` (time, quaternion), xyzw.
    """
    data = data_of(run)
    if "base_position" not in data:
        raise InvalidParameterError("base_motion", "run", "one with a free base", label_of(data))
    attitude = floats(variable(data, "base_attitude", "base_motion"))
    turn = Rotation.from_quat(attitude)
    names = [f"base.{part}" for part in ("vx", "vy", "vz", "wx", "wy", "wz")]
    v, a = (floats(variable(data, name, "base_motion").sel(coordinate=names)) for name in ("v", "a"))
    return motion_dataset(
        data,
        "base",
        attitude,
        position=floats(data["base_position"]),
        velocity=turn.apply(v[:, :3]),
        angular_velocity=turn.apply(v[:, 3:]),
        acceleration=turn.apply(a[:, :3] + np.cross(v[:, 3:], v[:, :3])),
        angular_acceleration=turn.apply(a[:, 3:]),
    )


# --- any link -----------------------------------------------------------------------------------------------


@takes()
def moved_body(run: RunLike, joint: str) -> str:
    """Return the name of the body that a joint moves."""
    mechanism = mechanism_of(run)
    return mechanism.bodies[mechanism.joint(joint).joint_id - 1]


@takes()
def body_motion(run: RunLike, body: str) -> xr.Dataset:
    """Return position, attitude, velocities and accelerations of a link's frame, all in world axes.

    Returns:
        The variables of :func:`base_motion`.
    """
    data = data_of(run)
    q, v, a = (floats(variable(data, name, "body_motion")) for name in "qva")
    attitudes, motion = link_motion(mechanism_of(data), body, q, v, a)
    names = ("position", "velocity", "angular_velocity", "acceleration", "angular_acceleration")
    columns = dict(zip(names, np.moveaxis(motion, 1, 0), strict=True))
    return motion_dataset(data, body, quaternions(attitudes), **columns)


@takes()
def body_deviation(run: RunLike, ideal: RunLike, body: str) -> xr.Dataset:
    """Return the deviation of a body from the ideal run, at the run's samples.

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
    motion = body_motion(data.isel(time=common_samples(data, reference, "body_deviation")), body)
    apart = motion_deviation(motion, body_motion(reference, body), body)
    coords = {name: motion.coords[name] for name in ("time", "axis") if name in motion.coords}
    about = {"case": str(data.attrs.get("case", "")), "ideal": str(reference.attrs.get("case", ""))}
    return xr.Dataset(apart, coords=coords, attrs=about)
