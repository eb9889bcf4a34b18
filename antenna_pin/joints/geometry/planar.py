"""Planar joint: a journal in a bore, restricted to its plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.dimension import dimension
from antenna_pin.joints.geometry.look import Across, Array, Look, Sizes, across_centre, radial_words
from antenna_pin.joints.geometry.round_kernels import ROUND
from antenna_pin.joints.geometry.shape import (
    ContactPlace,
    Motion,
    RoundShape,
    flat,
)

if TYPE_CHECKING:
    from antenna_pin.joints.geometry.coal_pairs import CoalPlanar

# --- readings of results ------------------------------------------------------------------------------------


def _across(size: Sizes, p: Array, z: Array) -> Across:
    clearance = size["bearing_radius"] - size["journal_radius"]
    return across_centre(p, np.hypot(p[:, None, 0], p[:, None, 1]), clearance)


def _dimensions(size: Sizes) -> list[str]:
    return [radial_words("bore", size["bearing_radius"], "journal", size["journal_radius"])]


LOOK = Look(
    held="a journal in a bore, held in the plane by contact alone",
    dimensions=_dimensions,
    picture="journal",
    contacts=frozenset({"radial"}),
    rows=("radial",),
    across=_across,
)


# --- shape --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarClearance(RoundShape):
    """Journal in a bore, restricted to its plane: radial play only, one candidate contact.

    Attributes:
        bearing_radius: R_i, radius of the bore [m].
        journal_radius: R_j, below R_i [m].
    """

    kind: ClassVar[str] = "planar"
    look: ClassVar[Look] = LOOK
    planar: ClassVar[bool] = True
    motion: ClassVar[Motion | None] = "turn"
    half_length: ClassVar[float | None] = None

    bearing_radius: float = dimension("bearing")
    journal_radius: float = dimension("journal", below="bearing_radius")

    @property
    def contact_places(self) -> tuple[ContactPlace, ...]:
        """The one candidate contact."""
        return (ContactPlace("radial"),)

    def candidates(self, axes: ArrayLike) -> NDArray[np.float64]:
        """Return the record of the candidate contact as flat numbers, (1, CANDIDATE)."""
        return flat(ROUND, (kernels.CIRCLE_IN_CIRCLE, self.bearing_radius, self.journal_radius, (0.0,) * 6))

    def coal(self, axes: ArrayLike) -> CoalPlanar:
        """Return the query of coal for the same distance."""
        from antenna_pin.joints.geometry.coal_pairs import CoalPlanar

        return CoalPlanar(self.bearing_radius, self.journal_radius)
