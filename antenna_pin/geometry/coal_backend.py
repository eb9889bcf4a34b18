"""The same distances by coal's own primitives.

The bore is concave, so it is not one coal shape. Radial: a sphere of radius zero at a point Q(phi) of the
bearing's end circle against a lengthened journal cylinder, and phi from d gap / d phi = 0 by Newton with
coal's own normal. Axial: a flange's half-space against the bearing's cylinder, or a small flange's cylinder
against the half-space of the bearing's end face. All of these pairs are closed forms inside coal; pairs that
go through GJK would be off by up to a micrometre.

Functors are built once; a query only moves a transform.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import coal
import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.geometry import _kernels
from antenna_pin.geometry.shapes import (
    TABLE_WIDTH,
    ContactPoint,
    PlanarClearance,
    RevoluteClearance,
    SphericalClearance,
    points_of_table,
    pose_of,
)

__all__ = ["CoalPlanar", "CoalRevolute", "CoalSpherical"]

_WORK_SIZE = 52
_RECORD = 12  # where the record of the first end circle starts in the work array
_RECORD_SIZE = 20
_MAX_QUERIES = 12


class CoalRevolute:
    """Distances of a :class:`RevoluteClearance` by coal.

    Args:
        shape: The joint's dimensions.
    """

    def __init__(self, shape: RevoluteClearance) -> None:
        """Build shapes, functors and buffers once."""
        self.geometry = shape
        self.contact_places = shape.contact_places
        self._shape = shape.shape()
        span = 40.0 * (shape.bearing_length + shape.bearing_radius + shape.flange_distance)
        self._point = coal.Sphere(0.0)
        self._journal = coal.Cylinder(shape.journal_radius, span)
        self._bearing = coal.Cylinder(shape.bearing_outer_radius, shape.bearing_length)
        half = 0.5 * shape.flange_distance
        self._covers = shape.flange_radius >= shape.bearing_outer_radius
        # A half-space is {x : n.x <= d}.
        axis = np.array([0.0, 0.0, 1.0])
        if self._covers:
            self._planes = (coal.Halfspace(-axis, -half), coal.Halfspace(axis, -half))
            self._axial = tuple(coal.ComputeDistance(self._bearing, p) for p in self._planes)
        else:
            # The flanges' inner faces as the end faces of a body of length L_j; the faces as half-spaces in
            # H.
            end = 0.5 * shape.bearing_length
            self._thick = coal.Cylinder(shape.flange_radius, shape.bearing_length)
            self._planes = (coal.Halfspace(axis, end), coal.Halfspace(-axis, end))
            self._axial = tuple(coal.ComputeDistance(self._thick, p) for p in self._planes)
        self._radial = coal.ComputeDistance(self._point, self._journal)
        # The flanges' inner faces in the journal frame, for points of the bearing's end faces.
        self._faces = (coal.Halfspace(-axis, -half), coal.Halfspace(axis, -half))
        self._sector_functors = tuple(coal.ComputeDistance(self._point, f) for f in self._faces)
        self._request = coal.DistanceRequest()
        self._result = coal.DistanceResult()
        self._identity = coal.Transform3s()
        self._at_point = coal.Transform3s()
        self._at_bearing = coal.Transform3s()
        self._at_flange = (coal.Transform3s(), coal.Transform3s())
        self.work = np.zeros(_WORK_SIZE)
        self._rotation = self.work[:9].reshape(3, 3)
        self._origin = self.work[9:12]
        starts = [_RECORD + k * _RECORD_SIZE for k in range(2)]
        self._ends = tuple(
            (1.0 - 2.0 * k, start, self.work[start : start + 3]) for k, start in enumerate(starts)
        )
        self._gaps = np.zeros(2)
        self._normals = np.zeros((2, 3))
        self._points = np.zeros((2, 3))

    def query(
        self, sine: float, table: NDArray[np.float64], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill four rows of a table for the pose that :func:`_kernels.coal_place` wrote to ``work``.

        Args:
            sine: Sine of the tilt between the axes [-].
            table: Contact table, (rows, TABLE_WIDTH).
            row: First row to fill.
            wanted: Which of the four contacts to ask for (nonzero); all if not given. The others' rows are
                not valid.
        """
        result = self._result
        request = self._request
        radial = self._radial
        at_point = self._at_point
        identity = self._identity
        gaps = self._gaps
        normals = self._normals
        turn = _kernels.coal_turn
        for k, (side, start, point) in enumerate(self._ends):
            if (wanted is not None and not wanted[k]) or self.work[start + 4] == 0.0:
                continue
            for _ in range(_MAX_QUERIES):
                at_point.setTranslation(point)
                result.clear()
                gap = radial(at_point, identity, request, result)
                if turn(self._shape, side, self.work, start, result.normal, gap):
                    break
        if self._covers:
            self._at_bearing.setTransform(self._rotation, self._origin)
            for k, functor in enumerate(self._axial):
                if wanted is not None and not wanted[2 + k]:
                    continue
                result.clear()
                gaps[k] = functor(self._at_bearing, identity, request, result)
                # coal's normal runs from the bearing to the flange's half-space: that is into the journal.
                normals[k] = result.normal
                self._points[k] = result.getNearestPoint1()
        else:
            self._query_small_flanges(wanted)
        _kernels.coal_collect(self._shape, self.work, gaps, normals, self._points, sine, table, row)

    def query_strips(
        self,
        pose: NDArray[np.float64],
        strips: int,
        nodes: NDArray[np.float64],
        radius: float,
        table: NDArray[np.float64],
        row: int,
        first: int,
    ) -> None:
        """Fill the strips of the bore and the sectors of the flanges, and the four patches' rows.

        The strips are those that the closed form loads and their neighbours on the surface, the sectors those
        of flanges that press; each is asked of coal.

        Args:
            pose: Journal's centre and axis in bearing axes, (6,) or longer.
            strips: Number of strips.
            nodes: Of the sectors (see :func:`_kernels.sector_contacts`), (2 sectors,).
            radius: Of the sectors' circle [m].
            table: Contact table.
            row: Row of the first patch.
            first: Row of the first strip.
        """
        at = (
            float(pose[0]), float(pose[1]), float(pose[2]),
            float(pose[3]), float(pose[4]), float(pose[5]),
        )  # fmt: skip
        count = len(nodes) // 2
        _kernels.coal_place(self._shape, *at, self.work)
        _kernels.strip_contacts(self._shape, strips, *at, table, row, first)
        start, point = _RECORD, self._ends[0][2]
        for k in range(strips):
            if table[first + k, 0] == _kernels.APART:
                continue
            side = (2.0 * k + 1.0) / strips - 1.0
            _kernels.coal_start(self._shape, side, *at, self.work, start)
            if self.work[start + 4] == 0.0:
                continue
            for _ in range(_MAX_QUERIES):
                self._at_point.setTranslation(point)
                self._result.clear()
                gap = self._radial(self._at_point, self._identity, self._request, self._result)
                if _kernels.coal_turn(self._shape, side, self.work, start, self._result.normal, gap):
                    break
            table[first + k, 0] = self.work[start + 11]
            table[first + k, 1:4] = self.work[start + 8 : start + 11]
            table[first + k, 4:7] = self.work[start + 5 : start + 8]
        half = strips // 2
        for patch, begin in enumerate((first + half, first)):
            least = begin + int(np.argmin(table[begin : begin + half, 0]))
            table[row + patch, :7] = table[least, :7]
        _kernels.sector_contacts(self._shape, nodes, count, radius, *at, table, row + 2, first + strips)
        rotation, origin = self._rotation, self._origin
        for patch, functor in enumerate(self._sector_functors):
            begin = first + strips + patch * count
            for r in (row + 2 + patch, *range(begin, begin + count)):
                if table[r, 0] == _kernels.APART:
                    continue
                self._at_point.setTranslation(rotation @ table[r, 4:7] + origin)
                self._result.clear()
                table[r, 0] = functor(self._at_point, self._identity, self._request, self._result)
                table[r, 1:4] = rotation.T @ self._result.normal

    def _query_small_flanges(self, wanted: Sequence[float] | None) -> None:
        # Solid discs behind each flange face, asked against the half-spaces inside the bearing's end faces.
        # Both are asked in H, where the half-spaces stand, and the answers carried to J.
        rotation = self._rotation  # of H in J
        centre = -rotation.T @ self._origin  # journal centre in H
        axis = rotation[2]
        half = 0.5 * (self.geometry.flange_distance + self.geometry.bearing_length)
        for k, (functor, side) in enumerate(zip(self._axial, (1.0, -1.0), strict=True)):
            if wanted is not None and not wanted[2 + k]:
                continue
            self._at_bearing.setTransform(np.ascontiguousarray(rotation.T), centre + side * half * axis)
            self._result.clear()
            self._gaps[k] = functor(self._at_bearing, self._identity, self._request, self._result)
            self._normals[k] = -(rotation @ self._result.normal)
            self._points[k] = rotation @ self._result.getNearestPoint1() + self._origin

    def contacts(self, p_HJ: ArrayLike, axis_J_H: ArrayLike) -> tuple[ContactPoint, ...]:
        """Return the four candidate contacts (see :meth:`RevoluteClearance.contacts`)."""
        pose = pose_of(p_HJ, axis_J_H)
        table = np.zeros((4, TABLE_WIDTH))
        _kernels.coal_place(self._shape, *pose, self.work)
        self.query(math.hypot(pose[3], pose[4]), table, 0)
        return points_of_table(table)


class CoalPlanar:
    """Distance of a :class:`PlanarClearance` by coal.

    Args:
        shape: The joint's dimensions.
    """

    def __init__(self, shape: PlanarClearance) -> None:
        """Build shapes, functors and buffers once."""
        self.geometry = shape
        self.contact_places = shape.contact_places
        self._shape = shape.shape()
        self._point = coal.Sphere(0.0)
        self._journal = coal.Cylinder(shape.journal_radius, 10.0 * shape.bearing_radius)
        self._radial = coal.ComputeDistance(self._point, self._journal)
        self._request = coal.DistanceRequest()
        self._result = coal.DistanceResult()
        self._at_point = coal.Transform3s()
        self._at_journal = coal.Transform3s()

    def query(self, ox: float, oy: float, table: NDArray[np.float64], row: int) -> None:
        """Fill one row for the journal centre (ox, oy) in the bearing plane [m]."""
        _kernels.planar_contact(self._shape, ox, oy, table, row)
        self._at_point.setTranslation(table[row, 4:7])
        self._at_journal.setTranslation(np.array([ox, oy, 0.0]))
        self._result.clear()
        table[row, 0] = self._radial(self._at_point, self._at_journal, self._request, self._result)
        table[row, 1:4] = self._result.normal

    def contacts(self, p_HJ: ArrayLike, axis_J_H: ArrayLike = (0.0, 0.0, 1.0)) -> tuple[ContactPoint, ...]:
        """Return the one candidate contact (see :meth:`PlanarClearance.contacts`)."""
        pose = pose_of(p_HJ, axis_J_H)
        table = np.zeros((1, TABLE_WIDTH))
        self.query(pose[0], pose[1], table, 0)
        return points_of_table(table)


class CoalSpherical:
    """Distance of a :class:`SphericalClearance` by coal.

    The socket's point on the line of the two centres is asked against the ball.

    Args:
        shape: The joint's dimensions.
    """

    def __init__(self, shape: SphericalClearance) -> None:
        """Build shapes, functors and buffers once."""
        self.geometry = shape
        self.contact_places = shape.contact_places
        self._shape = shape.shape()
        self._point = coal.Sphere(0.0)
        self._ball = coal.Sphere(shape.ball_radius)
        self._functor = coal.ComputeDistance(self._point, self._ball)
        self._request = coal.DistanceRequest()
        self._result = coal.DistanceResult()
        self._at_point = coal.Transform3s()
        self._at_ball = coal.Transform3s()

    def query(self, centre: NDArray[np.float64], table: NDArray[np.float64], row: int) -> None:
        """Fill one row for the ball's centre in the socket, (3,) [m]."""
        _kernels.spherical_contact(
            self._shape, float(centre[0]), float(centre[1]), float(centre[2]), table, row
        )
        self._at_point.setTranslation(table[row, 4:7])
        self._at_ball.setTranslation(centre)
        self._result.clear()
        table[row, 0] = self._functor(self._at_point, self._at_ball, self._request, self._result)
        table[row, 1:4] = self._result.normal

    def contacts(self, p_HJ: ArrayLike, axis_J_H: ArrayLike = (0.0, 0.0, 1.0)) -> tuple[ContactPoint, ...]:
        """Return the one candidate contact (see :meth:`SphericalClearance.contacts`)."""
        table = np.zeros((1, TABLE_WIDTH))
        self.query(np.array(pose_of(p_HJ, axis_J_H)[:3]), table, 0)
        return points_of_table(table)
