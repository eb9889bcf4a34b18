"""Distances between a flanged journal and its bearing by coal's own primitives.

The bore is concave, so it is not one coal shape. Radial: a sphere of radius zero at a point Q(phi) of the
bearing's end circle against a lengthened journal cylinder, and phi from d gap / d phi = 0 by Newton with
coal's own normal. Axial: a flange's half-space against the bearing's cylinder, or a small flange's cylinder
against the half-space of the bearing's end face. All of these pairs are closed forms inside coal; pairs that
go through GJK would be off by up to a micrometre.

Functors are built once; a query only moves a transform. Arguments and results are in one array of
numbers (:mod:`antenna_pin.joints.geometry.coal_kernels`), so that compiled code can set out a pose, have coal
asked (:meth:`CoalRevolute.answer`), and take the answers in.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.joints.geometry import coal_kernels as kernels
from antenna_pin.joints.geometry.patch_kernels import APART, sector_contacts, strip_contacts

__all__ = ["CoalRevolute"]

_ALL = (1.0, 1.0, 1.0, 1.0)
_Question = Callable[[], None]


class CoalRevolute:
    """Distances of a revolute joint by coal.

    Args:
        dimensions: The joint's, as the kernels' record, (1,).

    Attributes:
        work: Arguments and results, (WORDS,).
    """

    def __init__(self, dimensions: NDArray[Any]) -> None:
        """Build shapes and functors once."""
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
        self._identity = coal.Transform3s()
        self._at_point = coal.Transform3s()
        self._at_bearing = coal.Transform3s()
        self._result = coal.DistanceResult()
        self.take(np.zeros(kernels.WORDS))

    def take(self, work: NDArray[np.float64]) -> None:
        """Use another array for queries and results from now on, (WORDS,)."""
        self.work = work
        work[kernels.SHAPE_AT : kernels.FRAME_AT] = self._shape.view(np.float64)
        self._asked = work[: kernels.SHAPE_AT].view(kernels.QUERY)["asked"]
        frame = work[kernels.FRAME_AT : kernels.ENDS_AT].view(kernels.FRAME)
        self._rotation: NDArray[np.float64] = frame["rotation"][0]
        self._origin: NDArray[np.float64] = frame["origin"][0]
        self._ends = work[kernels.ENDS_AT : kernels.ANSWERS_AT].view(kernels.END)
        self._answers = work[kernels.ANSWERS_AT :].view(kernels.FLANGE_ANSWER)
        flange = self._large_flange if self._covers else self._small_flange
        rows = (self._end(0), self._end(1), flange(0), flange(1))
        # By the bits of the specified value: looked up, not decided, for each evaluation asks.
        self._questions = [
            tuple(question for k, question in enumerate(rows) if bits >> k & 1)
            for bits in range(1 << len(rows))
        ]

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill the four rows (see :class:`antenna_pin.joints.geometry.Distances`)."""
        bits = sum(1 << k for k, one in enumerate(_ALL if wanted is None else wanted) if one)
        if bits == 0:
            return
        kernels.coal_set_out(self.work, pose, bits)
        for _ in range(kernels.MOST_QUERIES):
            self.answer()
            if kernels.coal_take_in(self.work, pose, table, row):
                break

    def answer(self) -> None:
        """Carry out the queries of ``work`` by coal, and write the results there."""
        for question in self._questions[self._asked.item()]:
            question()

    def _end(self, k: int) -> _Question:
        """Return the query of coal for the point of END k.

        What it needs is examined once; coal's normal is read where it stands.
        """
        point, answers, direction = (
            self._ends["in_journal"][k],
            self._ends["answer"],
            self._ends["direction"][k],
        )
        place, at_point, identity = self._at_point.setTranslation, self._at_point, self._identity
        result, request, radial = coal.DistanceResult(), self._request, self._radial
        clear, normal = result.clear, result.normal

        def ask() -> None:
            place(point)
            clear()
            answers[k] = radial(at_point, identity, request, result)
            direction[:] = normal

        return ask

    def query_patches(
        self,
        pose: NDArray[Any],
        strips: int,
        nodes: NDArray[Any],
        radius: float,
        table: NDArray[Any],
        row: int,
        start: int,
    ) -> None:
        """Fill the rows of the bore's strips, the flanges' sectors, and the patches.

        The strips are those that the closed form loads and their neighbours on the surface, the sectors those
        of flanges that press; coal is queried for each.

        Args:
            pose: :data:`antenna_pin.base.records.POSE` of the journal, (1,).
            strips: Number of strips.
            nodes: Of the sectors (NODE, sectors).
            radius: Of the sectors' circle [m].
            table: Contact table.
            row: Row of the first patch.
            start: Row of the first strip.
        """
        shape = self._shape
        kernels.coal_set_out(self.work, pose, 0)
        strip_contacts(shape[0], strips, pose[0], table, row, start)
        for k in range(strips):
            if table["gap"][start + k] == APART:
                continue
            side = (2.0 * k + 1.0) / strips - 1.0
            if not kernels.coal_start(self.work, 0, side, pose):
                continue
            for _ in range(kernels.MOST_QUERIES):
                self._questions[1][0]()
                if kernels.coal_turn(self.work, 0):
                    break
            table["gap"][start + k] = self._ends["gap"][0]
            table["normal"][start + k] = self._ends["normal"][0]
            table["point"][start + k] = self._ends["in_bearing"][0]
        half = strips // 2
        for patch, begin in enumerate((start + half, start)):
            least = begin + int(np.argmin(table["gap"][begin : begin + half]))
            for name in ("gap", "normal", "point"):
                table[name][row + patch] = table[name][least]
        sector_contacts(shape[0], nodes, radius, pose[0], table, row + 2, start + strips)
        count = len(nodes)
        rotation, origin = self._rotation, self._origin
        for patch, functor in enumerate(self._sector_functors):
            begin = start + strips + patch * count
            for r in (row + 2 + patch, *range(begin, begin + count)):
                if table["gap"][r] == APART:
                    continue
                self._at_point.setTranslation(rotation @ table["point"][r] + origin)
                self._result.clear()
                table["gap"][r] = functor(self._at_point, self._identity, self._request, self._result)
                table["normal"][r] = rotation.T @ self._result.normal

    def _large_flange(self, k: int) -> _Question:
        """Return the query of coal for a flange that covers the bearing's end."""
        answer, functor, rotation, origin = self._answers[k], self._axial[k], self._rotation, self._origin
        gaps, to_normal, to_point = self._answers["gap"], answer["normal"], answer["point"]
        at_bearing, identity, request = self._at_bearing, self._identity, self._request
        result = coal.DistanceResult()
        clear, normal, nearest = result.clear, result.normal, result.getNearestPoint1

        def ask() -> None:
            at_bearing.setTransform(rotation, origin)
            clear()
            gaps[k] = functor(at_bearing, identity, request, result)
            # coal's normal runs from the bearing to the flange's half-space: that is into the journal.
            to_normal[:] = normal
            to_point[:] = nearest()

        return ask

    def _small_flange(self, k: int) -> _Question:
        """Return the query of coal for a flange smaller than the bearing's end.

        Solid discs behind each flange face, asked against the half-spaces inside the bearing's end faces.
        Both queries are in H, where the half-spaces are, and the results transformed to J.
        """
        answer, functor, rotation, origin = self._answers[k], self._axial[k], self._rotation, self._origin
        at_disc, identity, request = self._at_bearing, self._identity, self._request
        result, to_disc = coal.DistanceResult(), (1.0 - 2.0 * k) * self._to_disc

        def ask() -> None:  # rotation is that of H in J
            centre = -rotation.T @ origin + to_disc * rotation[2]
            at_disc.setTransform(np.ascontiguousarray(rotation.T), centre)
            result.clear()
            answer["gap"] = functor(at_disc, identity, request, result)
            answer["normal"][:] = -(rotation @ result.normal)
            answer["point"][:] = rotation @ result.getNearestPoint1() + origin

        return ask
