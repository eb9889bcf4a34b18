"""``--package-path``: where commands look for meshes of packages of ROS."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from antenna_pin.cli._common import refuse

PackagePathOption = Annotated[
    list[Path] | None,
    typer.Option(
        "--package-path",
        metavar="DIR",
        help="Folder with packages of package:// names, before ROS_PACKAGE_PATH. May be repeated.",
    ),
]


def package_folders(given: list[Path] | None) -> list[Path]:
    """Return the folders of the option as absolute paths, or end the command where one is none."""
    for folder in given or ():
        if not folder.is_dir():
            refuse(
                f"--package-path {folder}: must be a folder, got {'a file' if folder.exists() else 'none'}"
            )
    return [folder.absolute() for folder in given or ()]
