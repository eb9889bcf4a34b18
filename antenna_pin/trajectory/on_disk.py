"""Variables of a file that is too large for memory: what is asked of them is read when it is asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

__all__ = ["Stored", "StoredFile"]


class StoredFile:
    """An HDF5 file that stays open as long as its variables are used; it may be replaced meanwhile.

    Args:
        path: Of the file.
    """

    def __init__(self, path: Path) -> None:
        """Open it."""
        self._path = path
        self.file: Any = h5py.File(path, "r")

    def __getstate__(self) -> Path:
        return self._path

    def __setstate__(self, path: Path) -> None:
        self.__init__(path)  # type: ignore[misc]

    def __deepcopy__(self, memo: object) -> StoredFile:
        return self


class Stored(BackendArray):
    """A variable of a file, as xarray takes them.

    Args:
        source: The file.
        name: Of the variable.
    """

    def __init__(self, source: StoredFile, name: str) -> None:
        """Look how large it is."""
        self._source, self._name = source, name
        stored = source.file[name]
        self.shape: tuple[int, ...] = stored.shape
        self.dtype = stored.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        support = indexing.IndexingSupport.OUTER_1VECTOR
        return indexing.explicit_indexing_adapter(key, self.shape, support, self._read)

    def _read(self, key: tuple[Any, ...]) -> Any:
        return self._source.file[self._name][key]

    def variable(self, dims: tuple[str, ...], attributes: dict[str, Any]) -> xr.Variable:
        """Return it as a variable."""
        return xr.Variable(dims, indexing.LazilyIndexedArray(self), attributes)
