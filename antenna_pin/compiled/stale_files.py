"""Removal of machine code that was stored under other stamps."""

from __future__ import annotations

import contextlib
import glob
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

#: Modules cleaned by this process, by folder of machine code and name.
_swept: set[tuple[Path, str]] = set()


def pack_of(index: str, key: Any) -> str:
    """Return the path of a function's pack for argument types, by index and key."""
    digest = hashlib.sha256(str(key[0]).encode()).hexdigest()
    return f"{index.removesuffix('.nbi')}.{digest[:16]}.nbp"


def sweep(index: str, read: Callable[[str], Any], stamp: tuple[Any, Any], source: Path) -> None:
    """Delete a folder's machine code of other stamps of a module, and of missing modules.

    Files of the same version of Python only. A process about to read a deleted file finds nothing, and
    compiles. Unreadable files are left: they may belong to others.

    Args:
        index: Path of the index of a function of the module.
        read: Reads an index.
        stamp: Version of Numba and stamp of the module's machine code.
        source: File of the module.
    """
    folder = Path(index).parent
    if (folder, source.stem) in _swept:
        return
    _swept.add((folder, source.stem))
    tag = index.removesuffix(".nbi").rpartition(".")[2]
    # Listed before indexes are read: a file written meanwhile is in its index first.
    found = {
        path
        for kind in ("nbi", "*.nbc", "*.nbp")
        for path in folder.glob(f"*.{tag}.{kind}")
        if _module(path) == source.stem or not source.with_name(f"{_module(path)}.py").exists()
    }
    for path in [path for path in found if path.suffix == ".nbi"]:
        try:
            *own, names = read(str(path))
        except Exception:  # pickle may raise any exception
            found.difference_update(folder.glob(f"{glob.escape(path.stem)}.*"))
            continue
        if tuple(own) == stamp and _module(path) == source.stem:
            packs = (pack_of(str(path), key) for key in names)
            found.difference_update([path, *map(Path, packs), *(folder / name for name in names.values())])
    for path in found:
        with contextlib.suppress(OSError):
            path.unlink()


def _module(path: Path) -> str:
    """Return the name of the module whose machine code a file holds."""
    return path.name.partition(".")[0]
