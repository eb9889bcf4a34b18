"""How each kind of joint with play is looked at across its axis: one entry each."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from antenna_pin.analysis._run import Array

__all__ = ["JOURNAL_KINDS", "Across", "JournalKind"]


class Across(NamedTuple):
    """Where the journal is in its play, at the places where one looks."""

    places: tuple[str, ...]
    offset: Array  # (n, places, 3) [m], bearing axes
    eccentricity: Array  # (n, places) [m]
    ratio: Array  # (n, places) [-], 1 where rigid parts stop it
    clearance: float  # [m]
    outline: Array  # (m, 2) [m], what rigid parts leave the offset: a closed line in bearing axes
    # Limits of a centred journal; NaN where there is none.
    axial: float = math.nan  # [m]
    tilt: float = math.nan  # [rad]
    twist: float = math.nan  # [rad]


class JournalKind(NamedTuple):
    """What is to be known of a kind of joint."""

    # From dimensions [m], the journal's centre (n, 3) [m] and the direction of its axis (n, 3), bearing axes.
    across: Callable[[Mapping[str, float], Array, Array], Across]
    spatial: bool = False  # whether all three directions of the offset count
    # Which way a contact's wall faces out, x + i y in bearing axes, from dimensions and the contact's end;
    # None where the contact's own point says it.
    faces: Callable[[Mapping[str, float], str], complex] | None = None
    outline: str = "clearance circle"


def _circle(radius: float) -> Array:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _ends(p: Array, z: Array, half: float) -> Array:
    """Return where the journal's axis passes the cross sections at both ends of a bore, (n, 2, 3) [m]."""
    along = (np.array([half, -half]) - p[:, 2:]) / z[:, 2:]
    return np.asarray(p[:, None, :] + along[:, :, None] * z[:, None, :])


def _revolute(size: Mapping[str, float], p: Array, z: Array) -> Across:
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
        _circle(clearance),
        axial=0.5 * (size["flange_distance"] - size["bearing_length"]),
        tilt=2.0 * np.arctan2(clearance, half + root),
    )


def _planar(size: Mapping[str, float], p: Array, z: Array) -> Across:
    clearance = size["bearing_radius"] - size["journal_radius"]
    eccentricity = np.hypot(p[:, None, 0], p[:, None, 1])
    ratio = eccentricity / clearance
    return Across(("centre",), p[:, None, :].copy(), eccentricity, ratio, clearance, _circle(clearance))


def _spherical(size: Mapping[str, float], p: Array, z: Array) -> Across:
    clearance = size["socket_radius"] - size["ball_radius"]
    eccentricity = np.linalg.norm(p[:, None, :], axis=2)
    ratio = eccentricity / clearance
    return Across(("centre",), p[:, None, :].copy(), eccentricity, ratio, clearance, _circle(clearance))


def _prismatic(size: Mapping[str, float], p: Array, z: Array) -> Across:
    """The slider's axis at its own ends, which go along with it; the play is a rectangle, turned by the roll.

    A centred slider touches with a corner, the centre of whose rounding is at (a, b): a cos + b sin = c.
    """
    half = 0.5 * size["slider_length"]
    offset = p[:, None, :] + np.array([half, -half])[:, None] * z[:, None, :]
    guide = 0.5 * np.array([size["guide_width"], size["guide_height"]])
    slider = 0.5 * np.array([size["slider_width"], size["slider_height"]])
    play, corner = guide - slider, slider - size["corner_radius"]
    c, s = math.cos(size["roll"]), math.sin(size["roll"])
    turn = np.array([[c, -s], [s, c]])  # from the section's axes to the bearing's
    rectangle = play * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]])
    tilts = [_touches(a, half - size["corner_radius"], a + d) for a, d in zip(corner, play, strict=True)]
    twists = [_touches(a, b, a + d) for a, b, d in zip(corner, corner[::-1], play, strict=True)]
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


def _wall(size: Mapping[str, float], end: str) -> complex:
    """Return which way the wall of an end such as ``+x-y+z`` faces out."""
    return (1.0 if end[0] == "+" else -1.0) * (1j if end[1] == "y" else 1.0) * cmath.exp(1j * size["roll"])


def _touches(a: float, b: float, c: float) -> float:
    """Return the least angle at which a cos + b sin = c, for c > a; NaN if there is none [rad]."""
    left = b * b + a * a - c * c
    return math.nan if left < 0.0 else 2.0 * math.atan2(c - a, b + math.sqrt(left))


#: By the ``kind`` that a result carries.
JOURNAL_KINDS: dict[str, JournalKind] = {
    "revolute": JournalKind(_revolute),
    "planar": JournalKind(_planar),
    "spherical": JournalKind(_spherical, spatial=True),
    "prismatic": JournalKind(_prismatic, faces=_wall, outline="clearance rectangle"),
}
