"""Who makes the runs of a fit and remembers what they came to, in memory and on the disk."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from antenna_pin.fit.equation import with_slopes
from antenna_pin.fit.notebook import Notebook
from antenna_pin.fit.plan import FitPlan
from antenna_pin.fit.runs import Asked, Readings, Rig, make, nothing
from antenna_pin.sweep import Executor, Here
from antenna_pin.sweep.here import Lost

__all__ = ["Laboratory"]


# --- what an executor calls to have the runs of a fit made ---


def make_all(rigs: tuple[Rig, ...], batch: list[Asked]) -> list[tuple[Readings, ...]]:
    """Make what is asked for, one after the other."""
    return [(with_slopes if one.slopes else make)(rigs[one.record], one) for one in batch]


_REMEMBERED = 512  # answers that stay in memory


class Laboratory:
    """Makes runs that have not been made yet.

    A search that was interrupted asks, begun anew, for the same runs in the same order; what stands in the
    notebook is not run again, so that it goes on bit for bit as if it had never stopped.

    Args:
        executor: Who makes them: this process if left out, or a cluster.
        notebook: What was made before and what is made, on the disk; none if left out.
        progress: Called after each run with how many there are.
    """

    def __init__(
        self,
        executor: Executor | None = None,
        notebook: Notebook | None = None,
        progress: Callable[[int], None] | None = None,
    ) -> None:
        """Begin without rigs."""
        self.executor, self.notebook, self.progress = executor or Here(), notebook, progress
        self.made = 0
        #: How the energy or momentum of runs does not balance, in words, one entry a run.
        self.unbalanced: list[str] = []
        #: Why runs could not be made, one entry a run; those that derivatives were asked of do not count.
        self.failed: list[str] = []
        self._rigs: tuple[Rig, ...] = ()
        self._known: dict[Asked, tuple[Readings, ...]] = {}

    def take(self, plan: FitPlan, rigs: tuple[Rig, ...]) -> None:
        """Take up the tests that runs are asked of.

        Raises:
            OutputError: The notebook is of another fit.
        """
        self._rigs = rigs
        if self.notebook is not None:
            self.notebook.open(plan, rigs)

    def readings(self, asked: Sequence[Asked]) -> list[tuple[Readings, ...]]:
        """Return what each run's sensors read; those not known are made, side by side if there are hands.

        Raises:
            KeyboardInterrupt: It was interrupted; what was made is kept.
        """
        missing = [one for one in dict.fromkeys(asked) if one not in self._known]
        found: dict[Asked, tuple[Readings, ...]] = {}
        for one in list(missing):
            old = None if self.notebook is None else self.notebook.read(one)
            if old is not None:
                found[one] = old
                self.made += len(old)
                missing.remove(one)
        if missing:
            self.executor.start()
        batches: Iterator[list[Asked]] = ([one] for one in missing)
        for (one,), answer in self.executor.each(make_all, self._rigs, batches):
            lost = isinstance(answer, Lost)
            found[one] = tuple(nothing(str(answer)) for _ in one.starts) if lost else answer[0]
            self.made += len(one.starts)
            if self.notebook is not None:
                self.notebook.write(one, found[one])
            if self.progress is not None:
                self.progress(self.made)
        self.unbalanced += [one.unbalanced for made in found.values() for one in made if one.unbalanced]
        self.failed += [
            one.failed for key, made in found.items() if not key.slopes for one in made if one.failed
        ]
        self._known |= found
        answers = [self._known[one] for one in asked]
        for one in list(self._known)[: max(0, len(self._known) - _REMEMBERED)]:
            del self._known[one]
        return answers

    def said_of_unbalanced(self, last: Sequence[Readings]) -> list[str]:
        """Return a line if the energy or momentum of runs does not balance.

        Args:
            last: Of the runs with the fitted values.
        """
        if not self.unbalanced:
            return []
        mine = [one.unbalanced for one in last if one.unbalanced]
        which = "those with the fitted values among them" if mine else "none with the fitted values"
        return [
            f"note: the energy or momentum of {len(self.unbalanced)} of {self.made} runs does not balance, "
            f"{which}: {[*mine, *self.unbalanced][0]}"
        ]
