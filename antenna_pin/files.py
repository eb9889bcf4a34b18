"""Files written complete or not at all, and paths checked before any work is done."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from antenna_pin.errors import OutputError

__all__ = ["check_writable", "replacing"]


def check_writable(path: str | os.PathLike[str]) -> Path:
    """Return the path if a file can be written there; else raise before any work is done.

    Raises:
        OutputError: The folder is missing or not writable, or the path is a folder.
    """
    target = Path(path)
    folder = target.parent
    if target.is_dir():
        raise OutputError(f"{target}: the output must be a file, got a folder; name a file in it")
    if not folder.is_dir():
        raise OutputError(
            f"{target}: the output's folder {str(folder)!r} does not exist; make it or name another"
        )
    try:
        # Trying is the only test that holds for every user and file system.
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise OutputError(
            f"{target}: the output's folder must be writable, got: {error.strerror}; name another folder"
        ) from error
    return target


@contextlib.contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary name beside a file; what is written there becomes the file if all goes well.

    Whatever goes wrong, Ctrl-C included, the file is left as it was and nothing stays beside it.

    Raises:
        OutputError: It cannot be written there.
    """
    target = Path(path)
    partial = target.parent / f".{target.name}.{os.getpid()}.partial"
    try:
        yield partial
        partial.replace(target)
    except OutputError:  # an OSError itself, of another file
        raise
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error
    finally:
        with contextlib.suppress(OSError):
            partial.unlink()
