"""Distance between a rounded corner of a slider and a wall of its guide, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Contact, Pose, Record, Vector3, layout
from antenna_pin.compiled.decorators import deferred


class Corner(Record):
    """A rounded corner of the journal before a plane wall of the bearing."""

    primitive: int  # its kind
    corner: Vector3  # centre of the rounding, from the journal's centre in the child's axes [m]
    wall: Vector3  # normal of the wall into the hollow, bearing axes
    distance: float  # distance of the wall from the bearing's centre [m]
    radius: float  # radius of the corner [m]


CORNER = layout(Corner)


@deferred
def corner_contact(shape: Corner, pose: Pose, out: Contact) -> None:
    """Write the candidate of a corner's rounding, a ball, against a wall's plane.

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
