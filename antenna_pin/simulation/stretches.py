"""The compiled loop of a run: what it works on, whom it asks, what of it goes into the run's record."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import MEMORY
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import Workspace, works_in_x
from antenna_pin.engine import Compiled, CompiledStepper, loop_kernels
from antenna_pin.engine import stretch_kernels as kernels
from antenna_pin.integrate import Method
from antenna_pin.simulation.control import StepControl
from antenna_pin.simulation.episodes import Episodes
from antenna_pin.simulation.samples import Samples
from antenna_pin.simulation.search import ContactSearch
from antenna_pin.simulation.singular import Singularities
from antenna_pin.simulation.tape import Tape
from antenna_pin.simulation.watch import Watch
from antenna_pin.simulation.watched import Watched

__all__ = ["Made", "Parts", "Stretches", "stepper_of"]

Array = NDArray[np.float64]

# Trial steps from one look at the clock, at Ctrl-C and at limits to the next, of up to so many freedoms; of
# more they are fewer as the square. Where Python is asked from inside, a trial may take as long as what it
# asks. Where steps are dear they are at most a part of those before: what is wrong shows at the beginning.
_BUDGET, _FREEDOMS, _ASKED, _PART = 1024, 24, 32, 4
_CAPACITY = 256  # samples
_TAPED = 64  # steps on a tape
_COUNTS = ("accepted", "rejected", "relocated")


def stepper_of(workspace: Workspace, method: Method, scales: Array, settings: RunSettings) -> CompiledStepper:
    """Return the stepper of an engine.

    Raises:
        MechanismError: The system is not one that the engine can take.
    """
    return CompiledStepper(workspace, Compiled(workspace, settings.engine), method, scales, settings.rtol)


class Made(NamedTuple):
    """What a run has made so far.

    Attributes:
        tried: Trial steps.
        rejected: Those whose error was too large.
        relocated: Those made to end where something happens.
        evaluations: Of the right-hand side.
        wall: Wall time that it took [s].
    """

    tried: int
    rejected: int
    relocated: int
    evaluations: int
    wall: float


class Parts(NamedTuple):
    """What the loop works on besides its stepper.

    Attributes:
        control: How long steps are.
        samples: Where output goes.
        episodes: The contacts' record.
        search: What is looked for at contacts.
        watch: What is looked for besides.
        singular: What looks at each step's end; None where nothing is held.
    """

    control: StepControl
    samples: Samples
    episodes: Episodes
    search: ContactSearch
    watch: Watch
    singular: Singularities | None


class Stretches:
    """Makes steps in the compiled loop, up to the first thing that the run has to see to, and counts them.

    Args:
        stepper: What makes them.
        parts: What they are made with, and where they go.
        singly: Whether the run wants to see each step that is accepted.
        taped: Whether it wants to see where contacts change, with the steps up to there.

    Attributes:
        tape: Of steps that were accepted, where they are taped.
        accepted: Steps that have been accepted.
        rejected: Trial steps rejected by their error.
        relocated: Trial steps made to end where something happens.
    """

    def __init__(self, stepper: CompiledStepper, parts: Parts, singly: bool, taped: bool = False) -> None:
        """Allocate once."""
        self._stepper, self._parts = stepper, parts
        self.accepted = self.rejected = self.relocated = 0
        self._watched = Watched(parts.watch)
        self._stretch = np.zeros(1, kernels.STRETCH)
        self._stretch["rate"], self._stretch["begin"] = parts.samples.rate, parts.samples.begin
        self._stretch["end"] = parts.control.end
        freely = kernels.TO_CHANGES if taped else kernels.FREELY
        self._stretch["shown"] = kernels.SINGLY if singly else freely
        self.tape, self._taped = Tape(), taped
        self._lack: Callable[[], float] = float
        self._give_answers()
        freedoms = max(stepper.manifold.nv, _FREEDOMS)
        asks = stepper.answers.asks
        most = _ASKED if asks("elements") or asks("gaps") else _BUDGET
        self._dear = most == _ASKED or asks("acceleration") or asks("terms")
        self._most = max(1, min(most, _BUDGET) * _FREEDOMS**2 // freedoms**2)
        if taped:
            self._most = min(self._most, _TAPED)
        contacts, ends = len(parts.episodes), self._most if taped or parts.singular is not None else 0
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
            search=kernels.Search(
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
        )

    def _buffers(self, capacity: int, ends: int) -> kernels.Buffers:
        """Return room for so many samples, and for the ends of so many steps."""
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
        """Answer what the loop asks: implicit steps, where events are."""
        stepper, stretch = self._stepper, self._stretch
        answers, answer = stepper.answers, stepper.numbers.outside.asked

        def step(h: float) -> None:
            stepper.t = float(stretch["t"][0])
            if answer["new"][0]:
                stepper.newton.progress["fresh"] = answer["new"] = 0
            answer["answer"] = stepper.tried(h)

        def lack(h: float) -> None:
            stepper.h = h
            answer["answer"] = self._lack()

        if stepper.newton is not None:
            answers.give("step", step)
        if self._parts.watch:
            answers.give("lack", lack)

    # --- what there is --------------------------------------------------------------------------------------

    @property
    def made(self) -> int:
        """Trial steps made so far."""
        return self.accepted + self.rejected + self.relocated

    def so_far(self, wall: float) -> Made:
        """Return what was made, in so much wall time [s]."""
        return Made(self.made, self.rejected, self.relocated, self._stepper.evaluations, wall)

    @property
    def at_rest(self) -> bool:
        """Whether no step has begun."""
        return bool(self._stretch["phase"][0] == kernels.FRESH)

    def rest(self) -> None:
        """Give up the step that has begun: the next begins at the present state."""
        self._stretch["phase"] = kernels.FRESH

    @property
    def has_moved(self) -> bool:
        """Whether the last call has made a step."""
        return bool(self._stretch["accepted"][0] > 0)

    @property
    def following(self) -> float:
        """Size of the step to try next; within a step, of that which it began with [s]."""
        return float(self._stretch["h" if self.at_rest else "wished"][0])

    @following.setter
    def following(self, h: float) -> None:
        self._stretch["h"] = h

    @property
    def contact(self) -> int:
        """The contact that changes, or is too deep."""
        return int(self._stretch["contact"][0])

    @property
    def tried(self) -> tuple[float, float, bool]:
        """Size of the last trial step [s], its scaled error, whether a function had no answer in it."""
        found = self._stretch[0]
        return float(found["tried"]), float(found["error"]), bool(found["refused"])

    def take_up(self, other: Stretches) -> None:
        """Go on between two steps where another stands, which has been made with these parts."""
        self.accepted, self.rejected, self.relocated = other.accepted, other.rejected, other.relocated
        self.following = other.following

    def record_from(self, begin: float) -> None:
        """Leave nothing of before a time to the record [s]."""
        self._stretch["begin"] = begin

    def move_end(self, end: float) -> None:
        """Let steps be made up to another time [s]; the first that this cuts is told of."""
        self._stretch["end"], self._stretch["cut"] = end, 0

    # --- to make --------------------------------------------------------------------------------------------

    def go_on(self) -> int:
        """Make steps until something happens that the run has to see to; return what.

        Raises:
            FunctionError: A function of the user's has no answer.
        """
        most = min(self._most, self.made // _PART) if self._dear else self._most
        return self._made_by(loop_kernels.go_on, most=most)

    def finish_step(self) -> int:
        """Go on with the step that has begun, and no further; return what happens that the run has to see to.

        Raises:
            FunctionError: A function of the user's has no answer.
        """
        return self._made_by(loop_kernels.go_on)

    def search_until(self, theta: float) -> None:
        """Let the trial step that stands be searched up to where an event is, at this fraction of it."""
        self._stretch["until"] = theta

    def end_at(self, size: float, longest: float, lack: Callable[[], float], search: bool) -> int:
        """Make the trial step again to end at an event, and accept it; return what came of it.

        Args:
            size: How far into the step that is [s].
            longest: What the step may be corrected to at most [s].
            lack: How much longer the trial step should be [s], or 0.
            search: Whether contacts that change before are looked for.
        """
        self._lack = lack
        return self._made_by(loop_kernels.end_at, size, longest, search)

    def _made_by(self, kernel: Callable[..., int], *arguments: Any, most: int = 1) -> int:
        """Call the loop for so many trial steps at most; put what it has come to into the record."""
        stretch, (control, samples, episodes, *_) = self._stretch, self._parts
        for name in (*_COUNTS, "samples", "evaluations"):
            stretch[name] = 0
        stretch["t"] = began = self._stepper.t
        y = self._stepper.start[: self._stepper.manifold.size].copy()
        stretch["chosen"] = np.searchsorted(samples.chosen, self._stepper.t, side="right")
        stretch["budget"] = max(1, min(most, control.until_look(self.made)))
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
        """Put what the loop has come to, which began at a time [s] in a state, into the record."""
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
            self._parts.singular.look_along(buffers.instants[:ends], buffers.ends[:ends])
        if self._taped:
            self.tape.extend(began, y, (buffers.instants[:ends], buffers.sizes[:ends], buffers.ends[:ends]))
