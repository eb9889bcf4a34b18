"""When the shim to machine code is used and when not; and what its build refuses."""

import importlib.metadata
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from antenna_pin.apps.cli import app
from antenna_pin.compiled import native, native_build
from antenna_pin.errors import InvalidParameterError, MissingToolError

PACKAGE = Path(native.__file__).parents[2]


@pytest.fixture
def copied(shim, tmp_path):
    """A copy of the shim's file, to be changed."""
    return Path(shutil.copy(native_build.FOLDER / native_build.NAME, tmp_path))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (b'"pin": "', b'"pin": "9', "built for pin 9"),
        (b'"coal": "', b'"coal": "9', "built for coal 9"),
        (b'"interface": 1', b'"interface": 7', "built of other sources"),
        (b'"source": "', b'"source": "x', "built of other sources"),
        (b"antenna_pin shim: ", b"another's shim:    ", "is no shim"),
    ],
)
def test_a_shim_for_something_else_is_not_loaded(old, new, said, copied):
    """Told by the text in the file, before anything of it runs."""
    content = copied.read_bytes()
    at = content.index(old)
    # As long as before: the text ends at its line's end, wherever that is.
    copied.write_bytes(content[:at] + new + content[at + len(new) :])
    native_build.seal(copied)
    with pytest.raises(native._NotUsedError, match=said):
        native._load(copied)


def test_a_shim_that_is_missing_or_damaged_or_open_to_others_is_not_loaded(copied):
    """The system's loader would crash of a file that is cut off."""
    content = copied.read_bytes()
    copied.chmod(0o777)
    with pytest.raises(native._NotUsedError, match="not safe"):
        native._load(copied)
    copied.chmod(0o755)
    for damaged in (content[:-1000], content[:5000] + b"?" + content[5001:], b""):
        copied.write_bytes(damaged)
        with pytest.raises(native._NotUsedError, match="or damaged"):
            native._load(copied)
    copied.write_bytes(b"no machine code at all, antenna_pin shim: ")
    native_build.seal(copied)
    with pytest.raises(native._NotUsedError, match="cannot be read"):
        native._load(copied)
    copied.unlink()
    with pytest.raises(native._NotUsedError, match="not built"):
        native._load(copied)


def test_the_environment_chooses(monkeypatch):
    monkeypatch.setenv("ANTENNA_PIN_NATIVE", "off")
    assert native.native_shim() is None
    assert native.native_state() == "not used: ANTENNA_PIN_NATIVE=off"
    monkeypatch.setenv("ANTENNA_PIN_NATIVE", "maybe")
    with pytest.raises(InvalidParameterError, match="ANTENNA_PIN_NATIVE must be off, required or empty"):
        native.native_shim()
    monkeypatch.setenv("ANTENNA_PIN_NATIVE", "required")
    monkeypatch.setattr(native, "_loaded", lambda: (None, "it is not built"))
    with pytest.raises(MissingToolError, match="must be usable, but it is not built"):
        native.native_shim()


# --- build --------------------------------------------------------------------------------------------------


def test_a_build_without_a_compiler_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    with pytest.raises(native_build.NativeBuildError, match=r"C\+\+ compiler must be on the path.*apt-get"):
        native_build.build(tmp_path / "shim.so")
    monkeypatch.setenv("CXX", "no-such-compiler")
    with pytest.raises(native_build.NativeBuildError, match="tried no-such-compiler"):
        native_build.build(tmp_path / "shim.so")


def test_a_build_without_headers_says_which(monkeypatch, tmp_path):
    monkeypatch.setattr(native_build, "_compiler", lambda: "c++")
    known = native_build.prefix_of
    monkeypatch.setattr(native_build, "prefix_of", lambda name: None if "eigen" in name else known(name))
    with pytest.raises(native_build.NativeBuildError, match="pip install cmeel-eigen"):
        native_build.build(tmp_path / "shim.so")


@pytest.fixture
def compiler(monkeypatch, tmp_path, shim):
    """A compiler that takes half a second, notes that it was called, and copies the shim that is there."""
    made = tmp_path / "compiler"
    made.mkdir()
    script = made / "c++"
    script.write_text(
        f'#!/bin/sh\necho called >>"{made}/calls"\nsleep 0.5\n'
        'while [ "$1" != -o ]; do shift; done\n'
        f'cp "{native_build.FOLDER / native_build.NAME}" "$2"\n'
    )
    script.chmod(0o755)
    monkeypatch.setenv("CXX", str(script))
    monkeypatch.setattr(native_build, "prefix_of", lambda name: _prefix())
    return made / "calls"


def _prefix():
    found = native_build.importlib.metadata.distribution("libpinocchio").locate_file("cmeel.prefix")
    return Path(str(found))


def test_of_two_builds_at_once_one_compiles(compiler, tmp_path):
    """Threads of one process: a folder's lock is that of an open file."""
    from concurrent.futures import ThreadPoolExecutor

    target = tmp_path / "shim.so"
    with ThreadPoolExecutor(2) as pool:
        said = list(pool.map(lambda _: native_build.build(target), range(2)))
    assert sorted(one.split()[1] for one in said) == ["built", "shim.so"]
    assert compiler.read_text().split() == ["called"]
    assert native_build.built_of(target)["interface"] == 1
    assert set(os.listdir(tmp_path)) == {"compiler", "shim.so"}


def test_a_folder_that_may_not_be_written_is_named(compiler):
    """``/proc`` may be written by nobody, root included."""
    with pytest.raises(native_build.NativeBuildError, match="native: /proc must be writable"):
        native_build.build(Path("/proc/shim.so"))


def test_a_compiler_that_fails_leaves_what_was_there(monkeypatch, tmp_path, compiler):
    target = tmp_path / "shim.so"
    target.write_bytes(b"another")
    script = Path(os.environ["CXX"])
    script.write_text("#!/bin/sh\necho 'shim.cpp:7: error: no such thing' >&2\nexit 1\n")
    with pytest.raises(native_build.NativeBuildError, match="got shim.cpp:7: error: no such thing"):
        native_build.build(target)
    assert target.read_bytes() == b"another"
    assert set(os.listdir(tmp_path)) == {"compiler", "shim.so"}


@pytest.mark.slow
def test_the_shim_is_built_within_a_minute_and_loads(tmp_path, shim):
    """On one core; the processor's time counts, since others may be at work."""
    pytest.importorskip("resource")
    if native_build.prefix_of("cmeel-eigen") is None or shutil.which("c++") is None:
        pytest.skip("no compiler, or no headers of Eigen")
    import resource

    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    native_build.build(tmp_path / "shim.so")
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before < 60.0
    assert native._load(tmp_path / "shim.so").acceleration != 0


def test_a_forked_process_calls_machine_code_as_its_parent(shim):
    """A study's processes are forked with the shim loaded."""
    code = (
        "import os, sys\n"
        "from antenna_pin import load_scenario, simulate\n"
        "run = lambda: simulate(load_scenario('bai2020', case='case3'), duration=2e-3).data['v'].values\n"
        "here = run()\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        "    os._exit(0 if (run() == here).all() else 1)\n"
        "sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))\n"
    )
    environment = os.environ | {"ANTENNA_PIN_NATIVE": "required", "PYTHONPATH": str(PACKAGE)}
    began = time.monotonic()
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], env=environment, check=False)
    assert done.returncode == 0, time.monotonic() - began


def test_the_command_line_says_whether_it_is_used(monkeypatch):
    monkeypatch.setenv("ANTENNA_PIN_NATIVE", "off")
    said = CliRunner().invoke(app, ["info", "--versions"])
    assert said.exit_code == 0
    assert "native shim  not used: ANTENNA_PIN_NATIVE=off" in said.stdout
    assert f"pin          {importlib.metadata.version('pin')}" in said.stdout
