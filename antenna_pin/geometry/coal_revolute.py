"""Distances between a flanged journal and its bearing by coal's own primitives.

The bore is concave, so it is not one coal shape. Radial: a sphere of radius zero at a point Q(phi) of the
bearing's end circle against a lengthened journal cylinder, and phi from d gap / d phi = 0 by Newton with
coal's own normal. Axial: a flange's half-space against the bearing's cylinder, or a small flange's cylinder
against the half-space of the bearing's end face. All of these pairs are closed forms inside coal; pairs that
go through GJK would be off by up to a micrometre.

Functors are built once; a query only moves a transform.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.geometry import coal_kernels as kernels
from antenna_pin.geometry.patch_kernels import APART, sector_contacts, strip_contacts

__all__ = ["CoalRevolute"]

_MAX_QUERIES = 12
_ALL = (1.0, 1.0, 1.0, 1.0)


class CoalRevolute:
    """Distances of a revolute joint by coal.

    Args:
        dimensions: The joint's, as the kernels' record, (1,).
    """

    def __init__(self, dimensions: NDArray[Any]) -> None:
        """Build shapes, functors and buffers once."""
        self._shape = dimensions
        names = ("bearing_radius", "half_length", "outer_radius", "journal_radius", "flange_radius")
        bore, end, outer, journal, flange = (float(dimensions[name][0]) for name in names)
        half = float(dimensions["half_distance"][0])
        span = 40.0 * (2.0 * end + bore + 2.0 * half)
        self._point = coal.Sphere(0.0)
        self._journal = coal.Cylinder(journal, span)
        self._bearing = coal.Cylinder(outer, 2.0 * end)
        self._covers = flange >= outer
        self._to_disc = half + end  # from the journal's centre to that of a small flange's disc
        # A half-space is {x : n.x <= d}.
        axis = np.array([0.0, 0.0, 1.0])
        # The flanges' inner faces in the journal frame, also for points of the bearing's end faces.
        self._faces = (coal.Halfspace(-axis, -half), coal.Halfspace(axis, -half))
        if self._covers:
            self._axial = tuple(coal.ComputeDistance(self._bearing, face) for face in self._faces)
        else:
            # Small flanges as discs behind their inner faces; the bearing's end faces as half-spaces in H.
            self._disc = coal.Cylinder(flange, 2.0 * end)
            self._planes = (coal.Halfspace(axis, end), coal.Halfspace(-axis, end))
            self._axial = tuple(coal.ComputeDistance(self._disc, p) for p in self._planes)
        self._radial = coal.ComputeDistance(self._point, self._journal)
        self._sector_functors = tuple(coal.ComputeDistance(self._point, f) for f in self._faces)
        self._request = coal.DistanceRequest()
        self._result = coal.DistanceResult()
        self._identity = coal.Transform3s()
        self._at_point = coal.Transform3s()
        self._at_bearing = coal.Transform3s()
        # All that the kernels read and write, and parts of it by name.
        self._work = np.zeros(kernels.WORDS)
        self._work[kernels.SHAPE_AT : kernels.FRAME_AT] = dimensions.view(np.float64)
        frame = self._work[kernels.FRAME_AT : kernels.ENDS_AT].view(kernels.FRAME)
        self._rotation: NDArray[np.float64] = frame["rotation"][0]
        self._origin: NDArray[np.float64] = frame["origin"][0]
        self._ends = self._work[kernels.ENDS_AT : kernels.ANSWERS_AT].view(kernels.END)
        answers = self._work[kernels.ANSWERS_AT :].view(kernels.FLANGE_ANSWER)
        self._gaps = answers["gap"]
        self._normals = tuple(answers["normal"])
        self._points = tuple(answers["point"])
        self._search = self._searching()

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill the four rows (see :class:`antenna_pin.geometry.Distances`)."""
        if wanted is None:
            wanted = _ALL
        elif not any(wanted):
            return
        upper, lower = kernels.coal_place(self._work, pose)
        if upper and wanted[0]:
            self._search(0)
        if lower and wanted[1]:
            self._search(1)
        if wanted[2] or wanted[3]:
            if self._covers:
                self._query_large_flanges(wanted)
            else:
                self._query_small_flanges(wanted)
        kernels.coal_collect(self._work, pose, table, row)

    def _searching(self) -> Callable[[int], None]:
        """Return what finds the deepest point of an end circle, from where END k is.

        What it needs is looked at once: it is called for each contact of each evaluation.
        """
        work, asked, identity = self._work, tuple(self._ends["in_journal"]), self._identity
        at_point, result, request, radial = self._at_point, self._result, self._request, self._radial
        turn = kernels.coal_turn

        def search(k: int) -> None:
            point = asked[k]
            for _ in range(_MAX_QUERIES):
                at_point.setTranslation(point)
                result.clear()
                gap = radial(at_point, identity, request, result)
                if turn(work, k, result.normal, gap):
                    break

        return search

    def query_patches(
        self,
        pose: NDArray[Any],
        strips: int,
        nodes: NDArray[Any],
        radius: float,
        table: NDArray[Any],
        row: int,
        first: int,
    ) -> None:
        """Fill the strips of the bore and the sectors of the flanges, and the four patches' rows.

        The strips are those that the closed form loads and their neighbours on the surface, the sectors those
        of flanges that press; each is asked of coal.

        Args:
            pose: :data:`antenna_pin.records.POSE` of the journal, (1,).
            strips: Number of strips.
            nodes: Of the sectors (NODE, sectors).
            radius: Of the sectors' circle [m].
            table: Contact table.
            row: Row of the first patch.
            first: Row of the first strip.
        """
        shape = self._shape
        kernels.coal_place(self._work, pose)
        strip_contacts(shape[0], strips, pose[0], table, row, first)
        for k in range(strips):
            if table["gap"][first + k] == APART:
                continue
            side = (2.0 * k + 1.0) / strips - 1.0
            if not kernels.coal_start(self._work, 0, side, pose):
                continue
            self._search(0)
            table["gap"][first + k] = self._ends["gap"][0]
            table["normal"][first + k] = self._ends["normal"][0]
            table["point"][first + k] = self._ends["in_bearing"][0]
        half = strips // 2
        for patch, begin in enumerate((first + half, first)):
            least = begin + int(np.argmin(table["gap"][begin : begin + half]))
            for name in ("gap", "normal", "point"):
                table[name][row + patch] = table[name][least]
        sector_contacts(shape[0], nodes, radius, pose[0], table, row + 2, first + strips)
        count = len(nodes)
        rotation, origin = self._rotation, self._origin
        for patch, functor in enumerate(self._sector_functors):
            begin = first + strips + patch * count
            for r in (row + 2 + patch, *range(begin, begin + count)):
                if table["gap"][r] == APART:
                    continue
                self._at_point.setTranslation(rotation @ table["point"][r] + origin)
                self._result.clear()
                table["gap"][r] = functor(self._at_point, self._identity, self._request, self._result)
                table["normal"][r] = rotation.T @ self._result.normal

    def _query_large_flanges(self, wanted: Sequence[float]) -> None:
        self._at_bearing.setTransform(self._rotation, self._origin)
        result = self._result
        for k, functor in enumerate(self._axial):
            if not wanted[2 + k]:
                continue
            result.clear()
            self._gaps[k] = functor(self._at_bearing, self._identity, self._request, result)
            # coal's normal runs from the bearing to the flange's half-space: that is into the journal.
            self._normals[k][:] = result.normal
            self._points[k][:] = result.getNearestPoint1()

    def _query_small_flanges(self, wanted: Sequence[float]) -> None:
        # Solid discs behind each flange face, asked against the half-spaces inside the bearing's end faces.
        # Both are asked in H, where the half-spaces stand, and the answers carried to J.
        rotation = self._rotation  # of H in J
        centre = -rotation.T @ self._origin  # journal centre in H
        axis = rotation[2]
        for k, (functor, side) in enumerate(zip(self._axial, (1.0, -1.0), strict=True)):
            if not wanted[2 + k]:
                continue
            self._at_bearing.setTransform(
                np.ascontiguousarray(rotation.T), centre + side * self._to_disc * axis
            )
            self._result.clear()
            self._gaps[k] = functor(self._at_bearing, self._identity, self._request, self._result)
            self._normals[k][:] = -(rotation @ self._result.normal)
            self._points[k][:] = rotation @ self._result.getNearestPoint1() + self._origin
