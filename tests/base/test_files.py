"""Files are complete or as they were, whatever ends the writing."""

import errno
import os
import re
import resource
import subprocess
import sys
import threading

import h5py
import numpy as np
import pytest
import xarray as xr

from antenna_pin.base.files import PatientFile, check_writable, has_whole_seal, replacing, seal
from antenna_pin.errors import OutputError
from antenna_pin.trajectory.file import write


def test_what_was_written_becomes_the_file(tmp_path):
    """Also of the longest name; a folder that is not there is said in one line."""
    target = tmp_path / "result.txt"
    target.write_text("old")
    with replacing(target) as partial:
        partial.write_text("new")
        assert target.read_text() == "old"
    assert target.read_text() == "new"
    assert list(tmp_path.iterdir()) == [target]
    # The temporary name must not be longer than the file's own.
    target = tmp_path / ("n" * 252 + ".nc")
    check_writable(target)
    with replacing(target) as partial:
        partial.write_text("new")
    assert target.read_text() == "new"
    target = tmp_path / "missing" / "result.txt"
    message = rf"^{re.escape(str(target))}: cannot be written: No such file or directory$"
    with pytest.raises(OutputError, match=message), replacing(target) as partial:
        partial.write_text("new")


@pytest.mark.parametrize("reason", [KeyboardInterrupt, ValueError, OutputError("other.txt: is full")])
def test_what_ends_the_writing_leaves_the_file_as_it_was(tmp_path, reason):
    """Nothing stays beside it, and the reason is passed on: an error of another file keeps its words."""
    target = tmp_path / "result.txt"
    target.write_text("old")
    expected = reason if isinstance(reason, type) else type(reason)
    with pytest.raises(expected) as ended, replacing(target) as partial:
        partial.write_text("half of")
        raise reason
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]
    assert isinstance(reason, type) or str(ended.value) == "other.txt: is full"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("n" * 253 + ".nc", "File name too long"),
        ("missing/run.nc", "does not exist"),
        ("file/run.nc", "does not exist"),
        ("pipe", "got a device or pipe"),
        ("folder", "got a folder"),
        ("null\0", "null"),
    ],
)
def test_what_can_never_be_written_is_refused_before_any_work(tmp_path, name, words):
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OutputError, match=words) as refused:
        check_writable(tmp_path / name)
    assert len(str(refused.value)) < 300 + len(str(tmp_path))


def test_a_link_keeps_pointing_at_what_is_written(tmp_path):
    (tmp_path / "far").mkdir()
    link = tmp_path / "run.nc"
    link.symlink_to(tmp_path / "far" / "run.nc")
    with replacing(check_writable(link)) as partial:
        assert partial.parent == tmp_path / "far"  # a move between file systems could not be whole
        partial.write_text("new")
    assert link.is_symlink()
    assert (tmp_path / "far" / "run.nc").read_text() == "new"


def test_threads_that_write_one_file_do_not_meet(tmp_path):
    target = tmp_path / "result.txt"
    both = threading.Barrier(2)

    def fill(text):
        with replacing(target) as partial:
            partial.write_text(text)
            both.wait()
            assert partial.read_text() == text
            both.wait()

    threads = [threading.Thread(target=fill, args=(text,)) for text in ("one", "other")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert target.read_text() in ("one", "other")
    assert list(tmp_path.iterdir()) == [target]


_HALF = """
import sys, time
from antenna_pin.base.files import replacing
with replacing(sys.argv[1]) as partial:
    partial.write_text("half")
    print("half", flush=True)
    time.sleep(600)
"""


def test_what_a_killed_process_has_left_is_removed_by_the_next_and_what_one_writes_is_not(tmp_path):
    target = tmp_path / "result.txt"
    processes = [
        subprocess.Popen([sys.executable, "-c", _HALF, str(target)], stdout=subprocess.PIPE) for _ in range(2)
    ]
    for process in processes:
        assert process.stdout.readline() == b"half\n"
    assert len(list(tmp_path.iterdir())) == 2
    killed, alive = processes
    killed.kill()
    killed.wait()
    with replacing(target) as partial:
        partial.write_text("new")
    left = [path for path in tmp_path.iterdir() if path != target]
    assert [path.read_text() for path in left] == ["half"]
    assert str(alive.pid) in left[0].name
    for process in processes:
        process.kill()
        process.wait()
        process.stdout.close()


# --- a full disk ---


def test_hdf5_writes_through_a_patient_file_what_it_writes_itself(tmp_path):
    """It asks for places and reads back, too; then bytes are those of HDF5's own driver."""
    values = np.arange(30000.0)
    for name in (tmp_path / "own.h5", PatientFile(tmp_path / "patient.h5")):
        with h5py.File(name, "w", track_order=True) as file:
            for k in range(20):
                file.create_dataset(f"values{k}", data=values, chunks=(10000,), track_times=False)
                file[f"values{k}"].attrs["units"] = "m"
            file["values3"][:] = -values
    assert (tmp_path / "own.h5").read_bytes() == (tmp_path / "patient.h5").read_bytes()


def test_a_disk_that_is_full_at_any_write_costs_the_new_file_only(tmp_path, monkeypatch):
    """HDF5 crashes in its own way out if it ever hears of it; so every write fails once, from then on all."""
    data = xr.Dataset(
        {f"x{k}": (("time", "axis"), np.full((50, 3), float(k)), {"units": "m"}) for k in range(4)},
        coords={"time": np.arange(50.0), "axis": ["x", "y", "z"]},
        attrs={"format": "any"},
    )
    target = tmp_path / "run.nc"
    target.write_text("old")
    real, left = os.pwrite, [0]

    def full(descriptor, content, place):
        left[0] -= 1
        if left[0] < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(descriptor, content[: max(1, len(content) // 2)], place)  # short writes, too

    monkeypatch.setattr(os, "pwrite", full)
    for number in range(1000):
        left[0] = number
        try:
            with replacing(target) as partial:
                write(data, partial)
        except OutputError as error:
            assert str(error) == f"{target}: cannot be written: No space left on device"
            assert target.read_text() == "old"
            assert list(tmp_path.iterdir()) == [target]
        else:
            break
    assert number > 20
    assert has_whole_seal(target)


def test_a_patient_file_reads_back_what_it_could_not_write(tmp_path, monkeypatch):
    with PatientFile(tmp_path / "file") as file:
        file.write(b"0123456789")
        monkeypatch.setattr(os, "pwrite", lambda *_: (_ for _ in ()).throw(OSError(errno.ENOSPC, "full")))
        file.seek(8)
        file.write(b"abcd")
        file.seek(9)
        file.write(b"X")
        file.seek(0)
        assert file.read() == b"01234567aXcd"
        with pytest.raises(OSError, match="full"):
            file.check()


def _with_small_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))


def test_a_run_whose_result_does_not_fit_says_so_in_one_line(tmp_path, but_for_work):
    """The limit holds in every folder, so the result is nowhere; an older one is as it was."""
    (tmp_path / "run.nc").write_text("old")
    said = subprocess.run(
        [sys.executable, "-m", "antenna_pin.apps.cli", "run", "bai2020", "--case", "case1"]
        + ["--duration", "0.05", "--out", "run.nc", "--no-progress"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        preexec_fn=_with_small_files,
    )
    assert (said.returncode, said.stdout) == (2, "")
    (line,) = but_for_work(said.stderr).splitlines()
    assert line.startswith("antenna-pin: run.nc: cannot be written: File too large; no other folder")
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]
    assert (tmp_path / "run.nc").read_text() == "old"


def test_a_result_that_its_folder_has_no_room_for_is_written_elsewhere(cli, tmp_path, monkeypatch):
    far = tmp_path / "far"
    far.mkdir()
    real = os.pwrite

    def full(descriptor, content, place):
        if str(far) in os.readlink(f"/proc/self/fd/{descriptor}"):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(descriptor, content, place)

    monkeypatch.setattr(os, "pwrite", full)
    said = cli("run", "bai2020", "--case", "case1", "--duration", "0.002", "--out", far / "r.nc", "--quiet")
    assert said.code == 2
    assert said.err.endswith("No space left on device; the result is in r.nc instead\n")
    assert has_whole_seal(tmp_path / "r.nc")
    assert list(far.iterdir()) == []


@pytest.mark.parametrize("place", [0, 7, 8, 20, 40, 84, 92])
def test_a_seal_tells_whether_a_file_is_as_it_was(tmp_path, place):
    path = tmp_path / "file"
    path.write_bytes(b"8 bytes.")
    assert has_whole_seal(path) is None
    seal(path)
    assert has_whole_seal(path) is True
    content = bytearray(path.read_bytes())
    assert len(content) == 93
    content[place] ^= 4
    path.write_bytes(content)
    assert has_whole_seal(path) is not True
