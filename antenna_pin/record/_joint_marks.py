"""Joints, drawn as a pin along the axis each: those with play apart from those without."""

from __future__ import annotations

import json

from antenna_pin.record._marking import Label, Mark, Marking, rgb
from antenna_pin.record.shapes import Cylinder, Geometry, Sphere

__all__ = ["JOINT", "PLAY", "mark_joints"]

JOINT, PLAY = "#3B4552", "#CC3311"

# As shares of the mechanism's size: a pin's radius and length, the radius of a ball.
_PIN = (0.0025, 0.07)
_BALL = 0.007


def mark_joints(marking: Marking) -> Mark | None:
    """Put a pin on each moving joint, a ball where it is one; drawn over what hides them.

    Args:
        marking: What it is made of.
    """
    places = json.loads(marking.run.data.attrs.get("clearance_joints", "{}"))
    found, labels = [], []
    for name in marking.mechanism.joints:
        on, place = marking.seat(name)
        ball = places.get(name, {}).get("kind") == "spherical"
        radius, length = (share * marking.size for share in _PIN)
        shape: Geometry = Sphere(_BALL * marking.size) if ball else Cylinder(radius, length)
        colour = PLAY if name in places else JOINT
        found.append(f"{on}/joint {name}".replace("//", "/"))
        marking.scene.add(found[-1], shape, (*rgb(colour), 0.9), place, unlit=True, depthTest=False)
        x, y, z = map(float, place[:3, 3])
        labels.append(Label(name, on, (x, y, z)))
    if not found:
        return None
    words = "joints, their axes (red: with play)" if places else "joints, their axes"
    return Mark(words, JOINT, tuple(found), shown=False, labels=tuple(labels))
