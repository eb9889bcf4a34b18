"""A round slider in a round guide."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.dimension import RADIAL, Play, dimension
from antenna_pin.joints.geometry.look import Across, Array, Look, Sizes, circle, length, radial_words
from antenna_pin.joints.geometry.prismatic import (
    clamped,
    guide_words,
    guided_length,
    mouths,
    touches,
    walls,
)
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE
from antenna_pin.joints.geometry.shape import (
    ContactPlace,
    Motion,
    RoundShape,
    check_dimensions,
    flat,
    require_below,
)

if TYPE_CHECKING:
    from antenna_pin.joints.geometry.coal_pairs import CoalPrismatic

# --- readings of results ------------------------------------------------------------------------------------


def _across(size: Sizes, p: Array, z: Array) -> Across:
    """The slider's axis at the ends of what of it is within the guide."""
    half, guide = 0.5 * size["slider_length"], size["guide_length"]
    outer, inner = size["bearing_radius"], size["journal_radius"]
    offset = clamped(p, z, half, guide)
    eccentricity = np.hypot(offset[..., 0], offset[..., 1])
    short = guide and guide < size["slider_length"]
    twist = math.nan
    if size["key_width"]:
        twist = touches(0.5 * size["key_width"], size["key_reach"], 0.5 * size["keyway_width"])
    return Across(
        ("+", "-"),
        offset,
        eccentricity,
        eccentricity / (outer - inner),
        outer - inner,
        circle(outer - inner),
        tilt=mouths(0.5 * guide, outer, inner) if short else touches(inner, half, outer),
        twist=twist,
    )


def _dimensions(size: Sizes) -> list[str]:
    parts = [
        radial_words("guide", size["bearing_radius"], "slider", size["journal_radius"]),
        f"slider {length(size['slider_length'])} long",
        *guide_words(size),
    ]
    if size["key_width"]:
        parts.append(
            f"key {length(size['key_width'])} wide in a keyway of {length(size['keyway_width'])}, bearing "
            f"{length(size['key_reach'])} from the axis"
        )
    return parts


LOOK = Look(
    held="a round slider in a guide, held by contact alone",
    dimensions=_dimensions,
    picture="rod",
    contacts=frozenset({"radial", "key"}),
    rows=("radial",),
    across=_across,
)


# --- shape --------------------------------------------------------------------------------------------------

_SIGNS = ((1.0, "+"), (-1.0, "-"))
_KEY = ("key_width", "keyway_width", "key_reach")


@dataclass(frozen=True, slots=True, kw_only=True)
class CylindricalClearance(RoundShape):
    """A round slider in a round guide: it slides, and turns without a key.

    Candidates ``radial+`` and ``radial-`` are the two ends of the slider's part within the guide: the rim of
    the slider's end on the wall where it ends within, the mouth's edge on the slider's barrel where it
    protrudes. Nothing stops the slider along the axis, and one that has left is free of the guide, except for
    its block's face.

    A key on the slider, at its +x, slides in a keyway with play of its own: candidate ``key+y-z`` is its
    flank at +y, at the -z end.

    Attributes:
        bearing_radius: R_i, of the guide [m].
        journal_radius: R_j, of the slider, below R_i [m].
        slider_length: Along the axis [m].
        guide_length: Along the axis; 0 for a guide longer than the slider's travel [m].
        key_width: Of a key that keeps a round slider from turning; 0 for none [m].
        keyway_width: Above the key's [m].
        key_reach: From the axis to the load-bearing part of the key's flanks [m].
    """

    kind: ClassVar[str] = "cylindrical"
    look: ClassVar[Look] = LOOK
    planar: ClassVar[bool] = False
    motion: ClassVar[Motion] = "slide"
    plays: ClassVar[tuple[Play, ...]] = (RADIAL, Play("", "keyway_width", "key_width", share=2.0))
    no_line: ClassVar[str] = "the end of a round slider"

    bearing_radius: float = dimension("bearing")
    journal_radius: float = dimension("journal", below="bearing_radius")
    slider_length: float = dimension("journal")
    guide_length: float = dimension("bearing", rule="zero or more", default=0.0)
    key_width: float = dimension("journal", rule="zero or more", default=0.0)
    keyway_width: float = dimension("bearing", rule="zero or more", default=0.0)
    key_reach: float = dimension("journal", rule="zero or more", default=0.0)

    def __post_init__(self) -> None:
        """Check the dimensions."""
        check_dimensions(self)
        given = [getattr(self, name) for name in _KEY]
        if any(given):
            for name, length in zip(_KEY, given, strict=True):
                if not length:
                    raise InvalidParameterError(self, name, "positive, as a key has all three")
            require_below(self, "key_width", "keyway_width")

    @property
    def half_length(self) -> float:
        """Half the guided length of a centred slider [m]."""
        return 0.5 * guided_length(self.slider_length, self.guide_length)

    @property
    def contact_places(self) -> tuple[ContactPlace, ...]:
        """Both ends, then the key's flanks."""
        keys = [ContactPlace("key", end) for end, *_ in self._flanks()]
        return (ContactPlace("radial", "+"), ContactPlace("radial", "-"), *keys)

    def _flanks(self) -> list[tuple[str, NDArray[np.float64], NDArray[np.float64], float]]:
        """Return name, corner, inward normal and distance of the keyway's wall of the key's candidates."""
        if not self.key_width:
            return []
        found = []
        for (flank, w), (along, z) in itertools.product(_SIGNS, _SIGNS):
            corner = np.array(
                [self.key_reach, 0.5 * flank * self.key_width, 0.5 * along * self.slider_length]
            )
            found.append((f"{w}y{z}z", corner, np.array([0.0, -flank, 0.0]), 0.5 * self.keyway_width))
        return found

    def candidates(self, axes: ArrayLike) -> NDArray[np.float64]:
        """Return the records of the candidate contacts as flat numbers, (2 or 6, CANDIDATE)."""
        in_child = np.asarray(axes, dtype=float)
        half = 0.5 * self.guide_length if self.guide_length else math.inf
        ends = (
            (
                kernels.ROD_IN_GUIDE,
                side,
                self.bearing_radius,
                half,
                0.0,
                self.journal_radius,
                0.0,
                0.5 * self.slider_length,
                0.0,
            )
            for side, _ in _SIGNS
        )
        flanks = [(in_child @ corner, wall, at) for _, corner, wall, at in self._flanks()]
        rows = [flat(REVOLUTE, *ends)]
        return np.concatenate([*rows, walls(flanks, 0.0, self.guide_length)] if flanks else rows)

    def coal(self, axes: ArrayLike) -> CoalPrismatic:
        """Return the queries of coal for the same distances."""
        from antenna_pin.joints.geometry.coal_pairs import CoalPrismatic

        return CoalPrismatic(self.candidates(axes))
