"""Complete, sealed files, and checks of paths before any work.

A file is written under a temporary name beside its place and moved there when it is whole and on the disk.
The temporary one is locked while its process lives, so that the file of a killed process can be recognised
and is removed by the next that writes into the folder.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import hashlib
import io
import os
import re
import secrets
import stat
import urllib.parse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from antenna_pin.errors import OutputError

_PREFIX, _SUFFIX = ".antenna-pin-", ".partial"
# A file system's block: one that is full takes a name, but not this.
_BLOCK = 4096
_MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
_UNDECODED = re.compile("[\ud800-\udfff]")  # what Python has for a byte of a name that is no UTF-8
_SEAL = b"\nantenna_pin sha256 %b\n"
_SEAL_SIZE = len(_SEAL % (b"0" * 64))


def decoded(data: bytes) -> str:
    """Return an XML file's text: by byte order mark, declared encoding, UTF-8, or Latin-1.

    The first that fits: files are met that declare another encoding than theirs. Latin-1 fits any.

    Raises:
        UnicodeDecodeError: It is no text, for nothing in it is an element.
    """
    if marked := marked_encoding(data):
        return data.decode(marked, "replace")
    declared = re.match(rb"\s*<\?xml[^>]*?encoding\s*=\s*[\"']([\w.-]+)", data)
    for encoding in (*([declared[1].decode()] if declared else []), "utf-8"):
        with contextlib.suppress(LookupError, UnicodeDecodeError):
            text = data.decode(encoding)
            if "<" in text:  # bytes of UTF-8 taken for UTF-16 are Chinese
                return text
    return data.decode("latin-1" if b"<" in data else "utf-8")


def marked_encoding(data: bytes) -> str | None:
    """Return the encoding that a text's byte order mark gives; None without one."""
    return next((encoding for mark, encoding in _MARKS if data.startswith(mark)), None)


def absence(path: str | os.PathLike[str], what: str = "file") -> str:
    """Return the reason why a path is no readable file: missing, or a device."""
    there = os.path.exists(path) and not os.path.isdir(path) and not os.path.isfile(path)
    return "must be a regular file, got a device or a pipe" if there else f"no such {what}"


def check_writable(path: str | os.PathLike[str], suffix: str | None = None) -> Path:
    """Return the path of a writable file; else raise before any work is done.

    Raises:
        OutputError: The name ends otherwise, the folder is missing, not writable or full, the name is too
            long, or the path is that of a folder or a device.
    """
    target = Path(path)
    if suffix is not None and target.suffix.lower() != suffix and not target.is_dir():
        hint = f"try {target.with_suffix(suffix)}" if target.name else "name a file"
        if target.suffix.lower() == ".pdf" and suffix == ".html":
            hint += ", which a browser prints as a PDF"
        raise OutputError(f"{target}: the output's name must end in {suffix}; {hint}")
    folder = target.parent
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        mode = stat.S_IFREG
    except ValueError as error:  # a null character
        raise OutputError(f"{str(target)!r}: must be the name of a file: {error}; name another") from error
    except OSError as error:
        if error.errno == errno.ENOTDIR:
            mode = stat.S_IFREG  # the folder below is what is wrong
        else:
            raise OutputError(
                f"{_short(target)}: cannot be written: {error.strerror}; choose another name"
            ) from error
    if stat.S_ISDIR(mode):
        raise OutputError(f"{target}: the output must be a file, got a folder; name a file in it")
    if not stat.S_ISREG(mode):
        raise OutputError(f"{target}: the output must be a file, got a device or pipe; name a file")
    if not folder.is_dir():
        raise OutputError(
            f"{target}: the output's folder {str(folder)!r} does not exist; make it or name another"
        )
    try:
        # Trying is the only test that holds for every user and file system.
        with _partial_in(Path(os.path.realpath(target)).parent) as (partial, descriptor):
            os.write(descriptor, bytes(_BLOCK))
            os.fsync(descriptor)  # a full or shared disk may say so only now
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
        raise OutputError(
            f"{target}: the output's folder must be writable, got: {error.strerror}; "
            f"{'make room or ' if full else ''}name another folder"
        ) from error
    return target


@contextlib.contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path whose content replaces a file on success.

    Whatever goes wrong, Ctrl-C and a full disk included, the file is left as it was and nothing stays beside
    it. A link keeps pointing at the file that is written.

    Raises:
        OutputError: It cannot be written there.
    """
    target = Path(path)
    try:
        final = Path(os.path.realpath(target))
        with _partial_in(final.parent) as (partial, _):
            yield partial
            _flush(partial)
            partial.replace(final)
    except OutputError:  # an OSError itself, of another file
        raise
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error


@contextlib.contextmanager
def _partial_in(folder: Path) -> Iterator[tuple[Path, int]]:
    """Yield a new, locked file in a folder; it is removed unless moved away."""
    _sweep(folder)
    while True:
        # Short whatever the file is called, and another one in each thread.
        partial = folder / f"{_PREFIX}{os.getpid()}-{secrets.token_hex(6)}{_SUFFIX}"
        descriptor = os.open(partial, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666)
        if _locked(descriptor) and is_there(partial, descriptor):
            break
        os.close(descriptor)  # another process swept it away before it was locked
    try:
        yield partial, descriptor
    finally:
        with contextlib.suppress(OSError):
            partial.unlink()
        os.close(descriptor)


def _sweep(folder: Path) -> None:
    """Remove what processes that are gone have left in a folder."""
    try:
        with os.scandir(folder) as entries:
            left = [
                entry.path
                for entry in entries
                if entry.name.startswith(_PREFIX) and entry.name.endswith(_SUFFIX)
            ]
    except OSError:  # what is wrong with it is said when the file is made
        return
    for path in left:
        with contextlib.suppress(OSError):
            descriptor = os.open(path, os.O_RDWR | os.O_NOFOLLOW)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                os.unlink(path)
            finally:
                os.close(descriptor)


def _locked(descriptor: int) -> bool:
    """Lock a new file; return False if another process holds the lock."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in (errno.EWOULDBLOCK, errno.EACCES)
    return True


def is_there(path: Path, descriptor: int) -> bool:
    """Return whether an open file still has its name: neither deleted nor replaced."""
    try:
        return os.path.samestat(os.stat(path), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _flush(path: Path) -> None:
    """Write a file's buffers to the disk, which may be full."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _short(path: Path, most: int = 60) -> str:
    """Return a path, shortened for a message."""
    text = str(path)
    return text if len(text) <= most else f"{text[:most]}... ({len(text)} letters)"


def seal(path: Path) -> None:
    """Append a digest of a file to it, for :func:`has_whole_seal`.

    Readers of formats with their own length, as HDF5, ignore it.
    """
    with path.open("r+b") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
        file.seek(0, os.SEEK_END)
        file.write(_SEAL % digest.encode())


def is_unicode(text: str) -> bool:
    """Return whether a text has no bytes of a name that is not UTF-8."""
    return text.isascii() or not _UNDECODED.search(text)


def escaped(text: str) -> str:
    r"""Return a text for a file in UTF-8; other bytes become ``\udcff``."""
    return text if is_unicode(text) else text.encode("utf-8", "backslashreplace").decode()


def path_as_text(path: Path) -> str:
    """Return a path as text; a ``file:`` URI where its bytes are not UTF-8."""
    text = str(path)
    return text if is_unicode(text) else path.absolute().as_uri()


def path_of_text(text: str | Path) -> Path:
    """Return the path that :func:`path_as_text` wrote."""
    path = Path(text)
    if path.parts[:1] != ("file:",):
        return path
    return Path(os.fsdecode(urllib.parse.unquote_to_bytes(str(path).removeprefix("file:"))))


def has_whole_seal(path: Path) -> bool | None:
    """Return whether a file is as sealed; None without a seal.

    Raises:
        OSError: It cannot be read.
    """
    head, tail = _SEAL.split(b"%b")
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END) - _SEAL_SIZE
        if size < 0:
            return None
        file.seek(size)
        found = file.read()
        if not (found.startswith(head) and found.endswith(tail)):
            return None
        file.seek(0)
        digest = hashlib.sha256()
        while size > 0:
            block = file.read(min(size, 1 << 20))
            if not block:
                return False
            digest.update(block)
            size -= len(block)
    return found[len(head) : -len(tail)] == digest.hexdigest().encode()


class PatientFile(io.RawIOBase):
    """A file whose writes always succeed; HDF5 crashes on failed ones.

    All writes succeed. From the first one on that did not, what is written is kept in memory, so that the
    library stays in a state in which it can be closed; :meth:`check` then says what was wrong.

    Args:
        path: Of a file, made if missing and emptied.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Open the file."""
        self._descriptor = os.open(path, os.O_CREAT | os.O_TRUNC | os.O_RDWR, 0o666)
        self._place = 0
        self._kept: list[tuple[int, bytes]] = []
        self._error: OSError | None = None

    def check(self) -> None:
        """Raise what the first write that failed has raised."""
        if self._error is not None:
            raise self._error

    def write(self, content: Any) -> int:
        """Write at the current place; always all of it."""
        rest = memoryview(content).cast("B")
        size = len(rest)
        while rest and self._error is None:
            try:
                done = os.pwrite(self._descriptor, rest, self._place)
            except OSError as error:
                self._error = error
            else:
                self._place += done
                rest = rest[done:]
        if rest:
            self._kept.append((self._place, bytes(rest)))
            self._place += len(rest)
        return size

    def readinto(self, buffer: Any) -> int:
        """Read from the current place what was written."""
        wanted = memoryview(buffer).cast("B")
        start = self._place
        end = min(start + len(wanted), self._size())
        if end <= start:
            return 0
        wanted[: end - start] = bytes(end - start)
        found = os.pread(self._descriptor, end - start, start)
        wanted[: len(found)] = found
        for place, content in self._kept:
            first, last = max(place, start), min(place + len(content), end)
            if first < last:
                wanted[first - start : last - start] = content[first - place : last - place]
        self._place = end
        return end - start

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place."""
        origin = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._size()}[whence]
        self._place = origin + offset
        return self._place

    def tell(self) -> int:
        """Return the current place."""
        return self._place

    def truncate(self, size: int | None = None) -> int:
        """Make the file as long as asked."""
        length = self._place if size is None else size
        if self._error is None:
            try:
                os.ftruncate(self._descriptor, length)
            except OSError as error:
                self._error = error
        return length

    def _size(self) -> int:
        ends = [place + len(content) for place, content in self._kept]
        return max([os.fstat(self._descriptor).st_size, *ends])

    def readable(self) -> bool:
        """Return True: the stream is readable."""
        return True

    def writable(self) -> bool:
        """Return True: the stream is writable."""
        return True

    def seekable(self) -> bool:
        """Return True: the stream is seekable."""
        return True

    def close(self) -> None:
        """Close the file and release its memory."""
        if not self.closed:
            os.close(self._descriptor)
        super().close()
