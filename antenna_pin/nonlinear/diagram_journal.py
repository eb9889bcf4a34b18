"""What a diagram has come to so far, on the disk: a journal with a line for each value that was made."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from antenna_pin.errors import InvalidParameterError, OutputError
from antenna_pin.files import replacing
from antenna_pin.nonlinear.branches import Asked, Entry
from antenna_pin.nonlinear.surfaces import Crossing
from antenna_pin.simulation import Angle, Force, Gap, Rate
from antenna_pin.sweep.journal import Journal, read_journal
from antenna_pin.trajectory import library_versions

__all__ = ["Parts"]

_SUFFIX, _ABOUT, _JOURNAL = ".parts", "diagram.json", "journal"


class Parts:
    """The entries of a diagram, kept on the disk as they come if it has a folder.

    Attributes:
        entries: By number: of the branch, then of the value.
        folder: Where they are kept; None for in memory only.
    """

    def __init__(self, folder: Path | None) -> None:
        """Begin with none."""
        self.folder = folder
        self.entries: dict[int, Entry] = {}
        self._journal: Journal | None = None

    @classmethod
    @contextmanager
    def of(
        cls, target: Path | None, asked: Asked, values: Sequence[Any], branches: Sequence[str]
    ) -> Iterator[Parts]:
        """Yield what there is of a diagram.

        Args:
            target: File of the result, beside which the folder is; None for in memory only.
            asked: What is asked at every value.
            values: Of the parameter.
            branches: In the order of their numbers.

        Raises:
            OutputError: The folder is of another diagram, or cannot be written, or another process has it.
        """
        if target is None:
            yield cls(None)
            return
        parts = cls(target.with_name(target.name + _SUFFIX))
        parts._open(_about(asked, values, branches))
        try:
            yield parts
        finally:
            if parts._journal is not None:
                parts._journal.close()

    def add(self, entry: Entry) -> None:
        """Keep an entry."""
        if self._journal is not None:
            self._journal.add(entry)
        self.entries[int(entry["run"])] = entry

    def _open(self, about: dict[str, Any]) -> None:
        assert self.folder is not None
        text = json.dumps(about, sort_keys=True)
        key = hashlib.sha256(text.encode()).digest()
        path = self.folder / _ABOUT
        try:
            self.folder.mkdir(exist_ok=True)
            there = json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
        except (OSError, ValueError) as error:
            raise OutputError(f"{path}: cannot be read: {error}; remove its folder to begin anew") from error
        if there is None:
            if any(one.name != ".lock" for one in self.folder.iterdir()):
                raise OutputError(
                    f"{self.folder}: must be the unfinished part of a diagram, got another folder; name "
                    "another result"
                )
            with replacing(path) as partial:
                partial.write_text(text, encoding="utf-8")
        elif there != json.loads(text):
            changed = ", ".join(name for name in about if there.get(name) != json.loads(text)[name])
            raise OutputError(
                f"{self.folder}: is the unfinished part of another diagram; what differs: {changed}; name "
                "another result, or remove that folder"
            )
        try:
            old = read_journal(self.folder / _JOURNAL, key)
        except OSError as error:
            raise OutputError(f"{self.folder / _JOURNAL}: cannot be read: {error.strerror}") from error
        self.entries = dict(old.entries)
        keep = old.entries.values() if old.damaged or old.torn else None
        self._journal = Journal(self.folder / _JOURNAL, key, keep)


def _about(asked: Asked, values: Sequence[Any], branches: Sequence[str]) -> dict[str, Any]:
    """Return what makes a diagram itself, as JSON takes it."""
    scenario = json.loads(asked.scenario.model_dump_json())
    for name in ("name", "folder", "overrides", "description"):
        scenario.pop(name, None)
    section = asked.section
    if isinstance(section, Crossing) and not (
        isinstance(section.when, Angle | Rate | Gap | Force) or section.name
    ):
        raise InvalidParameterError(
            "bifurcation", "section", "given a name, by which a diagram on the disk tells its function", ""
        )
    return {
        "scenario": scenario,
        "parameter": asked.parameter,
        "values": list(values),
        "branches": list(branches),
        "section": section.words,
        "quantities": list(asked.quantities),
        "points": [asked.count, asked.transient, asked.most, asked.tolerance],
        "versions": library_versions(),
    }
