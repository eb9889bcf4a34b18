"""Successive runs in a thread of their own: the latest request wins."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from antenna_pin.compiled.compile_time import COMPILE_TIME, CompileClock, compiling_timed
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.session import start
from antenna_pin.scenario import Scenario
from antenna_pin.trajectory import Outcome, Trajectory

#: Stage of the work that may take longer than all others, once on a machine.
COMPILING = f"compiling, once on this machine, for {COMPILE_TIME}"

# Wall time [s]: between looks whether something else is asked for, and between pictures of a run on its way.
_LOOK, _PICTURE = 0.04, 0.2
_FIRST = 1.0 / 64.0  # of the run, before its pace is known
_FASTER = 4.0  # by how much a piece may be longer than the one before
# Shortest piece of a run: where going on takes its time whatever the piece, shorter ones would get nowhere.
_LEAST = 1.0 / 256.0


@dataclass(frozen=True, slots=True)
class RunUpdate:
    """Answer to a request.

    Attributes:
        number: Of the request.
        run: The run so far; None if it was refused.
        done: Whether the request is completed.
        refused: Reason of a refusal, in one line; empty for a run.
        wall: Time since the request [s].
    """

    number: int
    run: Trajectory | None
    done: bool
    refused: str
    wall: float


class Runner:
    """Runner of requested runs in a thread; a superseded run is stopped.

    Args:
        deliver: Called in that thread with answers to the latest request.
    """

    def __init__(self, deliver: Callable[[RunUpdate], None]) -> None:
        """Start the thread, which waits."""
        self._deliver = deliver
        self._change = threading.Condition()
        self._asked: tuple[int, Callable[[], Scenario], float] | None = None
        self._number = 0
        self._closed = False
        self._clock: CompileClock | None = None
        self._reached: tuple[float, float] | None = None
        self._thread = threading.Thread(target=self._work, name="antenna-pin explore", daemon=True)
        self._thread.start()

    def ask(self, scenario: Callable[[], Scenario]) -> int:
        """Request a run of the scenario that a function returns; return its number."""
        with self._change:
            self._number += 1
            self._asked = self._number, scenario, time.perf_counter()
            self._change.notify()
            return self._number

    @property
    def stage(self) -> str:
        """The present stage of the work, for a line of text."""
        if self._clock is not None and self._clock.is_compiling:
            return COMPILING
        if self._reached is None:
            return "loading and building the mechanism"
        time, end = self._reached
        return f"running, {time:.3g} of {end:g} s simulated"

    def close(self) -> None:
        """Stop what runs, and the thread."""
        with self._change:
            self._closed = True
            self._number += 1
            self._change.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _work(self) -> None:
        with compiling_timed() as self._clock:
            self._serve()

    def _serve(self) -> None:
        while True:
            with self._change:
                self._change.wait_for(lambda: self._asked is not None or self._closed)
                if self._closed:
                    return
                assert self._asked is not None
                number, scenario, asked = self._asked
                self._asked = None
            try:
                self._make(number, scenario, asked)
            except Exception as error:  # also a bug: it must not end the thread
                said = str(error)
                if not isinstance(error, AntennaPinError):
                    said = f"{type(error).__name__}: {' '.join(said.split())}"
                self._tell(RunUpdate(number, None, True, said, time.perf_counter() - asked))

    def _make(self, number: int, scenario: Callable[[], Scenario], requested: float) -> None:
        """Make a run piece by piece, identical to one run, until another request comes."""
        self._reached = None
        made = scenario()
        session = start(made)
        end, piece = made.duration, made.duration * _FIRST
        told = time.perf_counter()
        while session.time < end and session.outcome is Outcome.COMPLETED:
            if number != self._number:
                return
            self._reached = session.time, end
            began = time.perf_counter()
            left = end - session.time
            session.run_until(end if left < 1.5 * piece else session.time + piece)
            now = time.perf_counter()
            piece *= min(max(_LOOK / max(now - began, 1e-6), 1.0 / _FASTER), _FASTER)
            piece = max(piece, _LEAST * made.duration)
            if now - told > _PICTURE and session.time < end:
                told = now
                self._tell(RunUpdate(number, session.trajectory(), False, "", now - requested))
        run = session.trajectory()
        self._tell(RunUpdate(number, run, True, "", time.perf_counter() - requested))

    def _tell(self, answer: RunUpdate) -> None:
        if answer.number == self._number:
            self._deliver(answer)
