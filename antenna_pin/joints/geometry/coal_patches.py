"""Distances of a revolute joint under distributed load by coal: strips of the bore, sectors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.native import ShapePair
from antenna_pin.joints.geometry.coal_backend import CoalBackend
from antenna_pin.joints.geometry.coal_kernels import (
    END,
    ENDS_AT,
    FRAME_AT,
    PATCHED,
    QUERY,
    SHAPE_AT,
)
from antenna_pin.joints.geometry.coal_patch_kernels import (
    PATCH_QUERY,
    POINT,
    head_at,
    patch_words,
    points_at,
)


class PatchFunctors(NamedTuple):
    """Distances that coal measures."""

    radial: Any  # of a point and the journal
    faces: tuple[Any, Any]  # of a point and the inner face of each flange
    shapes: tuple[Any, ...]  # the shapes, which functors do not hold


class PatchLayout(NamedTuple):
    """Strips and sectors of a joint."""

    strips: int  # of the whole bore
    first: int  # row of the first strip, from the joint's first row
    radius: float  # of the sectors' circle [m]
    nodes: NDArray[Any]  # of the sectors, NODE, (sectors,)


class CoalPatches(CoalBackend):
    """Distances of a revolute joint under distributed load by coal.

    Args:
        dimensions: The joint's, as the kernels' record, (1,).
        functors: Distances that coal measures.
        patches: Strips and sectors.
    """

    def __init__(self, dimensions: NDArray[Any], functors: PatchFunctors, patches: PatchLayout) -> None:
        """Store them; functors are those of the joint under point load."""
        super().__init__(PATCHED, 4, patch_words(patches.strips, len(patches.nodes)))
        self._dimensions, self._functors, self._patches = dimensions, functors, patches
        self._request = coal.DistanceRequest()

    def prepare(self, work: NDArray[np.float64]) -> Sequence[Callable[[], None]]:
        """Write what is constant into an array; return the queries in Python."""
        patches = self._patches
        strips, sectors = patches.strips, len(patches.nodes)
        work[:SHAPE_AT].view(QUERY)["strips"] = strips
        work[SHAPE_AT:FRAME_AT] = self._dimensions.view(np.float64)
        begin, behind = head_at(strips), points_at(strips, sectors)
        nodes = np.ascontiguousarray(patches.nodes).view(np.float64).ravel()
        head = work[begin : behind - nodes.size].view(PATCH_QUERY)
        head["strips"], head["sectors"] = strips, sectors
        head["first"], head["radius"] = patches.first, patches.radius
        work[behind - nodes.size : behind] = nodes
        self._ends = work[ENDS_AT:begin].view(END)
        self._points = work[behind : self.words].view(POINT)
        return ()

    def pairs(self) -> Sequence[ShapePair]:
        """Return the pairs of shapes, as machine code evaluates them."""
        ends, points = self._ends, self._points
        functors, each = self._functors, len(self._patches.nodes) + 1
        strips = [
            ShapePair(
                functor=functors.radial,
                request=self._request,
                asked=ends["asked"][k : k + 1],
                bit=0,
                distance=ends["answer"][k : k + 1],
                normal=ends["direction"][k],
                first=ends["in_journal"][k],
                shapes=functors.shapes,
            )
            for k in range(len(ends))
        ]
        sectors = [
            ShapePair(
                functor=functors.faces[k // each],
                request=self._request,
                asked=points["asked"][k : k + 1],
                bit=0,
                distance=points["gap"][k : k + 1],
                normal=points["normal"][k],
                first=points["place"][k],
                shapes=functors.shapes,
            )
            for k in range(len(points))
        ]
        return [*strips, *sectors]

    def answer(self) -> None:
        """Evaluate the queries of ``work`` by coal in Python, and write the results there."""
        place, origin = coal.Transform3s(), coal.Transform3s()
        result, request, (radial, faces, _) = coal.DistanceResult(), self._request, self._functors
        ends, points, each = self._ends, self._points, len(self._patches.nodes) + 1
        for k in np.flatnonzero(ends["asked"]).tolist():
            place.setTranslation(ends["in_journal"][k])
            result.clear()
            ends["answer"][k] = radial(place, origin, request, result)
            ends["direction"][k] = result.normal
        for k in np.flatnonzero(points["asked"]).tolist():
            place.setTranslation(points["place"][k])
            result.clear()
            points["gap"][k] = faces[k // each](place, origin, request, result)
            points["normal"][k] = result.normal
