"""What a page holds in little room: texts, pictures and numbers, packed for its own script to unpack.

All is deflated (RFC 1950), which browsers undo by themselves. Of numbers the first bytes of all come first,
then the second ones, and so on: neighbours in a series differ in the last bytes only.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.plot import Drawn

__all__ = ["Numbers", "packed"]

_Array = NDArray[np.float64]
# Samples of a line, of which the page has fewer where all would take too much, at least.
_FEWEST = 64


def packed(content: bytes) -> str:
    """Return bytes as a page holds them."""
    return base64.b64encode(zlib.compress(content, 9)).decode()


class Numbers:
    """The numbers of all figures of a page, each column once: places, seven digits of what is over them.

    Args:
        most: What they may take [bytes]; longer lines are thinned to keep to it.
    """

    def __init__(self, most: float) -> None:
        """Begin with none."""
        self._most = most
        self._figures: dict[str, Sequence[Drawn]] = {}

    def add(self, key: str, drawn: Sequence[Drawn]) -> None:
        """Add what a figure shows, by the figure's name in the page."""
        if drawn:
            self._figures[key] = drawn

    def written(self) -> dict[str, Any]:
        """Return what the page's script reads: columns, and of each figure their names and which they are."""
        samples = max((one.columns[0].size for drawn in self._figures.values() for one in drawn), default=0)
        made, size = self._made(samples)
        while size > self._most and samples > _FEWEST:
            samples = max(int(0.9 * samples * self._most / size), _FEWEST)
            made, size = self._made(samples)
        return made

    def _made(self, most: int) -> tuple[dict[str, Any], int]:
        columns: dict[tuple[int, bytes], int] = {}
        texts: list[list[Any]] = []
        figures: dict[str, list[dict[str, Any]]] = {}
        for key, drawn in self._figures.items():
            figures[key] = []
            for one in drawn:
                places = []
                for number, values in enumerate(thinned(one.columns, most)):
                    exact = number == 0 and bool((np.diff(values) >= 0.0).all())
                    raw = _bytes(values, 8 if exact else 4)
                    name = (8 if exact else 4, raw)
                    if name not in columns:
                        columns[name] = len(texts)
                        texts.append([values.size, name[0], packed(raw)])
                    places.append(columns[name])
                about = {"panel": one.panel, "label": one.label, "names": one.names, "columns": places}
                figures[key].append(about | {"of": int(one.columns[0].size)})
        return {"columns": texts, "figures": figures}, sum(len(text) for _, _, text in texts)


def thinned(columns: Sequence[_Array], most: int) -> Iterable[_Array]:
    """Return columns with so many samples at most: of each stretch the first, the least and the greatest."""
    count = columns[0].size
    if count <= most:
        return columns
    stretches = np.array_split(np.arange(count), max(most // 3, 1))
    values = np.asarray(columns[1], dtype=float)
    low, high = np.nan_to_num(values, nan=np.inf), np.nan_to_num(values, nan=-np.inf)
    kept = {0, count - 1}
    for part in stretches:
        kept |= {int(part[0]), int(part[low[part].argmin()]), int(part[high[part].argmax()])}
    chosen = np.array(sorted(kept))
    return [np.asarray(column)[chosen] for column in columns]


def _bytes(values: _Array, width: int) -> bytes:
    whole = np.ascontiguousarray(values, dtype=f"<f{width}")
    return np.frombuffer(whole.tobytes(), dtype=np.uint8).reshape(-1, width).T.tobytes()
