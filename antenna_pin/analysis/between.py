r"""Interpolation of a joint with play between the samples of its run.

Where the journal is in its bearing is known at a sample together with how fast it moves there, from the
velocities of both links. Between two samples its place, and the numbers of its quaternion, are the cubic
polynomials that have both values and both rates (Hermite),

.. math:: \mathbf{p}(t_k + \theta h) = (1 - \theta)^2 (1 + 2 \theta)\, \mathbf{p}_k
    + \theta^2 (3 - 2 \theta)\, \mathbf{p}_{k+1}
    + h \theta (1 - \theta) \left[(1 - \theta)\, \dot{\mathbf{p}}_k - \theta\, \dot{\mathbf{p}}_{k+1}\right],

whose error is :math:`h^4 \ddddot{p} / 384`. A flight of constant velocity is met exactly. Forces and depths
have no rates of their own in a result; through their samples, among them the onset, the peak and the release
of every contact, goes the monotone cubic of Fritsch and Carlson (1980, SIAM J. Numer. Anal. 17(2), 238-246):
it has no extremum that the samples lack, so a peak stays the peak, and nothing is where nothing touches.
"""

from __future__ import annotations

import numpy as np
import scipy
import xarray as xr
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import RunLike, data_of, floats
from antenna_pin.analysis.bodies import body_poses, body_twists
from antenna_pin.analysis.journal import clearance_shapes, journal_motion
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array

_NEEDED = ("q", "v", "journal_position", "journal_attitude", "journal_tilt")
_FORCES = ("joint_force", "normal_force", "depth")
_QUARTERS = 4  # pieces of an interval at whose ends its bend is looked for
_MOST = 16  # pieces of an interval


@takes()
def between_samples(run: RunLike, joint: str, within: float = 1e-3) -> xr.Dataset:
    """Return journal and contacts of a joint, with extra samples where they curve.

    Args:
        run: A run, or its data.
        joint: Name of the clearance joint.
        within: How far chords of the result may be from the curves, over the clearance and over the largest
            force [-]. No interval between two samples is in more than 16 pieces.

    Returns:
        ``journal_position``, ``journal_attitude``, ``journal_tilt``, ``joint_force``, and ``normal_force``
        and ``depth`` of contacts, as in a result, over more times; attributes as they are. A run that does
        not carry its mechanism and its velocities, or has fewer than two samples, is returned as it is.
    """
    data = data_of(run)
    time = floats(data["time"])
    if "urdf" not in data.attrs or any(name not in data for name in _NEEDED) or time.size < 2:
        return data
    curves = _Curves(data, joint, time)
    trial = curves.at(np.full(time.size - 1, _QUARTERS))
    motion = journal_motion(trial, joint)
    clearance = float(motion.attrs["radial_clearance"])
    bend = np.zeros(time.size - 1)
    for name in ("offset", "eccentricity"):
        bend = np.maximum(bend, _bend(motion[name].values / clearance))
    for name in _FORCES:
        if name in trial:
            values = floats(trial[name].transpose("time", ...))
            bend = np.maximum(bend, _bend(values / (float(np.nanmax(np.abs(values), initial=0.0)) or 1.0)))
    # n chords of an arc are n^2 times as close to it as one.
    return curves.at(np.clip(np.ceil(np.sqrt(bend / within)), 1, _MOST).astype(int))


def _bend(values: Array) -> Array:
    """Return the largest distance of each interval from its chord, (intervals,)."""
    flat = values.reshape(len(values), -1)
    ends = flat[::_QUARTERS]
    bend = np.zeros(len(ends) - 1)
    for k in range(1, _QUARTERS):
        chord = ends[:-1] + k / _QUARTERS * np.diff(ends, axis=0)
        bend = np.maximum(bend, np.nan_to_num(np.abs(flat[k::_QUARTERS] - chord)).max(axis=1, initial=0.0))
    return bend


class _Curves:
    """The curves through the samples of one joint."""

    def __init__(self, data: xr.Dataset, joint: str, time: Array) -> None:
        picked = data.sel(clearance_joint=[joint])
        p = np.asarray(picked["journal_position"].values[:, 0], dtype=float)
        attitude = np.array(picked["journal_attitude"].values[:, 0], dtype=float)
        # A quaternion and its opposite are one attitude: neighbours are to be near each other.
        turned = np.einsum("ij,ij->i", attitude[1:], attitude[:-1]) < 0.0
        attitude[1:] *= np.where(np.cumsum(turned) % 2, -1.0, 1.0)[:, None]
        velocity, spin = _rates(data, joint)
        x, y, z, w = attitude.T
        wx, wy, wz = spin.T
        turning = 0.5 * np.stack(
            [
                w * wx + y * wz - z * wy,
                w * wy + z * wx - x * wz,
                w * wz + x * wy - y * wx,
                -x * wx - y * wy - z * wz,
            ],
            axis=1,
        )
        self._data, self._picked, self._time = data, picked, time
        self._place = scipy.interpolate.CubicHermiteSpline(time, p, velocity)
        self._attitude = scipy.interpolate.CubicHermiteSpline(time, attitude, turning)
        self._forces = {
            name: scipy.interpolate.PchipInterpolator(time, floats(picked[name].transpose("time", ...)))
            for name in _FORCES
            if name in picked and picked[name].size
        }

    def at(self, pieces: NDArray[np.int_]) -> xr.Dataset:
        """Return values at the ends of equal pieces, (n - 1,), of every interval."""
        start = np.repeat(np.cumsum(pieces) - pieces, pieces)
        part = (np.arange(int(pieces.sum())) - start) / np.repeat(pieces, pieces)
        begin, step = np.repeat(self._time[:-1], pieces), np.repeat(np.diff(self._time), pieces)
        time = np.append(begin + part * step, self._time[-1])
        attitude = self._attitude(time)
        attitude /= np.linalg.norm(attitude, axis=1)[:, None]
        axis = Rotation.from_quat(attitude).apply([0.0, 0.0, 1.0])
        values = {
            "journal_position": self._place(time)[:, None],
            "journal_attitude": attitude[:, None],
            "journal_tilt": np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), axis[:, 2])[:, None],
            **{name: curve(time) for name, curve in self._forces.items()},
        }
        picked = self._picked
        made = {}
        for name, value in values.items():
            dims = ("time", *(dim for dim in picked[name].dims if dim != "time"))
            made[name] = xr.Variable(dims, value, picked[name].attrs)
        rest = picked.drop_vars([name for name in picked.variables if "time" in picked[name].dims])
        coords = {name: rest[name] for name in rest.coords}
        return xr.Dataset(made, coords={**coords, "time": time}, attrs=self._data.attrs)


def _rates(data: xr.Dataset, joint: str) -> tuple[Array, Array]:
    """Return velocity and angular velocity of the journal in its bearing.

    Its centre's velocity, bearing axes (n, 3) [m/s]; its angular velocity, journal axes (n, 3) [rad/s].
    """
    shape = clearance_shapes(data)[joint]
    bodies = list(dict.fromkeys(shape[f"{side}_body"] for side in ("bearing", "journal")))
    poses, twists = body_poses(data, bodies=bodies), body_twists(data, bodies=bodies)
    seen = []
    for side in ("bearing", "journal"):
        body = shape[f"{side}_body"]
        placement = np.asarray(shape[f"{side}_placement"], dtype=float)
        of_link = Rotation.from_quat(poses["attitude"].sel(body=body).values)
        arm = of_link.apply(placement[:3])
        spin = of_link.apply(twists["angular_velocity"].sel(body=body).values)
        velocity = of_link.apply(twists["velocity"].sel(body=body).values) + np.cross(spin, arm)
        place = poses["position"].sel(body=body).values + arm
        seen.append((of_link * Rotation.from_quat(placement[3:]), place, velocity, spin))
    (axes, p, v, omega), (journal_axes, p_journal, v_journal, omega_journal) = seen
    velocity = axes.inv().apply(v_journal - v - np.cross(omega, p_journal - p))
    return np.asarray(velocity), np.asarray(journal_axes.inv().apply(omega_journal - omega))
