"""Bifurcation diagrams: settled points of a section over a parameter, fresh and on branches."""

from __future__ import annotations

import json
import math
import os
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import closing, contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any, Literal

import numpy as np
import xarray as xr

from antenna_pin.analysis.transients import RULE
from antenna_pin.base.arguments import takes
from antenna_pin.base.capacity import cores
from antenna_pin.base.files import check_writable
from antenna_pin.base.interruption import sheltered_processes
from antenna_pin.base.rules import AtLeastOne
from antenna_pin.base.side_by_side import end_with_parent
from antenna_pin.base.state import State
from antenna_pin.base.units import any_quantity
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError
from antenna_pin.run.simulation import Angle, Force, Gap, Progress, Rate
from antenna_pin.scenario import Scenario
from antenna_pin.studies.nonlinear.chart import carried
from antenna_pin.studies.nonlinear.returns import SectionRun, check_counts, settled_points
from antenna_pin.studies.nonlinear.sections import Crossing, Section, Stroboscope
from antenna_pin.studies.sweep.journal import Parts, scenario_content
from antenna_pin.trajectory import library_versions, open_table, save_table, table_attributes

# --- one value of a diagram ---------------------------------------------------------------------------------

Branch = Literal["fresh", "forward", "backward"]
"""How a value is come to: from the scenario's start, or from the end of the value before or after it."""

#: All branches.
_BRANCHES: tuple[Branch, ...] = ("fresh", "forward", "backward")

_Entry = dict[str, Any]
"""What is found at one value of one branch, as JSON takes it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Settings:
    """Settings of every value of a diagram."""

    scenario: Scenario  # base scenario
    parameter: str  # key of the scenario, with dots
    section: Section  # section of the points
    quantities: tuple[str, ...]  # recorded quantities
    count: int  # points kept [-]
    transient: int | None  # points cut before them; None to judge [-]
    most: int | None  # points after which to stop cutting; None for 20 times ``count`` [-]
    tolerance: float  # see :func:`antenna_pin.studies.nonlinear.poincare` [-]

    def at(self, value: Any) -> Scenario:
        """Return the scenario with the parameter set to a value."""
        return self.scenario.with_overrides({self.parameter: value})


def _evaluate(
    settings: _Settings,
    value: Any,
    start: State | None = None,
    period: float = math.nan,
    ending: threading.Event | None = None,
) -> _Entry:
    """Return the entry of a value."""
    entry: _Entry = {"times": [], "values": [], "units": [], "titles": [], "settled": False, "drift": None}
    entry |= {"transient": 0, "period": None, "state": ""}
    try:
        returns = SectionRun(
            settings.at(value), settings.section, settings.quantities, progress=interrupting(ending)
        )
        if start is not None:
            scale = returns.period / period if math.isfinite(period) else 1.0
            returns.state = carried(start, returns.system, scale=scale)
        found = settled_points(returns, settings.count, settings.transient, settings.most, settings.tolerance)
    except AntennaPinError as error:
        return entry | {"outcome": "REFUSED", "message": str(error)}
    except Exception as error:  # a bug must not end a diagram of hours
        return entry | {"outcome": "FAILED", "message": " ".join(f"{type(error).__name__}: {error}".split())}
    return entry | {
        "times": found.times.tolist(),
        "values": found.values.tolist(),
        "units": list(returns.units),
        "titles": list(returns.titles),
        "settled": found.settled,
        "drift": found.drift if math.isfinite(found.drift) else None,
        "transient": found.transient,
        "period": returns.period if math.isfinite(returns.period) else None,
        "outcome": found.outcome,
        "message": found.message,
        "state": "" if found.end is None or returns.ended else found.end.to_json(),
    }


def interrupting(ending: threading.Event | None) -> Callable[[Progress], None] | None:
    """Return a progress callback that raises KeyboardInterrupt once an event is set."""
    if ending is None:
        return None

    def look(_: Progress) -> None:
        if ending.is_set():
            raise KeyboardInterrupt

    return look


# --- datasets and their files -------------------------------------------------------------------------------


def _diagram_table(
    settings: _Settings, values: Sequence[Any], branches: Sequence[str], entries: Mapping[int, _Entry]
) -> xr.Dataset:
    """Return the dataset of a diagram."""
    b, n, most = len(branches), len(values), max((len(one["times"]) for one in entries.values()), default=0)
    times = np.full((b, n, most), np.nan)
    points = np.full((b, n, most, len(settings.quantities)), np.nan)
    shape = b, n
    about: dict[str, tuple[np.ndarray, dict[str, str]]] = {
        "settled": (np.zeros(shape, dtype=bool), {"long_name": "whether the points have settled"}),
        "drift": (
            np.full(shape, np.nan),
            {"units": "1", "long_name": "largest drift of a statistic of the points"},
        ),
        "points": (np.zeros(shape, dtype=np.int64), {"units": "1", "long_name": "points kept"}),
        "transient": (
            np.zeros(shape, dtype=np.int64),
            {"units": "1", "long_name": "points cut before these"},
        ),
        "period": (np.full(shape, np.nan), {"units": "s", "long_name": "period of the stroboscope"}),
        "outcome": (np.full(shape, "", dtype=object), {"long_name": "why the run ended"}),
        "message": (np.full(shape, "", dtype=object), {"long_name": "that in words"}),
    }
    found = {name: values for name, (values, _) in about.items()}
    units, titles = [""] * len(settings.quantities), [""] * len(settings.quantities)
    for number, entry in entries.items():
        place = np.unravel_index(number, shape)
        here = len(entry["times"])
        if here:
            times[place][:here] = entry["times"]
            points[place][:here] = entry["values"]
            units, titles = entry["units"], entry["titles"]
        found["points"][place] = here
        for name in ("settled", "transient", "outcome", "message"):
            found[name][place] = entry[name]
        for name in ("drift", "period"):
            found[name][place] = np.nan if entry[name] is None else entry[name]
    numbers = [any_quantity(value) for value in values]
    unit = next((one[1] for one in numbers if one is not None and one[1]), "")
    said = {"long_name": settings.parameter, "units": unit, "key": settings.parameter}
    over = ("branch", "value")
    variables: dict[str, Any] = {
        name: ((*over, "point"), points[..., k], {"units": units[k], "long_name": titles[k]})
        for k, name in enumerate(settings.quantities)
    }
    variables["time"] = ((*over, "point"), times, {"units": "s", "long_name": "when the section is passed"})
    variables |= {name: (over, *one) for name, one in about.items()}
    return xr.Dataset(
        variables,
        coords={
            "branch": ("branch", np.array(branches, dtype=str), {"long_name": "how a value is come to"}),
            "value": ("value", np.array([one[0] for one in numbers if one is not None]), said),
        },
        attrs={
            **table_attributes("bifurcation", settings.scenario),
            "parameter": settings.parameter,
            "quantities": json.dumps(settings.quantities),
            "section": settings.section.words,
            "rule": RULE,
            "tolerance": settings.tolerance,
        },
    )


@takes()
def open_diagram(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return a bifurcation diagram from its file.

    Returns:
        Over ``branch`` (fresh, forward, backward), ``value`` of the parameter, SI, and ``point``: ``time``
        [s] and each quantity, NaN where a run had fewer points. Over ``branch`` and ``value``: ``settled``,
        ``drift`` [-], ``points`` and ``transient`` [-], the points kept and those cut before them, ``period``
        [s] of the stroboscope, ``outcome`` and ``message``.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    table = open_table(path, "bifurcation")
    for name in ("outcome", "message"):
        table[name] = table[name].astype(object)
    table["settled"] = table["settled"].astype(bool)
    return table


# --- diagrams, whose entries are stored until they are whole ------------------------------------------------


def _identity(settings: _Settings, values: Sequence[Any], branches: Sequence[str]) -> dict[str, Any]:
    """Return the identity of a diagram as JSON types."""
    scenario = scenario_content(settings.scenario.model_dump_json())
    scenario.pop("name", None)
    section = settings.section
    if isinstance(section, Crossing) and not (
        isinstance(section.when, Angle | Rate | Gap | Force) or section.name
    ):
        raise InvalidParameterError(
            "bifurcation", "section", "given a name, by which a saved diagram identifies its function", ""
        )
    return {
        "scenario": scenario,
        "parameter": settings.parameter,
        "values": list(values),
        "branches": list(branches),
        "section": section.words,
        "quantities": list(settings.quantities),
        "points": [settings.count, settings.transient, settings.most, settings.tolerance],
        "versions": library_versions(),
    }


@dataclass(frozen=True, slots=True)
class DiagramProgress:
    """Progress of a diagram."""

    done: int  # finished values, including those of an earlier call [-]
    count: int  # values in all, of all branches [-]
    unsettled: int  # values whose points have not settled, failures included [-]


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
    workers: AtLeastOne | None = None,
    progress: Callable[[DiagramProgress], None] | None = None,
) -> xr.Dataset:
    """Return the points of a section over a parameter of a scenario.

    ``fresh`` begins every value at the scenario's start; ``forward`` begins the first value there, and each
    other in the state left by the previous one, its time, contacts and contact memory included; ``backward``
    does so from the last value to the first. Where two branches differ attractors coexist. A stroboscope
    keeps its phase where its period changes. A value that fails is an entry with its reason, and the next
    begins in the state before it.

    With ``out`` every value is stored in the folder ``OUT.parts``: after an interruption the same call
    continues, to the same diagram bit for bit.

    Args:
        scenario: The scenario.
        parameter: Key of the scenario, with dots, as in ``--set``.
        values: Its values, in order: numbers in SI units, or text with a unit.
        section: Section of the motion.
        quantities: Quantities recorded there, by the names of :func:`antenna_pin.analysis.quantity`.
        branches: Any of ``fresh``, ``forward``, ``backward``.
        count: Points of each value, at least 32 [-].
        transient: Points cut before them; None to cut until the rest has settled [-].
        most: Points of a value after which to stop cutting; 20 times ``count`` if left out [-].
        tolerance: A drift below this part of a quantity's largest amount is none [-].
        out: File of the result, ``.nc``.
        workers: Independent runs at a time: in threads for the compiled engine, in processes for the other;
            one for each core if left out.
        progress: Called after each value.

    Returns:
        See :func:`antenna_pin.studies.nonlinear.open_diagram`.

    Raises:
        AntennaPinError: The input is not valid; every value is built before any is run.
        OutputError: The result cannot be written, or ``OUT.parts`` is of another diagram.
    """
    check_counts("bifurcation", count, transient, most, tolerance)
    if not quantities or isinstance(quantities, str):
        raise InvalidParameterError("bifurcation", "quantities", "names of one or more", quantities)
    if not branches or isinstance(branches, str):
        raise InvalidParameterError("bifurcation", "branches", f"some of {', '.join(_BRANCHES)}", branches)
    for branch in branches:
        if branch not in _BRANCHES:
            raise UnknownNameError("bifurcation", "branch", branch, _BRANCHES)
    given = list(values)
    asked = _Settings(
        scenario=scenario,
        parameter=parameter,
        section=section,
        quantities=tuple(dict.fromkeys(quantities)),
        count=count,
        transient=transient,
        most=most,
        tolerance=tolerance,
    )
    chosen = tuple(branch for branch in _BRANCHES if branch in branches)
    _check(asked, given)
    target = None if out is None else check_writable(out, ".nc")
    parts = Parts(target, lambda: _identity(asked, given, chosen), "diagram")
    with closing(parts):
        _Driver(asked, given, chosen, parts, workers, progress).run()
        table = _diagram_table(asked, given, chosen, parts.entries)
        if target is not None:
            save_table(table, target)
    parts.remove()
    return table


def _check(settings: _Settings, values: list[Any]) -> None:
    """Refuse values that are no numbers, or that the scenario does not accept."""
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
    SectionRun(settings.at(values[0]), settings.section, settings.quantities)
    for value in values:
        changed = settings.at(value)
        if isinstance(settings.section, Stroboscope):
            settings.section.period_in(changed)


def submitted(executor: Executor, call: Callable[..., Any], *arguments: Any) -> Future[Any]:
    """Return the future of a call in a worker process without signals."""
    with sheltered_processes():
        return executor.submit(call, *arguments)


class _Driver:
    """Executor of missing values: fresh ones in any order, branches one after the other."""

    def __init__(
        self,
        settings: _Settings,
        values: list[Any],
        branches: tuple[Branch, ...],
        parts: Parts,
        workers: int | None,
        progress: Callable[[DiagramProgress], None] | None,
    ) -> None:
        self.asked, self.values, self.branches, self.parts = settings, values, branches, parts
        self.width = workers or cores()
        self.progress = progress
        self.ending = threading.Event()

    def run(self) -> None:
        """Evaluate all that is missing."""
        waiting = self._jobs()
        self._tell()
        if not any(one is not None for one in waiting):
            return
        with self._executor() as executor:
            running: dict[Future[_Entry], Iterator[tuple[int, Any, State | None, float]]] = {}
            numbers: dict[Future[_Entry], int] = {}
            queue = list(waiting)
            while queue or running:
                while queue and len(running) < self.width:
                    chain = queue.pop(0)
                    job = next(chain, None)
                    if job is None:
                        continue
                    number, value, start, period = job
                    ending = self.ending if isinstance(executor, ThreadPoolExecutor) else None
                    future = submitted(executor, _evaluate, self.asked, value, start, period, ending)
                    running[future], numbers[future] = chain, number
                for future in wait(running, return_when=FIRST_COMPLETED).done if running else ():
                    chain, number = running.pop(future), numbers.pop(future)
                    self.parts.add({"run": number} | future.result())
                    self._tell()
                    queue.insert(0, chain)  # a branch has the longest way

    def _jobs(self) -> list[Iterator[tuple[int, Any, State | None, float]]]:
        """Return the jobs as chains, one job of a chain at a time."""
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

    def _branch(self, offset: int, order: range) -> Iterator[tuple[int, Any, State | None, float]]:
        """Yield the jobs of a branch, each once its predecessor is done."""
        state: State | None = None
        period = math.nan
        for k in order:
            if offset + k not in self.parts.entries:
                yield offset + k, self.values[k], state, period
            entry = self.parts.entries[offset + k]
            if entry["state"]:
                state = State.from_json(entry["state"])
                period = math.nan if entry["period"] is None else float(entry["period"])

    @contextmanager
    def _executor(self) -> Iterator[Executor]:
        """Yield an executor that is shut down at once on an interruption."""
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
            self.progress(
                DiagramProgress(len(self.parts.entries), len(self.branches) * len(self.values), unsettled)
            )
