"""Steps that nothing interrupts, made in one compiled loop; what they come to goes into the run's record."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.engine import Compiled, CompiledImplicitStepper, CompiledStepper
from antenna_pin.engine import loop_kernels as kernels
from antenna_pin.engine import stretch_kernels as _stretch
from antenna_pin.integrate import Method, Stepper, made_stepper
from antenna_pin.records import MEMORY
from antenna_pin.settings import RunSettings
from antenna_pin.simulation.control import StepControl
from antenna_pin.simulation.episodes import Episodes
from antenna_pin.simulation.samples import Samples
from antenna_pin.simulation.search import ContactSearch
from antenna_pin.simulation.singular import Singularities
from antenna_pin.simulation.trials import Trial, Trials
from antenna_pin.simulation.watch import Watch
from antenna_pin.simulation.watched import Watched

__all__ = ["QuietTrials", "stepper_of"]

Array = NDArray[np.float64]

# Trial steps from one look at the clock, at Ctrl-C and at limits to the next, of up to so many freedoms; of
# more they are fewer as the square. The clock must not decide: where a stretch ends, the last digits of
# loops may be others.
_BUDGET, _FREEDOMS = 1024, 24
_CAPACITY = 256  # samples


def stepper_of(workspace: Workspace, method: Method, scales: Array, settings: RunSettings) -> Stepper:
    """Return the stepper of an engine.

    Raises:
        MechanismError: The system is not one that the compiled engine can take.
    """
    if settings.engine != "compiled":
        return made_stepper(workspace, method, scales, settings.rtol)
    kind = CompiledImplicitStepper if method.implicit else CompiledStepper
    return kind(workspace, Compiled(workspace), method, scales, settings.rtol)


class QuietTrials(Trials):
    """Trials of a compiled run: steps are made in one loop, up to the first that this one has to see to.

    Args:
        stepper: What makes them.
        control: How long they are.
        samples: Where output goes.
        episodes: The contacts' record.
        search: The contacts' search, whose findings these are.
        watch: What is looked for besides.
        singular: What looks at each step's end; None where nothing is held.
    """

    def __init__(
        self,
        stepper: CompiledStepper,
        control: StepControl,
        samples: Samples,
        episodes: Episodes,
        search: ContactSearch,
        watch: Watch,
        singular: Singularities | None,
    ) -> None:
        """Allocate once."""
        super().__init__(stepper, control)
        self._compiled = stepper
        self._singular = singular
        freedoms = max(stepper.manifold.nv, _FREEDOMS)
        self._most = max(1, _BUDGET * _FREEDOMS**2 // freedoms**2)
        self._samples, self._episodes, self._watch = samples, episodes, watch
        size, contacts = stepper.manifold.size, len(episodes)
        ends = 0 if singular is None else _BUDGET
        capacity = _CAPACITY + 2 * contacts
        self._stretch = np.zeros(1, _stretch.STRETCH)
        self._stretch["rate"], self._stretch["begin"] = samples.rate, samples.begin
        self._stretch["end"] = control.end
        self._watched = Watched(watch)
        self._loop = _stretch.Loop(
            stretch=self._stretch,
            pace=control.pace.numbers,
            breaks=control.pace.breaks,
            chosen=samples.chosen,
            tableau=stepper.tableau,
            space=stepper.manifold.layout,
            work=stepper.work,
            dense=stepper.dense,
            scales=stepper.scales,
            rtol=stepper.rtol,
            numbers=stepper.numbers,
            search=_stretch.Search(
                nodes=search.nodes,
                ignore=search.ignore,
                limits=search.limits,
                peaks=episodes.peaks,
                turns=episodes.system.turns,
            ),
            trial=search.trial,
            buffers=_stretch.Buffers(
                times=np.zeros(capacity),
                states=np.zeros((capacity, size)),
                memories=np.zeros((capacity, contacts), MEMORY),
                early=np.zeros(capacity, dtype=np.int64),
                instants=np.zeros(ends),
                ends=np.zeros((ends, size)),
                kept=stepper.kept,
                out=np.zeros((2, size)),
            ),
            book=episodes.book,
            sizes=control.sizes.table,
            watched=self._watched.numbers,
        )

    def first(self, h: float, cut: Callable[[float], None]) -> Trial:
        """Make steps until one is due in which something happens, or a while has passed; try that one.

        Args:
            h: Size to begin with [s].
            cut: As for :meth:`Trials.first`.
        """
        reason, made, h = self._go_on(h)
        if made and self._watch:
            self._watch.renew()
        if reason == kernels.TRIAL_STANDS:
            return Trial(True, h)
        if reason == kernels.STEP_DUE:
            return super().first(h, cut)
        return Trial(False, h, tried=False)

    def _budget(self) -> int:
        """How many trial steps may be made in one go."""
        most = self._control.settings.max_steps
        return self._most if most is None else max(1, min(self._most, most - self.made))

    def _go_on(self, h: float) -> tuple[int, int, float]:
        """Make steps; return why they ended, how many they were, and the size to try next [s]."""
        stepper, stretch, episodes, control = self._compiled, self._stretch, self._episodes, self._control
        for name in ("samples", "accepted", "rejected", "relocated", "evaluations"):
            stretch[name] = 0
        stretch["t"], stretch["h"] = stepper.t, h
        stretch["chosen"] = np.searchsorted(self._samples.chosen, stepper.t, side="right")
        stretch["budget"] = self._budget()
        episodes.make_room()
        control.sizes.make_room()
        self._watched.renew()
        loop = self._loop._replace(breaks=control.pace.breaks, book=episodes.book, sizes=control.sizes.table)
        reason = kernels.go_on(loop)
        found = stretch[0]
        stepper.t = float(found["t"])
        stepper.evaluations += int(found["evaluations"])
        stepper.has_dense = reason == kernels.TRIAL_STANDS
        if stepper.has_dense:
            stepper.h = float(found["tried"])
        buffers, count = loop.buffers, int(found["samples"])
        self._samples.extend(
            buffers.times[:count], buffers.states[:count], buffers.memories[:count], buffers.early[:count]
        )
        self.rejected += int(found["rejected"])
        self.relocated += int(found["relocated"])
        self.accepted += int(found["accepted"])
        if self._singular is not None:
            ends = int(found["accepted"])
            self._singular.look_along(buffers.instants[:ends], buffers.ends[:ends])
        return int(reason), int(found["accepted"]), float(found["h"])
