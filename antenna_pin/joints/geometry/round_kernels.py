"""Distances of round sections without an axis, compiled: circle and ball."""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Pose, Record, Vector6, layout
from antenna_pin.compiled.decorators import deferred


class Round(Record):
    """A journal in a bore, in its plane, or a ball in a socket."""

    primitive: int  # its kind
    bearing_radius: float  # [m]
    journal_radius: float  # [m]
    unused: Vector6  # as long as other shapes


ROUND = layout(Round)


@deferred
def circle_contact(shape: Round, pose: Pose, out: Contact) -> None:
    """Candidate of a circle in a circle, in the plane of the bearing."""
    ox, oy = pose.centre[0], pose.centre[1]
    eccentricity = math.hypot(ox, oy)
    out.gap = shape.bearing_radius - shape.journal_radius - eccentricity
    if eccentricity > 0.0:
        ux = ox / eccentricity
        uy = oy / eccentricity
    else:
        ux = 1.0
        uy = 0.0
    out.normal[0] = -ux
    out.normal[1] = -uy
    out.normal[2] = 0.0
    out.point[0] = shape.bearing_radius * ux
    out.point[1] = shape.bearing_radius * uy
    out.point[2] = 0.0


@deferred
def ball_contact(shape: Round, pose: Pose, out: Contact) -> None:
    """Candidate of a ball in a socket, on the line of the two centres."""
    ox, oy, oz = pose.centre[0], pose.centre[1], pose.centre[2]
    eccentricity = math.sqrt(ox * ox + oy * oy + oz * oz)
    out.gap = shape.bearing_radius - shape.journal_radius - eccentricity
    if eccentricity > 0.0:
        ux = ox / eccentricity
        uy = oy / eccentricity
        uz = oz / eccentricity
    else:
        ux = 1.0
        uy = 0.0
        uz = 0.0
    out.normal[0] = -ux
    out.normal[1] = -uy
    out.normal[2] = -uz
    out.point[0] = shape.bearing_radius * ux
    out.point[1] = shape.bearing_radius * uy
    out.point[2] = shape.bearing_radius * uz
