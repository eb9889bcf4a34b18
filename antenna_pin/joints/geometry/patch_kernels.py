"""Distributed contact, compiled: the bore cut into strips, the flanges into sectors."""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Pose, Record, Records, layout
from antenna_pin.compiled.decorators import kernel
from antenna_pin.joints.geometry.revolute_kernels import Revolute, bore_contact


class PatchSector(Record):
    """A sector of a patch."""

    sine: float  # of t_k
    share: float  # cos(t_k) over the number of sectors


NODE = layout(PatchSector)

APART = 1.0  # [m], gap of strips that are apart without being computed


@kernel
def take_place(patch: Contact, part: Contact) -> None:
    """Give a patch the gap, normal and point of one of its parts."""
    patch.gap = part.gap
    for i in range(3):
        patch.normal[i] = part.normal[i]
        patch.point[i] = part.point[i]


@kernel
def strip_contacts(
    shape: Revolute, strips: int, pose: Pose, table: Records[Contact], row: int, start: int
) -> None:
    """Fill the bore's strips, and its two halves.

    The +z half is in ``row``, the -z half behind it.

    The strips start at ``start``, from the -z to the +z end; a strip is the circle at its middle. The gap is
    concave along the bearing (the distance between two straight axes is convex), so in each half it is least
    at the outermost or the innermost strip, from which the loaded strips are found; the others are marked as
    apart. A half's row is that of its least gap. Each strip has 2 / strips of the law of its half.
    """
    half = strips // 2
    for k in range(strips):
        table[start + k].gap = APART
    for h in range(2):
        if h == 0:
            inner, outer, step = half, strips - 1, -1
        else:
            inner, outer, step = half - 1, 0, 1
        least = outer
        for begin, towards in ((outer, step), (inner, -step)):
            k = begin
            while (k >= half) == (h == 0) and 0 <= k < strips:
                if table[start + k].gap != APART:
                    break
                side = (2.0 * k + 1.0) / strips - 1.0
                bore_contact(shape, side, pose, table[start + k])
                table[start + k].share = 2.0 / strips
                if table[start + k].gap < table[start + least].gap:
                    least = k
                if table[start + k].gap >= 0.0:
                    break
                k += towards
        take_place(table[row + h], table[start + least])


@kernel
def sector_contacts(
    shape: Revolute,
    nodes: Records[PatchSector],
    radius: float,
    pose: Pose,
    table: Records[Contact],
    row: int,
    begin: int,
) -> None:
    r"""Fill the flanges' sectors, from ``begin`` on, and the flanges' own rows.

    These are ``row`` and the next.

    The annulus is a ring of ``radius``; its depth at the angle phi from its deepest point is
    d - 2 a sin^2(phi/2), a = radius sin(tilt), and the loaded arc ends at sin(phi/2) = sigma,
    sigma^2 = d / (2 a), or is the whole ring (sigma = 1). The sectors divide the loaded arc: with
    sin(phi/2) = sigma sin(t)

        1/(2 pi) integral of f dphi = 1/pi integral over t of f sigma cos(t) / sqrt(1 - sigma^2 sin^2(t)) dt

    by the midpoint rule. The integrand is periodic in t, as d cos^2(t) is the depth of a partly loaded ring,
    so that the sum converges quickly, passes smoothly from the part to the whole, where the sectors stand
    evenly, and is the same for all directions of the tilt. The sectors of the +z flange come first. A
    flange's row is that of its deepest point, with sigma as its share.
    """
    count = nodes.shape[0]
    ox, oy, oz = pose.centre[0], pose.centre[1], pose.centre[2]
    zx, zy, zz = pose.axis[0], pose.axis[1], pose.axis[2]
    sine = pose.sine
    a = radius * sine
    for h in range(2):
        side = 1.0 - 2.0 * h
        start = begin + h * count
        depth = side * (-ox * zx - oy * zy + (side * shape.half_length - oz) * zz) - shape.half_distance + a
        ux = side * zx / sine if sine > 0.0 else 1.0
        uy = side * zy / sine if sine > 0.0 else 0.0
        flange = table[row + h]
        flange.gap = -depth
        flange.normal[0] = side * zx
        flange.normal[1] = side * zy
        flange.normal[2] = side * zz
        flange.point[0] = radius * ux
        flange.point[1] = radius * uy
        flange.point[2] = side * shape.half_length
        sigma = math.sqrt(depth / (2.0 * a)) if 0.0 < depth < 2.0 * a else 1.0
        flange.share = sigma
        if depth <= 0.0:
            for k in range(count):
                table[start + k].gap = APART
            continue
        for k in range(count):
            s = sigma * nodes[k].sine
            root = math.sqrt(1.0 - s * s)
            c = 1.0 - 2.0 * s * s
            d = 2.0 * s * root
            sector = table[start + k]
            sector.gap = 2.0 * a * s * s - depth
            sector.normal[0] = side * zx
            sector.normal[1] = side * zy
            sector.normal[2] = side * zz
            sector.point[0] = radius * (c * ux - d * uy)
            sector.point[1] = radius * (d * ux + c * uy)
            sector.point[2] = side * shape.half_length
            sector.share = sigma * nodes[k].share / root
