"""How a round slider in a guide is looked at and told of."""

from __future__ import annotations

import math

import numpy as np

from antenna_pin.geometry.look import Across, Array, Look, Sizes, circle, length, radial_words
from antenna_pin.geometry.prismatic_look import clamped, guide_words, mouths, touches

__all__ = ["LOOK"]


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
