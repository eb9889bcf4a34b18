"""The only time loop: steps, contact memory, located events, sampling, stopping rules.

Contacts change only at located instants. A trial step whose error passes is searched, in its dense output,
for the first contact that changes; if there is one the step is made again to end there, the contact's memory
is changed, and the integration restarts from that state. So the equations are smooth inside every accepted
step.
"""

from __future__ import annotations

import bisect
import dataclasses
import math
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from antenna_pin.dynamics import System, Workspace, _inspect
from antenna_pin.dynamics.workspace import ON_SURFACE
from antenna_pin.integrate import Stepper, method_named
from antenna_pin.joints import _kernels as _joint
from antenna_pin.joints.clearance import LawInRun
from antenna_pin.simulation.settings import RunSettings
from antenna_pin.state import OpenContact, State
from antenna_pin.trajectory import Counts, Outcome

__all__ = ["Episode", "Progress", "Run", "Samples", "interruptible"]

Array = NDArray[np.float64]

_SAFETY = 0.9
_SHRINK = 0.2
_GROW = 6.0
_RELOCATIONS = 5
_REPORT_INTERVAL = 0.1  # [s] of wall time between progress reports
_LARGEST_TURN = 2.0  # [rad] of a joint in one step: an angle's whole turns are counted from step to step
_PACE_STEPS = 50_000  # trial steps from one look at the pace to the next: a burst of impacts takes fewer
_REJECTED_IN_A_ROW = 1000


@dataclass(frozen=True, slots=True)
class Progress:
    """Where a run is.

    Attributes:
        time: Simulated so far [s].
        end: To be simulated [s].
        step: Size of the last step [s].
        steps: Steps accepted.
        wall: Wall time so far [s].
    """

    time: float
    end: float
    step: float
    steps: int
    wall: float


@dataclass(slots=True)
class Episode:
    """One contact from onset to release."""

    contact: int
    onset: float
    approach_speed: float
    release: float = math.nan
    peak_force: float = 0.0
    peak_time: float = math.nan
    peak_depth: float = 0.0
    impulse: float = 0.0
    dissipated: float = 0.0
    effective_mass: float = math.nan


@dataclass(slots=True)
class Samples:
    """States of a run at its output times, with the contacts' memory there."""

    times: list[float] = field(default_factory=list)
    states: list[Array] = field(default_factory=list)
    memories: list[Array] = field(default_factory=list)

    def add(self, t: float, y: Array, memory: Array) -> None:
        """Append one sample, or replace the last where it is the same instant but for round-off.

        An event may fall on an output time; what holds from the event on is what is kept.
        """
        if self.times and t <= self.times[-1]:
            self.states[-1] = y
            self.memories[-1] = memory
            return
        self.times.append(t)
        self.states.append(y)
        self.memories.append(memory)

    def insert(self, t: float, y: Array, memory: Array) -> None:
        """Put a sample between others in time; one that is there already stays."""
        place = bisect.bisect_left(self.times, t)
        if place < len(self.times) and self.times[place] == t:
            return
        self.times.insert(place, t)
        self.states.insert(place, y)
        self.memories.insert(place, memory)


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Turn Ctrl-C into a flag that the loop reads between steps, so that nothing is left half done.

    An impatient second one changes nothing; a third interrupts at once.
    """
    presses = 0

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal presses
        presses += 1
        if presses > 2:
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    before = signal.signal(signal.SIGINT, note)
    try:
        yield lambda: presses > 0
    finally:
        signal.signal(signal.SIGINT, before)


class Run:
    """One run of a system from an initial state.

    Args:
        system: The system; its contact memory is set from the initial state.
        start: Where from: a state that a run left, or the first one as [q, v, x] (:meth:`System.state`), at
            time zero, whose contacts touch by the rule of :meth:`System.contact_memory`.
        end: Time at which the run ends [s].
        settings: How to integrate and sample.
    """

    def __init__(self, system: System, start: Array | State, end: float, settings: RunSettings) -> None:
        """Prepare the stepper, the buffers of the inspection, and the contacts that touch at the start."""
        self.system = system
        self.settings = settings
        self.workspace = Workspace(system)
        self.duration = end
        #: From when on it records [s].
        self.begin = start.reached if isinstance(start, State) else 0.0
        self.method = method_named(settings.method)
        self.stepper = Stepper(self.workspace, self.method, settings.scales.of(system), settings.rtol)
        self.samples = Samples()
        self.episodes: list[Episode] = []
        self.gap_difference = 0.0
        self.accepted = self.rejected = self.relocated = 0
        self.wall = 0.0
        self.outcome = Outcome.COMPLETED
        self.message = Outcome.COMPLETED.value
        contacts = len(system.contact_names)
        self._record = np.zeros((contacts, _inspect.RECORD_SIZE))
        self._open: list[Episode | None] = [None] * contacts
        self._peaks: list[tuple[float, Array, Array] | None] = [None] * contacts
        self._ignore = np.zeros(contacts, dtype=np.int64)
        self._nodes = np.zeros((3, _inspect.NODES + 1, contacts))
        self._table = np.zeros_like(self.workspace.table)
        self._pose = np.zeros(_joint.POSE_BUFFER)
        self._floors = system.approach_speed_floors
        self._depths = np.array([limit for j in system.clearances for limit in j.depth_limits])
        self._reasons = [reason for j in system.clearances for reason in j.limit_reasons]
        self._bristles = [j.stride - _joint.BRISTLE_START for j in system.clearances for _ in j.contact_names]
        plays = [j.geometry.radial_clearance for j in system.clearances for _ in j.contact_names]
        self._gap_tolerances = [1e-9 * play for play in plays]
        self._uses_coal = any(j.backend == "coal" for j in system.clearances)
        manifold = system.manifold
        factors = [system.mechanism.joint(j.name).joint_id - 1 for j in system.clearances]
        self._context = (
            manifold.part(factors, plain=system.bristle_x.size > 0),
            self.stepper.dense,
            self.stepper.work,
            self.stepper.start_row,
            self.workspace.program,
            self.workspace.memory,
            np.zeros((2, manifold.size)),
            self._pose,
            self._table,
            np.zeros(manifold.nv + manifold.nx),
        )
        # Laws written in Python, by the row of their contact: the compiled inspection cannot evaluate them.
        self._python_laws = [
            (r, law)
            for path in self.workspace.paths
            if not path.joint.compiled
            for r, law in enumerate(path.laws, path.row)
        ]
        instants = {t for drive in system.drives.values() for t in drive.instants}
        self._breaks = sorted(t for t in instants if 0.0 < t < end)
        self._longest = settings.max_step
        if self.method.adaptive:
            self._longest = min([self._longest, *(drive.longest_step for drive in system.drives.values())])
        self._patterns: dict[bytes, float] = {}
        self._spin = 0.0
        self._paced = (0, self.begin)
        self._next = 0.0
        self._left: State | None = None
        if isinstance(start, State):
            self._go_on(start)
        else:
            self._start(start)

    # --- start ----------------------------------------------------------------------------------------------

    def _start(self, y: Array) -> None:
        self.stepper.restart(0.0, y)
        self._spin = self.system.turn_on(self.stepper.start)
        self._closed_form(y)
        for c in range(len(self._open)):
            row = self._table[c]
            if row[0] <= ON_SURFACE:
                self._touch(c, max(float(row[_joint.RATE]), 0.0))
        self.stepper.refresh()
        self._sample(0.0, y.copy())
        self._next = self._first_step()

    def _go_on(self, state: State) -> None:
        """Take up a run where another left it."""
        self.workspace.memory[:] = state.memory
        self.stepper.restart(state.time, state.y)
        self._spin = self.system.turn_on(self.stepper.start)
        for one in state.contacts:
            episode = Episode(
                contact=one.contact,
                onset=one.onset,
                approach_speed=one.approach_speed,
                effective_mass=one.effective_mass,
                impulse=one.impulse,
                dissipated=one.dissipated,
            )
            self._open[one.contact] = episode
            self.episodes.append(episode)
            self._record[one.contact] = one.peak
            if one.peak_state.size:
                self._peaks[one.contact] = (one.peak[1], one.peak_state.copy(), one.peak_memory.copy())
        self._patterns = {bytes.fromhex(name): size for name, size in state.sizes}
        self._ignore[:] = state.changed
        self._next = state.step
        if state.time == state.reached:
            self._sample(state.time, state.y)

    @property
    def state(self) -> State:
        """The state that the run leaves: one to go on from."""
        return self._left if self._left is not None else self._state()

    def _state(self) -> State:
        nq, nv = self.system.model.nq, self.system.model.nv
        y = self.stepper.start[: self.system.manifold.size]
        contacts = []
        for c, episode in enumerate(self._open):
            if episode is None:
                continue
            kept = self._peaks[c]
            contacts.append(
                OpenContact(
                    contact=c,
                    onset=episode.onset,
                    approach_speed=episode.approach_speed,
                    effective_mass=episode.effective_mass,
                    impulse=episode.impulse,
                    dissipated=episode.dissipated,
                    peak=tuple(self._record[c].tolist()),
                    peak_state=np.zeros(0) if kept is None else kept[1].copy(),
                    peak_memory=np.zeros((0, 3)) if kept is None else kept[2].copy(),
                )
            )
        return State(
            time=self.stepper.t,
            reached=self.stepper.t,
            q=y[:nq].copy(),
            v=y[nq : nq + nv].copy(),
            x=y[nq + nv :].copy(),
            memory=self.workspace.memory.copy(),
            contacts=tuple(contacts),
            step=self._next,
            sizes=tuple((pattern.hex(), size) for pattern, size in self._patterns.items()),
            changed=tuple(self._ignore.tolist()),
        )

    def _closed_form(self, y: Array) -> None:
        """Fill the run's own contact table for a state, in closed form."""
        _inspect.contacts_in(y, self.system.program, self._pose, self._table)

    # --- contact memory -------------------------------------------------------------------------------------

    def _touch(self, c: int, rate: float) -> None:
        speed = max(rate, self._floors[c])
        self.workspace.memory[c, _joint.TOUCHING] = 1.0
        mass = self.workspace.effective_mass(self.stepper.start[: self.system.manifold.size], c)
        self.workspace.memory[c, _joint.APPROACH] = speed
        self.workspace.memory[c, _joint.MASS] = mass
        episode = Episode(contact=c, onset=self.stepper.t, approach_speed=speed, effective_mass=mass)
        self._record[c] = (0.0, self.stepper.t, 0.0)
        x = self.stepper.start[self.system.model.nq + self.system.model.nv :]
        # What the contact has integrated before; taken off at its end.
        episode.impulse = -float(x[self.system.impulse_x[c]])
        episode.dissipated = -self._lost(c, x)
        self._open[c] = episode
        self.episodes.append(episode)
        # A new contact has new bristles.
        first = len(self.stepper.start) - len(x) + int(self.system.impulse_x[c]) + _joint.BRISTLE_START
        self.stepper.start[first : first + self._bristles[c]] = 0.0

    def _release(self, c: int) -> None:
        self.workspace.memory[c] = 0.0
        self._close(c)
        episode = self._open[c]
        if episode is not None:
            episode.release = self.stepper.t
            if episode.release < self.begin:  # it is the run's that was before
                self.episodes.remove(episode)
        self._open[c] = None

    def _close(self, c: int) -> None:
        episode = self._open[c]
        if episode is None:
            return
        x = self.stepper.start[self.system.model.nq + self.system.model.nv :]
        episode.peak_force, episode.peak_time, episode.peak_depth = self._record[c].tolist()
        peak = self._peaks[c]
        if peak is not None and peak[0] >= self.begin:
            self.samples.insert(*peak)
            self._peaks[c] = None
        episode.impulse += float(x[self.system.impulse_x[c]])
        episode.dissipated += self._lost(c, x)

    def _lost(self, c: int, x: Array) -> float:
        return float(x[self.system.lost_normal_x[c]] + x[self.system.lost_friction_x[c]])

    def _flip(self, c: int, rate: float) -> None:
        if self.workspace.memory[c, _joint.TOUCHING] != 0.0:
            self._release(c)
        else:
            self._touch(c, rate)

    # --- stepping -------------------------------------------------------------------------------------------

    def advance(
        self,
        progress: Callable[[Progress], None] | None = None,
        interrupted: Callable[[], bool] = lambda: False,
    ) -> None:
        """Run to the end, or to what ends it earlier; ``interrupted`` is asked between steps."""
        began = time.perf_counter()
        reported = began
        h = self._next
        while self.stepper.t < self.duration:
            self._next = h
            h = self._step(h)
            if self.outcome is not Outcome.COMPLETED:
                break
            if interrupted():
                self._stop(Outcome.INTERRUPTED)
                break
            if not self._may_go_on(began):
                break
            if progress is not None:
                now = time.perf_counter()
                if now - reported > _REPORT_INTERVAL:
                    reported = now
                    progress(self._progress(h, now - began))
        self._next = h
        reached = self.stepper.t
        self._left = dataclasses.replace(self.state, reached=reached)
        for c in range(len(self._open)):
            self._close(c)
        if not self.samples.times or self.samples.times[-1] < self.stepper.t:
            self._sample(self.stepper.t, self.stepper.start[: self.system.manifold.size].copy())
        self.wall = time.perf_counter() - began
        if progress is not None:
            progress(self._progress(h, self.wall))

    @property
    def _trials(self) -> int:
        return self.accepted + self.rejected + self.relocated

    def _may_go_on(self, began: float) -> bool:
        """Look whether a limit is reached, or the run makes so little way that it would never end."""
        limit, longest = self.settings.max_steps, self.settings.max_wall_time
        if limit is not None and self._trials >= limit:
            self._stop(Outcome.STEP_LIMIT)
        elif longest is not None and time.perf_counter() - began >= longest:
            self._stop(Outcome.TIME_LIMIT)
        elif self._trials - self._paced[0] >= _PACE_STEPS:
            trials, way = self._trials - self._paced[0], self.stepper.t - self._paced[1]
            self._paced = (self._trials, self.stepper.t)
            if trials * (self.duration - self.stepper.t) > self.settings.max_expected_steps * way:
                self._stop(Outcome.NO_PROGRESS)
        return self.outcome is Outcome.COMPLETED

    def counts(self) -> Counts:
        """Return what the run took so far."""
        return Counts(self.accepted, self.rejected, self.relocated, self.stepper.evaluations, self.wall)

    def _progress(self, h: float, wall: float) -> Progress:
        return Progress(self.stepper.t, self.duration, h, self.accepted, wall)

    def _first_step(self) -> float:
        settings = self.settings
        if not self.method.adaptive:
            return settings.step
        if settings.first_step is not None:
            return min(settings.first_step, settings.max_step)
        return min(1e-6, settings.max_step, self.duration)

    def _limit(self, h: float) -> float:
        """Cut a step to the longest allowed, to the next instant of a torque table, and to the end."""
        t = self.stepper.t
        h = min(h, self._longest)
        if h * self._spin > _LARGEST_TURN:
            h = _LARGEST_TURN / self._spin
        while self._breaks and self._breaks[0] <= t:
            self._breaks.pop(0)
        end = self._breaks[0] if self._breaks else self.duration
        rest = end - t
        # Two equal steps rather than a sliver at the end.
        halved = self.method.adaptive and h > 0.5 * rest
        if (h >= rest or halved) and not self._breaks and self._left is None:
            self._left = self._state()
        if h >= rest:
            return rest
        return 0.5 * rest if halved else h

    def _step(self, h: float) -> float:
        """Make one accepted step from the state; return the size to try next."""
        stepper = self.stepper
        settings = self.settings
        rejected = self.rejected
        while True:
            tried = self._limit(h)
            if stepper.t + tried == stepper.t:
                self._stop(Outcome.STEP_TOO_SMALL)
                return h
            error = stepper.attempt(tried)
            if error <= 1.0:
                break
            self.rejected += 1
            if self.rejected - rejected >= _REJECTED_IN_A_ROW:
                self._stop(Outcome.NO_PROGRESS)
                return h
            h = self._shortened(tried, error)
            if self.outcome is not Outcome.COMPLETED:
                return h
        following = settings.step
        if self.method.adaptive:
            following = tried * (
                _GROW if error == 0.0 else min(_GROW, _SAFETY * error ** (-1.0 / self._power))
            )
            if self.rejected > rejected:
                following = min(following, tried)
            if tried < h:  # cut for the sake of an output or the end, not of the error
                following = max(following, h)
        if self._open:
            return self._accept_with_contacts(tried, following)
        self._accept()
        return following

    @property
    def _power(self) -> int:
        order = self.method.error_order
        return (self.method.order if order is None else order) + 1

    def _accept_with_contacts(self, h: float, following: float) -> float:
        stepper = self.stepper
        if self._uses_coal:
            self._compare_gaps()
        stepper.prepare_dense()
        context = (*self._context, h)
        c, theta, deep = _inspect.inspect_step(
            stepper.t, self._nodes, self._ignore, self._depths, self._record, context
        )
        if deep:
            if theta > 0.0:
                shorter = self._relocate(c, theta * h, h, -float(self._depths[c]))
                if shorter is not None:
                    return shorter
            of_joint = self._reasons[c] == "maximum_depth"
            self._stop(Outcome.TOO_DEEP if of_joint else Outcome.OUT_OF_LAW_RANGE, c)
            return following
        if c < 0:
            self._track_python_laws(context)
            self._keep_peaks()
            self._ignore[:] = 0
            self._accept()
            return following
        self._patterns[self._pattern()] = following
        if theta > 0.0:
            shorter = self._relocate(c, theta * h, h)
            if shorter is not None:
                return shorter
        elif self._ignore[c] != 0:
            # It has just changed here and would change back at once: a graze. Let it, this once more.
            self._ignore[c] = 2
            self._flip(c, 0.0)
            stepper.refresh()
            return following
        self._closed_form(stepper.start)
        self._flip(c, float(self._table[c, _joint.RATE]))
        self._ignore[c] = 1
        stepper.refresh()
        self._sample(stepper.t, stepper.start[: self.system.manifold.size].copy())
        return min(self._patterns.get(self._pattern(), following), following * 10.0)

    def _pattern(self) -> bytes:
        return self.workspace.memory[:, _joint.TOUCHING].tobytes()

    def _relocate(self, c: int, size: float, longest: float, target: float = 0.0) -> float | None:
        """Make the step again so that it ends where the gap of contact c is the target's [m], and accept it.

        The error of the step that went on past that point says nothing of the one up to it. Where that one's
        is too large nothing is accepted: a shorter step to try is returned [s].
        """
        stepper = self.stepper
        for _ in range(_RELOCATIONS):
            error = stepper.attempt(size)
            self.relocated += 1
            if not error <= 1.0:
                return self._shortened(size, error)
            self._closed_form(stepper.y)
            gap, rate = float(self._table[c, 0]) - target, float(self._table[c, _joint.RATE])
            if abs(gap) <= self._gap_tolerances[c] or rate == 0.0:
                break
            better = size + gap / rate
            if not 0.0 < better <= longest:
                break
            size = better
        if self._uses_coal:
            self._compare_gaps()
        stepper.prepare_dense()
        context = (*self._context, stepper.h)
        _inspect.fill_nodes(self._nodes, context)
        _inspect.track_peaks(stepper.t, self._nodes, self._record, context)
        self._track_python_laws(context)
        self._keep_peaks()
        self._ignore[:] = 0
        self._accept()
        return None

    def _shortened(self, tried: float, error: float) -> float:
        """Return the step to try after one with too large an error [s]; end a run that has none."""
        h = tried * _SHRINK
        if math.isfinite(error):
            h = tried * max(_SHRINK, _SAFETY * error ** (-1.0 / self._power))
        if h < self.settings.min_step or not self.method.adaptive:
            self._stop(Outcome.STEP_TOO_SMALL if math.isfinite(error) else Outcome.NOT_FINITE)
        return h

    def _keep_peaks(self) -> None:
        """Keep the state at the largest force so far of each touching contact, to sample it at the end."""
        t, h = self.stepper.t, self.stepper.h
        for c, episode in enumerate(self._open):
            if episode is None:
                continue
            moment = float(self._record[c, _inspect.PEAK_TIME])
            kept = self._peaks[c]
            if t < moment <= t + h and (kept is None or kept[0] != moment):
                state = np.empty(self.system.manifold.size)
                self.stepper.interpolate((moment - t) / h, state)
                self._peaks[c] = (moment, state, self.workspace.memory.copy())

    def _track_python_laws(self, context: tuple[Any, ...]) -> None:
        """Raise the largest force of contacts with a Python law to the maximum of the dense output."""
        t, h = self.stepper.t, self.stepper.h
        for c, law in self._python_laws:
            if self.workspace.memory[c, _joint.TOUCHING] == 0.0:
                continue
            onset = self.workspace.memory[c, _joint.APPROACH :]

            def lack(theta: float, c: int = c, law: LawInRun = law, onset: Array = onset) -> float:
                _inspect.contacts_at(theta, *context[:-1])
                depth = -float(self._table[c, 0])
                return -law.forces(depth, self._table[c, _joint.RATE], *onset)[1] if depth > 0.0 else 0.0

            points = [k / _inspect.NODES for k in range(_inspect.NODES + 1)]
            values = [lack(theta) for theta in points]
            best = int(np.argmin(values))
            theta, value = points[best], values[best]
            if -value > 0.95 * self._record[c, _inspect.PEAK_FORCE]:
                found = minimize_scalar(
                    lack,
                    bounds=(points[max(best - 1, 0)], points[min(best + 1, _inspect.NODES)]),
                    method="bounded",
                    options={"xatol": 1e-6},
                )
                if found.fun < value:
                    theta, value = float(found.x), float(found.fun)
            if -value > self._record[c, _inspect.PEAK_FORCE]:
                self._record[c, _inspect.PEAK_FORCE] = -value
                self._record[c, _inspect.PEAK_TIME] = t + theta * h

    def _accept(self) -> None:
        stepper = self.stepper
        t, h = stepper.t, stepper.h
        rate = self.settings.output_rate
        first = math.floor(t * rate + 1e-9) + 1
        last = math.floor((t + h) * rate + 1e-9)
        times = [k / rate for k in range(first, last + 1)]
        if t < self.begin <= t + h and self.begin not in times:
            times.insert(0, self.begin)
        if times:
            stepper.prepare_dense()
            for moment in times:
                state = np.empty(self.system.manifold.size)
                theta = (moment - t) / h
                if theta >= 1.0:
                    state[:] = stepper.y
                else:
                    stepper.interpolate(theta, state)
                self._sample(min(moment, self.duration), state)
        stepper.accept()
        if self.system.turn_x:
            self._spin = self.system.turn_on(stepper.start)
        if stepper.t > self.duration - 1e-15 * self.duration:
            stepper.t = self.duration
        self.accepted += 1

    def _sample(self, t: float, y: Array) -> None:
        if t < self.begin:
            return
        self.samples.add(t, y, self.workspace.memory.copy())

    def _compare_gaps(self) -> None:
        """Record how far coal's gaps are from the closed form at the end of the trial step."""
        self.workspace.measure(self.stepper.y)
        self._closed_form(self.stepper.y)
        contacts = len(self._open)
        difference = np.abs(self._table[:contacts, 0] - self.workspace.table[:contacts, 0]).max()
        if difference > self.gap_difference:
            self.gap_difference = float(difference)

    def _stop(self, outcome: Outcome, contact: int = -1) -> None:
        where = f"at t = {self.stepper.t:.9g} s"
        if contact >= 0:
            limit = self._depths[contact]
            self._closed_form(self.stepper.start)
            depth = -float(self._table[contact, 0])
            where += f", contact {self.system.contact_names[contact]} ({depth:.3g} m, limit {limit:.3g} m: "
            where += f"{self._reasons[contact]})"
        self.outcome = outcome
        self.message = f"{where}: {outcome.value}"
