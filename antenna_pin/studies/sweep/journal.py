"""Journal of a study: one line for each finished run, append-only.

Each line starts with a digest of itself, keyed by the digest of the study: a torn, damaged or foreign line is
no result. A study is resumed from its journal; all else in its folder follows from it.
"""

from __future__ import annotations

import errno
import fcntl
import hashlib
import json
import os
import shutil
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from antenna_pin.base.files import is_there, replacing
from antenna_pin.errors import OutputError

_DIGEST = 24
_SYNC_EVERY = 1.0  # [s]


class ReadJournal(NamedTuple):
    """Contents of a journal."""

    entries: dict[int, dict[str, Any]]  # of the runs, by number
    damaged: int  # number of damaged lines
    torn: bool  # incomplete last line


def _line(key: bytes, entry: dict[str, Any]) -> bytes:
    text = json.dumps(entry, ensure_ascii=True, separators=(",", ":")).encode()
    return _signed(key, text) + b" " + text + b"\n"


def _signed(key: bytes, text: bytes) -> bytes:
    return hashlib.blake2b(text, key=key, digest_size=_DIGEST // 2).hexdigest().encode()


def read_journal(path: Path, key: bytes) -> ReadJournal:
    """Return the undamaged entries of a journal; a missing one is empty."""
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
    """Return the error for a deleted journal."""
    return OutputError(
        f"{path}: must stay while the {what} runs, got deleted or replaced, and its finished runs with it; "
        "give the same command again, with --out elsewhere if something clears it"
    )


class Journal:
    """Journal open for writing; one process at a time has it.

    ``keep`` are the entries of a journal rewritten after damage; None to append.

    Raises:
        OutputError: The journal cannot be written, or is in use.
    """

    def __init__(
        self, path: Path, key: bytes, keep: Iterable[dict[str, Any]] | None = None, what: str = "study"
    ) -> None:
        self.path, self._key, self._what = path, key, what
        # The lock is on a file of its own: the journal may be replaced.
        lock = path.with_name(".lock")
        try:
            self._lock = os.open(lock, os.O_CREAT | os.O_RDWR, 0o666)
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
            self._file = os.open(path, os.O_CREAT | os.O_RDWR | os.O_APPEND, 0o666)
            self._end = os.fstat(self._file).st_size
        except OutputError:
            raise
        except OSError as error:
            raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error
        self._synced = time.monotonic()

    def check(self) -> None:
        """Refuse to continue with a deleted journal: its lines would be lost."""
        if not is_there(self.path, self._file):
            raise deleted(self.path, self._what)

    def add(self, entry: dict[str, Any]) -> None:
        """Write the line of a finished run.

        Raises:
            OutputError: The line cannot be written, and the journal is unchanged; or the journal was deleted.
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
                f"{self.path}: cannot be written: {error.strerror or error}; earlier runs are saved; free "
                f"disk space and repeat the command"
            ) from error
        self._end += len(line)

    def sync(self) -> None:
        """Write all lines to the disk."""
        os.fsync(self._file)
        self._synced = time.monotonic()

    def close(self) -> None:
        """Write all lines to the disk and release the journal."""
        try:
            os.fsync(self._file)
        finally:
            os.close(self._file)
            os.close(self._lock)


def scenario_content(text: str) -> dict[str, Any]:
    """Return a scenario, as JSON text or "", without its origin."""
    data: dict[str, Any] = json.loads(text) if text else {}
    return {name: value for name, value in data.items() if name not in ("folder", "overrides", "description")}


class Parts:
    """Entries by number of an unfinished result, stored beside it in the folder ``FILE.parts``.

    Without a result they are in memory only. An entry has its number as ``run``. Identity and errors are
    those of :func:`open_journal`.
    """

    def __init__(self, target: Path | None, about: Callable[[], Mapping[str, Any]], what: str) -> None:
        self.entries: dict[int, dict[str, Any]] = {}
        self._journal: Journal | None = None
        self._folder = None if target is None else target.with_name(f"{target.name}.parts")
        if self._folder is not None:
            self.entries, self._journal = open_journal(self._folder, about(), what)

    def add(self, entry: dict[str, Any]) -> None:
        """Store an entry."""
        if self._journal is not None:
            self._journal.add(entry)
        self.entries[int(entry["run"])] = entry

    def close(self) -> None:
        """Flush and release the folder."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None

    def remove(self) -> None:
        """Remove the folder of a saved result."""
        self.close()
        if self._folder is not None:
            shutil.rmtree(self._folder)


def open_journal(
    folder: Path, about: Mapping[str, Any], what: str
) -> tuple[dict[int, dict[str, Any]], Journal]:
    """Begin a journal in its own folder, or continue it.

    Returns the entries by number and the open journal. The identity ``about`` is of JSON types; ``what`` is
    the kind of the whole, for messages and the name of the identity's file: "diagram".

    Raises:
        OutputError: The folder belongs to another, cannot be written, or is in use.
    """
    text = json.dumps(about, sort_keys=True)
    key = hashlib.sha256(text.encode()).digest()
    path, journal = folder / f"{what}.json", folder / "journal"
    try:
        folder.mkdir(exist_ok=True)
        there = json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: cannot be read: {error}; remove its folder to restart") from error
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
