"""A ball in a socket."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.dimension import RADIAL, Play, dimension
from antenna_pin.joints.geometry.look import Across, Array, Look, Sizes, across_centre, radial_words
from antenna_pin.joints.geometry.round_kernels import ROUND
from antenna_pin.joints.geometry.shape import (
    ContactPlace,
    Motion,
    RoundShape,
    flat,
)

if TYPE_CHECKING:
    from antenna_pin.joints.geometry.coal_pairs import CoalSpherical

# --- readings of results ------------------------------------------------------------------------------------


def _across(size: Sizes, p: Array, z: Array) -> Across:
    clearance = size["socket_radius"] - size["ball_radius"]
    return across_centre(p, np.linalg.norm(p[:, None, :], axis=2), clearance)


def _dimensions(size: Sizes) -> list[str]:
    return [radial_words("socket", size["socket_radius"], "ball", size["ball_radius"])]


LOOK = Look(
    held="a ball in a socket, held by contact alone",
    dimensions=_dimensions,
    picture="ball",
    contacts=frozenset({"spherical"}),
    rows=("contact",),  # without an axis there is neither radial nor axial
    across=_across,
    spatial=True,
)


# --- shape --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class SphericalClearance(RoundShape):
    """A ball in a socket with play: one contact, on the line of centres.

    The socket is a whole sphere: it holds the ball in every direction.

    Attributes:
        socket_radius: Of the hollow sphere [m].
        ball_radius: Below the socket's, on the child [m].

    References:
        Chen and Cui (2021), equations (6)-(9).
    """

    kind: ClassVar[str] = "spherical"
    look: ClassVar[Look] = LOOK
    planar: ClassVar[bool] = False
    motion: ClassVar[Motion | None] = None
    half_length: ClassVar[float | None] = None
    plays: ClassVar[tuple[Play, ...]] = (RADIAL._replace(outer="socket_radius", inner="ball_radius"),)
    no_line: ClassVar[str] = "a ball in a socket"

    socket_radius: float = dimension("bearing", key="bearing_radius")
    ball_radius: float = dimension("journal", key="journal_radius", below="socket_radius")

    @property
    def bearing_radius(self) -> float:
        """The hollow part's radius, by the name that all joints share [m]."""
        return self.socket_radius

    @property
    def journal_radius(self) -> float:
        """The inner part's radius, by the name that all joints share [m]."""
        return self.ball_radius

    @property
    def contact_places(self) -> tuple[ContactPlace, ...]:
        """The one candidate contact."""
        return (ContactPlace("spherical"),)

    def candidates(self, axes: ArrayLike) -> NDArray[np.float64]:
        """Return the record of the candidate contact as flat numbers, (1, CANDIDATE)."""
        return flat(ROUND, (kernels.BALL, self.bearing_radius, self.journal_radius, (0.0,) * 6))

    def coal(self, axes: ArrayLike) -> CoalSpherical:
        """Return the query of coal for the same distance."""
        from antenna_pin.joints.geometry.coal_pairs import CoalSpherical

        return CoalSpherical(self.bearing_radius, self.journal_radius)
