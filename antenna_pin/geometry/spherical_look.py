"""How a ball in a socket is looked at and told of."""

from __future__ import annotations

import numpy as np

from antenna_pin.geometry.look import Across, Array, Look, Sizes, across_centre, radial_words

__all__ = ["LOOK"]


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
