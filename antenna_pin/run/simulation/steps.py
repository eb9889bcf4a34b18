"""Steps of a run: error scales, step size control, log, batches in the compiled loop."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import MEMORY
from antenna_pin.base.settings import ErrorScales, RunSettings
from antenna_pin.dynamics import System, Workspace, works_in_x
from antenna_pin.dynamics.outside_kernels import CallbackRecord
from antenna_pin.elements import ForceElement
from antenna_pin.integrate import Method
from antenna_pin.run.engine import Compiled, CompiledStepper, Pace, Sizes, loop_kernels
from antenna_pin.run.engine import stretch_kernels as kernels
from antenna_pin.run.simulation.constraints import Singularities
from antenna_pin.run.simulation.contacts import ContactSearch, Episodes
from antenna_pin.run.simulation.event_watch import EventWatch, WatchTable
from antenna_pin.run.simulation.samples import Samples
from antenna_pin.trajectory import Outcome

Array = NDArray[np.float64]

# --- error scales -------------------------------------------------------------------------------------------

#: Substitute for the play of a joint on bearings, which deflects by micrometres, and for half its
#: length [m].
BEARING_PLAY, BEARING_LEVER = 1e-4, 0.01


def scale_vector(system: System, scales: ErrorScales) -> NDArray[np.float64]:
    """Return the error scale of each component of [u, v, x], (2 nv + nx,).

    The scale of works and losses is the energy of the moving bodies at a velocity of one unit of tolerance.
    """
    model = system.model
    position = np.full(model.nv, scales.angle)
    velocity = np.full(model.nv, scales.angular_velocity)
    for slot in system.mechanism.joints.values():
        position[slot.ways] = scales.position
        velocity[slot.ways] = scales.velocity
    if system.mechanism.base == "free":
        masses = [inertia.mass for inertia in model.inertias]
        factor = scales.base if scales.base is not None else max(sum(masses[2:]) / sum(masses), 1e-6)
        position[:3] = factor * scales.position
        position[3:6] = factor * scales.angle
        velocity[:3] = factor * scales.velocity
        velocity[3:6] = factor * scales.angular_velocity
    shapes = [(joint.name, joint.geometry, 2 if joint.planar else 3) for joint in system.clearances]
    plays = [
        (name, scales.clearance * shape.radial_clearance, shape.half_length, shape.motion == "slide", linear)
        for name, shape, linear in shapes
    ]
    plays += [(name, scales.clearance * BEARING_PLAY, BEARING_LEVER, False, 3) for name in system.on_bearings]
    for name, play, half, slides, linear in plays:
        slot = system.mechanism.joint(name)
        start = slot.v.start
        # About the axis the motion angle, across it the tilt; in between, for an axis askew, the finer.
        along = np.abs(slot.axis) > 1.0 - 1e-9
        position[start : start + linear] = play
        velocity[start : start + linear] = scales.clearance_velocity
        if slides:
            position[start : start + 3] = np.where(along, scales.position, play)
            velocity[start : start + 3] = np.where(along, scales.velocity, scales.clearance_velocity)
        if half is not None:
            tilt, rate = play / half, scales.clearance_velocity / half
            turns = along & (not slides)
            position[start + 3 : start + 6] = np.where(turns, scales.angle, tilt)
            velocity[start + 3 : start + 6] = np.where(turns, scales.angular_velocity, rate)
    x = np.full(system.manifold.nx, math.inf)
    forces = system.force_x["work"], system.force_x["loss"]
    booked = (system.lost_normal_x, system.lost_friction_x, system.work_x, system.damper_x, system.element_x)
    energies = np.concatenate([places[places >= 0] for places in (*booked, *forces)])
    others = 2 if system.mechanism.base == "free" and model.njoints > 2 else 1
    moving = list(model.inertias)[others:]
    slow = scales.clearance_velocity if system.clearances or system.on_bearings else scales.velocity
    x[energies] = sum(i.mass for i in moving) * slow**2
    if not any(i.mass for i in moving):  # rotors that have an inertia alone
        x[energies] = sum(float(np.trace(i.inertia)) for i in moving) * scales.angular_velocity**2
    bristles = [
        scale
        for joint in system.clearances
        for _ in joint.contact_names
        for scale in getattr(joint.friction, "state_scales", ())
    ]
    # Bristles of elements are numbers of size 1.
    x[system.bristle_x] = bristles + [1.0] * (len(system.bristle_x) - len(bristles))
    return np.concatenate([position, velocity, x])


# --- step control -------------------------------------------------------------------------------------------

_PACE_STEPS = 50_000  # trial steps between checks of the pace: a burst of impacts takes fewer


class StepControl:
    """Step size control, with times at which steps must end, and limits of a run.

    Args:
        workspace: Workspace of the run; elements define times at which steps end, and longest steps.

    Attributes:
        sizes: Step sizes by pattern of touching contacts: impacts of one kind need steps of one size [s].
    """

    def __init__(
        self, workspace: Workspace, method: Method, settings: RunSettings, begin: float, end: float
    ) -> None:
        """Collect the times at which steps must end."""
        self.settings = settings
        self.method = method
        self.end = end
        order = method.order if method.error_order is None else method.error_order
        #: The sizes of steps, in numbers.
        self.pace = Pace(
            adaptive=method.adaptive,
            power=order + 1,
            control=method.control,
            step=settings.step,
            least=settings.min_step,
            end=end,
        )
        self.sizes = Sizes(workspace.memory)
        system = workspace.system
        elements = [element for family in system.families.values() for element in family.values()]
        self.pace.end_at({t for element in elements for t in element.instants})
        self.renew(elements)
        #: Trial steps and time [s] of the last check of the pace.
        self.paced = (0, begin)

    def move_end(self, end: float) -> None:
        """Move the end of the run [s]."""
        self.end = end
        self.pace.move_end(end)

    def renew(self, elements: Iterable[ForceElement]) -> None:
        """Update the longest step, with elements that have changed."""
        longest = self.settings.max_step
        if self.method.adaptive:
            longest = min([longest, *(element.longest_step for element in elements)])
        self.pace.numbers["longest"] = longest

    def limit_turns(self, rate: float) -> None:
        """Set the fastest rate of a continuous joint at the present state [rad/s]."""
        self.pace.numbers["spin"] = rate

    @property
    def error(self) -> float:
        """Scaled error of the last accepted step [-]; zero before the first."""
        return float(self.pace.numbers["error"][0])

    @error.setter
    def error(self, value: float) -> None:
        self.pace.numbers["error"] = value

    @property
    def first_step(self) -> float:
        """Size of the first step to try [s]."""
        settings = self.settings
        if not self.method.adaptive:
            return settings.step
        if settings.first_step is not None:
            return min(settings.first_step, settings.max_step)
        return min(1e-6, settings.max_step, self.end)

    def limit(self, trials: int, t: float, wall: float) -> Outcome | None:
        """Return the limit reached, or NO_PROGRESS of a run that would never end."""
        settings = self.settings
        if settings.max_steps is not None and trials >= settings.max_steps:
            return Outcome.STEP_LIMIT
        if settings.max_wall_time is not None and wall >= settings.max_wall_time:
            return Outcome.TIME_LIMIT
        return None if self._makes_way(trials, t) else Outcome.NO_PROGRESS

    def until_check(self, trials: int) -> int:
        """Return the number of trial steps until :meth:`limit` must be called."""
        most = self.settings.max_steps
        until = self.paced[0] + _PACE_STEPS - trials
        return until if most is None else min(until, most - trials)

    def _makes_way(self, trials: int, t: float) -> bool:
        """Return whether a run at t [s] may reach its end at its pace."""
        if trials - self.paced[0] < _PACE_STEPS:
            return True
        made, way = trials - self.paced[0], t - self.paced[1]
        self.paced = (trials, t)
        return made * (self.end - t) <= self.settings.max_expected_steps * way


# --- step log -----------------------------------------------------------------------------------------------


class LoggedStep(NamedTuple):
    """Step without a change inside."""

    time: float  # begin of the step [s]
    size: float  # size of the step [s]
    y: Array  # state at the begin
    until: float  # end of the step [s]
    end: Array  # state at the end, before any change there


# --- batches of steps ---------------------------------------------------------------------------------------

# Trial steps between checks of clock, Ctrl-C and limits, for systems of up to this many freedoms; for
# larger ones the number falls with the square. A trial step that calls Python may take as long as the
# called function. Expensive steps are at most a part of those before: errors appear at the beginning.
_BUDGET, _FREEDOMS, _ASKED, _PART = 1024, 24, 32, 4
_CAPACITY = 512  # samples
_LOGGED = 64  # steps of a log
_COUNTS = ("accepted", "rejected", "relocated")


def stepper_of(
    workspace: Workspace,
    method: Method,
    scales: Array,
    settings: RunSettings,
    tree: NDArray[Any] | None = None,
) -> CompiledStepper:
    """Return the stepper of an engine; ``tree`` as of :class:`Compiled`.

    Raises:
        MechanismError: The engine cannot run the system.
    """
    numbers = Compiled(workspace, settings.engine, tree)
    return CompiledStepper(workspace, numbers, method, scales, settings.rtol)


class StepCounts(NamedTuple):
    """Counts of steps and evaluations so far."""

    tried: int  # trial steps
    rejected: int  # trial steps with too large an error
    relocated: int  # trial steps repeated to end at a change or an event
    evaluations: int  # evaluations of the right-hand side
    wall: float  # wall time [s]


class LoopParts(NamedTuple):
    """Services of the compiled loop besides its stepper."""

    control: StepControl  # step size control
    samples: Samples  # samples of the run
    episodes: Episodes  # record of contacts
    search: ContactSearch  # search for changes of contact
    watch: EventWatch  # search for events
    singular: Singularities | None  # search for singular positions; None without constraints
    touches: NDArray[Any]  # largest efforts of elements in touch, TOUCH, (n,)


class StepBatches:
    """Batches of steps in the compiled loop, up to the next interruption, and their counts.

    Args:
        singly: Whether a batch ends after each accepted step.
        logged: Whether steps are logged, and a batch ends at each change of contact.

    Attributes:
        log: Accepted steps since the last call of the run's observer, if logged.
        accepted: Accepted steps.
        rejected: Trial steps rejected by their error.
        relocated: Trial steps repeated to end at a change or an event.
    """

    def __init__(
        self, stepper: CompiledStepper, parts: LoopParts, singly: bool, logged: bool = False
    ) -> None:
        """Allocate once."""
        self._stepper, self._parts = stepper, parts
        self.accepted = self.rejected = self.relocated = 0
        self._watched = WatchTable(parts.watch)
        self._stretch = np.zeros(1, kernels.STRETCH)
        self._stretch["rate"], self._stretch["begin"] = parts.samples.rate, parts.samples.begin
        self._stretch["end"] = parts.control.end
        freely = kernels.TO_CHANGES if logged else kernels.FREELY
        self._stretch["shown"] = kernels.SINGLY if singly else freely
        self.log: list[LoggedStep] = []
        self._logged = logged
        self._lack: Callable[[], float] = float
        self._give_answers()
        freedoms = max(stepper.manifold.nv, _FREEDOMS)
        asks = stepper.answers.asks
        most = _ASKED if asks("elements") or asks("gaps") else _BUDGET
        self._dear = most == _ASKED or asks("acceleration") or asks("terms")
        self._most = max(1, min(most, _BUDGET) * _FREEDOMS**2 // freedoms**2)
        if logged:
            self._most = min(self._most, _LOGGED)
        contacts, ends = len(parts.episodes), self._most if logged or parts.singular is not None else 0
        self._loop = kernels.Loop(
            stretch=self._stretch,
            pace=parts.control.pace.numbers,
            breaks=parts.control.pace.breaks,
            chosen=parts.samples.chosen,
            tableau=stepper.tableau,
            space=stepper.manifold.layout,
            work=stepper.work,
            dense=stepper.dense,
            scales=stepper.scales,
            rtol=stepper.rtol,
            numbers=stepper.numbers,
            search=kernels.EventSearch(
                nodes=parts.search.nodes,
                ignore=parts.search.ignore,
                limits=parts.search.limits,
                peaks=parts.episodes.peaks,
                turns=parts.episodes.system.turns,
                compared=parts.search.compared,
                difference=parts.search.difference,
            ),
            trial=parts.search.trial,
            buffers=self._buffers(_CAPACITY + 2 * contacts, ends),
            book=parts.episodes.book,
            sizes=parts.control.sizes.table,
            watched=self._watched.numbers,
            works=works_in_x(parts.episodes.system),
            touches=parts.touches,
        )

    def _buffers(self, capacity: int, ends: int) -> kernels.Buffers:
        """Return buffers for a number of samples and of ends of steps."""
        size, contacts = self._stepper.manifold.size, len(self._parts.episodes)
        return kernels.Buffers(
            times=np.zeros(capacity),
            states=np.zeros((capacity, size)),
            memories=np.zeros((capacity, contacts), MEMORY),
            early=np.zeros(capacity, dtype=np.int64),
            instants=np.zeros(ends),
            sizes=np.zeros(ends),
            ends=np.zeros((ends, size)),
            kept=self._stepper.kept,
            out=np.zeros((2, size)),
        )

    def _give_answers(self) -> None:
        """Set the callbacks of the loop: implicit steps, corrections to events."""
        stepper, stretch = self._stepper, self._stretch
        answers = stepper.answers
        answer: CallbackRecord = stepper.numbers.outside.asked[0]

        def step(h: float) -> None:
            stepper.t = float(stretch["t"][0])
            if answer.new:
                stepper.newton.progress["fresh"] = answer.new = 0
            answer.answer = stepper.tried(h)

        def lack(h: float) -> None:
            stepper.h = h
            answer.answer = self._lack()

        if stepper.newton is not None:
            answers.give("step", step)
        if self._parts.watch:
            answers.give("lack", lack)

    # --- state ----------------------------------------------------------------------------------------------

    @property
    def tried_so_far(self) -> int:
        """Trial steps so far."""
        return self.accepted + self.rejected + self.relocated

    def so_far(self, wall: float) -> StepCounts:
        """Return the counts, with a wall time [s]."""
        return StepCounts(self.tried_so_far, self.rejected, self.relocated, self._stepper.evaluations, wall)

    @property
    def at_rest(self) -> bool:
        """Return whether no step is in progress."""
        return bool(self._stretch["phase"][0] == kernels.FRESH)

    def rest(self) -> None:
        """Abort the step in progress: the next begins at the present state."""
        self._stretch["phase"] = kernels.FRESH

    @property
    def has_moved(self) -> bool:
        """Return whether the last call has accepted a step."""
        return bool(self._stretch["accepted"][0] > 0)

    @property
    def following(self) -> float:
        """Size of the next step to try; within a step, its initial size [s]."""
        return float(self._stretch["h" if self.at_rest else "wished"][0])

    @following.setter
    def following(self, h: float) -> None:
        self._stretch["h"] = h

    @property
    def contact(self) -> int:
        """Number of the contact that changes or is too deep."""
        return int(self._stretch["contact"][0])

    @property
    def tried(self) -> tuple[float, float, bool]:
        """Size of the last trial step [s], its scaled error, and whether a function refused."""
        found = self._stretch[0]
        return float(found["tried"]), float(found["error"]), bool(found["refused"])

    def take_up(self, other: StepBatches) -> None:
        """Continue from the counts and step size of other batches."""
        self.accepted, self.rejected, self.relocated = other.accepted, other.rejected, other.relocated
        self.following = other.following

    def record_from(self, begin: float) -> None:
        """Record from a time on [s]."""
        self._stretch["begin"] = begin

    def move_end(self, end: float) -> None:
        """Move the end of the run [s]; the first cut step interrupts the loop."""
        self._stretch["end"], self._stretch["cut"] = end, 0

    # --- batches --------------------------------------------------------------------------------------------

    def go_on(self) -> int:
        """Make steps up to the next interruption; return its reason."""
        most = min(self._most, self.tried_so_far // _PART) if self._dear else self._most
        return self._made_by(loop_kernels.go_on, most=most)

    def finish_step(self) -> int:
        """Continue the step in progress, and no further; return the reason of an interruption."""
        return self._made_by(loop_kernels.go_on)

    def search_until(self, theta: float) -> None:
        """Let the trial step be searched up to an event, at this fraction."""
        self._stretch["until"] = theta

    def end_at(self, size: float, longest: float, lack: Callable[[], float], search: bool) -> int:
        """Repeat the trial step to end at an event, and accept it; return the reason.

        Args:
            size: Time from the begin of the step to the event [s].
            longest: Upper limit of the corrected step size [s].
            lack: Function for the Newton correction of the step size [s], or 0.
            search: Whether to search for earlier changes of contact.
        """
        self._lack = lack
        return self._made_by(loop_kernels.end_at, size, longest, search)

    def _made_by(self, kernel: Callable[..., int], *arguments: Any, most: int = 1) -> int:
        """Call the loop for a number of trial steps; record the outcome."""
        stretch, (control, samples, episodes, *_) = self._stretch, self._parts
        for name in (*_COUNTS, "samples", "evaluations"):
            stretch[name] = 0
        stretch["t"] = began = self._stepper.t
        y = self._stepper.start[: self._stepper.manifold.size].copy()
        stretch["chosen"] = np.searchsorted(samples.chosen, self._stepper.t, side="right")
        stretch["budget"] = max(1, min(most, control.until_check(self.tried_so_far)))
        episodes.make_room()
        control.sizes.make_room()
        self._watched.renew()
        needed, buffers = int(stretch["needed"][0]), self._loop.buffers
        if needed > len(buffers.times):
            buffers = self._buffers(2 * needed, len(buffers.instants))
        self._loop = self._loop._replace(
            breaks=control.pace.breaks,
            book=episodes.book,
            sizes=control.sizes.table,
            buffers=buffers,
        )
        reason = int(kernel(self._loop, *arguments))
        try:
            self._take_over(began, y)
        finally:
            self._stepper.answers.check()
        return reason

    def _take_over(self, began: float, y: Array) -> None:
        """Record the outcome of a call that began at a time [s] in a state."""
        stepper, found, buffers = self._stepper, self._stretch[0], self._loop.buffers
        stepper.t, stepper.h = float(found["t"]), float(found["tried"])
        stepper.evaluations += int(found["evaluations"])
        stepper.has_dense = not self.at_rest
        count, ends = int(found["samples"]), int(found["accepted"])
        self._parts.samples.extend(
            buffers.times[:count], buffers.states[:count], buffers.memories[:count], buffers.early[:count]
        )
        for name in _COUNTS:
            setattr(self, name, getattr(self, name) + int(found[name]))
        if self._parts.singular is not None:
            self._parts.singular.inspect_along(buffers.instants[:ends], buffers.ends[:ends])
        for k in range(ends) if self._logged else ():
            until, end = float(buffers.instants[k]), buffers.ends[k].copy()
            self.log.append(LoggedStep(began, float(buffers.sizes[k]), y, until, end))
            began, y = until, end
