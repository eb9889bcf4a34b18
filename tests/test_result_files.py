"""Result files that are damaged, cut off or not ours: one line each, never a traceback."""

import h5py
import numpy as np
import pytest
import xarray as xr

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.errors import FileFormatError
from antenna_pin.trajectory.check import problem_of
from antenna_pin.trajectory.columns import ColumnRule
from antenna_pin.trajectory.file import write
from antenna_pin.trajectory.schema import VARIABLES


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "run.nc"
    return simulate(load_scenario("impact_pair", case="contact"), duration=2e-3).save(path)


@pytest.fixture
def data(loaded):
    """What the file holds, for each test anew."""
    return loaded.copy(deep=True)


@pytest.fixture(scope="module")
def loaded(result):
    return xr.load_dataset(result)


def _with(data: xr.Dataset, name: str, change) -> xr.Dataset:
    """Return data in one of whose variables numbers are changed, in place."""
    values = data[name].values.astype(float)
    change(values)
    return data.assign({name: (data[name].dims, values)})


# A number that breaks each part of a rule, and what it is set to where.
def _break(rule: ColumnRule, values: np.ndarray, data: xr.Dataset) -> None:
    last = (len(values) - 1, *(0,) * (values.ndim - 1))
    if rule.unit:
        values[-1] = 0.0
    elif rule.only:
        values[last] = 0.5
    elif rule.least != -np.inf:
        values[...] = rule.least - 1.0 - 2.0 * np.abs(values[np.isfinite(values)]).max(initial=0.0)
    elif rule.most != np.inf:
        values[last] = rule.most + 1.0
    elif rule.rising:
        values[last] = values[0] - 1.0
    elif rule.beside:
        apart = np.argwhere(data[rule.beside].values == 0)[0]
        values[(*apart, 0)] = 1.0
    else:
        values[last] = np.inf


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
        (lambda data: data.drop_vars("q"), "got no variable 'q'"),
        (lambda data: data.isel(time=slice(None, None, -1)), "in 'time' at .*, no less than the one before"),
        (lambda data: data.assign_attrs(clearance_joints="{"), "'clearance_joints' that cannot be read"),
        (lambda data: data.assign_attrs(counts="[]"), "'counts' that cannot be read"),
        (lambda data: data.assign_attrs(outcome="PERHAPS"), "'outcome' that cannot be read"),
        (lambda data: data.assign_attrs(scenario="{}"), "'scenario' that cannot be read"),
    ],
)
def test_a_result_that_is_not_whole_is_refused(data, tmp_path, change, words):
    path = tmp_path / "changed.nc"
    change(data).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(FileFormatError, match=words):
        Trajectory.load(path)


def test_every_column_is_held_to_its_rule(result):
    """The schema says of each column what it may be, and that is all."""
    data = Trajectory.load(result).data
    assert problem_of(data) is None
    found = [one for one in VARIABLES.values() if one.name in data and data[one.name].size]
    assert len(found) > 40
    for variable in found:
        said = problem_of(_with(data, variable.name, lambda v, rule=variable.rule: _break(rule, v, data)))
        assert said is not None and f"in '{variable.name}'" in said, (variable.name, said)
        assert "which must be finite" in said or variable.name == "episode_contact"


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("q", lambda q: q[3].__setitem__(slice(3, 7), 0.0), "in 'base' of 'q' at sample 3 .*of length 1"),
        (
            "q",
            lambda q: q[2].__setitem__(0, np.nan),
            r"nan in 'q' at sample 2 \(t = .* s\), which must be finite",
        ),
        ("normal_force", lambda f: np.negative(f, out=f), "in 'normal_force' at sample .*0 or more"),
        ("touching", lambda t: np.maximum(t, 0.5, out=t), "0.5 in 'touching' at sample 0 .*one of 0, 1"),
        ("touching", lambda t: t.fill(0.0), "in 'normal_force' at sample .*zero where touching is"),
        ("dissipated", lambda e: np.negative(e, out=e), "in 'dissipated' at episode 0, .*0 or more"),
        ("onset_time", lambda t: t.__setitem__(0, 1.0), "in 'onset_time' at episode 1, .*no less than"),
    ],
)
def test_what_a_hand_may_have_changed_is_told(data, tmp_path, name, change, words):
    path = tmp_path / "sealed.nc"
    write(_with(data, name, change), path)
    with pytest.raises(FileFormatError, match=words):
        Trajectory.load(path)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda data: data.assign_attrs(scenario="[]"), r"'\[\]' in the attribute 'scenario'.* a table"),
        (lambda data: data.assign_attrs(form="half"), "'half' in the attribute 'form'"),
        (
            lambda data: data.assign_coords(contact_end=("contact", ["top", "-", "+", "-"])),
            "'top'.* which must be ",
        ),
        (
            lambda data: data.assign_attrs(
                clearance_joints=data.attrs["clearance_joints"].replace('"load": "point"', '"load": "some"')
            ),
            "'clearance_joints' that cannot be read",
        ),
    ],
)
def test_words_that_there_are_not_are_refused(data, tmp_path, change, words):
    path = tmp_path / "sealed.nc"
    write(change(data), path)
    with pytest.raises(FileFormatError, match=words):
        Trajectory.load(path)


def test_a_run_that_ended_badly_may_have_numbers_that_are_none(data, tmp_path):
    data = _with(data, "a", lambda a: a[-1].fill(np.nan))
    path = tmp_path / "sealed.nc"
    write(data.assign_attrs(outcome="NOT_FINITE"), path)
    assert not Trajectory.load(path).completed
    write(data, path)
    with pytest.raises(FileFormatError, match="nan in 'a' at sample"):
        Trajectory.load(path)


def test_what_is_refused_is_one_line_of_a_command(data, tmp_path, cli):
    path = tmp_path / "changed.nc"
    data.drop_vars("q").to_netcdf(path, engine="h5netcdf")
    said = cli("pointing", path)  # info does not read the scenario
    assert (said.code, said.out) == (2, "")
    assert len(said.err.splitlines()) == 1
    assert said.err.rstrip().endswith("run the scenario again")


def test_a_truncated_file_is_refused(result, tmp_path):
    content = result.read_bytes()
    path = tmp_path / "cut.nc"
    for share in (0.0, 0.001, 0.5, 0.99):
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
    chosen = np.random.default_rng(5).integers(8 * len(content), size=60)
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


def test_samples_that_are_all_at_one_instant_are_no_result(result):
    data = Trajectory.load(result).data
    still = data.assign_coords(time=np.zeros(data.sizes["time"]))
    assert problem_of(still) == f"all {still.sizes['time']} samples of 'time' at one instant, 0 s"
