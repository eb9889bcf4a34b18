"""Distance between a rounded corner of a slider and a wall of its guide, compiled."""

from __future__ import annotations

from typing import Any

from antenna_pin.base.records import layout
from antenna_pin.compiled.decorators import kernel

#: The centre of a corner's rounding, from the journal's centre in the *child's* axes [m], a plane wall in
#: bearing axes: its normal into the hollow and its distance from the bearing's centre [m], and the corner's
#: radius [m].
CORNER = layout(
    ("primitive", "i8"),
    ("corner", "f8", (3,)),
    ("wall", "f8", (3,)),
    ("distance", "f8"),
    ("radius", "f8"),
)


@kernel
def corner_contact(shape: Any, pose: Any, out: Any) -> None:
    """Candidate between a corner and a wall: the ball of the corner's rounding against the plane.

    Of a box with rounded edges inside a hollow with plane walls no other point is deeper.
    """
    gap = shape.distance - shape.radius
    for i in range(3):
        place = pose.centre[i]
        for k in range(3):
            place += pose.rotation[i, k] * shape.corner[k]
        gap += shape.wall[i] * place
        out.point[i] = place - shape.radius * shape.wall[i]
        out.normal[i] = shape.wall[i]
    out.gap = gap
