"""Shapes of joints with play: where journal and bearing meet and how deep, in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.errors import InvalidParameterError
from antenna_pin.geometry import _kernels

__all__ = [
    "TABLE_WIDTH",
    "AxialScenario",
    "ClearanceGeometry",
    "ContactPoint",
    "PlanarClearance",
    "RadialScenario",
    "RevoluteClearance",
    "SphericalClearance",
]

Vector3 = NDArray[np.float64]

TABLE_WIDTH = _kernels.TABLE_WIDTH


class RadialScenario(IntEnum):
    """How the journal touches the bore."""

    NONE = _kernels.NONE
    ONE_POINT = _kernels.ONE_POINT
    TWO_POINTS = _kernels.TWO_POINTS
    LINE = _kernels.EXTENDED


class AxialScenario(IntEnum):
    """How the flanges touch the bearing's end faces."""

    NONE = _kernels.NONE
    ONE_POINT = _kernels.ONE_POINT
    TWO_POINTS = _kernels.TWO_POINTS
    SURFACE = _kernels.EXTENDED


class ContactPoint(NamedTuple):
    """One place where journal and bearing may touch, in bearing axes."""

    gap: float  # [m]; positive apart, so its zero can be located
    normal: Vector3  # (3,), unit, the way the bearing pushes the journal
    point: Vector3  # (3,) [m], from the bearing's centre

    @property
    def depth(self) -> float:
        """Penetration depth [m], zero when apart."""
        return max(-self.gap, 0.0)


class ClearanceGeometry(Protocol):
    """Shape of a joint with play, whatever computes its distances."""

    @property
    def contact_places(self) -> tuple[tuple[str, str], ...]:
        """Kind and end of each candidate contact, in the order of :meth:`contacts`."""

    def contacts(self, p_HJ: ArrayLike, axis_J_H: ArrayLike) -> tuple[ContactPoint, ...]:
        """Return the candidate contacts of a pose."""


def points_of_table(table: NDArray[np.float64]) -> tuple[ContactPoint, ...]:
    """Return the rows of a contact table as named values."""
    return tuple(ContactPoint(float(row[0]), row[1:4].copy(), row[4:7].copy()) for row in table)


Pose = tuple[float, float, float, float, float, float]


def pose_of(p_HJ: ArrayLike, axis_J_H: ArrayLike) -> Pose:
    """Return a pose as six floats, the axis made unit."""
    p = np.asarray(p_HJ, dtype=float)
    z = np.asarray(axis_J_H, dtype=float)
    if p.shape != (3,) or z.shape != (3,) or not (np.isfinite(p).all() and np.isfinite(z).all()):
        raise InvalidParameterError("contacts", "pose", "two finite vectors of three numbers", (p, z))
    length = float(np.linalg.norm(z))
    if length == 0.0:
        raise InvalidParameterError("contacts", "axis_J_H", "a nonzero vector", z)
    ox, oy, oz = p.tolist()
    zx, zy, zz = (z / length).tolist()
    return ox, oy, oz, zx, zy, zz


def _require_lengths(shape: object, names: tuple[str, ...]) -> None:
    for name in names:
        if not 0.0 < getattr(shape, name) < math.inf:
            raise InvalidParameterError(shape, name, "a positive length [m]")


@dataclass(frozen=True, slots=True, kw_only=True)
class RevoluteClearance:
    r"""A journal with two flanges in a bearing, with radial and axial play.

    Radial contact is sought on the bearing's two end circles, axial contact on the outer edges of its end
    faces (or on the rims of smaller flanges). Candidates, in this order: bore at the +z end, bore at the -z
    end, flange at the +z end, flange at the -z end.

    .. math:: C_r = R_i - R_j, \qquad C_a = (L_j - L_i) / 2

    The smaller of the two edges counts: the bearing's outer edge against the plane of a flange that covers
    it, else the flange's rim against the plane of the end face. Where the radii differ by less than the
    radial play the edge point may overhang the opposite face by up to the eccentricity; it is kept, at an
    error in depth of at most eccentricity times tilt, because force and energy stay continuous that way.

    Attributes:
        bearing_radius: R_i, of the bore [m].
        journal_radius: R_j, below R_i [m].
        bearing_length: L_i [m].
        flange_distance: L_j, between the flanges' inner faces, at least L_i [m].
        bearing_outer_radius: R_io, above R_i [m].
        flange_radius: R_f, above R_i [m].

    References:
        Bai and Zhao (2020), equations (2)-(8); the gaps here are the exact minima, which their (3)
        approximates.
    """

    bearing_radius: float
    journal_radius: float
    bearing_length: float
    flange_distance: float
    bearing_outer_radius: float
    flange_radius: float

    def __post_init__(self) -> None:
        """Check the dimensions."""
        _require_lengths(
            self,
            (
                "bearing_radius",
                "journal_radius",
                "bearing_length",
                "flange_distance",
                "bearing_outer_radius",
                "flange_radius",
            ),
        )
        if not self.journal_radius < self.bearing_radius:
            raise InvalidParameterError(
                self, "journal_radius", f"below bearing_radius = {self.bearing_radius:g} m"
            )
        # A difference of round-off size is an axial clearance of zero.
        if not self.flange_distance >= self.bearing_length * (1.0 - 1e-12):
            raise InvalidParameterError(
                self, "flange_distance", f"at least bearing_length = {self.bearing_length:g} m"
            )
        for name in ("bearing_outer_radius", "flange_radius"):
            if not getattr(self, name) > self.bearing_radius:
                raise InvalidParameterError(self, name, f"above bearing_radius = {self.bearing_radius:g} m")

    @classmethod
    def from_clearances(
        cls,
        *,
        bearing_radius: float,
        radial_clearance: float,
        bearing_length: float,
        axial_clearance: float,
        bearing_outer_radius: float,
        flange_radius: float,
    ) -> RevoluteClearance:
        """Return the shape with journal radius R_i - C_r and flange distance L_i + 2 C_a (all [m])."""
        return cls(
            bearing_radius=bearing_radius,
            journal_radius=bearing_radius - radial_clearance,
            bearing_length=bearing_length,
            flange_distance=bearing_length + 2.0 * axial_clearance,
            bearing_outer_radius=bearing_outer_radius,
            flange_radius=flange_radius,
        )

    @property
    def radial_clearance(self) -> float:
        """C_r [m]."""
        return self.bearing_radius - self.journal_radius

    @property
    def axial_clearance(self) -> float:
        """C_a [m]."""
        return 0.5 * (self.flange_distance - self.bearing_length)

    @property
    def contact_places(self) -> tuple[tuple[str, str], ...]:
        """Kind of each candidate contact, and the bearing's end that it is at ("+", "-" or none)."""
        return (("radial", "+"), ("radial", "-"), ("axial", "+"), ("axial", "-"))

    def shape(self) -> NDArray[np.float64]:
        """Return the flat numbers of the kernels: [R_i, L_i/2, R_io, R_j, R_f, L_j/2] [m]."""
        return np.array(
            [
                self.bearing_radius,
                0.5 * self.bearing_length,
                self.bearing_outer_radius,
                self.journal_radius,
                self.flange_radius,
                0.5 * self.flange_distance,
            ]
        )

    def contacts(self, p_HJ: ArrayLike, axis_J_H: ArrayLike) -> tuple[ContactPoint, ...]:
        """Return the four candidate contacts.

        Args:
            p_HJ: Journal centre from the bearing centre, bearing axes, (3,) [m].
            axis_J_H: Direction of the journal's axis in bearing axes, (3,).
        """
        table = np.zeros((4, TABLE_WIDTH))
        _kernels.revolute_contacts(self.shape(), *pose_of(p_HJ, axis_J_H), table, 0)
        return points_of_table(table)

    def scenario(self, p_HJ: ArrayLike, axis_J_H: ArrayLike) -> tuple[RadialScenario, AxialScenario]:
        """Return the contact scenario of a pose, from its penetrations.

        Args:
            p_HJ: Journal centre from the bearing centre, bearing axes, (3,) [m].
            axis_J_H: Direction of the journal's axis in bearing axes, (3,).
        """
        table = np.zeros((5, TABLE_WIDTH))
        pose = pose_of(p_HJ, axis_J_H)
        _kernels.revolute_contacts(self.shape(), *pose, table, 0)
        radial, axial = _kernels.contact_scenario(self.shape(), *pose, table, 0, 4)
        return RadialScenario(radial), AxialScenario(axial)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarClearance:
    """A journal in a bore that keeps its plane: radial play only, one candidate contact.

    Attributes:
        bearing_radius: R_i [m].
        journal_radius: R_j, below R_i [m].
    """

    bearing_radius: float
    journal_radius: float

    def __post_init__(self) -> None:
        """Check the dimensions."""
        _require_lengths(self, ("bearing_radius", "journal_radius"))
        if not self.journal_radius < self.bearing_radius:
            raise InvalidParameterError(
                self, "journal_radius", f"below bearing_radius = {self.bearing_radius:g} m"
            )

    @property
    def radial_clearance(self) -> float:
        """C_r [m]."""
        return self.bearing_radius - self.journal_radius

    @property
    def contact_places(self) -> tuple[tuple[str, str], ...]:
        """Kind of each candidate contact, and the bearing's end that it is at ("+", "-" or none)."""
        return (("radial", ""),)

    def shape(self) -> NDArray[np.float64]:
        """Return the flat numbers of the kernels: [R_i, R_j] [m]."""
        return np.array([self.bearing_radius, self.journal_radius])

    def contacts(self, p_HJ: ArrayLike, axis_J_H: ArrayLike = (0.0, 0.0, 1.0)) -> tuple[ContactPoint, ...]:
        """Return the one candidate contact; the axis is ignored, it stays the bearing's own."""
        table = np.zeros((1, TABLE_WIDTH))
        pose = pose_of(p_HJ, axis_J_H)
        _kernels.planar_contact(self.shape(), pose[0], pose[1], table, 0)
        return points_of_table(table)


@dataclass(frozen=True, slots=True, kw_only=True)
class SphericalClearance:
    """A ball in a socket with play: one candidate contact, on the line of the two centres.

    The socket is taken as a whole sphere: it holds the ball in every direction.

    Attributes:
        socket_radius: Of the hollow sphere, on the parent [m].
        ball_radius: Below the socket's, on the child [m].

    References:
        Chen and Cui (2021), equations (6)-(9).
    """

    socket_radius: float
    ball_radius: float

    def __post_init__(self) -> None:
        """Check the dimensions."""
        _require_lengths(self, ("socket_radius", "ball_radius"))
        if not self.ball_radius < self.socket_radius:
            raise InvalidParameterError(
                self, "ball_radius", f"below socket_radius = {self.socket_radius:g} m"
            )

    @property
    def bearing_radius(self) -> float:
        """The hollow part's radius, by the name that all joints share [m]."""
        return self.socket_radius

    @property
    def journal_radius(self) -> float:
        """The inner part's radius, by the name that all joints share [m]."""
        return self.ball_radius

    @property
    def radial_clearance(self) -> float:
        """Socket radius minus ball radius [m]."""
        return self.socket_radius - self.ball_radius

    @property
    def contact_places(self) -> tuple[tuple[str, str], ...]:
        """Kind of each candidate contact, and the bearing's end that it is at ("+", "-" or none)."""
        return (("spherical", ""),)

    def shape(self) -> NDArray[np.float64]:
        """Return the flat numbers of the kernels: [R_socket, R_ball] [m]."""
        return np.array([self.socket_radius, self.ball_radius])

    def contacts(self, p_HJ: ArrayLike, axis_J_H: ArrayLike = (0.0, 0.0, 1.0)) -> tuple[ContactPoint, ...]:
        """Return the one candidate contact; the axis is ignored."""
        table = np.zeros((1, TABLE_WIDTH))
        pose = pose_of(p_HJ, axis_J_H)
        _kernels.spherical_contact(self.shape(), pose[0], pose[1], pose[2], table, 0)
        return points_of_table(table)
