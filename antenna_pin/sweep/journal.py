"""The journal of a study: one line for each finished run, append-only.

Each line starts with a digest of itself, keyed by the digest of the study: a torn, damaged or foreign line is
not taken for a result. The journal is what a study is resumed from; all else in its folder follows from it.
"""

from __future__ import annotations

import errno
import fcntl
import hashlib
import json
import os
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from antenna_pin.base.files import is_there, replacing
from antenna_pin.errors import OutputError

__all__ = ["Journal", "ReadJournal", "deleted", "open_journal", "read_journal"]

_DIGEST = 24
_SYNC_EVERY = 1.0  # [s]


class ReadJournal(NamedTuple):
    """Contents of a journal.

    Attributes:
        entries: Of the runs, by number.
        damaged: Lines in its midst that are not what was written.
        torn: Whether its end is part of a line.
    """

    entries: dict[int, dict[str, Any]]
    damaged: int
    torn: bool


def _line(key: bytes, entry: dict[str, Any]) -> bytes:
    text = json.dumps(entry, ensure_ascii=True, separators=(",", ":")).encode()
    return _signed(key, text) + b" " + text + b"\n"


def _signed(key: bytes, text: bytes) -> bytes:
    return hashlib.blake2b(text, key=key, digest_size=_DIGEST // 2).hexdigest().encode()


def read_journal(path: Path, key: bytes) -> ReadJournal:
    """Return the entries of a journal that are as they were written.

    Args:
        path: The journal; one that is not there is empty.
        key: Digest of the study.

    Raises:
        OSError: It cannot be read.
    """
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        return ReadJournal({}, 0, False)
    entries: dict[int, dict[str, Any]] = {}
    lines = content.split(b"\n")
    torn = lines.pop() != b""
    damaged = 0
    for line in lines:
        if line[:_DIGEST] == _signed(key, line[_DIGEST + 1 :]) and line[_DIGEST : _DIGEST + 1] == b" ":
            entry = json.loads(line[_DIGEST + 1 :])
            entries[int(entry["run"])] = entry
        else:
            damaged += 1
    return ReadJournal(entries, damaged, torn)


def deleted(path: Path, what: str = "study") -> OutputError:
    """Return what is to be raised where a journal has been deleted."""
    return OutputError(
        f"{path}: must stay while the {what} runs, got deleted or replaced, and its finished runs with it; "
        "give the same command again, with --out elsewhere if something clears it"
    )


class Journal:
    """A journal that is written to; one process at a time has it.

    Args:
        path: The journal, made if missing.
        key: Digest of the study.
        keep: Entries to start from, where it has to be written anew for damage; None to go on behind its end.
        what: What it is a part of, a word for messages.

    Raises:
        OutputError: It cannot be written, or another process has it.
    """

    def __init__(
        self, path: Path, key: bytes, keep: Iterable[dict[str, Any]] | None = None, what: str = "study"
    ) -> None:
        """Open the journal."""
        self.path, self._key, self._what = path, key, what
        # The lock is on a file of its own: the journal may be replaced.
        lock = path.with_name(".lock")
        try:
            self._lock = os.open(lock, os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, 0o666)
            try:
                fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
                    os.close(self._lock)
                    raise OutputError(
                        f"{path.parent}: must not be in use, got another process that runs this {what}; let "
                        "it end"
                    ) from None
            if keep is not None:
                with replacing(path) as partial:
                    partial.write_bytes(b"".join(_line(key, entry) for entry in keep))
            self._file = os.open(path, os.O_CREAT | os.O_RDWR | os.O_APPEND | os.O_CLOEXEC, 0o666)
            self._end = os.fstat(self._file).st_size
        except OutputError:
            raise
        except OSError as error:
            raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error
        self._synced = time.monotonic()

    def check(self) -> None:
        """Refuse to continue with a deleted journal: its lines would be lost.

        Raises:
            OutputError: It has been.
        """
        if not is_there(self.path, self._file):
            raise deleted(self.path, self._what)

    def add(self, entry: dict[str, Any]) -> None:
        """Write the line of a finished run.

        Raises:
            OutputError: It cannot be written; the journal is left as it was. Or it has been deleted.
        """
        self.check()
        line = _line(self._key, entry)
        try:
            rest = memoryview(line)
            while rest:
                rest = rest[os.write(self._file, rest) :]
            if time.monotonic() - self._synced > _SYNC_EVERY:
                self.sync()
        except OSError as error:
            os.ftruncate(self._file, self._end)
            raise OutputError(
                f"{self.path}: cannot be written: {error.strerror or error}; the runs before are kept: make "
                "room and give the same command again"
            ) from error
        self._end += len(line)

    def sync(self) -> None:
        """Have all lines put on the disk."""
        os.fsync(self._file)
        self._synced = time.monotonic()

    def close(self) -> None:
        """Put all lines on the disk and let others have the journal."""
        try:
            os.fsync(self._file)
        finally:
            os.close(self._file)
            os.close(self._lock)


def open_journal(
    folder: Path, about: Mapping[str, Any], what: str
) -> tuple[dict[int, dict[str, Any]], Journal]:
    """Begin a journal in its own folder, or continue it.

    Args:
        folder: The folder, made if it is not there.
        about: What it is of, as JSON takes it: a journal of anything else is refused.
        what: What it is a part of, a word for messages and the file that says so: "diagram".

    Returns:
        The entries that there are by their number, and the journal to add to.

    Raises:
        OutputError: The folder is of another, or cannot be written, or another process has it.
    """
    text = json.dumps(about, sort_keys=True)
    key = hashlib.sha256(text.encode()).digest()
    path, journal = folder / f"{what}.json", folder / "journal"
    try:
        folder.mkdir(exist_ok=True)
        there = json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: cannot be read: {error}; remove its folder to begin anew") from error
    if there is None:
        if any(one.name != ".lock" for one in folder.iterdir()):
            raise OutputError(
                f"{folder}: must be the unfinished part of a {what}, got another folder; name another result"
            )
        with replacing(path) as partial:
            partial.write_text(text, encoding="utf-8")
    elif there != json.loads(text):
        changed = ", ".join(name for name in about if there.get(name) != json.loads(text)[name])
        raise OutputError(
            f"{folder}: is the unfinished part of another {what}; what differs: {changed}; name another "
            "result, or remove that folder"
        )
    try:
        old = read_journal(journal, key)
    except OSError as error:
        raise OutputError(f"{journal}: cannot be read: {error.strerror}") from error
    keep = old.entries.values() if old.damaged or old.torn else None
    return dict(old.entries), Journal(journal, key, keep, what)
