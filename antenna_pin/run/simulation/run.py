"""Simulation of a scenario or a system, and the result of the finished run.

One step from here to an accepted sample: :mod:`inputs` (checked inputs), :mod:`loop` (the run), :mod:`steps`
(batches of steps), ``engine/loop_kernels.py`` (the compiled loop), :mod:`samples`.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.base.interruption import interruptible
from antenna_pin.base.parameters import holds
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.compiled.compile_time import CompileClock, compiling_timed
from antenna_pin.dynamics import System
from antenna_pin.elements.control import Controller
from antenna_pin.errors import InvalidParameterError, LedgerOpenWarning, OutputError
from antenna_pin.run.simulation.checkpoint import Checkpoint, CheckpointStore, about_run, check_same
from antenna_pin.run.simulation.events import Event
from antenna_pin.run.simulation.inputs import RunStart, as_run, prepare_run
from antenna_pin.run.simulation.loop import Progress, Run
from antenna_pin.run.simulation.recorder import Recorder, result_data
from antenna_pin.run.simulation.samples import FEW, check_room
from antenna_pin.scenario import Scenario, scenario_named
from antenna_pin.trajectory import Outcome, Trajectory, library_versions, write_blocks
from antenna_pin.trajectory.labelled import Unlabelled
from antenna_pin.trajectory.quantities import needs_samples

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario

# --- simulate -----------------------------------------------------------------------------------------------


@takes(duration="s", checkpoint="s", angles="rad")
def simulate(
    model: Scenario | System | str | os.PathLike[str],
    duration: float | str | None = None,
    *,
    q: ArrayLike | None = None,
    v: ArrayLike | None = None,
    angles: Mapping[str, float] | None = None,
    start: State | None = None,
    settings: RunSettings | None = None,
    events: Sequence[Event] = (),
    controllers: Mapping[str, Controller] = MappingProxyType({}),
    progress: Callable[[Progress], None] | None = None,
    out: str | os.PathLike[str] | None = None,
    checkpoint: float | str = math.inf,
    resume: bool = False,
) -> Trajectory:
    """Run a scenario, or a system built in Python, and return the trajectory.

    A run that aborts, or is stopped by Ctrl-C, returns its record so far; the reason is its ``outcome``.

    With ``out`` the result is written there, and memory does not limit the run: a record that grows large
    goes to the disk in parts, in the folder ``OUT.parts``, and the trajectory that is returned reads from the
    file on demand. That folder also has checkpoints, of a run that was stopped and at an
    interval: with ``resume`` the run continues from there, bit for bit as if it had not stopped.

    Args:
        model: Scenario or system; or the name of a shipped scenario, or a path, whose default case is run.
        duration: Time span [s], or text as ``"0.1 s"``, from ``start`` on; the scenario's if not given. This
            and ``settings`` enter the result's scenario as overrides.
        q: Initial configuration, (nq,); the scenario's, or neutral. Its quaternions must be of length 1 to
            1e-6 and are made so exactly.
        v: Initial velocity, (nv,); the scenario's, or zero.
        angles: Angles of joints without limits, by name [rad], for their whole turns, which q
            does not hold. Those not given are in (-pi, pi].
        start: State to continue from instead, the ``end`` of a run of the same system: the two runs together
            are bit for bit the one run. The state includes time, contacts and step sizes.
        settings: Integration and sampling; the scenario's, or the defaults.
        events: Events with their actions, besides the scenario's.
        controllers: Sampled controllers, by name, besides the scenario's. The run
            works on copies: the given ones are not changed.
        progress: Called about ten times a second.
        out: File of the result, ``NAME.nc``, written at the end; its folder of parts is removed then, unless
            the run was interrupted.
        checkpoint: Wall time from one checkpoint to the next [s].
        resume: Whether to continue the run whose checkpoint belongs to ``out``; its other inputs, the
            initial state excepted, are given again. ``duration`` is that run's if not given.

    Raises:
        AntennaPinError: The input is not valid; raised before any step is made.
        FileFormatError: Likewise; there is no checkpoint, or it is damaged, or of another version or run.
        OutputError: The result cannot be written; :class:`antenna_pin.run.simulation.UnsavedError` holds it.
    """
    assert not isinstance(duration, str) and not isinstance(checkpoint, str)  # converted by `takes`
    if not holds(checkpoint, "positive") and checkpoint != math.inf:
        raise InvalidParameterError("simulate", "checkpoint", "positive [s]", checkpoint)
    if resume and out is None:
        raise InvalidParameterError("simulate", "out", "given beside resume", None)
    target = None if out is None else check_writable(out, ".nc")
    previous = Checkpoint.load(target) if resume and target is not None else None
    if previous is not None:
        for name, begun in (("start", start), ("q", q), ("v", v), ("angles", angles)):
            if begun is not None:
                rule = "left out with resume, which continues from a checkpoint"
                raise InvalidParameterError("simulate", name, rule, said=type(begun).__name__)
        start, duration = previous.start, previous.about["span"] if duration is None else duration
    origin, begin = RunStart(q, v, angles, start), None if previous is None else previous.begin
    system, scenario, used, events, controllers, begin, span, first = prepare_run(
        "simulate", scenario_named(model), origin, settings, events, duration, begin, controllers
    )
    if span is None:
        raise InvalidParameterError("simulate", "duration", "given for a system built in Python [s]", None)
    if scenario is not None:
        scenario = as_run(scenario, float(span), used)
    source = origin.text(scenario) if previous is None else previous.about["start"]
    store, few = None, not needs_samples(used.output_keep)
    if target is None:
        check_room(system, FEW if few else float(span) * used.output_rate + len(used.output_times))
    else:
        about = about_run(system, scenario, used, float(span), source, events, controllers)
        if previous is not None:
            check_same(previous, about)
        store = CheckpointStore(target, system, about, checkpoint, previous)
    with store or contextlib.nullcontext(), compiling_timed() as compiling:
        until = begin + float(span)
        run = Run(system, first, until, used, events, begin, controllers=controllers, few=few)
        if previous is not None:
            previous.give_to(run)
        with interruptible() as interrupted:
            before = compiling.seconds  # the run's own time begins with its first step
            run.advance(progress, interrupted, store)
            run.wall -= compiling.seconds - before
            return result_of(run, scenario, source, store, time.perf_counter(), compiling)


# --- result of a finished run -------------------------------------------------------------------------------


class UnsavedError(OutputError):
    """Result that cannot be written to its file; it is still in memory.

    Args:
        message: Reason.
        trajectory: Result.
    """

    def __init__(self, message: str, trajectory: Trajectory) -> None:
        """Store the result."""
        super().__init__(message)
        self.trajectory = trajectory


def result_of(
    run: Run,
    scenario: Scenario | None,
    start: str,
    store: CheckpointStore | None,
    began: float,
    compiling: CompileClock | None = None,
) -> Trajectory:
    """Return the result of a run after its last step; write it if stored.

    Raises:
        OutputError: The result cannot be written. It is in memory (:class:`UnsavedError`), or can be
            made from the store.
    """
    title = scenario.title or scenario.name if scenario is not None else run.system.mechanism.name
    case = (scenario.case or "") if scenario is not None else ""
    lean = run.settings.output_form == "lean"
    compiled = CompileClock() if compiling is None else compiling
    before = compiled.seconds

    def result(data: Unlabelled) -> Trajectory:
        if start:
            data.more["start"] = start
        if run.monitor.advice:
            data.more["advice"] = run.monitor.advice
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

    if store is None or not store.parts.rows:
        trajectory = result(result_data(run, title, case, library_versions(), lean=lean))
        if store is not None:
            try:
                trajectory.save(store.path)
            except OutputError as error:
                raise UnsavedError(str(error), trajectory) from error
    else:
        trajectory = _streamed(run, store, {"title": title, "case": case}, result, lean)
    if store is not None and not run.outcome.may_go_on:
        store.parts.remove()
    if run.outcome is Outcome.LEDGER_OPEN:
        warnings.warn(run.message, LedgerOpenWarning, stacklevel=3)
    return trajectory


def _streamed(
    run: Run, store: CheckpointStore, about: Mapping[str, Any], result: Any, lean: bool
) -> Trajectory:
    """Write the result of a run from its parts, block by block, and load it."""
    recording = Recorder(run, store.parts)
    about = {**about, "versions": json.dumps(library_versions())}

    def dataset_of(series: Mapping[str, Any]) -> Any:
        return result(recording.unlabelled(series, about, lean=lean)).stored()

    try:
        target = check_writable(store.path)
        with replacing(target) as partial:
            write_blocks(recording.blocks(), dataset_of, recording.count, partial)
    except OutputError as error:
        raise OutputError(
            f"{error}; what the run has recorded is in {str(store.parts.folder)!r}: free disk space and "
            f"resume it"
        ) from error
    return Trajectory.load(target)
