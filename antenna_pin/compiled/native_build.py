"""Build of the shim to Pinocchio's and coal's machine code, from ``antenna_pin/native``.

Only the standard library is needed, so that the wheel's build hook and ``scripts/setup`` use it as well::

    python -m antenna_pin.compiled.native_build            # into the package's folder
    python -m antenna_pin.compiled.native_build --quiet    # silent on success

The headers are those of the installed wheels of Pinocchio, coal and Boost, Eigen's those of the package
``cmeel-eigen``. No flag chooses an instruction set: the wheels are built for the baseline of the platform,
and Eigen's alignment must be theirs.
"""

from __future__ import annotations

import argparse
import contextlib
import fcntl
import hashlib
import importlib.metadata
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

#: Folder of the sources, and of the shared library.
FOLDER = Path(__file__).parents[1] / "native"
#: Name of the shared library.
NAME = "shim.so"

_SOURCES = ("shim.h", "shim.cpp")
_MARKER = b"antenna_pin shim: "
# The shared library ends with this and its digest: a truncated file would crash the process that loads it.
_SEAL = b"\nantenna_pin seal: "
_COMPILERS = ("c++", "g++", "clang++")
# Definitions of Pinocchio's and coal's CMake files for users of the headers.
_DEFINITIONS = (
    "NDEBUG",
    "PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION",
    "PINOCCHIO_WITH_COLLISION",
    "BOOST_MPL_LIMIT_LIST_SIZE=30",
    "BOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "BOOST_FUSION_INVOKE_MAX_ARITY=12",
)
_LONGEST = 300.0  # limit of a compiler's time [s]


class NativeBuildError(RuntimeError):
    """Failed build of the shim, with the reason and a way out."""


def digest_of_sources(folder: Path = FOLDER) -> str:
    """Return a digest of the shim's sources and compile-time definitions."""
    digest = hashlib.sha256(" ".join(_DEFINITIONS).encode())
    for name in _SOURCES:
        digest.update((folder / name).read_bytes())
    return digest.hexdigest()[:16]


def prefix_of(package: str) -> Path | None:
    """Return the cmeel folder of an installed wheel; None without one."""
    try:
        found = Path(str(importlib.metadata.distribution(package).locate_file("cmeel.prefix")))
    except importlib.metadata.PackageNotFoundError:
        return None
    return found if found.is_dir() else None


def built_of(path: Path) -> dict[str, str | int]:
    """Return the versions stored in a built shim, without loading it.

    Raises:
        OSError: It cannot be read.
        ValueError: The file is no shim, or not as it was built.
    """
    content, _, digest = path.read_bytes().rpartition(_SEAL)
    if hashlib.sha256(content).hexdigest().encode() != digest:
        raise ValueError(f"{path}: is no shim of antenna_pin, or damaged")
    at = content.find(_MARKER)
    line = content[at + len(_MARKER) :].partition(b"\n")[0] if at >= 0 else b""
    told = json.loads(line.decode("utf-8", "replace") or "0")
    if not isinstance(told, dict):
        raise ValueError(f"{path}: is no shim of antenna_pin")
    return told


def seal(path: Path) -> None:
    """Append the digest of a shared library to it."""
    content = path.read_bytes().partition(_SEAL)[0]
    path.write_bytes(content + _SEAL + hashlib.sha256(content).hexdigest().encode())


def build(target: Path = FOLDER / NAME, sources: Path = FOLDER) -> str:
    """Build the shim unless it is up to date; return a sentence on it.

    Of several builds at the same time one compiles and the others wait; the file is complete or missing.

    Args:
        target: The shared library.
        sources: Folder of the sources.

    Raises:
        NativeBuildError: There is no compiler, a package is missing, the folder cannot be written, or the
            compiler fails.
    """
    compiler = _compiler()
    libraries, eigen = prefix_of("libpinocchio"), prefix_of("cmeel-eigen")
    for package, prefix in (("libpinocchio", libraries), ("libcoal", prefix_of("libcoal"))):
        if prefix is None or not (prefix / "include").is_dir():
            raise NativeBuildError(
                f"native: the headers of {package} must be installed, by pip install pin coal"
            )
    if eigen is None:
        raise NativeBuildError("native: Eigen's headers must be installed, by pip install cmeel-eigen")
    assert libraries is not None
    wanted = {
        "pin": importlib.metadata.version("libpinocchio"),
        "coal": importlib.metadata.version("libcoal"),
        "source": digest_of_sources(sources),
    }
    with _turn(target.parent), contextlib.suppress(OSError, ValueError):
        told = built_of(target)
        if all(told.get(name) == one for name, one in wanted.items()):
            return f"native: {target.name} is up to date"
    with _turn(target.parent):
        _compile(compiler, (sources, libraries, eigen), wanted["source"], target)
        told = built_of(target)
    return f"native: built {target.name} of pin {told['pin']}, coal {told['coal']}, Eigen {told['eigen']}"


def _compiler() -> str:
    """Return the compiler named by ``CXX``, or the first one on the path."""
    named = os.environ.get("CXX", "")
    names = (named,) if named else _COMPILERS
    found = next((path for name in names if (path := shutil.which(name))), None)
    if found is None:
        raise NativeBuildError(
            f"native: a C++ compiler must be on the path, tried {', '.join(names)}; install g++ (Debian, "
            "Ubuntu: apt-get install g++), or name one by CXX"
        )
    return found


@contextlib.contextmanager
def _turn(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, which ends with the process."""
    try:
        held = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise NativeBuildError(f"native: {folder} must be a folder, got {error.strerror}") from None
    try:
        with contextlib.suppress(OSError):  # where folders cannot be locked, each process builds for itself
            fcntl.flock(held, fcntl.LOCK_EX)
        yield
    finally:
        os.close(held)


def _compile(compiler: str, places: tuple[Path, Path, Path], digest: str, target: Path) -> None:
    """Compile into a temporary file beside the target, and move it there."""
    sources, libraries, eigen = places
    try:
        handle, made = tempfile.mkstemp(".so", ".shim-", target.parent)
        os.close(handle)
    except OSError as error:
        raise NativeBuildError(
            f"native: {target.parent} must be writable to build {target.name}, got {error.strerror}"
        ) from None
    command: Sequence[str] = (
        *(compiler, "-O2", "-std=c++17", "-fPIC", "-shared", "-fvisibility=hidden"),
        *(f"-D{one}" for one in _DEFINITIONS),
        f'-DAPIN_SOURCE="{digest}"',
        *("-isystem", str(libraries / "include"), "-isystem", str(eigen / "include" / "eigen3")),
        *(str(sources / "shim.cpp"), "-o", made),
        *(f"-L{libraries / 'lib'}", "-lpinocchio_default", "-lcoal"),
    )
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_LONGEST, check=False)
        if done.returncode:
            lines = [line.strip() for line in done.stderr.splitlines() if "error" in line]
            reason = (lines or [f"exit code {done.returncode}"])[0]
            raise NativeBuildError(
                f"native: {Path(compiler).name} must compile {sources / 'shim.cpp'}, got {reason}"
            )
        seal(Path(made))
        os.chmod(made, 0o755)
        os.replace(made, target)
    except subprocess.TimeoutExpired:
        raise NativeBuildError(
            f"native: {Path(compiler).name} must end within {_LONGEST:g} s, did not"
        ) from None
    except OSError as error:
        raise NativeBuildError(f"native: {target} must be writable, got {error.strerror}") from None
    finally:
        with contextlib.suppress(OSError):
            os.unlink(made)


def main() -> int:
    """Build into the package's folder; print the result in one line."""
    parser = argparse.ArgumentParser(prog="native_build", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quiet", action="store_true", help="say nothing of success")
    asked = parser.parse_args()
    try:
        said = build()
    except NativeBuildError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    if not asked.quiet:
        sys.stderr.write(f"{said}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
