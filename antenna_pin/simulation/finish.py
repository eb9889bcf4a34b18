"""The end of a run: from its record to a result, in memory or, where that is large, on the disk."""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from antenna_pin.base.files import check_writable, replacing
from antenna_pin.compiled.compile_time import CompileClock
from antenna_pin.errors import LedgerOpenWarning, OutputError
from antenna_pin.simulation.keeper import Keeper
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.record import Recording, recorded
from antenna_pin.trajectory import Outcome, Trajectory, library_versions, write_blocks
from antenna_pin.trajectory.labelled import Unlabelled

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario

__all__ = ["UnsavedError", "finished"]


class UnsavedError(OutputError):
    """A result cannot be written where it was asked to be; it is still in memory.

    Args:
        message: Why.
        trajectory: The result.
    """

    def __init__(self, message: str, trajectory: Trajectory) -> None:
        """Keep the result."""
        super().__init__(message)
        self.trajectory = trajectory


def finished(
    run: Run,
    scenario: Scenario | None,
    start: str,
    keeper: Keeper | None,
    began: float,
    compiling: CompileClock | None = None,
) -> Trajectory:
    """Return the result of a run that has made its last step; written, if it has a keeper.

    Args:
        run: The run.
        scenario: As it was run; None for a system built in Python.
        start: Where from, if not from the scenario's start: in words.
        keeper: Who has kept the record, and where the result is to be.
        began: When the recording began, by ``time.perf_counter`` [s].
        compiling: What knows how long was compiled for it; None if nothing was.

    Raises:
        OutputError: The result cannot be written. Then it is in memory (:class:`UnsavedError`), or can be
            made of what the keeper has.
    """
    title = scenario.title or scenario.name if scenario is not None else run.system.mechanism.name
    case = (scenario.case or "") if scenario is not None else ""
    lean = run.settings.output_form == "lean"
    compiled = CompileClock() if compiling is None else compiling
    before = compiled.seconds

    def result(data: Unlabelled) -> Trajectory:
        if start:
            data.more["start"] = start
        if run.oversight.advice:
            data.more["advice"] = run.oversight.advice
        data.more["finished"] = datetime.now(UTC).isoformat(timespec="seconds")
        nonlocal began
        now = time.perf_counter() - (compiled.seconds - before)
        run.wall, began = run.wall + now - began, now
        return Trajectory.later(
            data,
            outcome=run.outcome,
            message=run.message,
            counts=replace(run.counts(), compile_seconds=compiled.seconds),
            scenario=scenario,
            end=run.state,
        )

    if keeper is None or not keeper.parts.rows:
        trajectory = result(recorded(run, title, case, library_versions(), lean=lean))
        if keeper is not None:
            try:
                trajectory.save(keeper.path)
            except OutputError as error:
                raise UnsavedError(str(error), trajectory) from error
    else:
        trajectory = _streamed(run, keeper, {"title": title, "case": case}, result, lean)
    if keeper is not None and not run.outcome.may_go_on:
        keeper.parts.remove()
    if run.outcome is Outcome.LEDGER_OPEN:
        warnings.warn(run.message, LedgerOpenWarning, stacklevel=3)
    return trajectory


def _streamed(run: Run, keeper: Keeper, about: Mapping[str, Any], result: Any, lean: bool) -> Trajectory:
    """Write the result of a run whose record is on the disk, block by block, and return it as it is read."""
    recording = Recording(run, keeper.parts)
    about = {**about, "versions": json.dumps(library_versions())}

    def dataset_of(series: Mapping[str, Any]) -> Any:
        return result(recording.unlabelled(series, about, lean=lean)).stored()

    try:
        target = check_writable(keeper.path)
        with replacing(target) as partial:
            write_blocks(recording.blocks(), dataset_of, recording.count, partial)
    except OutputError as error:
        raise OutputError(
            f"{error}; what the run has recorded is in {str(keeper.parts.folder)!r}: make room and resume it"
        ) from error
    return Trajectory.load(target)
