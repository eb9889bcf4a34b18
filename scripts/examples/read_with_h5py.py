"""A result is a NetCDF 4 file, that is HDF5: any tool that reads one will do."""

import json

import h5py

with h5py.File("case3.nc") as file:
    force = file["normal_force"]
    print(force.shape, force.attrs["units"], force.attrs["long_name"])
    print([name.decode() for name in file["contact"][:]])
    counts = json.loads(file.attrs["counts"])
    print(file.attrs["format"], file.attrs["outcome"], sorted(counts))
