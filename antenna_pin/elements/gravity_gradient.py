"""Gravity on a circular orbit, as it differs from that at the reference point."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from antenna_pin.base.directions import A_DIRECTION, unit
from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.base.records import Triple, Vector3
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.curve import both_given
from antenna_pin.elements.desk_kernels import Desk
from antenna_pin.elements.element import ForceElement, packed
from antenna_pin.elements.on_links import OnLinks
from antenna_pin.errors import InvalidParameterError

_SQUARE = 1e-9  # cosine of what counts as a right angle


@dataclass(frozen=True, slots=True, kw_only=True)
class GravityGradient(OnLinks):
    r"""Gravity gradient of a central field on a circular orbit, to first order.

    The world's axes do not turn, and their origin, the reference point, falls along the orbit. With e the
    direction to the centre, n the orbital rate, c a body's mass centre and I its inertia about that,

    .. math:: F = m n^2 (3 (e \cdot c)\, e - c), \quad M = 3 n^2\, e \times I e,

    the force from the differing gravity, and the torque of that within the body. Left out is the second order
    of size over radius. Start with the mass centre of the whole near the origin; the work is booked as put
    in.

    Orbit-fixed axes (``[pointing.orbit]`` has the same): z to the centre, y against the orbit's normal, x
    along the velocity.

    Attributes:
        rate: Orbital rate n [rad/s]; or give ``mu`` and ``radius``.
        mu: Gravitational parameter of the centre [m^3/s^2].
        radius: Of the orbit [m].
        normal: Of the orbit, along the orbital angular momentum, in world axes, of any length [-].
        nadir: Direction to the centre at t = 0, in world axes, square to that [-].
    """

    kernels: ClassVar[str] = __name__
    everywhere: ClassVar[bool] = True
    replaces_gravity: ClassVar[bool] = True

    rate: float | None = parameter("rad/s", rule="positive", default=None)
    mu: float | None = parameter("m^3/s^2", rule="positive", default=None)
    radius: float | None = parameter("m", rule="positive", default=None)
    normal: Triple = parameter("1", rule=A_DIRECTION, sizes=(3,), default=(0.0, 1.0, 0.0))
    nadir: Triple = parameter("1", rule=A_DIRECTION, sizes=(3,), default=(0.0, 0.0, -1.0))

    def __post_init__(self) -> None:
        """Check the parameters, and that they define one orbit."""
        ForceElement.__post_init__(self)
        both_given(self, "mu", "radius")
        if (self.rate is None) == (self.mu is None):
            said = "neither" if self.rate is None else "both"
            raise InvalidParameterError(self, "rate", "given, or mu and radius in its place", said=said)
        if abs(float(unit(self.normal) @ unit(self.nadir))) > _SQUARE:
            raise InvalidParameterError(self, "nadir", f"at right angles to normal {self.normal}")

    @packed
    def orbital_rate(self) -> float:
        """N [rad/s]."""
        if self.rate is not None:
            return self.rate
        assert self.mu is not None and self.radius is not None
        return math.sqrt(self.mu / self.radius**3)

    @property
    def longest_step(self) -> float:
        """A twelfth of the orbital period [s]."""
        return 2.0 * math.pi / (12.0 * self.orbital_rate)

    @packed
    def down(self) -> Vector3:
        """Direction to the centre at t = 0, unit."""
        return unit(self.nadir)

    @packed
    def ahead(self) -> Vector3:
        """Direction that follows a quarter of a turn later, unit."""
        return np.cross(unit(self.normal), self.down)

    def facts(self) -> dict[str, float]:
        """Return the orbit, for readers of a result."""
        names = ("normal_x", "normal_y", "normal_z", "nadir_x", "nadir_y", "nadir_z")
        numbers = (*unit(self.normal).tolist(), *unit(self.nadir).tolist())
        return {"rate": self.orbital_rate, **dict(zip(names, numbers, strict=True))}

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        period = readable(2.0 * math.pi / self.orbital_rate, "s", 6)
        rate = readable(self.orbital_rate, "rad/s", GIVEN if self.rate is not None else 6)
        return f"gravity gradient of a circular orbit, {rate}, a revolution in {period}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def act(own: GravityGradient, t: float, desk: Desk) -> None:
    """Write force and torque on every body, whose points are their mass centres."""
    c, s = math.cos(own.orbital_rate * t), math.sin(own.orbital_rate * t)
    ex = c * own.down[0] + s * own.ahead[0]
    ey = c * own.down[1] + s * own.ahead[1]
    ez = c * own.down[2] + s * own.ahead[2]
    square = own.orbital_rate * own.orbital_rate
    links = desk[1]
    for i in range(links.shape[0]):
        link = links[i]
        p, r, inertia = link.place, link.rotation, link.inertia
        along = 3.0 * (ex * p[0] + ey * p[1] + ez * p[2])
        factor = link.mass * square
        link.force[0] = factor * (along * ex - p[0])
        link.force[1] = factor * (along * ey - p[1])
        link.force[2] = factor * (along * ez - p[2])
        # e and I e in the body's axes.
        ax = r[0, 0] * ex + r[1, 0] * ey + r[2, 0] * ez
        ay = r[0, 1] * ex + r[1, 1] * ey + r[2, 1] * ez
        az = r[0, 2] * ex + r[1, 2] * ey + r[2, 2] * ez
        hx = inertia[0, 0] * ax + inertia[0, 1] * ay + inertia[0, 2] * az
        hy = inertia[1, 0] * ax + inertia[1, 1] * ay + inertia[1, 2] * az
        hz = inertia[2, 0] * ax + inertia[2, 1] * ay + inertia[2, 2] * az
        mx, my, mz = ay * hz - az * hy, az * hx - ax * hz, ax * hy - ay * hx
        for k in range(3):
            link.torque[k] = 3.0 * square * (r[k, 0] * mx + r[k, 1] * my + r[k, 2] * mz)
