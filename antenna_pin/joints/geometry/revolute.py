"""A journal with two flanges in a bearing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.records import CONTACT
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.dimension import RADIAL, Play, dimension
from antenna_pin.joints.geometry.look import Across, Array, Look, Sizes, circle, length, radial_words
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE, scenario_in
from antenna_pin.joints.geometry.shape import (
    ContactPlace,
    Motion,
    RoundShape,
    check_dimensions,
    flat,
    pose_of,
)

if TYPE_CHECKING:
    from antenna_pin.joints.geometry.coal_revolute import CoalRevolute

# --- readings of results ------------------------------------------------------------------------------------


def _ends(p: Array, z: Array, half: float) -> Array:
    """Return the journal's axis at both ends of the bore, (n, 2, 3) [m]."""
    along = (np.array([half, -half]) - p[:, 2:]) / z[:, 2:]
    return np.asarray(p[:, None, :] + along[:, :, None] * z[:, None, :])


def _across(size: Sizes, p: Array, z: Array) -> Across:
    clearance, half = size["bearing_radius"] - size["journal_radius"], 0.5 * size["bearing_length"]
    offset = _ends(p, z, half)
    eccentricity = np.hypot(offset[..., 0], offset[..., 1])
    # A centred journal touches both ends: R_i cos - L_i / 2 sin = R_j.
    root = np.sqrt(half**2 + (size["bearing_radius"] + size["journal_radius"]) * clearance)
    return Across(
        ("+", "-"),
        offset,
        eccentricity,
        eccentricity / clearance,
        clearance,
        circle(clearance),
        axial=0.5 * (size["flange_distance"] - size["bearing_length"]),
        tilt=2.0 * np.arctan2(clearance, half + root),
    )


def _dimensions(size: Sizes) -> list[str]:
    play = 0.5 * (size["flange_distance"] - size["bearing_length"])
    return [
        radial_words("bore", size["bearing_radius"], "journal", size["journal_radius"]),
        f"axial clearance {length(play)} at each flange: bearing "
        f"{length(size['bearing_length'])} long, flanges {length(size['flange_distance'])} apart",
        f"bearing's outer radius {length(size['bearing_outer_radius'])}, flanges' radius "
        f"{length(size['flange_radius'])}",
    ]


LOOK = Look(
    held="a journal with flanges in a bore, held by contact alone",
    dimensions=_dimensions,
    picture="journal",
    contacts=frozenset({"radial", "axial"}),
    rows=("radial", "axial"),
    across=_across,
)


# --- shape --------------------------------------------------------------------------------------------------

#: Greatest depth of a hard preload, over the bearing's radius: that at which contact stiffness still applies.
HARDEST = 0.01
#: Outer radius of a bearing over that of its bore, where a scenario does not give it [-]: a thick plain bush.
OUTER = 1.5

_AXIAL = Play(
    "axial_clearance",
    "flange_distance",
    "bearing_length",
    "C_a at each flange when centred, below 0 a hard preload; if left out, from the flanges, else the radial "
    "one [m].",
    share=2.0,
    rule="",
    along=True,
    like="radial_clearance",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RevoluteClearance(RoundShape):
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
        bearing_radius: R_i, radius of the bore [m].
        journal_radius: R_j, below R_i [m].
        bearing_length: L_i [m].
        flange_distance: L_j = L_i + 2 C_a, between the flanges' inner faces [m]

            Below L_i both faces are pressed by -C_a in the centred place, a hard preload; by at most a
            hundredth of R_i.
        bearing_outer_radius: R_io, above R_i [m].
        flange_radius: R_f, above R_i [m].

    References:
        Bai and Zhao (2020), equations (2)-(8); the gaps here are the exact minima, which their (3)
        approximates.
    """

    kind: ClassVar[str] = "revolute"
    look: ClassVar[Look] = LOOK
    planar: ClassVar[bool] = False
    motion: ClassVar[Motion] = "turn"
    plays: ClassVar[tuple[Play, ...]] = (RADIAL, _AXIAL)
    ends: ClassVar[int] = 2

    bearing_radius: float = dimension("bearing")
    journal_radius: float = dimension("journal", below="bearing_radius")
    bearing_length: float = dimension("bearing")
    flange_distance: float = dimension("journal")
    bearing_outer_radius: float = dimension(
        "bearing", above="bearing_radius", times=(OUTER, "bearing_radius"), words="outer radius"
    )
    flange_radius: float = dimension(
        "journal",
        above="bearing_radius",
        times=(1.0, "bearing_outer_radius"),
        words="flanges of radius",
    )

    def __post_init__(self) -> None:
        """Check the dimensions."""
        check_dimensions(self)
        # A difference of round-off size is an axial clearance of zero.
        hardest = 2.0 * HARDEST * self.bearing_radius + 1e-12 * self.bearing_length
        if not self.flange_distance >= self.bearing_length - hardest:
            raise InvalidParameterError(
                self,
                "flange_distance",
                f"at least bearing_length = {self.bearing_length:g} m, or for a hard preload less by at most "
                f"{2.0 * HARDEST:g} bearing_radius",
            )

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
        """Return the shape by its clearances C_r and C_a [m]."""
        return cls(
            bearing_radius=bearing_radius,
            journal_radius=bearing_radius - radial_clearance,
            bearing_length=bearing_length,
            flange_distance=bearing_length + 2.0 * axial_clearance,
            bearing_outer_radius=bearing_outer_radius,
            flange_radius=flange_radius,
        )

    @property
    def patch_radius(self) -> float:
        """Root mean square radius of a flange's loaded annulus [m].

        A ring there has the annulus' second moment, so a uniform modulus resists compression and tilt as over
        the whole annulus.
        """
        outer = min(self.bearing_outer_radius, self.flange_radius)
        return math.sqrt(0.5 * (outer**2 + self.bearing_radius**2))

    @property
    def axial_clearance(self) -> float:
        """C_a [m]."""
        return 0.5 * (self.flange_distance - self.bearing_length)

    @property
    def half_length(self) -> float:
        """Half the bearing's length [m]."""
        return 0.5 * self.bearing_length

    @property
    def contact_places(self) -> tuple[ContactPlace, ...]:
        """Bore and flange at both ends."""
        return tuple(ContactPlace(kind, end) for kind in ("radial", "axial") for end in "+-")

    def candidates(self, axes: ArrayLike) -> NDArray[np.float64]:
        """Return the records of the candidate contacts as flat numbers, (4, CANDIDATE)."""
        return flat(
            REVOLUTE, *(self._record(p, s) for p in (kernels.BORE, kernels.FLANGE) for s in (1.0, -1.0))
        )

    def dimensions(self) -> NDArray[Any]:
        """Return the dimensions as the kernels' record, (1,)."""
        return np.array([self._record(kernels.BORE, 1.0)], dtype=REVOLUTE)

    def _record(self, primitive: int, side: float) -> tuple[float, ...]:
        return (
            primitive,
            side,
            self.bearing_radius,
            0.5 * self.bearing_length,
            self.bearing_outer_radius,
            self.journal_radius,
            self.flange_radius,
            0.5 * self.flange_distance,
            0.0,
        )

    def coal(self, axes: ArrayLike) -> CoalRevolute:
        """Return the queries of coal for the same distances."""
        from antenna_pin.joints.geometry.coal_revolute import CoalRevolute

        return CoalRevolute(self.dimensions())

    def scenario(self, p_HJ: ArrayLike, attitude: ArrayLike) -> tuple[RadialScenario, AxialScenario]:
        """Return the contact scenario of a pose (:func:`antenna_pin.joints.geometry.pose_of`)."""
        radial, axial = revolute_scenario(self.dimensions(), pose_of(p_HJ, attitude))
        return RadialScenario(radial), AxialScenario(axial)


def revolute_scenario(dimensions: NDArray[Any], pose: NDArray[Any]) -> tuple[int, int]:
    """Return the contact scenario of a pose, of bore and flanges.

    Args:
        dimensions: REVOLUTE, (1,); a journal longer or thicker than can be built is allowed.
        pose: POSE, (1,).
    """
    radial, axial = scenario_in(dimensions, pose, np.zeros(5, CONTACT))
    return int(radial), int(axial)


# --- contact scenarios --------------------------------------------------------------------------------------


class RadialScenario(IntEnum):
    """Scenario of radial contact, in the bore; numbers as in the kernels."""

    NONE = 0
    ONE_POINT = 1
    TWO_POINTS = 2
    LINE = 3


class AxialScenario(IntEnum):
    """Scenario of axial contact, at the flanges; numbers as in the kernels."""

    NONE = 0
    ONE_POINT = 1
    TWO_POINTS = 2
    SURFACE = 3
