"""Result files that are damaged, cut off or not ours: one line each, never a traceback."""

import h5py
import numpy as np
import pytest
import xarray as xr

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.errors import FileFormatError


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "run.nc"
    return simulate(load_scenario("impact_pair", case="contact"), duration=2e-3).save(path)


def _spoiled(data: xr.Dataset, name: str) -> xr.Dataset:
    values = data[name].values.copy()
    values.flat[0] = np.nan
    return data.assign({name: (data[name].dims, values)})


def _without_its_joint(data: xr.Dataset) -> xr.Dataset:
    (joint,) = data["clearance_joint"].values
    return data.assign_attrs(urdf=data.attrs["urdf"].replace(f'"{joint}"', '"another"'))


def _in_kilonewtons(data: xr.Dataset) -> xr.Dataset:
    changed = data.copy()
    changed["contact_force"].attrs["units"] = "kN"
    return changed


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda data: data.isel(time=slice(0, 0), episode=slice(0, 0)), "got no samples"),
        (lambda data: data.assign_coords(axis=["x", "x", "z"]), "labels in 'axis' that are there twice"),
        (_without_its_joint, "in the attribute 'clearance_joints' but not in its URDF"),
        (_in_kilonewtons, "'contact_force' in 'kN', not in 'N'"),
        (lambda data: data.drop_vars("contact_force"), "got no variable 'contact_force'"),
        (lambda data: data.drop_vars("q"), "got no variable 'q'"),
        (lambda data: _spoiled(data, "q"), "numbers in 'q' that are not finite"),
        (lambda data: data.isel(time=slice(None, None, -1)), "times that are not finite or go back"),
        (lambda data: data.assign_attrs(clearance_joints="{"), "'clearance_joints' that cannot be read"),
        (lambda data: data.assign_attrs(counts="[]"), "'counts' that cannot be read"),
        (lambda data: data.assign_attrs(outcome="PERHAPS"), "'outcome' that cannot be read"),
        (lambda data: data.assign_attrs(scenario="{}"), "'scenario' that cannot be read"),
    ],
)
def test_a_result_that_is_not_whole_is_refused(result, tmp_path, change, words):
    path = tmp_path / "changed.nc"
    change(xr.load_dataset(result)).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(FileFormatError, match=words):
        Trajectory.load(path)


def test_what_is_refused_is_one_line_of_a_command(result, tmp_path, cli):
    path = tmp_path / "changed.nc"
    xr.load_dataset(result).drop_vars("q").to_netcdf(path, engine="h5netcdf")
    said = cli("pointing", path)  # info does not read the scenario
    assert (said.code, said.out) == (2, "")
    assert len(said.err.splitlines()) == 1
    assert said.err.rstrip().endswith("run the scenario again")


@pytest.mark.parametrize("share", [0.0, 0.001, 0.5, 0.99])
def test_a_truncated_file_is_refused(result, tmp_path, share):
    content = result.read_bytes()
    path = tmp_path / "cut.nc"
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(FileFormatError, match="must be a NetCDF file written by antenna-pin"):
        Trajectory.load(path)


def test_numbers_that_were_damaged_are_not_read(result, tmp_path):
    """One bit of a velocity: the file's tables are whole, its checksum is not."""
    path = tmp_path / "flipped.nc"
    content = bytearray(result.read_bytes())
    with h5py.File(result) as file:
        content[file["v"].id.get_chunk_info(0).byte_offset + 5] ^= 1
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match="must be as antenna-pin wrote it, got another checksum"):
        Trajectory.load(path)


def test_any_flipped_bit_is_found(result, tmp_path):
    """Anywhere: numbers, HDF5's tables and what nobody reads, the seal itself."""
    content = result.read_bytes()
    path = tmp_path / "flipped.nc"
    chosen = np.random.default_rng(5).integers(8 * len(content), size=200)
    for bit in [*chosen, *range(8 * len(content) - 8 * 85, 8 * len(content), 8)]:
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        with pytest.raises(FileFormatError) as refused:
            Trajectory.load(path)
        assert len(str(refused.value).splitlines()) == 1, bit


def test_a_result_edited_in_place_is_not_taken_for_what_was_written(result, tmp_path):
    path = tmp_path / "edited.nc"
    path.write_bytes(result.read_bytes())
    with h5py.File(path, "r+") as file:
        file.attrs["title"] = "another"
    with pytest.raises(FileFormatError, match="another checksum"):
        Trajectory.load(path)


def test_a_result_opens_in_xarray_and_comes_back_from_it(result, tmp_path):
    """A NetCDF 4 file: coordinates, units and long names are found, and another writer's copy is read."""
    ours = Trajectory.load(result)
    with xr.open_dataset(result, engine="h5netcdf") as opened:
        theirs = opened.load()
    assert set(theirs.coords) == set(ours.data.coords)
    for name in ours.data.variables:
        xr.testing.assert_identical(theirs[name], ours.data[name])
    copied = tmp_path / "copied.nc"
    theirs.assign(mine=("time", np.arange(theirs.sizes["time"]))).to_netcdf(copied, engine="h5netcdf")
    again = Trajectory.load(copied)
    assert again.data["mine"].dims == ("time",)
    xr.testing.assert_identical(again.data.drop_vars("mine"), ours.data)
    assert again.summary() == ours.summary()
