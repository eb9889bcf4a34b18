"""Bifurcation diagrams: settled points of a section over a parameter, from fresh starts and on branches."""

from __future__ import annotations

import json
import math
import os
import shutil
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable
from antenna_pin.base.interruption import sheltered_processes
from antenna_pin.base.side_by_side import end_with_parent
from antenna_pin.base.state import State
from antenna_pin.base.units import any_quantity
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.nonlinear.branches import BRANCHES, Asked, Branch, Entry, make
from antenna_pin.nonlinear.diagram_table import diagram_table
from antenna_pin.nonlinear.returns import Returns
from antenna_pin.nonlinear.sections import check_counts
from antenna_pin.nonlinear.surfaces import Crossing, Section, Stroboscope
from antenna_pin.scenario import Scenario
from antenna_pin.simulation import Angle, Force, Gap, Rate
from antenna_pin.sweep.journal import Journal, begun
from antenna_pin.trajectory import library_versions, save_table, table_attributes

__all__ = ["Made", "bifurcation"]


# --- what a diagram has come to so far, on the disk: a journal with a line for each value that was made ---

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


@dataclass(frozen=True, slots=True)
class Made:
    """How far a diagram is.

    Attributes:
        done: Values made, of an earlier call too [-].
        count: Values in all, of all branches [-].
        unsettled: Those of them whose points have not settled, failures included [-].
    """

    done: int
    count: int
    unsettled: int


@takes()
def bifurcation(
    scenario: Scenario,
    parameter: str,
    values: Sequence[Any],
    section: Section,
    quantities: Sequence[str],
    *,
    branches: Sequence[Branch] = ("fresh",),
    count: int = 100,
    transient: int | None = None,
    most: int | None = None,
    tolerance: float = 1e-4,
    out: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Callable[[Made], None] | None = None,
) -> xr.Dataset:
    """Return the points of a section over a parameter of a scenario.

    ``fresh`` begins every value at the scenario's start; ``forward`` begins the first value there, and each
    other in the state that the one before has left, its time, contacts and what these remember included;
    ``backward`` does so from the last value to the first. Where two branches differ attractors coexist.
    A stroboscope keeps its phase where its period changes. A value that fails is an entry with its reason,
    and the next is begun in the state before it.

    With ``out`` every value is kept on the disk as it is made, in the folder ``OUT.parts``: what was killed
    goes on with the same call, and comes to the same diagram bit for bit.

    Args:
        scenario: What is run.
        parameter: Key of the scenario, with dots, as in ``--set``.
        values: Of it, in order: numbers in SI units, or text with a unit.
        section: Where the motion is looked at.
        quantities: What is noted there, by the names that :func:`antenna_pin.analysis.quantity` knows.
        branches: Any of ``fresh``, ``forward``, ``backward``.
        count: Points of each value, at least 32 [-].
        transient: Points cut before them; None to cut until what follows has settled [-].
        most: Points of a value after which to stop cutting; 20 times ``count`` if left out [-].
        tolerance: A drift below this part of a quantity's largest amount is none [-].
        out: File of the result, ``.nc``.
        workers: Runs made at a time, each of which does not depend on another: in threads for the compiled
            engine, in processes for the other; one for each core if left out.
        progress: Called after each value.

    Returns:
        See :func:`antenna_pin.nonlinear.open_diagram`.

    Raises:
        AntennaPinError: The input is not valid; every value is built before any is run.
        OutputError: The result cannot be written, or ``OUT.parts`` is of another diagram.
    """
    check_counts("bifurcation", count, transient, most, tolerance)
    if not quantities or isinstance(quantities, str):
        raise InvalidParameterError("bifurcation", "quantities", "names of one or more", quantities)
    if not branches or isinstance(branches, str):
        raise InvalidParameterError("bifurcation", "branches", f"some of {', '.join(BRANCHES)}", branches)
    for branch in branches:
        if branch not in BRANCHES:
            raise UnknownNameError("bifurcation", "branch", branch, BRANCHES)
    if workers is not None and (isinstance(workers, bool) or workers < 1):
        raise InvalidParameterError("bifurcation", "workers", "1 or more", workers)
    given = list(values)
    asked = Asked(
        scenario=scenario,
        parameter=parameter,
        section=section,
        quantities=tuple(dict.fromkeys(quantities)),
        count=count,
        transient=transient,
        most=most,
        tolerance=tolerance,
    )
    chosen = tuple(branch for branch in BRANCHES if branch in branches)
    _check(asked, given)
    target = None if out is None else check_writable(out, ".nc")
    with Parts.of(target, asked, given, chosen) as parts:
        _Driver(asked, given, chosen, parts, workers, progress).run()
        table = diagram_table(asked, given, chosen, parts.entries)
        table.attrs |= table_attributes("bifurcation", scenario)
        if target is not None:
            save_table(table, target)
    if parts.folder is not None:
        shutil.rmtree(parts.folder)
    return table


def _check(asked: Asked, values: list[Any]) -> None:
    """Refuse values that are none, or that the scenario does not take."""
    if len(values) < 2:
        raise InvalidParameterError("bifurcation", "values", "two or more", said=f"{len(values)}")
    numbers = []
    for k, value in enumerate(values):
        found = any_quantity(value)
        if found is None or not math.isfinite(found[0]):
            rule = "a number, or text with a unit"
            raise InvalidParameterError("bifurcation", f"values[{k}]", rule, value)
        numbers.append(found[0])
    steps = [b - a for a, b in zip(numbers, numbers[1:], strict=False)]
    if not (all(step > 0.0 for step in steps) or all(step < 0.0 for step in steps)):
        raise InvalidParameterError("bifurcation", "values", "in order, each but once", values)
    Returns(asked.at(values[0]), asked.section, asked.quantities)
    for value in values:
        changed = asked.at(value)
        if isinstance(asked.section, Stroboscope):
            asked.section.period_in(changed)


def submitted(executor: Executor, call: Callable[..., Any], *arguments: Any) -> Future[Any]:
    """Return the future of a call; a process that is started for it takes no signals."""
    with sheltered_processes():
        return executor.submit(call, *arguments)


class _Driver:
    """Makes what is missing: fresh values in any order, each branch one value after the other."""

    def __init__(
        self,
        asked: Asked,
        values: list[Any],
        branches: tuple[Branch, ...],
        parts: Parts,
        workers: int | None,
        progress: Callable[[Made], None] | None,
    ) -> None:
        self.asked, self.values, self.branches, self.parts = asked, values, branches, parts
        self.width = workers or len(os.sched_getaffinity(0))
        self.progress = progress
        self.ending = threading.Event()

    def run(self) -> None:
        """Make all that is missing."""
        waiting = self._jobs()
        self._tell()
        if not any(one is not None for one in waiting):
            return
        with self._executor() as executor:
            running: dict[Future[Entry], Iterator[tuple[int, Any, State | None, float]]] = {}
            numbers: dict[Future[Entry], int] = {}
            queue = list(waiting)
            while queue or running:
                while queue and len(running) < self.width:
                    chain = queue.pop(0)
                    job = next(chain, None)
                    if job is None:
                        continue
                    number, value, start, period = job
                    ending = self.ending if isinstance(executor, ThreadPoolExecutor) else None
                    future = submitted(executor, make, self.asked, value, start, period, ending)
                    running[future], numbers[future] = chain, number
                for future in wait(running, return_when=FIRST_COMPLETED).done if running else ():
                    chain, number = running.pop(future), numbers.pop(future)
                    self.parts.add({"run": number} | future.result())
                    self._tell()
                    queue.insert(0, chain)  # a branch has the longest way

    def _jobs(self) -> list[Iterator[tuple[int, Any, State | None, float]]]:
        """Return what is to be done, as chains of which one job at a time may be made."""
        n = len(self.values)
        chains: list[Iterator[tuple[int, Any, State | None, float]]] = []
        for b, branch in enumerate(self.branches):
            if branch == "fresh":
                chains += [
                    iter([(b * n + k, self.values[k], None, math.nan)])
                    for k in range(n)
                    if b * n + k not in self.parts.entries
                ]
            else:
                order = range(n) if branch == "forward" else range(n - 1, -1, -1)
                chains.insert(0, self._branch(b * n, order))
        return chains

    def _branch(self, first: int, order: range) -> Iterator[tuple[int, Any, State | None, float]]:
        """Yield the values of a branch, each once the one before is there."""
        state: State | None = None
        period = math.nan
        for k in order:
            if first + k not in self.parts.entries:
                yield first + k, self.values[k], state, period
            entry = self.parts.entries[first + k]
            if entry["state"]:
                state = State.from_json(entry["state"])
                period = math.nan if entry["period"] is None else float(entry["period"])

    @contextmanager
    def _executor(self) -> Iterator[Executor]:
        """Yield who makes the runs; what is interrupted ends at once."""
        compiled = self.asked.scenario.integrator.engine == "compiled"
        executor: Executor
        if compiled or self.width == 1:
            executor = ThreadPoolExecutor(self.width)
        else:
            executor = ProcessPoolExecutor(self.width, get_context("spawn"), end_with_parent)
        try:
            yield executor
        except BaseException:
            self.ending.set()
            for process in (getattr(executor, "_processes", None) or {}).values():
                process.kill()  # each may be in a long run
            executor.shutdown(wait=True, cancel_futures=True)
            raise
        executor.shutdown()

    def _tell(self) -> None:
        if self.progress is not None:
            entries = self.parts.entries.values()
            unsettled = sum(not entry["settled"] for entry in entries)
            self.progress(Made(len(self.parts.entries), len(self.branches) * len(self.values), unsettled))
