"""Checkpoints of a run: state and record as a file, and their store."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import os
import re
import secrets
import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from antenna_pin.base.readable import of_size
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.dynamics import System
from antenna_pin.elements.control import Controller
from antenna_pin.errors import AntennaPinError, FileFormatError, OutputError, one_line
from antenna_pin.run.simulation.attributes import mechanism_attributes
from antenna_pin.run.simulation.element_events import ModeChangeEvent
from antenna_pin.run.simulation.event_actions import EventRecord
from antenna_pin.run.simulation.events import Event
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.sample_files import (
    CHECKPOINT,
    LATE,
    SAMPLED,
    SampleFiles,
    changed_words,
    chunk_of,
    folder_of,
    late_numbers,
    late_of,
    numbers_of,
    read_sealed,
    words_of,
    write_sealed,
)
from antenna_pin.trajectory import Outcome, library_versions

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario

Array = NDArray[np.float64]

# --- checkpoint ---------------------------------------------------------------------------------------------

# Keys of a scenario that describe its origin, or may differ when a run continues.
_MAY_DIFFER = {"name", "description", "overrides", "folder", "duration"}

# Names that its arrays may have.
_ARRAYS = re.compile(
    "|".join(("about", *SAMPLED, *LATE, "touches", "book_[a-z]+", "tick_(times|values)_[0-9]+"))
)

#: Identifies the file format; others are refused.
FORMAT = "antenna_pin checkpoint 5"


class _Singular(BaseModel):
    """Data of the search for singular positions: ``Singularities.value``."""

    model_config = ConfigDict(strict=True, extra="forbid")

    last: list[tuple[float, list[float], float]]
    passed: tuple[float, list[float]] | None
    middle: tuple[float, list[float]] | None
    found: list[tuple[float, float]]
    most: float
    rank: int
    apart: bool
    time: float
    way: float


# Beyond that two numbers of type float64 that follow one another are not both whole.
_Count = Annotated[int, Field(ge=0, le=2**53)]
_Duration = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


class _Counts(BaseModel):
    """Counts of steps, and times spent [s]: ``Counts``."""

    model_config = ConfigDict(strict=True, extra="forbid")

    accepted: _Count
    rejected: _Count
    relocated: _Count
    evaluations: _Count
    wall_seconds: _Duration
    compile_seconds: _Duration


# Fields of a ``ModeChangeEvent``.
_Changed = tuple[str, str, str, float, str, float, float, float, float, float, float, float, float]


class _About(BaseModel):
    """Schema of a checkpoint's JSON: plain numbers and text."""

    model_config = ConfigDict(strict=True, extra="forbid")

    format: str
    versions: dict[str, str]
    run: str
    rows: list[_Count]
    scenario: str
    system: str
    settings: dict[str, Any]
    span: float
    start: str
    events: list[str]
    controllers: list[list[Any]]
    state: str
    left: str | None
    begin: float
    counts: _Counts
    outcome: str
    message: str
    gap_difference: float
    paced: tuple[_Count, float]
    happened: list[tuple[str, float, float]]
    changed: list[_Changed]
    singular: _Singular | None
    handed: float | None
    before: list[tuple[int, int]]


@dataclass(frozen=True, slots=True, eq=False)
class Checkpoint:
    """A run between two steps.

    Attributes:
        about: Identity of the run, by :func:`about_run`, and its state; plain numbers and text.
        numbers: Arrays, by name.
    """

    about: dict[str, Any]
    numbers: Mapping[str, NDArray[Any]]

    @classmethod
    def of(cls, run: Run, about: Mapping[str, Any]) -> Self:
        """Return the checkpoint of a run between two steps.

        Args:
            run: Between two steps.
            about: Identity of the run, stored unchanged.
        """
        ended = not (run.outcome is Outcome.COMPLETED or run.outcome.may_go_on)
        counts = dataclasses.asdict(run.counts())
        handed, before = run.samples.handed
        how = {
            "state": run.present().to_json(),
            "left": None if run.left is None else run.left.to_json(),
            "begin": run.begin,
            "counts": counts,
            "outcome": (run.outcome if ended else Outcome.COMPLETED).name,
            "message": (run.message if ended else Outcome.COMPLETED.value),
            "gap_difference": float(run.search.difference[0]),
            "paced": run.control.paced,
            "happened": [dataclasses.astuple(one) for one in run.actions.happened],
            "changed": [dataclasses.astuple(one) for one in run.actions.modes.changed],
            "singular": None if run.singular is None else run.singular.value(),
            "handed": handed,
        }
        base = run.system.program
        changed = [] if before is None else changed_words(before, base)
        how["before"] = [] if before is None else [(word, int(words_of(before)[word])) for word in changed]
        return cls({**about, **how}, _arrays_of(run))

    def give_to(self, run: Run) -> None:
        """Restore a run that was created from :attr:`start` and records since :attr:`begin`.

        Raises:
            FileFormatError: The checkpoint is not of such a run.
        """
        try:
            _check_arrays(self.numbers, _arrays_of(run))
            self._give_to(run)
        except AntennaPinError:
            raise
        except _WRONG as error:
            raise _no_checkpoint("simulate", error) from None

    def _give_to(self, run: Run) -> None:
        how, counts = self.about, self.about["counts"]
        base = run.system.program
        if how["left"] is not None:
            run.left = State.from_json(how["left"])
        run.contacts.take_up_all(
            {name.removeprefix("book_"): array for name, array in self.numbers.items() if "book_" in name}
        )
        for name in ("effort", "time"):  # where the blocks are is the run's own
            run.actions.modes.peaks.numbers[name] = self.numbers["touches"][name]
        run.controllers.take_up_record(self.numbers)
        samples = run.samples
        samples.take_up(chunk_of(self.numbers, base))
        samples.late = late_of(self.numbers)
        if how["handed"] is not None:
            before = base.copy()
            for word, value in how["before"]:
                words_of(before)[word] = value
            samples.go_on_after(how["handed"], before)
        run.outcome, run.message = Outcome[how["outcome"]], how["message"]
        run.search.difference[0] = how["gap_difference"]
        run.control.paced = tuple(how["paced"])
        run.actions.happened[:] = [EventRecord(*one) for one in how["happened"]]
        run.actions.modes.changed[:] = [ModeChangeEvent(*one) for one in how["changed"]]
        if run.singular is not None:
            run.singular.take_up(how["singular"])
        made = run.steps
        made.accepted, made.rejected, made.relocated = (
            counts[name] for name in ("accepted", "rejected", "relocated")
        )
        run.stepper.evaluations = counts["evaluations"]
        run.wall = counts["wall_seconds"]

    @property
    def start(self) -> State:
        """State at the checkpoint."""
        return State.from_json(self.about["state"])

    @property
    def begin(self) -> float:
        """Time from which the run records [s]."""
        return float(self.about["begin"])

    @property
    def scenario(self) -> Scenario | None:
        """Scenario of the run; None for a system built in Python."""
        from antenna_pin.scenario import Scenario

        text = self.about["scenario"]
        try:
            return Scenario.model_validate_json(text) if text else None
        except ValueError as error:
            raise _no_checkpoint("scenario", error) from None

    # --- as a file ------------------------------------------------------------------------------------------

    def write(self, folder: Path) -> None:
        """Write the checkpoint into a folder of parts, in place of the previous checkpoint.

        Raises:
            OutputError: The checkpoint cannot be written.
        """
        about = {"format": FORMAT, "versions": library_versions(), **self.about}
        write_sealed(folder / CHECKPOINT, {"about": np.array(json.dumps(about)), **self.numbers})

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read the checkpoint of a run, by its result's name or its folder of parts.

        Raises:
            FileFormatError: The checkpoint is missing, damaged or of another version.
        """
        source = folder_of(path) / CHECKPOINT
        if not source.is_file():
            raise FileFormatError(
                f"{path}: no checkpoint of a run in {str(folder_of(path))!r}: it was never stopped, or has "
                "come to its end"
            )
        numbers = read_sealed(source, _ARRAYS)
        try:
            about = json.loads(str(numbers.pop("about")))
            found = about["format"]
            of_scenario = json.loads(about["scenario"] or "{}")
        except _WRONG as error:
            raise _no_checkpoint(source, error) from None
        if found != FORMAT:
            raise FileFormatError(
                f"{source}: the format must be {FORMAT!r}, got {found!r}; resume with the version that "
                f"wrote it, or run the scenario again"
            )
        if not isinstance(of_scenario, dict):
            raise _no_checkpoint(source, ValueError(f"scenario {of_size(of_scenario)}"))
        try:
            _About.model_validate_json(json.dumps(about))
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"]))
            said = f"{where} {of_size(first['input'])} ({first['msg'].lower()})"
            raise _no_checkpoint(source, ValueError(said)) from None
        for name, version in library_versions().items():
            if about["versions"].get(name) != version:
                raise FileFormatError(
                    f"{source}: must be of {name} {version}, got one of {about['versions'].get(name)}: its "
                    f"result would differ; resume with that version, or run the scenario again"
                )
        return cls(about, numbers)


# Errors of data that no run has written.
_WRONG = (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError, RecursionError)


def _no_checkpoint(place: object, error: Exception) -> FileFormatError:
    words = one_line(str(error) if type(error) is ValueError else repr(error))[:200]
    return FileFormatError(
        f"{place}: must be a checkpoint of a run, got one with {words}; run the scenario again from its start"
    )


def _arrays_of(run: Run) -> dict[str, NDArray[Any]]:
    """Return the arrays of a run's checkpoint, by name."""
    return {
        **numbers_of(run.samples.chunk, run.system.program),
        **late_numbers(run.samples.late, run.system.manifold.size, len(run.contacts)),
        **{f"book_{name}": array for name, array in run.contacts.numbers().items()},
        "touches": run.actions.modes.peaks.numbers,
        **run.controllers.numbers(),
    }


def _check_arrays(arrays: Mapping[str, NDArray[Any]], own: Mapping[str, NDArray[Any]]) -> None:
    """Refuse arrays that differ from a run's, except in the number of rows."""
    for name in [*own, *arrays]:
        if name not in own or name not in arrays:
            raise ValueError(f"{'no' if name in own else 'an'} array {name!r}")
        one, like = arrays[name], own[name]
        if one.dtype.descr != like.dtype.descr or one.ndim != like.ndim or one.shape[1:] != like.shape[1:]:
            raise ValueError(f"{name} of {one.dtype}, shape {one.shape}")


def about_run(
    system: System,
    scenario: Scenario | None,
    settings: RunSettings,
    span: float,
    start: str,
    events: Sequence[Event],
    controllers: Mapping[str, Controller],
) -> dict[str, Any]:
    """Return the identity of a run, as its checkpoints store it."""
    made = json.dumps(mechanism_attributes(system), sort_keys=True)
    return {
        "scenario": "" if scenario is None else scenario.model_dump_json(),
        "system": hashlib.sha256(made.encode()).hexdigest(),
        "settings": json.loads(json.dumps(dataclasses.asdict(settings))),
        "span": span,
        "start": start,
        "events": [event.name for event in events],
        "controllers": [
            [name, type(one).__name__, one.period, one.phase, one.delay, one.delay_periods]
            for name, one in controllers.items()
        ],
    }


# Parts of a run, besides its scenario's keys, that must be those of its checkpoint.
_PARTS = {
    "system": "this mechanism: links, joints, elements or their numbers differ",
    "settings": "these settings",
    "events": "these events",
    "controllers": "these controllers",
}


def check_same(stood: Checkpoint, about: Mapping[str, Any]) -> None:
    """Refuse to continue a run from the checkpoint of another.

    Raises:
        FileFormatError: The runs differ.
    """
    was = stood.about
    way_out = "pass the inputs it was started with, or run it from the start"
    ours, theirs = (json.loads(one["scenario"] or "{}") for one in (about, was))
    for one in (ours, theirs):
        one["integrator"] = _of_any_patience(one.get("integrator"))
    for name in [*theirs, *ours]:
        if name not in _MAY_DIFFER and ours.get(name) != theirs.get(name):
            what = "URDF: the file has changed" if name == "urdf_text" else repr(name)
            raise FileFormatError(
                f"simulate: the checkpoint must be of this scenario, got one with another {what}; {way_out}"
            )
    for name in _PARTS:
        if _of_any_patience(about[name]) != _of_any_patience(was[name]):
            raise FileFormatError(f"simulate: the checkpoint must be of a run with {_PARTS[name]}; {way_out}")
    if about["span"] == was["span"]:
        return
    if was["left"] is not None or was["outcome"] != Outcome.COMPLETED.name:
        raise FileFormatError(
            f"simulate: duration must be {was['span']:g} s, to which the run's last steps were already cut, "
            f"got {about['span']:g} s; let it finish, then continue with start"
        )
    if not stood.begin + about["span"] > stood.start.time:
        raise FileFormatError(
            f"simulate: duration must be beyond the checkpoint, at {stood.start.time:.6g} s, got "
            f"{about['span']:g} s"
        )


def _of_any_patience(settings: Any) -> Any:
    """Return settings without the limit of wall time, which may differ each time."""
    return (
        {k: v for k, v in settings.items() if k != "max_wall_time"}
        if isinstance(settings, dict)
        else settings
    )


# --- checkpoint store ---------------------------------------------------------------------------------------

_PART = 16_000_000  # bytes of samples that make a part
_TIMES = 9.0  # times the cost of a checkpoint before the next one: a tenth of the wall time
_AGAIN = 10.0  # [s] of wall time between failed attempts to write


class NotKeptWarning(UserWarning):
    """Record that cannot be written to the disk and stays in memory."""


class CheckpointsWaitedWarning(UserWarning):
    """Checkpoints at longer intervals than requested, because each took too long."""


class CheckpointStore:
    """Checkpoints and parts of the record of a run, on the disk.

    A run with a small record and without due checkpoints does not touch the disk.

    Args:
        path: File of the run's result.
        system: The system.
        about: Identity of the run, for its checkpoints.
        interval: Wall time from one checkpoint to the next [s], and at least nine times what the last one
            took, as the run reports at its end; infinity for checkpoints at interruptions only.
        checkpoint: Checkpoint from which the run continues.

    Attributes:
        path: File of the run's result.
        parts: Parts on the disk.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        system: System,
        about: Mapping[str, Any],
        interval: float = math.inf,
        checkpoint: Checkpoint | None = None,
    ) -> None:
        """Begin, or continue with the parts that the checkpoint lists."""
        found = {} if checkpoint is None else checkpoint.about
        identity = found.get("run", secrets.token_hex(8))
        self.path = Path(path)
        self.parts = SampleFiles(folder_of(path), system.program, identity)
        self.parts.rows[:] = found.get("rows", ())
        self._about = {**about, "run": identity}
        self._interval = interval
        self._asked = self._due = math.nan
        self._wait = -math.inf
        self._dearest, self._waited = 0.0, False
        self._goes_on = checkpoint is not None

    def __enter__(self) -> Self:
        """Lock the folder of a run that continues."""
        if self._goes_on:
            self.parts.open()
            self.parts.drop_others()
        return self

    def __exit__(self, *error: object) -> None:
        """Unlock the folder."""
        self.parts.close()

    def observe(self, run: Run) -> None:
        """Write the parts and checkpoints that are due."""
        wall = run.wall
        if math.isnan(self._due):
            self._asked = self._due = wall + self._interval
        self._waited |= self._asked <= wall < self._due
        large = run.samples.size > _PART
        if not (large or wall >= self._due) or wall < self._wait:
            return
        try:
            if large:
                self.parts.append(run.samples.chunk.part(None, -1))  # the last may yet be replaced
                run.samples.hand_out()
            if wall >= self._due:
                cost = self.write(run)
                self._dearest = max(self._dearest, cost)
                self._asked = wall + cost + self._interval
                self._due = wall + cost + max(self._interval, _TIMES * cost)
        except OutputError as error:
            if self._wait == -math.inf:
                warnings.warn(
                    f"{error}; the run continues and keeps the checkpoint in memory",
                    NotKeptWarning,
                    stacklevel=2,
                )
            self._wait = wall + _AGAIN

    def end(self, run: Run) -> None:
        """Store a run that may continue or has parts; warn of delayed checkpoints."""
        if run.outcome.may_go_on or self.parts.rows:
            try:
                self.write(run)
            except OutputError as error:
                warnings.warn(f"{error}; the run cannot be resumed", NotKeptWarning, stacklevel=2)
        if self._waited:
            warnings.warn(
                f"checkpoints took up to {self._dearest:.2g} s each, and so waited for up to "
                f"{_TIMES * self._dearest:.2g} s instead of the {self._interval:.3g} s asked: they take a "
                "tenth of the time at most",
                CheckpointsWaitedWarning,
                stacklevel=2,
            )

    def write(self, run: Run) -> float:
        """Write a checkpoint, and return the time that this took [s].

        Raises:
            OutputError: The checkpoint cannot be written.
        """
        began = time.perf_counter()
        self.parts.open()
        Checkpoint.of(run, {**self._about, "rows": self.parts.rows}).write(self.parts.folder)
        return time.perf_counter() - began
