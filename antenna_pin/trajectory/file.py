"""NetCDF 4 files of datasets, by HDF5's own library, for speed.

A NetCDF 4 file is an HDF5 file in which every dimension is a *scale*, a dataset that others name as their
axis. Nothing is compressed: of doubles at their full length that saves a quarter of the file and takes four
times as long as all the rest. Behind HDF5's own end stands a digest of the whole file, so that a damaged one
is not read; every variable also has a checksum for other readers.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from antenna_pin.base.files import PatientFile, absence, escaped, has_whole_seal, seal
from antenna_pin.base.interruption import held_back
from antenna_pin.errors import FileFormatError
from antenna_pin.trajectory.labelled import Column, Content
from antenna_pin.trajectory.schema import COORDINATES, DIMENSIONS, VARIABLES

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.trajectory.on_disk import StoredFile

_NO_NUMBERS = b"This is a netCDF dimension"  # such a dataset stands for a size, and has no numbers
_DEFLATED = 1032  # by this share deflate packs at most
_LITTLE = 2**20  # bytes, which do no harm


def open_hdf5(path: str | os.PathLike[str]) -> Any:
    """Return an open ``h5py.File``; refuse data outside the file.

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


def _check(group: Any, at: str, addresses: set[int], where: str) -> None:
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
            if address not in addresses:  # groups may contain one another
                addresses.add(address)
                _check(h5py.Group(found), f"{at}{name}/", addresses, where)


def _check_stored(dataset: Any, name: str, where: str) -> None:
    """Refuse numbers that are not in the file."""
    stored = dataset.id.get_storage_size()
    if dataset.nbytes > _DEFLATED * stored + _LITTLE:
        if bytes(dataset.attrs.get("NAME", b"")).startswith(_NO_NUMBERS):
            return
        got = f"{dataset.nbytes:.3g} bytes of which {stored} are in the file"
        raise FileFormatError(f"{where}: {name} must hold its own numbers, got {got}; get a complete copy")


def _refusal(where: str, name: str, got: str) -> FileFormatError:
    return FileFormatError(
        f"{where}: {name} must hold its own numbers, got {got}; a result must not refer to another file; "
        f"get a complete copy from its author"
    )


#: Identifies the file format; others are refused.
FORMAT = "antenna_pin trajectory 3"

# Says in NetCDF's own attribute that a file is as this module wrote it, and so must end in a seal.
_WRITER = "antenna_pin=" + FORMAT.rpartition(" ")[2]
# A variable of more bytes is stored in pieces of so many samples, and written one after the other.
_AT_ONCE = 4_000_000
_ROWS = 8192
# Of a file of more bytes than the one variables of more than the other are read when they are asked for.
_LARGE = 64_000_000
_SHORT = 1_000_000
_TEXT = h5py.string_dtype()
# What belongs to the file, not to the data.
_OWN = {
    *("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "_Netcdf4Dimid", "_Netcdf4Coordinates"),
    *("_NCProperties", "_FillValue", "coordinates"),
}
_CHANGED = (
    "{}: must be as antenna-pin wrote it, got another checksum: it was damaged, or edited in place; take "
    "another copy of it, or run the scenario again"
)
# NetCDF's own words for a dimension without labels, with its length.
_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"


def write(data: xr.Dataset | Content, path: Path) -> None:
    """Write a dataset or its content.

    Raises:
        OSError: It cannot be written there.
    """
    # Neither a full disk nor Ctrl-C may reach HDF5, which cannot be stopped on its way.
    with held_back(), PatientFile(path) as stream:
        with h5py.File(stream, "w", track_order=True) as file:
            made = _structure(file, data)
            for name, variable in data.variables.items():
                if name in made:
                    _put(made[name], variable, stream)
            _attribute(file, data)
        stream.check()
    seal(path)


def write_blocks(
    blocks: Iterator[tuple[int, Mapping[str, Any]]],
    dataset_of: Callable[[Mapping[str, Any]], xr.Dataset | Content],
    count: int,
    path: Path,
) -> None:
    """Write a dataset that is too large for memory.

    Args:
        blocks: The number of a block's first sample, and its series by name.
        dataset_of: Returns the whole dataset for given series, once all blocks have been made; before that it
            may have other numbers in what is no series, and other attributes.
        count: Samples in all.
        path: Where.

    Raises:
        OSError: It cannot be written there.
    """
    with held_back(), PatientFile(path) as stream:
        # Whole pieces are written once each: a cache of them would be one for every variable.
        with h5py.File(stream, "w", track_order=True, rdcc_nbytes=0) as file:
            made: dict[Any, Any] = {}
            series: dict[Any, Any] = {}
            for first, values in blocks:
                if not made:
                    for name, part in values.items():  # of the right shape, and next to no size
                        series[name] = np.broadcast_to(np.zeros((), part.dtype), (count, *part.shape[1:]))
                    made = _structure(file, dataset_of(series))
                for name, part in values.items():
                    if name in made and part.size:
                        made[name][first : first + len(part)] = part
                stream.check()
            data = dataset_of(series)
            for key, variable in data.variables.items():
                if key in made and key not in series:
                    _put(made[key], variable, stream)
            _attribute(file, data)
        stream.check()
    seal(path)


def _attribute(file: Any, data: xr.Dataset | Content) -> None:
    file.attrs["_NCProperties"] = (
        f"version=2,{_WRITER},h5py={h5py.__version__},hdf5={h5py.version.hdf5_version}"
    )
    for name, value in data.attrs.items():
        file.attrs[str(name)] = escaped(value) if isinstance(value, str) else value


def _structure(file: Any, data: xr.Dataset | Content) -> dict[Any, Any]:
    """Make all that a file holds, without the numbers; return its variables, by name."""
    scales, variables = {}, {}
    for number, (name, size) in enumerate(data.sizes.items()):
        if name in data.coords:
            scale = variables[name] = _create(file, str(name), data.variables[str(name)])
        else:
            scale = file.create_dataset(str(name), shape=(size,), dtype=">f4")
        scale.make_scale(str(name) if name in data.coords else _NO_VARIABLE.format(size))
        scale.attrs["_Netcdf4Dimid"] = np.int32(number)
        scales[name] = scale.ref
    users: dict[Any, list[tuple[Any, int]]] = {name: [] for name in scales}
    for name, variable in data.variables.items():
        if name in scales:
            continue
        made = variables[name] = _create(file, str(name), variable)
        others = [c.name for c in COORDINATES if c.dim in variable.dims and name not in data.coords]
        if others:
            made.attrs["coordinates"] = " ".join(others)
        lists = np.empty(variable.ndim, dtype=h5py.vlen_dtype(h5py.ref_dtype))
        for axis, dim in enumerate(variable.dims):
            lists[axis] = np.array([scales[dim]], dtype=h5py.ref_dtype)
            users[dim].append((made.ref, axis))
        if variable.ndim:
            made.attrs.create("DIMENSION_LIST", lists, dtype=h5py.vlen_dtype(h5py.ref_dtype))
    back = np.dtype([("dataset", h5py.ref_dtype), ("dimension", np.int32)])
    for name, found in users.items():
        if found:
            file[str(name)].attrs.create("REFERENCE_LIST", np.array(found, dtype=back))
    return variables


def _create(file: Any, name: str, variable: xr.Variable | Column) -> Any:
    if variable.dtype.kind in "OUT":
        made = file.create_dataset(name, shape=variable.shape, dtype=_TEXT)
    elif variable.size and variable.ndim:
        rows = variable.shape[0] if variable.nbytes <= _AT_ONCE else min(variable.shape[0], _ROWS)
        shape = variable.shape
        made = file.create_dataset(
            name, shape=shape, dtype=variable.dtype, chunks=(rows, *shape[1:]), fletcher32=True
        )
    else:
        made = file.create_dataset(name, shape=variable.shape, dtype=variable.dtype)
    for key, value in variable.attrs.items():
        made.attrs[str(key)] = value
    return made


def _put(stored: Any, variable: xr.Variable | Column, stream: PatientFile) -> None:
    """Write the numbers of a variable, a part at a time if they are many."""
    if variable.dtype.kind in "OUT":
        stored[()] = variable.values.astype(object)
    elif variable.size and variable.nbytes <= _AT_ONCE:
        stored[()] = variable.values
    elif variable.size:
        for first in range(0, variable.shape[0], _ROWS):
            stored[first : first + _ROWS] = variable[first : first + _ROWS].values
            stream.check()
    stream.check()


def read(source: Path) -> xr.Dataset:
    """Return the dataset of a file; also of one that another program has written again.

    Raises:
        FileFormatError: It is not there, damaged, or not of this version of the format.
    """
    if not source.is_file():
        raise FileFormatError(f"{source}: {absence(source)}; `antenna-pin run` writes one")
    try:
        whole = has_whole_seal(source)
        if whole is False:
            raise FileFormatError(_CHANGED.format(source))
        with open_hdf5(source) as file:
            if whole is None and _WRITER in str(file.attrs.get("_NCProperties")):
                raise FileFormatError(_CHANGED.format(source))
            attributes = _attributes(file)
            found = attributes.get("format")
            known = isinstance(found, str) and found == FORMAT
            large = source.stat().st_size > _LARGE
            content = _variables(file, _stored(source) if large else None) if known else {}
    except FileFormatError:
        raise
    except Exception as error:  # HDF5 raises any if damaged
        words = " ".join(str(error).split())
        raise FileFormatError(
            f"{source}: must be a NetCDF file written by antenna-pin, got: {words}"
        ) from None
    if not known:
        run = not isinstance(found, str) or found.startswith(FORMAT.rpartition(" ")[0])
        way = "run the scenario again with this version" if run else "`antenna-pin report` shows other files"
        raise FileFormatError(f"{source}: the format must be {FORMAT!r}, got {found!r}; {way}")
    import xarray as xr

    labels = {*DIMENSIONS, *(coordinate.name for coordinate in COORDINATES)}
    try:
        return xr.Dataset(
            {name: variable for name, variable in content.items() if name not in labels},
            coords={name: variable for name, variable in content.items() if name in labels},
            attrs=attributes,
        )
    except ValueError as error:  # shapes that do not go together
        words = " ".join(str(error).split())
        raise FileFormatError(
            f"{source}: must be a whole result of antenna-pin, got {words}; run the scenario again"
        ) from None


def _stored(source: Path) -> StoredFile:
    from antenna_pin.trajectory.on_disk import StoredFile

    return StoredFile(source, open_hdf5)


def _variables(file: Any, large: StoredFile | None) -> dict[str, xr.Variable]:
    """Return the variables of a file; long ones of a large file are read later."""
    import xarray as xr

    from antenna_pin.trajectory.on_disk import Stored

    names: dict[str, tuple[str, ...]] = {one.name: (one.dim,) for one in COORDINATES}
    names |= {variable.name: variable.dims for variable in VARIABLES.values()}
    content = {}
    for name, stored in file.items():
        if not isinstance(stored, h5py.Dataset):  # a link to nowhere, a group
            continue
        attributes = _attributes(stored)
        if name in DIMENSIONS:
            if bytes(stored.attrs.get("NAME", b"")).startswith(_NO_VARIABLE[:20].encode()):
                continue
            dims: tuple[str, ...] = (name,)
        else:
            dims = names.get(name) or _dims_of(file, stored)
        if large is not None and stored.nbytes > _SHORT and name not in DIMENSIONS:
            content[name] = Stored(large, name).variable(dims, attributes)
            continue
        values = stored[()]
        if values.dtype == object:
            values = np.array([text.decode() for text in values], dtype=object)
        content[name] = xr.Variable(dims, values, attributes)
    return content


def _dims_of(file: Any, stored: Any) -> tuple[str, ...]:
    """Return the dimensions of a variable outside the schema."""
    return tuple(file[references[0]].name.strip("/") for references in stored.attrs["DIMENSION_LIST"])


def _attributes(stored: Any) -> dict[str, Any]:
    attributes = stored.attrs
    read = {name: attributes[name] for name in attributes if name not in _OWN}
    return {
        # Some programs write a number as a row of one.
        name: value.item() if isinstance(value, np.generic | np.ndarray) and value.size == 1 else value
        for name, value in read.items()
    }
