"""HDF5 files opened for reading: what stands in them, and nothing that stands elsewhere.

A file of this format may say that the numbers of a dataset are in another file, at any path of the machine:
by external storage, as a virtual dataset, or by a link. HDF5 follows it without a word, so that a result from
a stranger would show bytes of a file of its reader's. No program that writes results writes such a thing.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import h5py

from antenna_pin.errors import FileFormatError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["load_dataset", "open_hdf5"]

_NO_VARIABLE = b"This is a netCDF dimension"  # such a dataset stands for a size, and has no numbers
_DEFLATED = 1032  # by this share deflate packs at most
_LITTLE = 2**20  # bytes, which do no harm


def open_hdf5(path: str | os.PathLike[str]) -> Any:
    """Return a file, an ``h5py.File`` to be read, in which every dataset holds its own numbers.

    Raises:
        FileFormatError: Something in it refers to another file.
        Exception: HDF5 raises any where the file is damaged or none of its own.
    """
    file = h5py.File(path, "r")
    try:
        _check(file, "/", {h5py.h5o.get_info(file.id).addr}, os.fspath(path))
    except BaseException:
        file.close()
        raise
    return file


def load_dataset(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return all that stands in a NetCDF 4 file as xarray reads it.

    Raises:
        FileFormatError: As :func:`open_hdf5`.
        Exception: The libraries raise any where the file is damaged or none of theirs.
    """
    import xarray as xr

    open_hdf5(path).close()
    with xr.open_dataset(path, engine="h5netcdf") as stored:
        return stored.load()


def _check(group: Any, at: str, seen: set[int], where: str) -> None:
    for name in group:
        link = group.get(name, getlink=True)  # which does not follow it
        if not isinstance(link, h5py.HardLink):
            raise _refusal(where, f"{at}{name}", "a link")
        found = h5py.h5o.open(group.id, name.encode())
        if isinstance(found, h5py.h5d.DatasetID):
            how = found.get_create_plist()
            if how.get_external_count():
                raise _refusal(where, f"{at}{name}", "numbers in another file")
            if how.get_layout() == h5py.h5d.VIRTUAL:
                raise _refusal(where, f"{at}{name}", "a virtual dataset")
            _check_stored(h5py.Dataset(found), f"{at}{name}", where)
        elif isinstance(found, h5py.h5g.GroupID):
            address = h5py.h5o.get_info(found).addr
            if address not in seen:  # groups may hold one another
                seen.add(address)
                _check(h5py.Group(found), f"{at}{name}/", seen, where)


def _check_stored(dataset: Any, name: str, where: str) -> None:
    """Refuse numbers that nobody has written, of which a short file can have any number."""
    if bytes(dataset.attrs.get("NAME", b"")).startswith(_NO_VARIABLE):
        return
    stored = dataset.id.get_storage_size()
    if dataset.nbytes > _DEFLATED * stored + _LITTLE:
        got = f"{dataset.nbytes:.3g} bytes of which {stored} are in the file"
        raise FileFormatError(f"{where}: {name} must hold its own numbers, got {got}; ask for a whole copy")


def _refusal(where: str, name: str, got: str) -> FileFormatError:
    return FileFormatError(
        f"{where}: {name} must hold its own numbers, got {got}; a result never refers to another file: ask "
        "who made this one for a whole copy"
    )
