"""Lines whose colour tells a number, of any length."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from matplotlib.artist import Artist, allow_rasterization
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.collections import LineCollection

from antenna_pin.plot._style import Array

__all__ = ["draw_parts", "draw_pieces"]

# Pieces from which on a line is drawn part by part, and those of a part: as a path of its own each takes a
# hundred times the room of its numbers.
_MANY = 20_000
_AT_ONCE = 2_000

#: Points (m, 2) and values of the pieces between them (m - 1,), part by part, each from the last point on.
Parts = Callable[[], Iterable[tuple[Array, Array]]]


def draw_pieces(axes: Axes, points: Array, values: Array, kept: Any = slice(None), **looks: Any) -> None:
    """Draw the pieces of a line, each in the colour of its own value, one after another.

    Long lines are made into paths part by part while they are drawn.

    Args:
        axes: Axes, whose limits are set elsewhere.
        points: (n, 2), in their units.
        values: Of the pieces between them, (n - 1,).
        kept: Which pieces, and in what order; all, as they come, if left out.
        looks: As for ``LineCollection``.
    """
    pieces = np.stack([points[:-1], points[1:]], axis=1)[kept]
    if len(pieces) > _MANY:
        axes.add_artist(_InParts(axes, lambda: [(pieces, values[kept])], looks))
    else:
        axes.add_collection(LineCollection(list(pieces), array=values[kept], **looks))


def draw_parts(axes: Axes, parts: Parts, **looks: Any) -> None:
    """Draw a line as :func:`draw_pieces` does that is too long for memory: it is made while it is drawn.

    Args:
        axes: Axes, whose limits are set elsewhere.
        parts: Returns the line part by part.
        looks: As for ``LineCollection``.
    """

    def pieces() -> Iterable[tuple[Array, Array]]:
        for points, values in parts():
            yield np.stack([points[:-1], points[1:]], axis=1), values

    axes.add_artist(_InParts(axes, pieces, looks))


class _InParts(Artist):
    """Pieces of a line that become paths when they are drawn, so many at once."""

    def __init__(self, axes: Axes, parts: Parts, looks: dict[str, Any]) -> None:
        super().__init__()
        self._on, self._parts, self._looks = axes, parts, looks
        self.set_zorder(looks.get("zorder", 2))
        self.set_rasterized(bool(looks.get("rasterized", False)))
        self.set_in_layout(False)  # the axes' limits are what counts

    @allow_rasterization
    def draw(self, renderer: RendererBase) -> None:
        figure = self._on.figure
        assert figure is not None
        for pieces, values in self._parts():
            for first in range(0, len(pieces), _AT_ONCE):
                part = slice(first, first + _AT_ONCE)
                lines = LineCollection(list(pieces[part]), array=values[part], **self._looks)
                lines.set_rasterized(False)  # the whole of them is
                lines.set_transform(self._on.transData)
                lines.axes = self._on
                lines.set_figure(figure)
                lines.set_clip_path(self._on.patch)
                lines.draw(renderer)
        self.stale = False
