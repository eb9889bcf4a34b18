"""MAT files up to version 7, read in a process of their own: damaged ones end SciPy's reader with a crash."""

from __future__ import annotations

import contextlib
import faulthandler
import multiprocessing
import os
import resource
import signal
import sys
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from antenna_pin.base.capacity import free_memory

__all__ = ["BadMatFileError", "Mat73Error", "read_mat"]

_SHARE = 0.4  # of the free memory: what is read is there twice while it is sent
_SECONDS = 600  # of processor time that a damaged file is read for at most


class BadMatFileError(ValueError):
    """A file that the reader of MAT files cannot read."""


class Mat73Error(ValueError):
    """A MAT file of version 7.3, which is an HDF5 file."""


def read_mat(path: Path) -> dict[str, Any]:
    """Return the variables of a file, as :func:`scipy.io.loadmat` does.

    Raises:
        Mat73Error: It is one of version 7.3.
        BadMatFileError: It cannot be read.
    """
    import scipy.io  # noqa: F401 - in this process, so that the other has it

    if sys.platform != "linux" or multiprocessing.current_process().daemon:
        return _loaded(path)
    ours, theirs = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(target=_serve, args=(path, theirs), daemon=True)
    process.start()
    theirs.close()
    try:
        with contextlib.closing(ours):
            content = ours.recv()
    except EOFError:
        process.join()
        number = -(process.exitcode or 0)
        cause = signal.Signals(number).name if number in set(signal.Signals) else "no answer"
        raise BadMatFileError(
            f"its reader ended with {cause}: the file is damaged; export it again"
        ) from None
    finally:
        process.kill()
        process.join()
    if isinstance(content, Exception):
        raise content
    return dict(content)


def _serve(path: Path, pipe: Connection) -> None:
    """Send the variables of a file, or what keeps it from being read."""
    faulthandler.disable()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that waits acts on it
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        free = free_memory()
        if free is not None:
            pages = int(Path("/proc/self/statm").read_text().split()[0])
            most = pages * resource.getpagesize() + int(_SHARE * free)
            resource.setrlimit(resource.RLIMIT_AS, (most, most))
    code = 0
    try:
        pipe.send(_loaded(path))
    except (BadMatFileError, Mat73Error) as error:
        pipe.send(error)
    except BaseException:
        code = 1
    os._exit(code)


def _loaded(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    try:
        return dict(loadmat(path, squeeze_me=True, struct_as_record=True))
    except NotImplementedError:
        raise Mat73Error from None
    except MemoryError:
        raise BadMatFileError("it needs more memory than this machine has; export fewer variables") from None
    except Exception as error:  # the reader raises any on a damaged file
        raise BadMatFileError(" ".join(str(error).split())) from None
