"""Mesh files of a URDF: location, and names in a URDF of another folder."""

from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path, PurePosixPath
from urllib.parse import unquote

from antenna_pin.base.files import replacing
from antenna_pin.errors import MechanismError, OutputError

__all__ = [
    "mesh_file",
]

# --- packages -----------------------------------------------------------------------------------------------

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


# --- meshes of a written URDF -------------------------------------------------------------------------------

# What a Wavefront material file calls the images it uses.
_IMAGE_KEYS = ("map_", "bump", "disp", "decal", "refl", "norm")


def name_from(folder: Path, start: Path, filename: str) -> str:
    """Return a mesh's name in ``folder``; unchanged if missing or in a package."""
    mesh = None if "://" in filename else mesh_file(filename, start)
    if mesh is None:
        return filename
    source = mesh.resolve()
    try:
        return Path(os.path.relpath(source, folder.resolve())).as_posix()
    except ValueError:
        return source.as_posix()


def planned_copies(
    folder: Path,
    start: Path | None,
    filenames: Iterable[str],
    where: str,
    package_path: Iterable[Path] = (),
) -> tuple[dict[str, str], dict[Path, Path]]:
    """Return the names of meshes after copying to ``folder``, and the files to copy.

    A name that leads down from ``start`` is kept; of any other the last part is. Materials and images that a
    Wavefront mesh names go with it.

    Returns:
        New name of each mesh, and source of each copy, by its target.

    Raises:
        MechanismError: A mesh is not a file.
        OutputError: Two files would become one, or would replace another file.
    """
    names: dict[str, str] = {}
    copies: dict[Path, Path] = {}
    for filename in dict.fromkeys(filenames):
        source = mesh_file(filename, start, package_path)
        if source is None:
            raise MechanismError(
                f"{where}: mesh {filename!r} must be a file to be copied; put it there, or copy nothing"
            )
        names[filename] = name = _kept_name(filename)
        for path, below in [(source, PurePosixPath(name)), *_companions(source, PurePosixPath(name).parent)]:
            target = folder / below
            before = copies.setdefault(target, path)
            if not filecmp.cmp(before, path, shallow=False):
                raise OutputError(f"{target}: {before} and {path} would both be copied here; rename one")
            if target.exists() and not (target.is_file() and filecmp.cmp(target, path, shallow=False)):
                raise OutputError(f"{target}: differs from {path}, whose copy goes there; write elsewhere")
    return names, {target: path for target, path in copies.items() if not target.exists()}


def copy_all(copies: dict[Path, Path]) -> None:
    """Copy files, each complete or not at all; sources by targets."""
    for target, source in copies.items():
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{target}: its folder cannot be created: {error.strerror}") from error
        with replacing(target) as partial:
            shutil.copyfile(source, partial)


def _kept_name(filename: str) -> str:
    path = PurePosixPath(filename.partition("://")[2] or filename)
    return path.name if path.is_absolute() or ".." in path.parts else path.as_posix()


def _companions(source: Path, below: PurePosixPath) -> list[tuple[Path, PurePosixPath]]:
    """Return the files that a Wavefront mesh or material names beside or below itself."""
    suffix = source.suffix.lower()
    if suffix not in (".obj", ".mtl"):
        return []
    found: dict[str, None] = {}
    for line in source.read_text(encoding="utf-8", errors="replace").splitlines():
        key, _, rest = line.strip().partition(" ")
        if suffix == ".obj" and key == "mtllib":
            found.update(dict.fromkeys((rest.strip(), *rest.split())))
        elif suffix == ".mtl" and key.lower().startswith(_IMAGE_KEYS) and rest.split():
            found.update(dict.fromkeys((rest.strip(), rest.split()[-1])))
    files = []
    for name in found:
        path = PurePosixPath(name)
        if name and _kept_name(name) == path.as_posix() and (source.parent / path).is_file():
            files.append((source.parent / path, below / path))
            if suffix == ".obj":
                files += _companions(source.parent / path, (below / path).parent)
    return files
