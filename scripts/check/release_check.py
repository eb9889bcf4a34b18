#!/usr/bin/env python3
"""Whether this checkout can be released: one version everywhere, and packages that install and run.

The source archive is built, and of it the wheel; both must hold what they should and nothing else. Each
Python that is there gets an empty environment, in which the wheel is installed by pip with
``constraints.txt``, and a shipped scenario is run and read away from the checkout::

    python scripts/check/release_check.py                        # all Pythons from 3.11 on that are there
    python scripts/check/release_check.py --python python3.12    # one of them; may be given several times
    python scripts/check/release_check.py --tools                # also by pipx and by uv, as users install it
    python scripts/check/release_check.py --code dist            # also a wheel with machine code, into it
    python scripts/check/release_check.py --code dist --suite    # and a part of the tests under that code
    python scripts/check/release_check.py --no-install           # what the files say only
    python scripts/check/release_check.py --tag v0.2.0           # the tag must be the version's, too

The plain wheel is installed with its extra ``compile``, which has Numba. A wheel with machine code is one for
this platform and all Pythons: the plain wheel, with a shared library of all kernels as they are compiled in
an empty environment of the first Python, and with the shim to Pinocchio's and coal's machine code. It is
tried without Numba, and must use the shim.

It needs nothing but the standard library; packages, pipx and uv come from the index that pip is set to.
"""

from __future__ import annotations

import argparse
import functools
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
NEWEST = 14
LARGEST = 25.0  # of a wheel with machine code [MB]
_WITHOUT = """
import importlib.util
from antenna_pin import load_scenario, simulate
for model, case in (("bai2020", "case3"), ("slider_crank", "planar"), ("solar_array", "play")):
    simulate(load_scenario(model, case=case), "2 ms")
print(*(name for name in ("numba", "llvmlite") if importlib.util.find_spec(name)))
"""
#: Commands that an installed package without Numba must carry out.
_COMMANDS = (
    "run bai2020 --duration 0.02 --out run.nc --no-progress --no-summary",
    "info run.nc",
    "analyse run.nc",
    "report run.nc --out report.html",
    "sensitivity impact_pair clearance.bore.radial_clearance --set clearance.bore.geometry=closed-form",
)
#: Folders of tests that run under shipped code, but for files of what only kernels call, or Numba compiles.
_SUITE = ("engine", "joints", "constraints", "contact")
_NOT_SHIPPED = re.compile(r"^(from|import) .*(numba|llvmlite|kernels)", re.MULTILINE)
KINDS = ("Added", "Changed", "Changed results", "Deprecated", "Removed", "Fixed", "Security")
_TITLE = re.compile(r"\[(Unreleased)\]|\[(\d+\.\d+\.\d+)\] - (\d{4}-\d{2}-\d{2})")


def project_version(root: Path = ROOT) -> str:
    """Return the version, which stands in pyproject.toml."""
    return str(tomllib.loads((root / "pyproject.toml").read_text())["project"]["version"])


def metadata_faults(root: Path = ROOT) -> list[str]:
    """Return in which files another version or licence stands than in pyproject.toml, or another day."""
    project = tomllib.loads((root / "pyproject.toml").read_text())["project"]
    found = re.findall(
        r"^(version|license|date-released): *(\S+)$", (root / "CITATION.cff").read_text(), re.MULTILINE
    )
    cff, zenodo = dict(found), json.loads((root / ".zenodo.json").read_text())
    faults = []
    for name, said in (("CITATION.cff", cff), (".zenodo.json", zenodo)):
        for key in ("version", "license"):
            if said.get(key) != project[key]:
                faults.append(f"{name}: {key} is {said.get(key)!r}, in pyproject.toml {project[key]!r}")
    newest = re.search(rf"^## {_TITLE.pattern}$", (root / "CHANGELOG.md").read_text(), re.MULTILINE)
    if newest is None or newest[1]:  # on the way to a version that has no day yet
        return faults
    if newest[2] != project["version"]:
        faults.append(f"CHANGELOG.md: the newest is {newest[2]!r}, in pyproject.toml {project['version']!r}")
    for name, key, day in (
        ("CITATION.cff", "date-released", cff.get("date-released")),
        (".zenodo.json", "publication_date", zenodo.get("publication_date")),
    ):
        if day != newest[3]:
            faults.append(f"{name}: {key} is {day!r}, in CHANGELOG.md {newest[3]!r}")
    return faults


def changelog_faults(text: str) -> list[str]:
    """Return where a changelog is not in the form of Keep a Changelog, with *Changed results* besides."""
    faults, versions = [], []
    if not text.startswith("# Changelog\n"):
        faults.append("CHANGELOG.md: the first line must be '# Changelog'")
    sections: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        place = f"CHANGELOG.md:{number}"
        if line.startswith("## "):
            match = _TITLE.fullmatch(line[3:])
            if match is None:
                faults.append(f"{place}: '{line}' must be '## [Unreleased]' or '## [1.2.3] - 2026-01-31'")
            else:
                if match[1] and versions:
                    faults.append(f"{place}: what is unreleased must come first")
                versions.append(match[2] or "")
            sections = []
        elif line.startswith("### "):
            if line[4:] not in KINDS:
                faults.append(f"{place}: '{line[4:]}' must be one of {', '.join(KINDS)}")
            if line[4:] in sections:
                faults.append(f"{place}: '{line[4:]}' stands there twice")
            sections.append(line[4:])
    numbers = [tuple(map(int, one.split("."))) for one in versions if one]
    if numbers != sorted(set(numbers), reverse=True):
        faults.append("CHANGELOG.md: versions must fall from top to bottom, each once")
    return faults


def contents_faults(names: list[str], kind: str) -> list[str]:
    """Return what an archive lacks, and what it holds that nobody needs who installs it.

    Args:
        names: Files, from the folder of the package or of the checkout on.
        kind: "wheel" or "source".
    """
    wanted = {
        "wheel": [
            "antenna_pin/__init__.py",
            "antenna_pin/py.typed",
            "antenna_pin/native/shim.cpp",
            "antenna_pin/_models/bai2020/scenario.toml",
        ],
        "source": ["pyproject.toml", "LICENSE", "README.md", "CHANGELOG.md", "models/bai2020/scenario.toml"],
    }[kind]
    faults = [f"{kind}: lacks {name}" for name in wanted if name not in names]
    allowed = (
        r"antenna_pin/|antenna_pin-[^/]+\.dist-info/" if kind == "wheel" else r"(?!build/|\.venv/|\.ci/)"
    )
    left = r"(^|/)(__pycache__|\.\w+_cache|\.hypothesis)/|\.(pyc|nbi|nbc|nc)$"
    return faults + [
        f"{kind}: holds {name}" for name in names if not re.match(allowed, name) or re.search(left, name)
    ]


def pythons() -> list[str]:
    """Return the Pythons that are there and run, from 3.11 on: on the path, or made by pyenv or uv."""
    home = Path.home()
    makers = [
        Path(os.environ.get("PYENV_ROOT", home / ".pyenv")) / "versions",
        Path(os.environ.get("UV_PYTHON_INSTALL_DIR", home / ".local" / "share" / "uv" / "python")),
    ]
    found = []
    for minor in range(11, NEWEST + 1):
        name = f"python3.{minor}"
        made = [str(one) for maker in makers for one in sorted(maker.glob(f"*/bin/{name}"), reverse=True)]
        for candidate in [name, *made]:
            if (
                shutil.which(candidate)
                and not subprocess.run(
                    [candidate, "-c", "import ensurepip, venv"], capture_output=True, check=False
                ).returncode
            ):
                found.append(candidate)
                break
    return found


def told(*command: str | Path, cwd: Path | None = None, **variables: str | Path) -> str:
    """Run a command and return what it prints; it ends this program where it fails."""
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env=os.environ | {name: str(value) for name, value in variables.items()},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        said = (done.stderr or done.stdout).strip().splitlines()[-12:]
        raise SystemExit("\n".join([f"failed: {' '.join(map(str, command))}", *said]))
    return done.stdout


def packages(folder: Path) -> Path:
    """Build source archive and, of that, the wheel, into a folder; return the wheel."""
    python = ROOT / ".venv" / "bin" / "python"
    told(python if python.is_file() else sys.executable, "-m", "build", "--outdir", folder, ROOT)
    return wheel_in(folder)


def wheel_in(folder: Path) -> Path:
    """Return the only wheel of a folder that has its source archive beside it."""
    wheels, archives = sorted(folder.glob("*.whl")), sorted(folder.glob("*.tar.gz"))
    if len(wheels) != 1 or len(archives) != 1:
        raise SystemExit(
            f"{folder}: must hold one wheel and one source archive, has {len(wheels) + len(archives)} files"
        )
    return wheels[0]


def looked_into(wheel: Path) -> list[str]:
    """Return what is wrong with what a wheel, and the source archive beside it, hold."""
    (archive,) = wheel.parent.glob("*.tar.gz")
    with zipfile.ZipFile(wheel) as opened:
        inside = opened.namelist()
    with tarfile.open(archive) as source:
        files = [one.name.partition("/")[2] for one in source if one.isfile()]
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, {len(inside)} files")
    print(f"{archive.name}: {archive.stat().st_size / 1e6:.1f} MB, {len(files)} files")
    return contents_faults(inside, "wheel") + contents_faults(files, "source")


def run_by(command: Path, folder: Path) -> str:
    """Run a shipped scenario by an installed command, away from the checkout; return its version."""
    words = ("run", "impact_pair", "--out", "run.nc", "--no-progress", "--no-summary")
    told(command, *words, cwd=folder)
    return told(command, "--version", cwd=folder).strip()


def tried(python: str, wheel: Path, folder: Path, code: bool = False, suite: bool = False) -> str:
    """Install a wheel into an empty environment of a Python, run a scenario; return what came of it."""
    told(python, "-m", "venv", folder / "env")
    there = folder / "env" / "bin"
    given = wheel if code else f"{wheel}[compile]"
    told(there / "python", "-m", "pip", "install", "-q", "-c", ROOT / "constraints.txt", given)
    version = run_by(there / "antenna-pin", folder)
    read = "from antenna_pin import Trajectory; print(Trajectory.load('run.nc').outcome.name)"
    said = f"{version}, run {told(there / 'python', '-c', read, cwd=folder).strip()}"
    return f"{said}, {without_numba(there, folder, suite)}" if code else said


def with_code(python: str, wheel: Path, folder: Path, out: Path) -> Path:
    """Return a wheel for this platform that holds the machine code of all kernels."""
    told(python, "-m", "venv", folder / "env")
    there = folder / "env" / "bin" / "python"
    packages = (f"{wheel}[compile]", "wheel", "cmeel-eigen")
    told(there, "-m", "pip", "install", "-q", "-c", ROOT / "constraints.txt", *packages)
    told(there, "-m", "antenna_pin.compiled.native_build", cwd=folder)
    given = ("NUMBA_CACHE_DIR", "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "PYTHONPATH")
    without = [word for name in given for word in ("-u", name)]
    told("env", *without, there, ROOT / "scripts" / "compile_kernels.py", "--all", cwd=folder)
    told(there, "-m", "wheel", "unpack", "--dest", folder, wheel)
    (unpacked,) = folder.glob("antenna_pin-*")
    linked = "import sys, antenna_pin, sysconfig; from pathlib import Path; package = antenna_pin.__path__[0]"
    linked += "; from antenna_pin.compiled.shared_library import write_library"
    linked += "; write_library(Path(package), Path(sys.argv[1])); print(sysconfig.get_platform())"
    # Elsewhere than in the checkout, whose package comes before the installed one.
    command = ("env", *without, there, "-c", linked, unpacked / "antenna_pin" / "compiled")
    platform = told(*command, cwd=folder).strip()
    index = unpacked / "antenna_pin" / "compiled" / "kernels.json"
    told("env", *without, there, ROOT / "scripts" / "check" / "called_kernels.py", index)
    where = told(there, "-c", "import antenna_pin; print(antenna_pin.__path__[0])", cwd=folder).strip()
    for path in Path(where, "native").glob("*.so"):
        shutil.copy2(path, unpacked / "antenna_pin" / "native" / path.name)
    (folder / "packed").mkdir()
    told(there, "-m", "wheel", "pack", "--dest-dir", folder / "packed", unpacked)
    (packed,) = (folder / "packed").glob("*.whl")
    platform = platform.replace("-", "_").replace(".", "_")
    tags = ("--python-tag", "py3", "--abi-tag", "none", "--platform-tag", platform)
    name = told(there, "-m", "wheel", "tags", "--remove", *tags, packed).split()[-1]
    out.mkdir(parents=True, exist_ok=True)
    made = out / Path(name).name
    shutil.copy2(packed.parent / made.name, made)
    size = made.stat().st_size / 1e6
    if size > LARGEST:
        raise SystemExit(f"{made.name}: {size:.1f} MB, at most {LARGEST:g}")
    print(f"{made.name}: {size:.1f} MB")
    return made


def without_numba(there: Path, folder: Path, suite: bool) -> str:
    """Return that a package with machine code does all without Numba; end this program where it does not."""
    found = told(
        there / "python", "-W", "ignore", "-c", _WITHOUT, cwd=folder, ANTENNA_PIN_NATIVE="required"
    ).split()
    if found:
        raise SystemExit(f"{' and '.join(found)} must not be needed, but came with the wheel")
    for command in _COMMANDS:
        told(there / "antenna-pin", *command.split(), cwd=folder)
    said = f"{len(_COMMANDS)} commands without Numba"
    if not suite:
        return said
    told(
        there / "python", "-m", "pip", "install", "-q", "-c", ROOT / "constraints.txt", "pytest", "hypothesis"
    )
    files = [path for name in _SUITE for path in sorted((ROOT / "tests" / name).glob("test_*.py"))]
    files = [path for path in files if not _NOT_SHIPPED.search(path.read_text())]
    command = (there / "pytest", "-q", "-p", "no:cacheprovider", *files)
    return f"{said}, {told(*command, cwd=ROOT).strip().splitlines()[-1]}"


def tried_as_tool(tool: str, python: str, wheel: Path | str, folder: Path) -> str:
    """Install a wheel as a command for a user by pipx or uv, run a scenario and take it away again.

    Args:
        tool: "pipx" or "uv".
        python: The Python to make the command's environment of.
        wheel: What is installed.
        folder: An empty folder, for the tool itself where it is not there, its environments and commands.
    """
    command = shutil.which(tool)
    if command is None:
        told(python, "-m", "venv", folder / "maker")
        told(folder / "maker" / "bin" / "python", "-m", "pip", "install", "-q", tool)
        command = str(folder / "maker" / "bin" / tool)
    python = shutil.which(python) or python
    if tool == "pipx":
        places = {
            "PIPX_HOME": folder / "home",
            "PIPX_BIN_DIR": folder / "bin",
            "PIPX_MAN_DIR": folder / "man",
        }
        told(command, "install", "--python", python, wheel, **places)
        away = (command, "uninstall", "antenna-pin")
    else:
        places = {"UV_TOOL_DIR": folder / "home", "UV_TOOL_BIN_DIR": folder / "bin", **index_of_pip(python)}
        told(command, "tool", "install", "--python", python, wheel, **places)
        away = (command, "tool", "uninstall", "antenna-pin")
    version = run_by(folder / "bin" / "antenna-pin", folder)
    told(*away, **places)
    if (folder / "bin" / "antenna-pin").exists():
        raise SystemExit(f"{tool}: the command is still there after it was taken away")
    return f"{version}, installed, run and taken away"


def index_of_pip(python: str) -> dict[str, str]:
    """Return where pip takes packages from, as uv is told of it."""
    given = {}
    for setting, variable in (("global.index-url", "UV_DEFAULT_INDEX"), ("global.cert", "SSL_CERT_FILE")):
        asked = (python, "-m", "pip", "config", "get", setting)
        done = subprocess.run(asked, capture_output=True, text=True, check=False)
        if not done.returncode and variable not in os.environ:
            given[variable] = done.stdout.strip()
    return given


def main() -> int:
    """Check, and try on each Python."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--python", action="append", help="a Python to try, instead of all that are there")
    parser.add_argument("--tools", action="store_true", help="also install by pipx and by uv")
    parser.add_argument("--dist", type=Path, help="folder of packages that are built already")
    parser.add_argument("--code", type=Path, help="make and try a wheel with machine code, into this folder")
    parser.add_argument("--suite", action="store_true", help="run tests under the machine code of --code")
    parser.add_argument("--no-install", action="store_true", help="look at the files only")
    parser.add_argument("--tag", help="the tag that is released")
    asked = parser.parse_args()
    faults = metadata_faults() + changelog_faults((ROOT / "CHANGELOG.md").read_text())
    version = project_version()
    if asked.tag is not None and asked.tag != f"v{version}":
        faults.append(f"the tag is {asked.tag}, of version {version} it must be v{version}")
    if faults:
        print("\n".join(faults))
        return 1
    print(f"version {version} stands in every file")
    if asked.no_install:
        return 0
    with tempfile.TemporaryDirectory() as made:
        wheel = wheel_in(asked.dist) if asked.dist else packages(Path(made) / "dist")
        faults = looked_into(wheel)
        if faults:
            print("\n".join(faults))
            return 1
        there = asked.python or pythons()
        trials = [(python, tried, (python, wheel)) for python in there]
        if asked.code:
            (Path(made) / "maker").mkdir()
            coded = with_code(there[0], wheel, Path(made) / "maker", asked.code)
            trial = functools.partial(tried, code=True, suite=asked.suite)
            trials += [(f"{python}, machine code", trial, (python, coded)) for python in there]
        if asked.tools:
            given = coded if asked.code else f"{wheel}[compile]"
            trials += [(tool, tried_as_tool, (tool, there[-1], given)) for tool in ("pipx", "uv")]
        for number, (name, trial, given) in enumerate(trials):
            folder, begun = Path(made) / str(number), time.monotonic()
            folder.mkdir()
            print(f"{name}: {trial(*given, folder)} ({time.monotonic() - begun:.0f} s)", flush=True)
            shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
