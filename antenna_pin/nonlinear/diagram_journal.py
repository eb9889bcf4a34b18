"""What a diagram has come to so far, on the disk: a journal with a line for each value that was made."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from antenna_pin.errors import InvalidParameterError
from antenna_pin.nonlinear.branches import Asked, Entry
from antenna_pin.nonlinear.surfaces import Crossing
from antenna_pin.simulation import Angle, Force, Gap, Rate
from antenna_pin.sweep.journal import Journal, begun
from antenna_pin.trajectory import library_versions

__all__ = ["Parts"]

_SUFFIX = ".parts"


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
        self.entries, self._journal = begun(self.folder, about, "diagram")


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
