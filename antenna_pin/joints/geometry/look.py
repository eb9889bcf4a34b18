"""Descriptions of a kind of joint with play for figures and reports.

Each kind has its :class:`Look` beside its shape (:data:`antenna_pin.joints.geometry.LOOKS`); neither loads
coal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.readable import GIVEN, readable

Array = NDArray[np.float64]
Sizes = Mapping[str, float]
"""The dimensions of a shape by the names that its class has for them, [m] and [rad]."""
Picture = Literal["journal", "ball", "slider", "rod"]
"""Which close-up of :mod:`antenna_pin.show.record` shows it."""
Row = Literal["contact", "transverse", "radial", "axial"]
"""What is drawn of a joint's forces: their sizes as a whole, across the axis (by two names), or along it.

Joints of several kinds are drawn by the first of these that one of them has.
"""


class Across(NamedTuple):
    """Place of the journal in its play, at the inspected places."""

    places: tuple[str, ...]
    offset: Array  # (n, places, 3) [m], bearing axes
    eccentricity: Array  # (n, places) [m]
    ratio: Array  # (n, places) [-], 1 at the limit of rigid parts
    clearance: float  # [m]
    outline: Array  # (m, 2) [m], limit of the offset for rigid parts: a closed line in bearing axes
    # Limits of a centred journal; NaN where there is none.
    axial: float = math.nan  # [m]
    tilt: float = math.nan  # [rad]
    twist: float = math.nan  # [rad]


class Look(NamedTuple):
    """Description of a kind of joint with play for figures and reports.

    Attributes:
        held: Parts that hold it together, as text.
        dimensions: Description of its parts, from its dimensions.
        picture: Kind of its close-up.
        contacts: Kinds of its contacts.
        rows: Drawn forces, row by row.
        across: Place of the journal: from dimensions, its centre (n, 3) [m] and the direction of its axis (n,
            3), bearing axes.
        spatial: Whether all three directions of the offset count.
        faces: Outward direction of a contact's wall, x + i y in bearing axes, from dimensions and the
            contact's end; None where the contact's own point gives it.
        outline: Name of the outline of the play.
    """

    held: str
    dimensions: Callable[[Sizes], list[str]]
    picture: Picture
    contacts: frozenset[str]
    rows: tuple[Row, ...]
    across: Callable[[Sizes, Array, Array], Across]
    spatial: bool = False
    faces: Callable[[Sizes, str], complex] | None = None
    outline: str = "clearance circle"


def length(value: float) -> str:
    """Return a length that was given [m] in words."""
    return readable(value, "m", GIVEN)


def radial_words(hollow: str, radius: float, inner: str, inner_radius: float) -> str:
    """Return the description of a round part in a hollow: names and radii [m]."""
    return (
        f"radial clearance {length(radius - inner_radius)}: {hollow} of radius {length(radius)}, "
        f"{inner} of {length(inner_radius)}"
    )


def circle(radius: float) -> Array:
    """Return a closed circle about the origin, (n, 2) [m]."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def across_centre(p: Array, eccentricity: Array, clearance: float) -> Across:
    """Return the place of a journal with the same play in all directions.

    Args:
        p: Its centre, bearing axes, (n, 3) [m].
        eccentricity: Its distance from the place without play, (n, 1) [m].
        clearance: [m].
    """
    offset = p[:, None, :].copy()
    return Across(("centre",), offset, eccentricity, eccentricity / clearance, clearance, circle(clearance))
