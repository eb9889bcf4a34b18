"""Variables of a large file, read on access."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

_ROWS = 8192  # of a part that is read at once where single rows or columns are asked for


class StoredFile:
    """HDF5 file that stays open as long as its variables are used."""

    def __init__(self, path: Path, opened: Callable[[Path], Any]) -> None:
        """Open it."""
        self._path, self._opened = path, opened
        self.file: Any = opened(path)

    def __getstate__(self) -> tuple[Path, Callable[[Path], Any]]:
        return self._path, self._opened

    def __setstate__(self, state: tuple[Path, Callable[[Path], Any]]) -> None:
        self.__init__(*state)  # type: ignore[misc]

    def __deepcopy__(self, memo: object) -> StoredFile:
        return self


class Stored(BackendArray):
    """A variable of a file, as xarray takes them."""

    def __init__(self, source: StoredFile, name: str) -> None:
        """Look how large it is."""
        self._source, self._name = source, name
        stored = source.file[name]
        self.shape: tuple[int, ...] = stored.shape
        self.dtype = stored.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        support = indexing.IndexingSupport.OUTER
        return indexing.explicit_indexing_adapter(key, self.shape, support, self._read)

    def _read(self, key: tuple[Any, ...]) -> Any:
        stored = self._source.file[self._name]
        if not any(isinstance(one, np.ndarray) for one in key):
            return stored[key]
        if not isinstance(key[0], np.ndarray | slice):
            return _outer(stored[key[0]], key[1:])
        # HDF5 takes its time over lists of rows or columns: what they are in is read part by part.
        rows = np.arange(self.shape[0])[key[0]]
        parts = [_outer(stored[:0], (slice(None), *key[1:]))]
        begin = 0
        while begin < rows.size:
            first = int(rows[begin])
            near = (rows[begin : begin + _ROWS] >= first) & (rows[begin : begin + _ROWS] < first + _ROWS)
            end = begin + (int(np.argmin(near)) if not near.all() else near.size)
            part = stored[first : int(rows[begin:end].max()) + 1]
            parts.append(_outer(part, (rows[begin:end] - first, *key[1:])))
            begin = end
        return np.concatenate(parts)

    def variable(self, dims: tuple[str, ...], attributes: dict[str, Any]) -> xr.Variable:
        """Return it as a variable."""
        return xr.Variable(dims, indexing.LazilyIndexedArray(self), attributes)


def _outer(values: Any, key: tuple[Any, ...]) -> Any:
    """Return what lies at a key of numbers, slices and lists, one for each dimension."""
    for axis in reversed(range(len(key))):  # so that a number takes away no axis that is still to come
        values = values[(slice(None),) * axis + (key[axis],)]
    return values
