"""Executors with Dask: processes of this machine, or workers of any scheduler.

Scenarios go to the workers as data and results come back as data: nothing of a file system is shared.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
import multiprocessing
import os
import queue
import re
import signal
import sys
import tempfile
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

from antenna_pin.base.arguments import check_number
from antenna_pin.base.interruption import held_back, sheltered_processes
from antenna_pin.base.lazy import take_back
from antenna_pin.errors import AntennaPinError, MissingToolError
from antenna_pin.studies.sweep.executor import Lost
from antenna_pin.studies.sweep.scheduler import (
    ANSWERS_WITHIN,
    ClusterLostError,
    check_address,
    check_scheduler,
    own_security,
    security_of,
    words_of,
)

# --- why processes that were to make runs did not start: how they ended, and what may be the cause ---

_ENDED = re.compile(r"Worker process \d+ (?:was killed by signal (\d+)|exited with status (\d+))")


class _Ends(logging.Handler):
    """Handler that records exit codes of processes from Dask's log."""

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self.codes: list[int] = []

    def emit(self, record: logging.LogRecord) -> None:
        found = _ENDED.search(record.getMessage())
        if found:
            self.codes.append(-int(found[1]) if found[1] else int(found[2]))


@contextlib.contextmanager
def exit_codes() -> Iterator[list[int]]:
    """Yield a list of exit codes of ended processes; a signal's number is negative."""
    logger, ends = logging.getLogger("distributed.nanny"), _Ends()
    before = logger.level, logger.propagate
    logger.setLevel(logging.INFO)
    logger.propagate = False
    logger.addHandler(ends)
    try:
        yield ends.codes
    finally:
        logger.removeHandler(ends)
        logger.setLevel(before[0])
        logger.propagate = before[1]


class _WithoutDask(logging.Filter):
    """Filter that drops tracebacks of Dask's own tasks, which fail while its processes end."""

    def __init__(self, folder: str) -> None:
        super().__init__()
        self._folder = folder

    def __eq__(self, other: object) -> bool:  # that a logger takes it once
        return isinstance(other, _WithoutDask)

    __hash__ = logging.Filter.__hash__

    def filter(self, record: logging.LogRecord) -> bool:
        trace = record.exc_info[2] if record.exc_info else None
        files = [frame.f_code.co_filename for frame, _ in traceback.walk_tb(trace)]
        return not any(self._folder in text for text in (record.getMessage(), *files))


def silence(package: ModuleType) -> None:
    """Silence the loggers of Dask, and of its event loop where they log Dask's errors.

    Errors that matter are raised as exceptions.
    """
    for name in [package.__name__, f"{package.__name__}.client", *logging.root.manager.loggerDict]:
        if name.partition(".")[0] == package.__name__:
            logging.getLogger(name).setLevel(logging.CRITICAL)
    without_dask = _WithoutDask(os.path.dirname(str(package.__file__)))
    for name in ("asyncio", "tornado.application"):
        logging.getLogger(name).addFilter(without_dask)


def said_of_start(codes: list[int], error: str) -> str:
    """Return the reason for a failed start as text, from exit codes and Dask's message."""
    if not codes:
        return error
    if codes[0] < 0:
        try:
            name = signal.Signals(-codes[0]).name
        except ValueError:
            name = f"signal {-codes[0]}"
        why = (
            "; so ends what takes more memory than there is or than a queue allows: take fewer --workers"
            if name == "SIGKILL"
            else ""
        )
        return f"one was ended by {name} before it took work{why}"
    unguarded = (
        "; a script that starts them does so under if __name__ == '__main__': only, as they read it too"
    )
    return f"one ended with exit code {codes[0]} before it took work{unguarded if _is_unguarded() else ''}"


def _is_unguarded() -> bool:
    """Return true for a main script without a `__main__` guard."""
    script = getattr(sys.modules.get("__main__"), "__file__", None)
    if script is None:
        return False
    try:
        return "__main__" not in Path(script).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False


T = TypeVar("T")

_AHEAD = 2  # batches for each worker: one it works on, one it finds ready
_LOOK_EVERY = 1.0  # [s] at whether anybody is there
_LOSSES = 3  # times that all under way is lost, one after the other
_PATIENCE = 30.0  # [s] without any worker
_QUIET = {  # what processes of this machine look at between the runs: their cores are the runs'
    "distributed.worker.profile.enabled": False,
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.system-monitor.gil.enabled": False,
    "distributed.scheduler.work-stealing": False,
    # Told by the clock that may be set, which a machine that was asleep has moved on; a run may be as long.
    "distributed.scheduler.worker-ttl": None,
    "distributed.scheduler.active-memory-manager.start": False,
    # Pages on their state, for whoever on this machine asks: nobody does.
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}


class Cluster:
    """Processes that make runs, connected by Dask.

    Nothing is started or connected before the first runs (:meth:`start`).

    Args:
        workers: Number of processes of this machine; one for each core by default.
        scheduler: Address of an external scheduler, ``tcp://host:8786`` or ``tls://...``; its workers need
            this package in the same version, and nothing else.
        tls: Files for a scheduler reached by TLS: ``ca``, ``cert`` and ``key``.

    Raises:
        MissingToolError: Dask is not installed.
        ClusterLostError: Address or files are not valid.
    """

    def __init__(
        self, workers: int | None = None, scheduler: str | None = None, tls: dict[str, str] | None = None
    ) -> None:
        take_back("dask")  # the command goes without it, for a quick start
        try:
            distributed: Any = importlib.import_module("distributed")
        except ImportError:
            raise MissingToolError(
                "studies on several cores need dask.distributed; install it with pip install "
                "'antenna-pin[studies]', or run them in this process with --workers 0"
            ) from None
        check_number("Cluster", "workers", workers, "1 or more")
        silence(distributed)  # what it has to say of lost connections is said here, in one line
        self._distributed = distributed
        self._local: Any = None
        self._client: Any = None
        self._shared: tuple[Any, Any] | None = None
        self._started: set[BaseProcess] = set()
        self._workers, self._scheduler = workers, scheduler
        if scheduler is not None:
            check_address(scheduler, tls or {})
        self._security = own_security() if scheduler is None else security_of(tls or {})
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    def start(self) -> None:
        """Start the processes, or connect to the scheduler, and load the code of runs; once.

        Raises:
            ClusterLostError: The processes do not start, or no scheduler answers.
        """
        if self._client is not None:
            return
        if self._scheduler is not None:
            check_scheduler(self._scheduler, self._security)
        ended, signals = list[int](), list[int]()
        try:
            # A signal that comes while Dask starts is lost in it, or makes tracebacks.
            with held_back() as signals, self._starting(), exit_codes() as ended:
                self._local = self._processes() if self._scheduler is None else None
                self._client = self._connected()
            if self._scheduler is not None and not self._client.nthreads():
                self._client.wait_for_workers(1, timeout=_PATIENCE)
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:
            self.close()
            if signals:  # which may have ended the processes, too
                signal.raise_signal(signals[0])
            if self._scheduler is None:
                raise ClusterLostError(
                    f"processes of this machine: must start, but {said_of_start(ended, words_of(error))}"
                ) from None
            raise ClusterLostError(
                f"scheduler {self._scheduler}: must have workers within {_PATIENCE:g} s, got: "
                f"{words_of(error)}; start some: dask worker {self._scheduler}"
            ) from None

        # What they have to load, they load while the driver makes its own trial.
        with contextlib.suppress(OSError, RuntimeError):
            self._client.run(_wake, wait=False)

    @contextlib.contextmanager
    def _starting(self) -> Iterator[None]:
        """Shelter the processes started within the context, and list them."""
        before = {*multiprocessing.active_children()}
        try:
            with sheltered_processes():
                yield
        finally:
            self._started = {*multiprocessing.active_children()} - before

    def _processes(self) -> Any:
        """Return a cluster of processes of this machine."""
        # What workers put aside is read back by pickle: in a folder of their own, no shared one.
        self._folder = tempfile.TemporaryDirectory(prefix="antenna_pin.", ignore_cleanup_errors=True)
        with importlib.import_module("dask").config.set(_QUIET):
            return self._distributed.LocalCluster(
                host="127.0.0.1",
                protocol="tls://",
                security=self._security,
                local_directory=self._folder.name,
                n_workers=self._workers or os.cpu_count() or 1,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,  # which any user of this machine could read
                # What serves it listens still, for nothing: on any free port, as the default may be taken.
                scheduler_kwargs={"dashboard_address": "127.0.0.1:0", "dashboard": False},
                silence_logs=logging.CRITICAL,
            )

    def _connected(self) -> Any:
        client = self._distributed.Client.__new__(self._distributed.Client)
        try:
            client.__init__(
                self._local or self._scheduler,
                security=self._security,
                timeout=ANSWERS_WITHIN,
                set_as_default=False,
            )
        except BaseException:
            client.status = "closed"  # or it would wait for its peer when it is collected
            raise
        return client

    @property
    def width(self) -> int:
        """Number of threads of all workers; at least 1."""
        self.start()
        try:
            return max(1, int(sum(self._client.nthreads().values())))
        except Exception:  # the connection is gone, which is said where runs are given out
            return 1

    def each(
        self, call: Callable[[Any, list[T]], Any], shared: Any, batches: Iterator[list[T]]
    ) -> Iterator[tuple[list[T], Any]]:
        """Yield each batch with its answer, in order of completion.

        Raises:
            ClusterLostError: The scheduler, or all its workers, became unreachable.
        """
        self.start()
        under_way: dict[Any, tuple[list[T], Any]] = {}
        again: deque[list[T]] = deque()
        ready: queue.SimpleQueue[Any] = queue.SimpleQueue()
        lost = 0
        try:
            while True:
                while len(under_way) < _AHEAD * self.width:
                    batch = again.popleft() if again else next(batches, None)
                    if batch is None:
                        break
                    with held_back():  # interrupted, Dask leaves unknown batches and tracebacks
                        data = self._data(shared)
                        future = _call_client(self._client.submit, call, data, batch, pure=False)
                        under_way[future] = batch, data
                        future.add_done_callback(ready.put)
                if not under_way:
                    return
                future = self._finished(ready)
                batch, data = under_way.pop(future)
                try:
                    answer = self._answer(future)
                except CancelledError:
                    # All who had what the runs share have gone, and it with them; or the scheduler has.
                    lost += 1
                    if self._client.status != "running" or lost > _LOSSES * _AHEAD * self.width:
                        raise
                    if self._shared is not None and self._shared[1] is data:
                        self._shared = None
                    again.append(batch)
                    continue
                lost = 0
                yield batch, answer
        except AntennaPinError:
            raise
        except (OSError, TimeoutError, CancelledError) as error:
            why = "the connection is gone" if isinstance(error, CancelledError) else words_of(error)
            raise ClusterLostError(
                f"scheduler {self._scheduler or 'this machine'}: was lost: {why}; finished runs are saved; "
                f"repeat the command to continue"
            ) from None
        finally:
            with contextlib.suppress(Exception):
                self._client.cancel(list(under_way))

    def _data(self, shared: Any) -> Any:
        """Return the data of all runs, scattered to every worker.

        The data are kept: scattered again under the same name while the old ones are released, they would be
        lost.
        """
        if self._shared is None or self._shared[0] is not shared:
            (data,) = _call_client(self._client.scatter, [shared], broadcast=True, hash=False)
            self._shared = shared, data
        return self._shared[1]

    def _finished(self, ready: queue.SimpleQueue[Any]) -> Any:
        """Wait for a finished batch; raise after a long time without workers."""
        waited = 0.0
        while True:
            with contextlib.suppress(queue.Empty):
                return ready.get(timeout=_LOOK_EVERY)
            if self._client.status != "running":
                raise OSError("the connection is closed")
            waited = 0.0 if _call_client(self._client.nthreads) else waited + _LOOK_EVERY
            if waited > _PATIENCE:
                raise OSError(f"no workers for {_PATIENCE:g} s")

    def _answer(self, future: Any) -> Any:
        from distributed.scheduler import KilledWorker

        try:
            return future.result()
        except (MissingToolError, OSError, CancelledError):
            raise
        except KilledWorker:
            return Lost("its process was lost")
        except Exception as error:
            return Lost(f"it did not come back: {words_of(error)}")

    def close(self) -> None:
        """End the processes, or disconnect from the scheduler."""
        self._shared = None
        with held_back():  # half closed, its processes would outlive it
            for name in ("_client", "_local"):
                made = getattr(self, name, None)
                if made is not None:
                    with contextlib.suppress(Exception):
                        made.close()
            for process in self._started & {*multiprocessing.active_children()}:
                process.kill()  # left by a close that failed
        if self._folder is not None:
            self._folder.cleanup()


def _call_client(call: Callable[..., Any], *arguments: Any, **more: Any) -> Any:
    """Return a client's answer; raise its failure for a closed connection."""
    try:
        return call(*arguments, **more)
    except RuntimeError as error:
        raise OSError(words_of(error)) from None


async def _wake() -> None:
    await asyncio.to_thread(importlib.import_module, "antenna_pin.studies.sweep.jobs")
