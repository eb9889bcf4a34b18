"""The progress bars of runs and films."""

from __future__ import annotations

import _thread
import contextlib
import io
import itertools
import math
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any, TextIO, TypeAlias, TypeVar, cast

from antenna_pin.base.readable import lasting
from antenna_pin.compiled.compile_time import COMPILE_TIME, told_of_compiling

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

    from antenna_pin.run.simulation import Progress
    from antenna_pin.studies.nonlinear import DiagramProgress
    from antenna_pin.studies.sweep import StudyProgress


class _ErrorStream(io.TextIOBase):
    """Error stream that discards output once its terminal is closed."""

    def __init__(self) -> None:
        self._stream = sys.stderr  # which a bar takes the place of while it is shown

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return self._stream.encoding

    def write(self, text: str) -> int:
        with contextlib.suppress(OSError):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        with contextlib.suppress(OSError):
            self._stream.flush()

    def isatty(self) -> bool:
        return self._stream.isatty()

    def fileno(self) -> int:
        return self._stream.fileno()


def _bar(*texts: str, counted: bool = False) -> Bar:
    """Return a hidden bar on the error stream: title, share, counts, texts, remaining time."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    return Bar(
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        *([MofNCompleteColumn()] if counted else []),
        *map(TextColumn, texts),
        TimeRemainingColumn(compact=True),
        console=Console(file=cast(TextIO, _ErrorStream())),
        expand=True,
        refresh_per_second=5,
    )


T = TypeVar("T")
Reporting: TypeAlias = AbstractContextManager[T | None]
"""Yields the progress function of some work; None where no bar is shown."""


class _Task:
    """Bar of one task, shown from its first update."""

    def __init__(self, title: str, *texts: str, counted: bool = False, **fields: Any) -> None:
        self.bar = _bar(*texts, counted=counted)
        self.identity = self.bar.add_task(title, **fields)

    def update(self, **values: Any) -> None:
        self.bar.update(self.identity, **values)
        self.bar.start()

    @contextlib.contextmanager
    def reporting(self, report: T) -> Iterator[T]:
        """Yield the progress function, then remove the bar."""
        _bars.append(self.bar)
        try:
            yield report
        finally:
            _bars.remove(self.bar)
            if self.bar.live.is_started:
                self.bar.stop()


#: Bars that are there, the innermost last.
_bars: list[Bar] = []

#: One for each wait for the user, during which a command is not at work.
_waits: list[None] = []

_FIRST = 10.0  # [s] after which a command says that it is at work; then after twice as long each time


@contextlib.contextmanager
def said_at_work(command: str, say: Callable[[str], None]) -> Iterator[None]:
    """Report a long command at growing intervals, unless a bar is on the terminal."""
    done, began = threading.Event(), time.monotonic()

    def beat() -> None:
        wait = _FIRST
        while not done.wait(began + wait - time.monotonic()):
            bar = _bars[-1] if _bars else None
            if not _waits and (bar is None or not (bar.console.is_terminal and bar.live.is_started)):
                say(f"note: {command} is at work, for {lasting(wait)} so far{_how_far(bar)}")
            wait *= 2.0

    # A Thread's start waits for the thread's first word, which never comes if there is no memory for it.
    with contextlib.suppress(RuntimeError):
        _thread.start_new_thread(beat, ())
    try:
        yield
    finally:
        done.set()


@contextlib.contextmanager
def waiting_for_the_user() -> Iterator[None]:
    """Suppress reports of :func:`said_at_work` while a command waits for its user."""
    _waits.append(None)
    try:
        yield
    finally:
        _waits.pop()


def _how_far(bar: Bar | None) -> str:
    """Return a bar's progress in words; empty where it is unknown."""
    tasks = [task for task in bar.tasks if task.visible and task.total] if bar is not None else []
    if not tasks:
        return ""
    share = 100.0 * tasks[-1].completed / (tasks[-1].total or 1.0)
    return f": {tasks[-1].description}, {share:.3g} % done"


@contextlib.contextmanager
def progress_bar(title: str, shown: bool) -> Iterator[Callable[[Progress], None] | None]:
    """Yield the progress function of a run: simulated time, speed, step size.

    The speed is in wall seconds per simulated second. While kernels are compiled, at the first run of their
    kind on a machine, the bar shows their number instead.
    """
    if not shown:
        yield None
        return
    texts = ("{task.fields[time]}", "{task.fields[speed]}", "{task.fields[step]}")
    task = _Task(title, *texts, total=None, time="", speed="", step="")
    compiled = itertools.count(1)

    def compiling() -> None:
        text = f"{title}: compiling, once, for {COMPILE_TIME}"
        task.update(description=text, time=f"kernel {next(compiled)}", speed="", step="")

    def report(progress: Progress) -> None:
        task.update(
            description=title,
            completed=progress.time,
            total=progress.end,
            time=f"{progress.time:.4g} of {progress.end:g} s",
            speed=f"{progress.wall / progress.time:.3g} s/s" if progress.time > 0.0 else "",
            step=f"step {_seconds(progress.step)}",
        )

    with task.reporting(report), told_of_compiling(compiling):
        yield report


def picture_bar(title: str, shown: bool) -> Reporting[Callable[[int, int], None]]:
    """Yield the progress function of a film: pictures done."""
    if not shown:
        return nullcontext()
    task = _Task(title, "pictures", counted=True, total=None)
    return task.reporting(lambda done, planned: task.update(completed=done, total=planned))


def study_bar(title: str, shown: bool) -> Reporting[Callable[[StudyProgress], None]]:
    """Yield the progress function of a study: runs checked, then runs made."""
    if not shown:
        return nullcontext()
    task = _Task("", "{task.fields[failed]}", counted=True, total=None, failed="")
    stages = ["check"]

    def report(progress: StudyProgress) -> None:
        checks = progress.stage == "check"
        if progress.stage != stages[-1]:
            stages.append(progress.stage)
            task.bar.reset(task.identity)
        failed = f"{progress.failed} {'refused' if checks else 'not completed'}"
        task.update(
            description=f"{title}: {'checking' if checks else 'runs'}",
            completed=progress.done,
            total=progress.count,
            failed=failed if progress.failed else "runs",
        )

    return task.reporting(report)


def branch_bar(title: str, ends: tuple[float, float], shown: bool) -> Reporting[Callable[[float], None]]:
    """Yield the progress function of a branch: share of its range, number of orbits."""
    if not shown:
        return nullcontext()
    first, last = ends
    task = _Task(title, "{task.fields[value]}", "{task.fields[orbits]}", total=1.0, value="", orbits="")
    counted = itertools.count(2)  # the first orbit is that which it begins with

    def report(value: float) -> None:
        share = min(max((value - first) / (last - first), 0.0), 1.0)
        task.update(completed=share, value=f"at {value:.6g}", orbits=f"{next(counted)} orbits")

    return task.reporting(report)


def exponent_bar(title: str, count: int, shown: bool) -> Reporting[Callable[[int, float], None]]:
    """Yield the progress function of exponents: intervals done, largest exponent so far."""
    if not shown:
        return nullcontext()
    task = _Task(title, "{task.fields[value]}", counted=True, total=count, value="")

    def report(done: int, value: float) -> None:
        text = "" if math.isnan(value) else f"{value:.3g} 1/s"
        words = f"{title}: the motion itself" if math.isnan(value) else title
        # The largest alone takes some more intervals, in which its direction settles.
        task.update(description=words, completed=done, total=max(count, done), value=text)

    return task.reporting(report)


def fit_bar(title: str, shown: bool) -> Reporting[Callable[[int], None]]:
    """Yield the progress function of a fit: number of runs made."""
    if not shown:
        return nullcontext()
    task = _Task(f"{title}: searching", "{task.fields[runs]}", total=None, runs="")
    return task.reporting(lambda runs: task.update(runs=f"{runs} runs"))


def verification_bar(title: str, shown: bool) -> Reporting[Callable[[str, int, int], None]]:
    """Yield the progress function of a verification: stage, points done, their number."""
    if not shown:
        return nullcontext()
    task = _Task(title, counted=True, total=None)

    def report(stage: str, done: int, count: int) -> None:
        task.update(description=f"{title}: {stage}", completed=done, total=count)

    return task.reporting(report)


def _seconds(value: float) -> str:
    """Return a short duration with a unit that suits it."""
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value:.3g} s"


@contextlib.contextmanager
def diagram_bar(title: str, shown: bool) -> Iterator[Callable[[DiagramProgress], None]]:
    """Yield the progress function of a bifurcation diagram."""
    from antenna_pin.studies.sweep import StudyProgress

    with study_bar(title, shown) as report:

        def tell(progress: DiagramProgress) -> None:
            if report is not None:
                report(StudyProgress("run", progress.done, progress.count, 0))

        yield tell
