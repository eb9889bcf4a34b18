"""A circular orbit and the axes that turn with it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import AXES, RunLike, data_of, entries_in, sample_times
from antenna_pin.analysis.bodies import body_poses
from antenna_pin.base.arguments import takes
from antenna_pin.base.directions import unit
from antenna_pin.base.rules import Positive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario import OrbitSpec
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
