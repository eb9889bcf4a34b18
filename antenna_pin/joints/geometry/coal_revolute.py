"""Distances between a flanged journal and its bearing by coal's own primitives.

The bore is concave, so it is not one coal shape. Radial: a sphere of radius zero at a point Q(phi) of the
bearing's end circle against a lengthened journal cylinder, with phi from d gap / d phi = 0 by Newton with
coal's own normal. Axial: a flange's half-space against the bearing's cylinder, or a small flange's cylinder
against the half-space of the bearing's end face. All of these pairs are closed forms inside coal; pairs by
GJK would be off by up to a micrometre.

Functors are built once; a query only moves a transform. Queries and results are in one array of numbers
(:mod:`antenna_pin.joints.geometry.coal_kernels`), so that compiled code can write a pose, have coal evaluate
it, and read the results.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.native import FIRST_TURNED, ShapePair
from antenna_pin.joints.geometry import coal_kernels as kernels
from antenna_pin.joints.geometry.coal_backend import CoalBackend
from antenna_pin.joints.geometry.coal_patches import CoalPatches, PatchFunctors, PatchLayout

_Question = Callable[[], None]


class CoalRevolute(CoalBackend):
    """Distances of a revolute joint by coal.

    Args:
        dimensions: Dimensions of the joint, the kernels' record, (1,).
    """

    def __init__(self, dimensions: NDArray[Any]) -> None:
        """Build shapes and functors once."""
        super().__init__(kernels.FLANGED, 4, kernels.WORDS)
        self._shape = dimensions
        names = ("bearing_radius", "half_length", "outer_radius", "journal_radius", "flange_radius")
        bore, end, outer, journal, flange = (float(dimensions[name][0]) for name in names)
        half = float(dimensions["half_distance"][0])
        span = 40.0 * (2.0 * end + bore + 2.0 * half)
        self._point = coal.Sphere(0.0)
        self._journal = coal.Cylinder(journal, span)
        self._bearing = coal.Cylinder(outer, 2.0 * end)
        self._covers = flange >= outer
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
        first, second = self._faces
        self._sector_functors = (
            coal.ComputeDistance(self._point, first),
            coal.ComputeDistance(self._point, second),
        )
        self._request = coal.DistanceRequest()
        self._identity = coal.Transform3s()
        self._at_point = coal.Transform3s()
        self._at_cylinder = coal.Transform3s()

    def prepare(self, work: NDArray[np.float64]) -> Sequence[_Question]:
        """Write the dimensions into an array; return the queries in Python, bit by bit."""
        work[kernels.SHAPE_AT : kernels.FRAME_AT] = self._shape.view(np.float64)
        frame = work[kernels.FRAME_AT : kernels.ENDS_AT].view(kernels.FRAME)
        self._rotation: NDArray[np.float64] = frame["rotation"][0]
        self._origin: NDArray[np.float64] = frame["origin"][0]
        self._ends = work[kernels.ENDS_AT : kernels.ANSWERS_AT].view(kernels.END)
        self._answers = work[kernels.ANSWERS_AT : kernels.DISCS_AT].view(kernels.FLANGE_ANSWER)
        discs = work[kernels.DISCS_AT : kernels.WORDS].view(kernels.DISCS)[0]
        # Placement of each flange's cylinder in queries.
        self._cylinders = [
            (self._rotation, self._origin) if self._covers else (discs["rotation"], discs[centre])
            for centre in ("centre", "other")
        ]
        rows = (self._end(0), self._end(1), self._flange(0), self._flange(1))
        # Queries by the bits of the requested rows: looked up, since each evaluation needs them.
        self._by_bits = [
            tuple(question for k, question in enumerate(rows) if bits >> k & 1)
            for bits in range(1 << len(rows))
        ]
        return rows

    def pairs(self) -> Sequence[ShapePair]:
        """Return the pairs of shapes, as machine code evaluates them."""
        ends, answers = self._ends, self._answers
        radial = [
            ShapePair(
                functor=self._radial,
                request=self._request,
                asked=self._asked,
                bit=k,
                distance=ends["answer"][k : k + 1],
                normal=ends["direction"][k],
                first=ends["in_journal"][k],
            )
            for k in range(2)
        ]
        axial = [
            ShapePair(
                functor=self._axial[k],
                request=self._request,
                asked=self._asked,
                bit=2 + k,
                distance=answers["gap"][k : k + 1],
                normal=answers["normal"][k],
                point=answers["point"][k],
                first=origin,
                turned=FIRST_TURNED,
                turn=rotation,
            )
            for k, (rotation, origin) in enumerate(self._cylinders)
        ]
        return [*radial, *axial]

    def answer(self) -> None:
        """Evaluate the queries of ``work`` by coal in Python, and write the results there."""
        for question in self._by_bits[self._asked.item()]:
            question()

    def _end(self, k: int) -> _Question:
        """Return the query of coal for the point of END k."""
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

    def patches(self, layout: PatchLayout) -> CoalPatches:
        """Return the distances of the joint under distributed load."""
        shapes = (self._point, self._journal, *self._faces)
        functors = PatchFunctors(self._radial, self._sector_functors, shapes)
        return CoalPatches(self._shape, functors, layout)

    def _flange(self, k: int) -> _Question:
        """Return the query of coal for a flange.

        One that covers the bearing's end is a half-space in J before the bearing as a cylinder: coal's normal
        is that into the journal. A smaller one is a disc behind its inner face before the half-space inside
        the bearing's end face, in H: coal's normal is that into the bearing.
        """
        answer, functor, (rotation, origin) = self._answers[k], self._axial[k], self._cylinders[k]
        gaps, to_normal, to_point = self._answers["gap"], answer["normal"], answer["point"]
        at_cylinder, identity, request = self._at_cylinder, self._identity, self._request
        result = coal.DistanceResult()
        clear, normal, nearest = result.clear, result.normal, result.getNearestPoint1

        def ask() -> None:
            at_cylinder.setTransform(rotation, origin)
            clear()
            gaps[k] = functor(at_cylinder, identity, request, result)
            to_normal[:] = normal
            to_point[:] = nearest()

        return ask
