"""MAT files that end their reader: one line, whatever becomes of it."""

import multiprocessing
import os
import signal

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.fit.record_file import BadMatFileError, Mat73Error, read_columns, read_mat
from antenna_pin.studies.fit.specs import LayoutSpec
from antenna_pin.trajectory.file import open_hdf5

from .conftest import matlab_7_3

ANGLE = np.linspace(0.0, 1.0, 50)


@pytest.fixture
def path(tmp_path):
    savemat(tmp_path / "a.mat", {"angle": ANGLE, "rig": {"t": ANGLE, "note": "first"}})
    return tmp_path / "a.mat"


def test_what_is_whole_is_read(path):
    found = read_mat(path)
    assert np.array_equal(found["angle"], ANGLE) and np.array_equal(found["rig"]["t"].item(), ANGLE)


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGKILL, signal.SIGABRT])
def test_a_reader_that_dies_is_one_line(path, monkeypatch, number):
    monkeypatch.setattr("scipy.io.loadmat", lambda *_, **__: os.kill(os.getpid(), number))
    with pytest.raises(BadMatFileError, match=f"^its reader ended with {number.name}: the file is damaged"):
        read_mat(path)


def test_workers_of_a_pool_have_the_file_read_elsewhere_too(path, monkeypatch):
    """Multiprocessing lets a process that is to end with another start none."""
    own = os.getpid()
    monkeypatch.setitem(multiprocessing.current_process()._config, "daemon", True)
    monkeypatch.setattr("scipy.io.loadmat", lambda *_, **__: {"is_elsewhere": os.getpid() != own})
    assert read_mat(path) == {"is_elsewhere": True}


def test_a_reader_that_wants_all_memory_is_one_line(path, monkeypatch):
    monkeypatch.setattr("scipy.io.loadmat", lambda *_, **__: bytearray(10**15))
    with pytest.raises(BadMatFileError, match="needs more memory than this machine has"):
        read_mat(path)


def test_changed_bytes_are_refused_or_read(path):
    """Tags with any type and size; the process of the test is none the worse for it."""
    whole, random = path.read_bytes(), np.random.default_rng(0)
    refused = 0
    for _ in range(15):
        changed = bytearray(whole)
        for place in random.integers(128, len(whole), 3):
            changed[place] = random.integers(256)
        path.write_bytes(changed)
        try:
            read_mat(path)
        except BadMatFileError as error:
            refused += 1
            assert "\n" not in str(error)
    assert refused


def test_version_7_3_is_told(path):
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + bytes(400))
    with pytest.raises(Mat73Error):
        read_mat(path)


def circle(file):
    file.create_group("a")["b"] = file["/"]


def twice(file):
    file["b"] = file.create_group("a")


def unwritten(file):
    file.create_dataset("angle", (300_000_000,), "f8", chunks=True)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (circle, "a.mat cannot be read as a MAT file: group /a/b stands elsewhere in it, too"),
        (twice, "a.mat cannot be read as a MAT file: group /b stands elsewhere in it, too"),
        (unwritten, r"/angle must hold its own numbers, got 2\.4e\+09 bytes of which 0 are in the file"),
    ],
)
def test_hdf5_files_that_have_no_end_are_refused(tmp_path, make, said):
    """Version 7.3 of MAT files."""
    with matlab_7_3(tmp_path / "a.mat") as file:
        make(file)
    with pytest.raises(AntennaPinError, match=said):
        read_columns(tmp_path / "a.mat", ["angle"], LayoutSpec(), "records.a")


def test_what_is_packed_as_well_as_can_be_is_read(tmp_path):
    with h5py.File(tmp_path / "a.nc", "w") as file:
        file.create_dataset("x", data=np.zeros(10**7), compression="gzip", compression_opts=9)
    open_hdf5(tmp_path / "a.nc").close()
