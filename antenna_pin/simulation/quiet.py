"""Steps that nothing interrupts, made in one compiled loop; what they come to goes into the run's record."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace
from antenna_pin.engine import Compiled, CompiledStepper
from antenna_pin.engine import _loop_kernels as _kernels
from antenna_pin.integrate import Method, Stepper
from antenna_pin.settings import RunSettings
from antenna_pin.simulation.control import StepControl
from antenna_pin.simulation.episodes import Episodes
from antenna_pin.simulation.samples import Samples
from antenna_pin.simulation.search import ContactSearch
from antenna_pin.simulation.singular import Singularities
from antenna_pin.simulation.trials import Trial, Trials

__all__ = ["QuietTrials", "stepper_of"]

Array = NDArray[np.float64]

_BUDGET = 256  # steps from one look at the clock, at Ctrl-C and at limits to the next
_CAPACITY = 256  # samples


def stepper_of(workspace: Workspace, method: Method, scales: Array, settings: RunSettings) -> Stepper:
    """Return the stepper of an engine.

    Raises:
        MechanismError: The system is not one that the compiled engine can take.
    """
    if settings.engine == "compiled":
        return CompiledStepper(workspace, Compiled(workspace), method, scales, settings.rtol)
    return Stepper(workspace, method, scales, settings.rtol)


class QuietTrials(Trials):
    """Trials of a compiled run: the steps in which nothing happens are made before the first that is tried.

    Args:
        stepper: What makes them.
        control: How long they are.
        samples: Where output goes.
        episodes: The contacts' record.
        search: The contacts' search, whose findings these are.
        singular: What looks at each step's end; None where nothing is held.
    """

    def __init__(
        self,
        stepper: CompiledStepper,
        control: StepControl,
        samples: Samples,
        episodes: Episodes,
        search: ContactSearch,
        singular: Singularities | None,
    ) -> None:
        """Allocate once."""
        super().__init__(stepper, control)
        self._compiled = stepper
        self._singular = singular
        self._samples, self._episodes = samples, episodes
        size, contacts = stepper.manifold.size, len(episodes)
        self._buffers = _kernels.Buffers(
            times=np.zeros(_CAPACITY),
            states=np.zeros((_CAPACITY, size)),
            moments=np.full(contacts, np.nan),
            peaks=np.zeros((contacts, size)),
            instants=np.zeros(0 if singular is None else _BUDGET),
            ends=np.zeros((0 if singular is None else _BUDGET, size)),
            kept=stepper.kept,
            out=np.zeros((2, size)),
        )
        self._search = _kernels.Search(
            nodes=search.nodes,
            ignore=search.ignore,
            limits=search.limits,
            peaks=episodes.peaks,
            turns=episodes.system.turns,
        )
        self._trial = search.trial
        self._stretch = np.zeros(1, _kernels.STRETCH)
        self._stretch["rate"], self._stretch["begin"] = samples.rate, samples.begin
        self._stretch["end"] = control.end

    def first(self, h: float, cut: Callable[[float], None]) -> Trial:
        """Make steps until one is due in which something happens, or a while has passed; try that one.

        Args:
            h: Size to begin with [s].
            cut: As for :meth:`Trials.first`.
        """
        reason, made, h = self._go_on(h)
        if reason == _kernels.TRIAL_STANDS:
            return Trial(True, h, made=made)
        if reason == _kernels.STEP_DUE:
            return super().first(h, cut)._replace(made=made)
        return Trial(False, h, made=made, tried=False)

    def _go_on(self, h: float) -> tuple[int, int, float]:
        """Make steps; return why they ended, how many they were, and the size to try next [s]."""
        stepper, stretch, buffers = self._compiled, self._stretch, self._buffers
        for name in ("samples", "accepted", "rejected", "evaluations"):
            stretch[name] = 0
        most = self._control.settings.max_steps
        stretch["t"], stretch["h"] = stepper.t, h
        stretch["budget"] = _BUDGET if most is None else 1
        reason = _kernels.go_on(
            stretch,
            self._control.pace.numbers,
            self._control.pace.breaks,
            stepper.tableau,
            stepper.manifold.layout,
            stepper.work,
            stepper.dense,
            stepper.scales,
            stepper.rtol,
            stepper.numbers,
            self._search,
            self._trial,
            buffers,
        )
        found = stretch[0]
        stepper.t = float(found["t"])
        stepper.evaluations += int(found["evaluations"])
        stepper.has_dense = reason == _kernels.TRIAL_STANDS
        if stepper.has_dense:
            stepper.h = float(found["tried"])
        count = int(found["samples"])
        self._samples.extend(buffers.times[:count], buffers.states[:count])
        self._episodes.keep(buffers.moments, buffers.peaks)
        self.rejected += int(found["rejected"])
        if self._singular is not None:
            for k in range(int(found["accepted"])):
                self._singular.look(float(buffers.instants[k]), buffers.ends[k])
        return int(reason), int(found["accepted"]), float(found["h"])
