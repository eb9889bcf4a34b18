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
from typing import TYPE_CHECKING, TextIO, cast

from antenna_pin.base.readable import lasting

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

    from antenna_pin.nonlinear import Made
    from antenna_pin.simulation import Progress
    from antenna_pin.sweep import StudyProgress


class _ErrorStream(io.TextIOBase):
    """The error stream, or nothing once its terminal is closed: a bar must not cost what it tells of."""

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
    """Return a bar on the error stream, not shown yet: what, how far, counts if wanted, texts, time to go."""
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


@contextlib.contextmanager
def _ended(bar: Bar) -> Iterator[None]:
    """Take a bar away at the end, if it was ever shown."""
    _bars.append(bar)
    try:
        yield
    finally:
        _bars.remove(bar)
        if bar.live.is_started:
            bar.stop()


#: Bars that are there, the innermost last.
_bars: list[Bar] = []

#: One for each wait for the user, during which a command is not at work.
_waits: list[None] = []

_FIRST = 10.0  # [s] after which a command says that it is at work; then after twice as long each time


@contextlib.contextmanager
def said_at_work(command: str, say: Callable[[str], None]) -> Iterator[None]:
    """Have a command that takes long say so now and then, where no bar on a terminal shows it.

    Args:
        command: Its name.
        say: How.
    """
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
    """Have a command that only waits for its user, as one that serves a page, not say that it is at work."""
    _waits.append(None)
    try:
        yield
    finally:
        _waits.pop()


def _how_far(bar: Bar | None) -> str:
    """Return in words how far what a bar tells of has come; empty if it does not know."""
    tasks = [task for task in bar.tasks if task.visible and task.total] if bar is not None else []
    if not tasks:
        return ""
    share = 100.0 * tasks[-1].completed / (tasks[-1].total or 1.0)
    return f": {tasks[-1].description}, {share:.3g} % done"


@contextlib.contextmanager
def progress_bar(title: str, shown: bool) -> Iterator[Callable[[Progress], None] | None]:
    """Yield what a run reports its progress to: simulated time, speed and step size on the error stream.

    The speed is in wall seconds per simulated second. While kernels are compiled, at the first run of their
    kind on a machine, the bar says that instead.
    """
    if not shown:
        yield None
        return
    bar = _bar("{task.fields[time]}", "{task.fields[speed]}", "{task.fields[step]}")
    task = bar.add_task(title, total=None, time="", speed="", step="")
    compiled = itertools.count(1)

    def compiling() -> None:
        text = f"{title}: compiling, once"
        bar.update(task, description=text, time=f"kernel {next(compiled)}", speed="", step="")
        bar.start()

    def report(now: Progress) -> None:
        bar.update(
            task,
            description=title,
            completed=now.time,
            total=now.end,
            time=f"{now.time:.4g} of {now.end:g} s",
            speed=f"{now.wall / now.time:.3g} s/s" if now.time > 0.0 else "",
            step=f"step {_seconds(now.step)}",
        )
        bar.start()  # with the first step: what is refused before leaves no bar behind

    from antenna_pin.compiled.kernel_cache import told_of_compiling

    with _ended(bar), told_of_compiling(compiling):
        yield report


@contextlib.contextmanager
def picture_bar(title: str, shown: bool) -> Iterator[Callable[[int, int], None] | None]:
    """Yield what a film reports its progress to: pictures done, on the error stream."""
    if not shown:
        yield None
        return
    bar = _bar("pictures", counted=True)
    task = bar.add_task(title, total=None)

    def report(done: int, planned: int) -> None:
        bar.update(task, completed=done, total=planned)
        bar.start()

    with _ended(bar):
        yield report


@contextlib.contextmanager
def study_bar(title: str, shown: bool) -> Iterator[Callable[[StudyProgress], None] | None]:
    """Yield what a study reports its progress to: runs checked, then runs made, on the error stream."""
    if not shown:
        yield None
        return
    bar = _bar("{task.fields[failed]}", counted=True)
    tasks = {stage: bar.add_task("", total=None, failed="", visible=False) for stage in ("check", "run")}

    def report(now: StudyProgress) -> None:
        words = "checking" if now.stage == "check" else "runs"
        failed = (
            f"{now.failed} {'refused' if now.stage == 'check' else 'not completed'}" if now.failed else "runs"
        )
        bar.update(tasks["check"], visible=now.stage == "check")
        bar.update(
            tasks[now.stage],
            description=f"{title}: {words}",
            completed=now.done,
            total=now.count,
            failed=failed,
            visible=True,
        )
        bar.start()

    with _ended(bar):
        yield report


@contextlib.contextmanager
def branch_bar(
    title: str, ends: tuple[float, float], shown: bool
) -> Iterator[Callable[[float], None] | None]:
    """Yield what a branch reports each value it comes to: how far it is in its range, and how many orbits."""
    if not shown:
        yield None
        return
    first, last = ends
    bar = _bar("{task.fields[value]}", "{task.fields[orbits]}")
    task = bar.add_task(title, total=1.0, value="", orbits="")
    counted = itertools.count(2)  # the first orbit is that which it begins with

    def report(value: float) -> None:
        share = min(max((value - first) / (last - first), 0.0), 1.0)
        bar.update(task, completed=share, value=f"at {value:.6g}", orbits=f"{next(counted)} orbits")
        bar.start()

    with _ended(bar):
        yield report


@contextlib.contextmanager
def exponent_bar(title: str, count: int, shown: bool) -> Iterator[Callable[[int, float], None] | None]:
    """Yield what exponents report each interval to: how many are done, and the largest exponent so far."""
    if not shown:
        yield None
        return
    bar = _bar("{task.fields[value]}", counted=True)
    task = bar.add_task(title, total=count, value="")

    def report(done: int, value: float) -> None:
        said = "" if math.isnan(value) else f"{value:.3g} 1/s"
        words = f"{title}: the motion itself" if math.isnan(value) else title
        # The largest alone takes some more intervals, in which its direction settles.
        bar.update(task, description=words, completed=done, total=max(count, done), value=said)
        bar.start()

    with _ended(bar):
        yield report


def _seconds(value: float) -> str:
    """Return a short duration with a unit that suits it."""
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value:.3g} s"


@contextlib.contextmanager
def diagram_bar(title: str, shown: bool) -> Iterator[Callable[[Made], None]]:
    """Yield what a bifurcation diagram reports its runs to, on the error stream."""
    from antenna_pin.sweep import StudyProgress

    with study_bar(title, shown) as report:

        def tell(now: Made) -> None:
            if report is not None:
                report(StudyProgress("run", now.done, now.count, 0))

        yield tell


@contextlib.contextmanager
def fit_bar(title: str, shown: bool) -> Iterator[Callable[[int], None] | None]:
    """Yield what a fit reports how many runs it has made to; how many it will be nobody knows."""
    if not shown:
        yield None
        return
    bar = _bar("{task.fields[runs]}")
    task = bar.add_task(f"{title}: searching", total=None, runs="")

    def report(runs: int) -> None:
        bar.update(task, runs=f"{runs} runs")
        bar.start()

    with _ended(bar):
        yield report
