"""Study on disk: its identity, the journal of runs, dataset, full results.

``study.json`` holds the identity of the study, ``journal`` has a line for each finished run, ``runs.nc`` is
the dataset made of them, ``runs/`` holds full results. The driver alone writes. A digest in every
file reveals damage.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable, has_whole_seal, replacing, seal
from antenna_pin.errors import FileFormatError, OutputError
from antenna_pin.studies.sweep.design import SAMPLE, Design
from antenna_pin.studies.sweep.jobs import Work
from antenna_pin.studies.sweep.journal import Journal, ReadJournal, deleted, read_journal, scenario_content
from antenna_pin.studies.sweep.study import Study
from antenna_pin.trajectory.file import load_dataset, write

# --- the dataset of a study: its responses and how its runs ended, labelled by its parameters ---

#: Identifies the format of a study's dataset.
FORMAT = "antenna_pin study 1"

#: Outcome of a run that is still to be made.
PENDING = "PENDING"

# What is kept of each run beside its responses: units, meaning, type.
_COLUMNS: dict[str, tuple[str, str, type]] = {
    "end_time": ("s", "simulated time", float),
    "steps": ("1", "steps accepted", int),
    "rejected": ("1", "trial steps rejected by their error", int),
    "relocated": ("1", "trial steps cut back to end at a change of contact", int),
    "evaluations": ("1", "evaluations of the equations of motion", int),
}


def empty_table(study: Study, design: Design, about: Mapping[str, str]) -> xr.Dataset:
    """Return the dataset of a study without finished runs, with further attributes ``about``."""
    dims = tuple(design.sizes)
    coordinates: dict[str, Any] = {}
    for column in design.columns:
        values = column.settings.values
        numeric = not any(math.isnan(value.number) for value in values)
        attributes = {"long_name": column.title, "key": ", ".join(column.keys)}
        if numeric:
            attributes["units"] = column.settings.unit
        labels = [value.number if numeric else value.text for value in values]
        coordinates[column.name] = (column.dim, np.array(labels, dtype=float if numeric else str), attributes)
    found: dict[str, Any] = {
        name: (dims, np.full(design.shape, np.nan), {"units": response.unit, "long_name": response.meaning})
        for name, response in study.responses.items()
    }
    found["outcome"] = (dims, np.full(design.shape, PENDING, dtype=object), {"long_name": "why it ended"})
    found["message"] = (dims, np.full(design.shape, "", dtype=object), {"long_name": "that in words"})
    for name, (units, meaning, kind) in _COLUMNS.items():
        fill = np.full(design.shape, np.nan) if kind is float else np.zeros(design.shape, dtype=np.int64)
        found[name] = (dims, fill, {"units": units, "long_name": meaning})
    found["seed"] = (dims, design.seeds.reshape(design.shape), {"long_name": "seed of the run"})
    if design.probability is not None:
        coordinates["factor"] = ("factor", np.array(design.factors, dtype=str))
        found["probability"] = (
            (SAMPLE, "factor"),
            design.probability,
            {"units": "1", "long_name": "where a sample stands in its distribution"},
        )
    attributes = {
        "format": FORMAT,
        "title": study.title,
        "study": study.model_dump_json(exclude={"folder"}),
        "parameters": json.dumps([column.name for column in design.columns]),
        "responses": json.dumps(list(study.responses)),
        "method": study.sampling.method if study.sampling is not None else "grid",
        **about,
    }
    return xr.Dataset(found, coords=coordinates, attrs=attributes)


def add_entries(table: xr.Dataset, entries: Iterable[Mapping[str, Any]]) -> None:
    """Write finished runs into a study's dataset."""
    shape = table["outcome"].shape
    names = json.loads(table.attrs["responses"])
    arrays = {name: table[name].values for name in (*names, "outcome", "message", *_COLUMNS)}
    for entry in entries:
        place = np.unravel_index(entry["run"], shape)
        for name in names:
            arrays[name][place] = entry["values"].get(name, np.nan)
        for name in ("outcome", "message", *_COLUMNS):
            arrays[name][place] = entry[name]


#: How the name of a store ends.
SUFFIX = ".study"

#: Outcome of a run that has taken its process along.
LOST = "LOST"

_ABOUT, _JOURNAL, _TABLE, _RESULTS = "study.json", "journal", "runs.nc", "runs"


@dataclasses.dataclass(frozen=True, slots=True)
class Identity:
    """Identity of a study: its runs, responses, and the computing code."""

    digest: str  # of all, as hexadecimal text
    parts: dict[str, str]  # digests of the parts, by name, to report differences of two studies
    versions: dict[str, str]  # of the package and its libraries

    @property
    def key(self) -> bytes:
        """Key that signs the lines of the journal."""
        return bytes.fromhex(self.digest)[:32]


def identity_of(study: Study, design: Design, work: Work) -> Identity:
    """Return a study's identity, by which its store is recognised."""
    values = [[list(c.keys), c.dim, [v.set for v in c.settings.values]] for c in design.columns]
    responses = {name: response.model_dump() for name, response in study.responses.items()}
    follows = study.reference and study.reference.follows
    parts = {
        "the scenario": _digest(scenario_content(work.base)),
        "the reference": _digest([scenario_content(work.reference), follows]),
        "the parameters": _digest([list(study.parameters), values, design.seeds.tolist()]),
        "the responses": _digest([responses, work.sources]),
        "the results kept": _digest(study.results if study.keep is None else [study.results, study.keep]),
        "the versions": _digest(work.versions),
    }
    return Identity(_digest(parts), parts, work.versions)


def _digest(value: Any) -> str:
    text = json.dumps(value, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


class Store:
    """Folder of a running study.

    Raises:
        OutputError: The store belongs to another study, or cannot be written.
    """

    def __init__(self, path: Path, study: Study, design: Design, identity: Identity) -> None:
        """Read the folder, if it exists; nothing is written yet."""
        self.path, self.study, self.design, self.identity = path, study, design, identity
        self.notes: list[str] = []
        self._journal: Journal | None = None
        old = ReadJournal({}, 0, False)
        if not path.exists():
            if not path.parent.is_dir():
                raise OutputError(f"{path}: the folder {str(path.parent)!r} does not exist; make it")
            check_writable(path.with_name(path.name + ".json"))  # tells a full disk before any work
        elif not path.is_dir():
            raise OutputError(f"{path}: must be a folder, got a file; name another with --out")
        else:
            old = self._own()
        # What took its process along may have been the machine's doing: such a run is tried again.
        found = {number: entry for number, entry in old.entries.items() if entry["outcome"] != LOST}
        self.entries = {number: entry for number, entry in found.items() if self._has_result(entry)}
        lost = len(found) - len(self.entries)
        self._rewrite = bool(old.damaged or old.torn or lost)
        for count, what in (
            (old.damaged, "damaged line# in its journal"),
            (lost, "run# whose full result is missing or damaged"),
        ):
            if count:
                words = what.replace("#", "" if count == 1 else "s")
                self.notes.append(f"{path}: found {count} {words}; missing runs are repeated")
        if has_seal(path / _TABLE) is False:
            self.notes.append(f"{path / _TABLE}: is damaged; rebuilt from the journal")

    def begin(self) -> None:
        """Make the folder, or continue in it, with a dataset that others may open.

        Raises:
            OutputError: The folder cannot be written, is in use, or was deleted since it was read.
        """
        if self.entries and not (self.path / _JOURNAL).is_file():
            raise deleted(self.path / _JOURNAL)
        try:
            self.path.mkdir(exist_ok=True)
        except OSError as error:
            raise OutputError(f"{self.path}: cannot be created: {error.strerror}") from error
        keep = self.entries.values() if self._rewrite else None
        self._journal = Journal(self.path / _JOURNAL, self.identity.key, keep)
        self._write_about()
        self.write_table()

    def _own(self) -> ReadJournal:
        """Return the journal of an existing folder of this study."""
        path = self.path
        about = _read_about(path)
        if about is not None and about["digest"] != self.identity.digest:
            parts = about.get("parts", {})
            changed = [name for name, digest in self.identity.parts.items() if parts.get(name) != digest]
            if changed == ["the versions"]:
                old = about.get("versions", {})
                changed = [
                    f"{name} {old.get(name)} is now {version}"
                    for name, version in self.identity.versions.items()
                    if old.get(name) != version
                ]
                what = f"of other versions: {', '.join(changed)}"
            else:
                what = f"of another study; what differs: {', '.join(changed)}"
            raise OutputError(
                f"{path}: is a store {what}; name another with --out, or create a second store with --apart"
            )
        journal = read_journal(path / _JOURNAL, self.identity.key)
        if about is None:
            others = sorted(entry.name for entry in path.iterdir() if entry.name != ".lock")
            if others and not journal.entries:
                raise OutputError(
                    f"{path}: is a folder without a complete {_ABOUT}, and contains nothing of this study; "
                    f"name another with --out, or remove it"
                )
            if others:
                self.notes.append(
                    f"{path / _ABOUT}: is missing or damaged, and is written again: the journal is this "
                    "study's"
                )
        return journal

    def _write_about(self) -> None:
        about = {"format": FORMAT, "digest": self.identity.digest, "parts": self.identity.parts}
        about |= {"versions": self.identity.versions, "study": json.loads(self.study.model_dump_json())}
        with replacing(self.path / _ABOUT) as partial:
            partial.write_text(json.dumps(about, indent=1), encoding="utf-8")
            seal(partial)

    def _has_result(self, entry: Mapping[str, Any]) -> bool:
        name = entry.get("result")
        return not name or has_seal(self.path / _RESULTS / str(name)) is True

    def add(self, entry: dict[str, Any], result: bytes) -> None:
        """Store a finished run: its full result first, then its line."""
        if result:
            name = f"{entry['run']:06d}.nc"
            try:
                (self.path / _RESULTS).mkdir(exist_ok=True)
                with replacing(self.path / _RESULTS / name) as partial:
                    partial.write_bytes(result)
            except OSError as error:
                raise OutputError(
                    f"{self.path / _RESULTS / name}: cannot be written: {error.strerror or error}; earlier "
                    f"runs are saved; free disk space and repeat the command"
                ) from error
            entry = {**entry, "result": name}
        assert self._journal is not None
        self._journal.add(entry)
        self.entries[int(entry["run"])] = entry

    def missing(self) -> list[int]:
        """Return the numbers of the missing runs."""
        return [run for run in range(self.design.count) if run not in self.entries]

    def table(self) -> xr.Dataset:
        """Return the dataset of the runs made so far."""
        about = {"digest": self.identity.digest, "versions": json.dumps(self.identity.versions)}
        table = empty_table(self.study, self.design, about)
        add_entries(table, self.entries.values())
        return table

    def write_table(self) -> None:
        """Write the dataset of the runs made so far; a failure leaves the one before."""
        if self._journal is not None:
            self._journal.check()
        table = self.table()
        # xarray's own way to say which variables label others; index labels are known by their names.
        table.attrs["coordinates"] = " ".join(str(name) for name in table.coords if name not in table.dims)
        try:
            with replacing(self.path / _TABLE) as partial:
                write(table, partial)
        except OutputError as error:
            raise OutputError(
                f"{error}; the runs are saved in the journal; repeat the command to continue"
            ) from None

    def close(self) -> None:
        """Write all to the disk."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None


def has_seal(path: Path) -> bool | None:
    """Return true for an intact sealed file, false without a seal, None for no file."""
    try:
        return has_whole_seal(path) is True
    except (FileNotFoundError, ValueError):  # of a name that no file can have
        return None
    except OSError:
        return False


def _read_about(path: Path) -> dict[str, Any] | None:
    """Return a store's description; None if missing or damaged."""
    target = path / _ABOUT
    if not has_seal(target):
        return None
    try:
        about = json.JSONDecoder().raw_decode(target.read_text(encoding="utf-8"))[0]
    except (OSError, ValueError):
        return None
    return about if isinstance(about, dict) and isinstance(about.get("digest"), str) else None


@takes()
def open_study(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return the dataset of a study's finished runs; it may still be running.

    Returns:
        Over the parameters of a grid, and ``sample`` if any is sampled, labelled by the parameters' values:
        each response; ``outcome`` (``PENDING`` for a missing run) and ``message``; ``end_time`` [s],
        ``steps``, ``rejected``, ``relocated``, ``evaluations`` [-]; ``wall_time`` [s] and ``worker``;
        ``seed``; ``run``, the number of each.

    Raises:
        FileFormatError: The folder is not a store of a study, or is damaged.
    """
    folder = Path(path)
    target = folder / _TABLE
    about = _read_about(folder)
    if about is None or not target.is_file():
        what = "no folder of that name" if not folder.is_dir() else "a folder without a whole one"
        raise FileFormatError(
            f"{folder}: must be the store of a study, got {what}; `antenna-pin sweep` makes it"
        )
    if has_seal(target) is not True:
        raise FileFormatError(
            f"{target}: must be as antenna-pin wrote it, got another checksum; give the command of the study "
            "again, which makes it from the journal"
        )
    try:
        table = load_dataset(target)
    except FileFormatError:
        raise
    except Exception as error:  # HDF5 raises any
        words = " ".join(str(error).split())
        raise FileFormatError(f"{target}: must be the dataset of a study, got: {words}") from None
    if table.attrs.get("format") != FORMAT or table.attrs.get("digest") != about["digest"]:
        raise FileFormatError(f"{target}: must be the dataset of this study, of format {FORMAT!r}")
    for name in ("outcome", "message"):
        table[name] = table[name].astype(object)
    entries = read_journal(folder / _JOURNAL, bytes.fromhex(about["digest"])[:32]).entries
    add_entries(table, entries.values())
    shape, dims = table["outcome"].shape, table["outcome"].dims
    wall, worker = np.full(shape, np.nan), np.full(shape, "", dtype=object)
    for number, entry in entries.items():
        place = np.unravel_index(number, shape)
        wall[place], worker[place] = entry["wall_time"], entry["worker"]
    table["wall_time"] = (dims, wall, {"units": "s", "long_name": "time that it took"})
    table["worker"] = (dims, worker, {"long_name": "machine that made it"})
    table["run"] = (dims, np.arange(table["outcome"].size).reshape(shape), {"long_name": "number of the run"})
    table.attrs["path"] = str(folder)
    return table
