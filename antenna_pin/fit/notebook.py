"""What the runs of a fit have come to so far, on the disk: a journal, a line for those asked for at once."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from antenna_pin.fit.plan import FitPlan
from antenna_pin.fit.runs import Asked, Readings, Rig, Slopes
from antenna_pin.sweep.journal import Journal, begun
from antenna_pin.trajectory import library_versions

__all__ = ["Notebook"]

_SUFFIX = ".parts"
_FORM = 3  # of a line


class Notebook:
    """A fit's runs beside the file that it is to be saved in, in the folder ``FILE.parts``.

    A line is for good: what was written under other records, parameters' keys, scenarios or versions is
    refused; other starts, bounds and losses ask for other runs, and share those that are the same.

    Args:
        target: Of the fit's result.

    Raises:
        OutputError: The folder is of another fit, or cannot be written, or another process has it.
    """

    def __init__(self, target: Path) -> None:
        """Name the folder."""
        self.folder = target.with_name(target.name + _SUFFIX)
        self._entries: dict[tuple[Any, ...], dict[str, Any]] = {}
        self._journal: Journal | None = None
        self._next = 0

    def open(self, plan: FitPlan, rigs: tuple[Rig, ...]) -> None:
        """Begin a fit's notebook, or go on with it."""
        entries, self._journal = begun(self.folder, _about(plan, rigs), "fit")
        self._entries = {_key(entry["asked"]): entry for entry in entries.values()}
        self._next = max(entries, default=-1) + 1

    def read(self, asked: Asked) -> tuple[Readings, ...] | None:
        """Return what runs came to; None if they were not made."""
        entry = self._entries.get(_key(asked))
        if entry is None:
            return None
        return tuple(_readings(one) for one in entry["found"])

    def write(self, asked: Asked, found: Sequence[Readings]) -> None:
        """Keep what runs came to."""
        entry = {
            "run": self._next,
            "asked": list(asked),
            "found": [_lists(one) for one in found],
        }
        if self._journal is not None:
            self._journal.add(entry)
        self._entries[_key(asked)] = entry
        self._next += 1

    def close(self) -> None:
        """Put all on the disk, and let others have it."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None

    def remove(self) -> None:
        """Remove the folder: the fit is done, and saved."""
        self.close()
        for name in ("journal", "fit.json", ".lock"):
            (self.folder / name).unlink(missing_ok=True)
        self.folder.rmdir()


def _lists(found: Readings) -> dict[str, Any]:
    """Return what came of a run as JSON takes it."""
    lists: dict[str, Any] = _plain({name: getattr(found, name) for name in ("columns", "lead", "end")})
    lists |= {"failed": found.failed, "unbalanced": found.unbalanced}
    if found.slopes is not None:
        lists["slopes"] = _plain(found.slopes._asdict())
        lists["fitted"] = found.slopes.lead.shape[1]
    return lists


def _plain(found: Any) -> Any:
    if isinstance(found, dict):
        return {name: _plain(one) for name, one in found.items()}
    if isinstance(found, tuple):
        return [_plain(one) for one in found]
    return found.tolist() if isinstance(found, np.ndarray) else found


def _readings(lists: dict[str, Any]) -> Readings:
    """Return what came of a run from what was kept."""
    found = Readings(_arrays(lists["columns"]), np.array(lists["lead"]), np.array(lists["end"]))
    slopes = lists.get("slopes")
    if slopes is not None:
        lead, end = (np.array(slopes[name]).reshape(-1, lists["fitted"]) for name in ("lead", "end"))
        columns = tuple(one.reshape(-1, lists["fitted"]) for one in _arrays(slopes["columns"]))
        clock = None if slopes["clock"] is None else _arrays(slopes["clock"])
        found = found._replace(slopes=Slopes(columns, lead, end, clock))
    return found._replace(failed=lists["failed"], unbalanced=lists.get("unbalanced", ""))


def _arrays(lists: list[Any]) -> tuple[np.ndarray, ...]:
    return tuple(np.array(one) for one in lists)


def _key(asked: Any) -> tuple[Any, ...]:
    record, values, shift, starts, *rest = asked
    return record, tuple(values), shift, tuple((piece, tuple(start)) for piece, start in starts), *rest


def _about(plan: FitPlan, rigs: tuple[Rig, ...]) -> dict[str, Any]:
    """Return what the readings of runs depend on, as JSON takes it."""
    records = {}
    for rig in rigs:
        scenario = json.loads(rig.scenario)
        for name in ("name", "folder", "overrides", "description"):
            scenario.pop(name, None)
        columns = {name: one.model_dump(mode="json") for name, one in rig.columns.items()}
        for one in columns.values():
            for number in (
                "gain",
                "offset",
                "sd",
                "weight",
                "compare",
                "spectrum",
                "blows",
                "column",
                "unit",
            ):
                one.pop(number)
        time = hashlib.sha256(rig.time.tobytes()).hexdigest()
        made_of = [scenario, rig.keys, rig.units, rig.derived]
        records[rig.name] = [*made_of, columns, time, rig.pieces, rig.origins]
    return {"form": _FORM, "records": records, "versions": library_versions()}
