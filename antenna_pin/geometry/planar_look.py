"""How a journal in a bore that keeps its plane is looked at and told of."""

from __future__ import annotations

import numpy as np

from antenna_pin.geometry.look import Across, Array, Look, Sizes, across_centre, radial_words

__all__ = ["LOOK"]


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
