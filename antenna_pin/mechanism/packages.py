"""Where a mesh of a URDF is: beside it, at a place of its own, or in a package of ROS."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from urllib.parse import unquote

__all__ = ["mesh_file"]

# Variables that list folders with packages; with those of the last a package is below share/.
_VARIABLES = ("ROS_PACKAGE_PATH", "GAZEBO_MODEL_PATH", "AMENT_PREFIX_PATH")
_SCHEMES = ("package://", "model://")


def mesh_file(filename: str, folder: Path | None, package_path: Iterable[Path] = ()) -> Path | None:
    """Return the file that a mesh is in, None if it is not there.

    ``package://NAME/rest`` is ``NAME/rest`` below a folder of ``package_path``, of ROS_PACKAGE_PATH or
    GAZEBO_MODEL_PATH, below ``share`` of one of AMENT_PREFIX_PATH, or in a folder above the URDF; a folder
    that is itself called NAME is the package. The first that has the file is taken.

    Args:
        filename: As it stands in the URDF.
        folder: Where relative names start; None if that is unknown.
        package_path: Folders to look in first.
    """
    for scheme in _SCHEMES:
        if filename.startswith(scheme):
            name, _, rest = filename.removeprefix(scheme).partition("/")
            candidates = _in_packages(name, rest, folder, package_path)
            return next((path for path in candidates if path.is_file()), None)
    if filename.startswith("file://"):
        path = Path(filename.removeprefix("file://"))
        path = path if path.is_file() else Path(unquote(str(path)))
    elif "://" in filename:
        return None
    else:
        path = Path(filename)
    if not path.is_absolute():
        if folder is None:
            return None
        path = folder / path
    return path if path.is_file() else None


def _in_packages(name: str, rest: str, folder: Path | None, package_path: Iterable[Path]) -> Iterator[Path]:
    roots = list(package_path)
    for variable in _VARIABLES:
        below = "share" if variable.startswith("AMENT") else ""
        roots += [Path(part, below) for part in os.environ.get(variable, "").split(os.pathsep) if part]
    if folder is not None:
        roots += [folder, *folder.parents]
    for root in roots:
        yield root / name / rest
        if root.name == name:
            yield root / rest
