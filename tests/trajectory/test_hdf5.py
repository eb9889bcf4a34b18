"""A result that refers to another file is refused before a byte of that is read, wherever it is opened."""

import h5py
import numpy as np
import pytest

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.base.files import seal
from antenna_pin.errors import FileFormatError
from antenna_pin.trajectory import format_of, open_table
from antenna_pin.trajectory.file import open_hdf5


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    path = simulate(load_scenario("impact_pair", case="contact"), duration=2e-3).save(folder / "run.nc")
    (folder / "secret").write_bytes(np.arange(10_000.0).tobytes())
    with h5py.File(folder / "other.nc", "w") as other:
        other["q"] = np.zeros((1000, 100))
    return path


def external(file, folder, shape):
    file.create_dataset("q", shape, "f8", external=[(str(folder / "secret"), 0, h5py.h5f.UNLIMITED)])


def virtual(file, folder, shape):
    layout = h5py.VirtualLayout(shape, "f8")
    layout[...] = h5py.VirtualSource(folder / "other.nc", "q", (1000, 100))[: shape[0], : shape[1]]
    file.create_virtual_dataset("q", layout)


# Of the last one group down, where xarray looks for further dimensions.
CHANGES = {
    "external": (external, "/q", "numbers in another file"),
    "virtual": (virtual, "/q", "a virtual dataset"),
    "link": (lambda f, at, _: f.update(q=h5py.ExternalLink(at / "other.nc", "q")), "/q", "a link"),
    "soft link": (lambda f, _, __: f.update(q=h5py.SoftLink("/v")), "/q", "a link"),
    "deep": (lambda f, *of: external(f.create_group("deep"), *of), "/deep/q", "numbers in another file"),
}


@pytest.mark.parametrize("kind", CHANGES)
def test_a_result_does_not_pull_in_another_file(run, tmp_path, kind):
    """Sealed like any, so that no checksum tells."""
    change, name, got = CHANGES[kind]
    path = tmp_path / "changed.nc"
    path.write_bytes(run.read_bytes())
    with h5py.File(path, "r+") as file:
        shape = file["q"].shape
        if kind != "deep":
            del file["q"]
        change(file, run.parent, shape)
    seal(path)
    said = f"{name} must hold its own numbers, got {got}; .* complete copy"
    for read in (Trajectory.load, format_of, lambda at: open_table(at, "orbit"), open_hdf5):
        with pytest.raises(FileFormatError, match=said):
            read(path)


def test_the_files_of_every_kind_are_read(run):
    """Groups that hold one another do not make it look for ever."""
    assert Trajectory.load(run).data.sizes["time"] > 0
    with h5py.File(run.parent / "loop.nc", "w") as file:
        file["a/b"] = h5py.Empty("f8")
        file["a/back"] = file["a"]
    assert format_of(run.parent / "loop.nc") == ""
