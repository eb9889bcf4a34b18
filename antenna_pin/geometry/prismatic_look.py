"""How a slider in a guide is looked at and told of."""

from __future__ import annotations

import cmath
import math

import numpy as np

from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.geometry.look import Across, Array, Look, Sizes, length

__all__ = ["LOOK", "clamped", "guide_words", "mouths", "touches"]


def _across(size: Sizes, p: Array, z: Array) -> Across:
    """The slider's axis at the ends of what is within the guide; the play is a rectangle, turned by the roll.

    A centred slider touches with a corner, the centre of whose rounding is at (a, b): a cos + b sin = c.
    """
    half = 0.5 * size["slider_length"]
    guided = size.get("guide_length", 0.0)
    offset = clamped(p, z, half, guided)
    guide = 0.5 * np.array([size["guide_width"], size["guide_height"]])
    slider = 0.5 * np.array([size["slider_width"], size["slider_height"]])
    play, corner = guide - slider, slider - size["corner_radius"]
    c, s = math.cos(size["roll"]), math.sin(size["roll"])
    turn = np.array([[c, -s], [s, c]])  # from the section's axes to the bearing's
    rectangle = play * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]])
    if guided and guided < size["slider_length"]:
        tilts = [mouths(0.5 * guided, a, b) for a, b in zip(guide, slider, strict=True)]
    else:
        tilts = [touches(a, half - size["corner_radius"], a + d) for a, d in zip(corner, play, strict=True)]
    twists = [touches(a, b, a + d) for a, b, d in zip(corner, corner[::-1], play, strict=True)]
    return Across(
        ("+", "-"),
        offset,
        np.hypot(offset[..., 0], offset[..., 1]),
        np.max(np.abs(offset[..., :2] @ turn) / play, axis=2),
        float(play.min()),
        rectangle @ turn.T,
        tilt=math.hypot(*tilts),  # both ways at once
        twist=float(np.fmin.reduce(twists)),
    )


def _wall(size: Sizes, end: str) -> complex:
    """Return which way the wall of an end such as ``+x-y+z`` faces out."""
    return (1.0 if end[0] == "+" else -1.0) * (1j if end[1] == "y" else 1.0) * cmath.exp(1j * size["roll"])


def clamped(p: Array, z: Array, half: float, guide: float) -> Array:
    """Return a slider's axis at the ends of what of it is within its guide, (n, 2, 3) [m].

    Args:
        p: Its centre, (n, 3) [m].
        z: Its axis, (n, 3).
        half: Half its length [m].
        guide: The guide's length [m]; 0 for one without end.
    """
    along = np.array([half, -half])[None, :] * np.ones((len(p), 1))
    if guide:
        ends = p[:, 2:] + along * z[:, 2:]
        along = (np.clip(ends, -0.5 * guide, 0.5 * guide) - p[:, 2:]) / z[:, 2:]
    return np.asarray(p[:, None, :] + along[:, :, None] * z[:, None, :])


def mouths(half: float, outer: float, inner: float) -> float:
    """Return the tilt at which a centred slider touches both mouths: outer cos - half sin = inner [rad]."""
    play = outer - inner
    return 2.0 * math.atan2(play, half + math.sqrt(half * half + (outer + inner) * play))


def guide_words(size: Sizes) -> list[str]:
    """Return in words how long a guide is that ends."""
    guide = size.get("guide_length", 0.0)
    return [f"guide {length(guide)} long"] if guide else []


def touches(a: float, b: float, c: float) -> float:
    """Return the least angle at which a cos + b sin = c, for c > a; NaN if there is none [rad]."""
    left = b * b + a * a - c * c
    return math.nan if left < 0.0 else 2.0 * math.atan2(c - a, b + math.sqrt(left))


def _dimensions(size: Sizes) -> list[str]:
    play = {side: 0.5 * (size[f"guide_{side}"] - size[f"slider_{side}"]) for side in ("width", "height")}
    parts = [
        f"guide {length(size['guide_width'])} wide and {length(size['guide_height'])} high, slider "
        f"{length(size['slider_width'])} wide, {length(size['slider_height'])} high and "
        f"{length(size['slider_length'])} long",
        f"clearance {length(play['width'])} to each side along the width, {length(play['height'])} along the "
        "height",
    ]
    parts += guide_words(size)
    if size["corner_radius"]:
        parts.append(f"slider's edges rounded by {length(size['corner_radius'])}")
    if size["roll"]:
        parts.append(f"section turned by {readable(size['roll'], 'rad', GIVEN)} about the axis")
    return parts


LOOK = Look(
    held="a rectangular slider in a guide, held by contact alone",
    dimensions=_dimensions,
    picture="slider",
    contacts=frozenset({"wall"}),
    rows=("transverse",),
    across=_across,
    faces=_wall,
    outline="clearance rectangle",
)
