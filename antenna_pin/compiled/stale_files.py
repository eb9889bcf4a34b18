"""Removal of machine code that was stored under other stamps."""

from __future__ import annotations

import contextlib
import glob
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

__all__ = ["pack_of", "sweep"]

#: Folders that this process has swept: once is enough, for it knows one stamp.
_swept: set[Path] = set()


def pack_of(index: str, key: Any) -> str:
    """Return the path of a function's pack for argument types, by index and key."""
    digest = hashlib.sha256(str(key[0]).encode()).hexdigest()
    return f"{index.removesuffix('.nbi')}.{digest[:16]}.nbp"


def sweep(index: str, read: Callable[[str], Any], stamp: tuple[Any, Any]) -> None:
    """Delete what an index's folder holds of other stamps, of the same version of Python.

    A process that was about to read some of it finds nothing, and compiles. What cannot be read is left: it
    may be somebody else's.
    """
    folder = Path(index).parent
    if folder in _swept:
        return
    _swept.add(folder)
    tag = index.removesuffix(".nbi").rpartition(".")[2]
    # Looked for before indexes are read: what is written meanwhile stands in its index before it is there.
    found = {path for kind in ("nbi", "*.nbc", "*.nbp") for path in folder.glob(f"*.{tag}.{kind}")}
    for path in folder.glob(f"*.{tag}.nbi"):
        try:
            *own, names = read(str(path))
        except Exception:  # pickle promises no certain ones
            found.difference_update(folder.glob(f"{glob.escape(path.stem)}.*"))
            continue
        if tuple(own) == stamp:
            packs = (pack_of(str(path), key) for key in names)
            found.difference_update([path, *map(Path, packs), *(folder / name for name in names.values())])
    for path in found:
        with contextlib.suppress(OSError):
            path.unlink()
