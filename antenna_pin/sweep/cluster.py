"""Runs made by Dask: by processes of this machine, or by the workers of any scheduler.

Scenarios go to the workers as data and results come back as data: nothing of a file system is shared.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
import os
import queue
import sys
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from antenna_pin.errors import AntennaPinError, MissingToolError
from antenna_pin.sweep.here import Lost

__all__ = ["Cluster", "ClusterLostError"]

T = TypeVar("T")

_AHEAD = 2  # batches for each worker: one it works on, one it finds ready
_LOOK_EVERY = 1.0  # [s] at whether anybody is there
_PATIENCE = 30.0  # [s] without any worker
_QUIET = {  # what processes of this machine look at between the runs: their cores are the runs'
    "distributed.worker.profile.enabled": False,
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.system-monitor.gil.enabled": False,
    "distributed.scheduler.work-stealing": False,
    "distributed.scheduler.active-memory-manager.start": False,
}


class ClusterLostError(AntennaPinError, RuntimeError):
    """The scheduler, or all its workers, cannot be reached any more."""


class Cluster:
    """Processes that make runs, with Dask between.

    Args:
        workers: How many processes of this machine; one for each core if left out.
        scheduler: Address of a scheduler that runs elsewhere, ``tcp://host:8786`` or ``tls://...``; its
            workers need this package in the same version, and nothing else.
        tls: Files for a scheduler that is reached by TLS: ``ca``, ``cert`` and ``key``.

    Raises:
        MissingToolError: Dask is not installed.
        ClusterLostError: No scheduler answers there.
    """

    def __init__(
        self, workers: int | None = None, scheduler: str | None = None, tls: dict[str, str] | None = None
    ) -> None:
        """Start the processes, or reach the scheduler."""
        if sys.modules.get("dask", sys) is None:  # the command goes without it, for a quick start
            del sys.modules["dask"]
        try:
            distributed: Any = importlib.import_module("distributed")
        except ImportError:
            raise MissingToolError(
                "studies on several cores need dask.distributed; install it with pip install "
                "'antenna-pin[studies]', or run them in this process with --workers 0"
            ) from None
        # What it has to say of lost connections is said here, in one line.
        for name in ["distributed", "distributed.client", *logging.root.manager.loggerDict]:
            if name.partition(".")[0] == "distributed":
                logging.getLogger(name).setLevel(logging.CRITICAL)
        self._distributed = distributed
        if (scheduler or "").startswith("tls://") and len(tls or {}) < 3:
            raise ClusterLostError(
                f"scheduler {scheduler}: must be given the files of its authority, of a certificate and "
                "of its key (--tls-ca, --tls-cert, --tls-key)"
            )
        self._local: Any = None
        self._client: Any = None
        self._where = scheduler or "this machine"
        try:
            if scheduler is None:
                with importlib.import_module("dask").config.set(_QUIET):
                    self._local = distributed.LocalCluster(
                        n_workers=workers or os.cpu_count() or 1,
                        threads_per_worker=1,
                        processes=True,
                        dashboard_address="127.0.0.1:0",  # any free port; the default one may be taken
                        silence_logs=logging.CRITICAL,
                    )
                self._client = distributed.Client(self._local, set_as_default=False)
            else:
                self._client = distributed.Client(
                    scheduler, security=self._security(tls), timeout="20s", set_as_default=False
                )
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:
            self.close()
            if scheduler is None:
                raise ClusterLostError(
                    f"processes of this machine: must start, got: {_words(error)}; a script that starts them "
                    "does so under if __name__ == '__main__': only, as they read it too"
                ) from None
            raise ClusterLostError(
                f"scheduler {scheduler}: must answer, got: {_words(error)}; is it running, and is the "
                "address right?"
            ) from None

        # What they have to load, they load while the driver makes its own trial.
        with contextlib.suppress(OSError):
            self._client.run(_wake, wait=False)

    def _security(self, tls: dict[str, str] | None) -> Any:
        if not tls:
            return None
        return self._distributed.Security(
            tls_ca_file=tls.get("ca"),
            tls_client_cert=tls.get("cert"),
            tls_client_key=tls.get("key"),
            require_encryption=True,
        )

    @property
    def width(self) -> int:
        """How many threads the workers have in all; at least 1."""
        try:
            return max(1, int(sum(self._client.nthreads().values())))
        except Exception:  # the connection is gone, which is said where runs are given out
            return 1

    def each(
        self, call: Callable[[Any, list[T]], Any], shared: Any, batches: Iterator[list[T]]
    ) -> Iterator[tuple[list[T], Any]]:
        """Yield each batch with its answer, as they come; a few are under way at a time.

        Raises:
            ClusterLostError: The scheduler, or all its workers, cannot be reached any more.
        """
        under_way: dict[Any, list[T]] = {}
        ready: queue.SimpleQueue[Any] = queue.SimpleQueue()
        try:
            # To every worker: batches go where it is, and all but one would wait.
            (data,) = self._client.scatter([shared], broadcast=True, hash=True)
            while True:
                while len(under_way) < _AHEAD * self.width:
                    batch = next(batches, None)
                    if batch is None:
                        break
                    future = self._client.submit(call, data, batch, pure=False)
                    under_way[future] = batch
                    future.add_done_callback(ready.put)
                if not under_way:
                    return
                future = self._finished(ready)
                yield under_way.pop(future), self._answer(future)
        except AntennaPinError:
            raise
        except (OSError, TimeoutError, self._cancelled()) as error:
            why = "the connection is gone" if isinstance(error, self._cancelled()) else _words(error)
            raise ClusterLostError(
                f"scheduler {self._where}: was lost: {why}; finished runs are kept: give the same "
                "command again"
            ) from None
        finally:
            with contextlib.suppress(Exception):
                self._client.cancel(list(under_way))

    def _cancelled(self) -> type[BaseException]:
        from concurrent.futures import CancelledError

        return CancelledError

    def _finished(self, ready: queue.SimpleQueue[Any]) -> Any:
        """Wait for one; where all workers are gone for long, raise."""
        waited = 0.0
        while True:
            with contextlib.suppress(queue.Empty):
                return ready.get(timeout=_LOOK_EVERY)
            if self._client.status != "running":
                raise OSError("the connection is closed")
            waited = 0.0 if self._client.nthreads() else waited + _LOOK_EVERY
            if waited > _PATIENCE:
                raise OSError(f"it has had no workers for {_PATIENCE:g} s")

    def _answer(self, future: Any) -> Any:
        from distributed.scheduler import KilledWorker

        try:
            return future.result()
        except MissingToolError:
            raise
        except KilledWorker:
            return Lost("the process that made it was lost")
        except self._cancelled():
            raise
        except OSError:
            raise
        except Exception as error:
            return Lost(f"it did not come back: {_words(error)}")

    def close(self) -> None:
        """End the processes, or leave the scheduler to others."""
        for name in ("_client", "_local"):
            made = getattr(self, name, None)
            if made is not None:
                with contextlib.suppress(Exception):
                    made.close()


async def _wake() -> None:
    await asyncio.to_thread(importlib.import_module, "antenna_pin.sweep.work")


def _words(error: BaseException) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
