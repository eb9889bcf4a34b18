"""How a journal with flanges in a bore is looked at and told of."""

from __future__ import annotations

import numpy as np

from antenna_pin.geometry.look import Across, Array, Look, Sizes, circle, length, radial_words

__all__ = ["LOOK"]


def _ends(p: Array, z: Array, half: float) -> Array:
    """Return where the journal's axis passes the cross sections at both ends of a bore, (n, 2, 3) [m]."""
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
