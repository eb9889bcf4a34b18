#!/usr/bin/env python3
"""Whether this checkout can be released: one version everywhere, and packages that install and run.

The source archive is built, and of it the wheel, and each Python that is there gets an empty environment, in
which the wheel is installed by pip with ``constraints.txt``, and a shipped scenario is run and read away from
the checkout::

    python scripts/release_check.py                        # all Pythons from 3.11 on that are there
    python scripts/release_check.py --python python3.12    # one of them; may be given several times
    python scripts/release_check.py --no-install           # what the files say only
    python scripts/release_check.py --tag v0.1.0           # the tag must be the version's, too

It needs nothing but the standard library; packages come from the index that pip is set to.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

__all__ = ["changelog_faults", "metadata_faults", "pythons"]

ROOT = Path(__file__).parents[1]
NEWEST = 14
KINDS = ("Added", "Changed", "Changed results", "Deprecated", "Removed", "Fixed", "Security")
_TITLE = re.compile(r"\[(Unreleased)\](?: - \d+\.\d+\.\d+)?|\[(\d+\.\d+\.\d+)\] - (\d{4}-\d{2}-\d{2})")


def project_version(root: Path = ROOT) -> str:
    """Return the version, which stands in pyproject.toml."""
    return str(tomllib.loads((root / "pyproject.toml").read_text())["project"]["version"])


def metadata_faults(root: Path = ROOT) -> list[str]:
    """Return in which files another version or licence stands than in pyproject.toml."""
    project = tomllib.loads((root / "pyproject.toml").read_text())["project"]
    cff = dict(re.findall(r"^(version|license): *(\S+)$", (root / "CITATION.cff").read_text(), re.MULTILINE))
    zenodo = json.loads((root / ".zenodo.json").read_text())
    faults = []
    for name, said in (("CITATION.cff", cff), (".zenodo.json", zenodo)):
        for key in ("version", "license"):
            if said.get(key) != project[key]:
                faults.append(f"{name}: {key} is {said.get(key)!r}, in pyproject.toml {project[key]!r}")
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


def pythons() -> list[str]:
    """Return the Pythons that are there and run, from 3.11 on."""
    found = []
    for minor in range(11, NEWEST + 1):
        name = f"python3.{minor}"
        if (
            shutil.which(name)
            and not subprocess.run([name, "-c", ""], capture_output=True, check=False).returncode
        ):
            found.append(name)
    return found


def told(*command: str | Path, cwd: Path | None = None) -> str:
    """Run a command and return what it prints; it ends this program where it fails."""
    done = subprocess.run(
        [str(word) for word in command], cwd=cwd, capture_output=True, text=True, check=False
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


def tried(python: str, wheel: Path, folder: Path) -> str:
    """Install a wheel into an empty environment of a Python, run a scenario; return what came of it."""
    told(python, "-m", "venv", folder / "env")
    there = folder / "env" / "bin"
    told(there / "python", "-m", "pip", "install", "-q", "-c", ROOT / "constraints.txt", wheel)
    version = told(there / "antenna-pin", "--version", cwd=folder).strip()
    told(
        there / "antenna-pin",
        "run",
        "impact_pair",
        "--out",
        "run.nc",
        "--no-progress",
        "--no-summary",
        cwd=folder,
    )
    read = "from antenna_pin import Trajectory; print(Trajectory.load('run.nc').outcome.name)"
    return f"{version}, run {told(there / 'python', '-c', read, cwd=folder).strip()}"


def main() -> int:
    """Check, and try on each Python."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--python", action="append", help="a Python to try, instead of all that are there")
    parser.add_argument("--dist", type=Path, help="folder of packages that are built already")
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
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB")
        for python in asked.python or pythons():
            folder = Path(made) / Path(python).name
            folder.mkdir()
            print(f"{python}: {tried(python, wheel, folder)}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
