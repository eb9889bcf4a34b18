"""The search of a trial step for contacts that change, and for the largest forces."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from antenna_pin.dynamics import Workspace, inspect_kernels, peak_kernels, trial_kernels
from antenna_pin.integrate import Stepper
from antenna_pin.joints import LawInRun
from antenna_pin.records import POSE
from antenna_pin.simulation.episodes import Episodes
from antenna_pin.simulation.measured import POINTS, Found, Measured

__all__ = ["ContactSearch"]

Array = NDArray[np.float64]


class ContactSearch:
    """Looks at the contacts inside trial steps.

    Args:
        workspace: What the run works on.
        stepper: Whose steps.
        episodes: The contacts' record.

    Attributes:
        ignore: Of each contact, how often it has changed at this very instant, (contacts,).
        gap_difference: Largest difference so far between coal's gaps and the closed form [m].
    """

    def __init__(self, workspace: Workspace, stepper: Stepper, episodes: Episodes) -> None:
        """Allocate once."""
        self.system = system = workspace.system
        self.workspace = workspace
        self.stepper = stepper
        self.episodes = episodes
        contacts = len(system.contact_names)
        manifold = system.manifold
        self.ignore = np.zeros(contacts, dtype=np.int64)
        self.gap_difference = 0.0
        self.table = np.zeros_like(workspace.table)
        self._pose = np.zeros(1, POSE)
        self.nodes = np.zeros((inspect_kernels.NODE_SIZE, peak_kernels.NODES + 1, contacts))
        self.limits = np.array([limit for j in system.clearances for limit in j.depth_limits])
        self.reasons = [reason for j in system.clearances for reason in j.limit_reasons]
        self.tolerances = episodes.book.places["tolerance"].tolist()
        self.uses_coal = any(j.backend == "coal" for j in system.clearances)
        factors = [system.mechanism.joint(j.name).joint_id - 1 for j in system.clearances]
        self.trial = trial_kernels.Trial(
            layout=manifold.part(factors, plain=system.bristle_x.size > 0),
            dense=stepper.dense,
            work=stepper.work,
            start=stepper.start_row,
            program=workspace.program,
            memory=workspace.memory,
            out=np.zeros((2, manifold.size)),
            pose=self._pose,
            table=self.table,
            rates=np.zeros(manifold.nv + manifold.nx),
            measured=np.zeros(contacts, dtype=np.int64),
        )
        self._measured = Measured(workspace, stepper, self.table)
        self.trial.measured[list(self._measured.contacts)] = 1
        # Laws written in Python or on gaps that a backend measures, by the row of their contact: the compiled
        # inspection cannot evaluate them.
        self._python_laws = [
            (r, law)
            for path in workspace.paths
            if path.measured or not path.compiled
            for r, law in enumerate(path.laws, path.row)
        ]

    def measure(self, y: Array) -> None:
        """Fill the search's own contact table for a state, by what locates changes of contact."""
        self.workspace.locate(y, self.table)

    def first(self, until: float = 2.0) -> Found:
        """Return what happens first in the trial step, before the fraction ``until`` of it.

        The step's dense output must be there. If nothing happens at all the contacts' record is brought up to
        its end.
        """
        stepper = self.stepper
        measured = self._measured.first(until, self.ignore, self.limits)
        found = Found(
            *inspect_kernels.inspect_step(
                stepper.t,
                stepper.h,
                measured.theta,
                self.nodes,
                self.ignore,
                self.limits,
                self.episodes.peaks,
                self.trial,
                False,
            )
        )
        if found.contact < 0 and measured.theta > 1.0:
            self._track_in_python()
        return measured if found.contact < 0 else found

    def track(self) -> None:
        """Bring the contacts' record up to the end of a trial step in which none changes."""
        stepper = self.stepper
        inspect_kernels.fill_nodes(self.nodes, self.trial, False)
        peak_kernels.track_peaks(stepper.t, stepper.h, self.nodes, self.episodes.peaks, self.trial)
        self._track_in_python()

    def _track_in_python(self) -> None:
        """Raise the largest force of contacts that are asked in Python to the maximum of the dense output."""
        self._measured.track_depths(self.episodes.peaks)
        t, h = self.stepper.t, self.stepper.h
        memory, peaks = self.workspace.memory, self.episodes.peaks
        for c, law in self._python_laws:
            if memory[c].touching == 0.0:
                continue
            _, *onset = memory[c].tolist()

            def lack(theta: float, c: int = c, law: LawInRun = law, onset: Sequence[float] = onset) -> float:
                if self.trial.measured[c]:
                    self._measured.at(theta, c)
                else:
                    trial_kernels.contacts_at(theta, self.trial, c)
                depth = -float(self.table[c].gap)
                return -law.forces(depth, self.table[c].rate, *onset)[1] if depth > 0.0 else 0.0

            values = [lack(theta) for theta in POINTS]
            best = int(np.argmin(values))
            theta, value = POINTS[best], values[best]
            if -value > 0.95 * peaks[c].force:
                found = minimize_scalar(
                    lack,
                    bounds=(POINTS[max(best - 1, 0)], POINTS[min(best + 1, peak_kernels.NODES)]),
                    method="bounded",
                    options={"xatol": 1e-6},
                )
                if found.fun < value:
                    theta, value = float(found.x), float(found.fun)
            if -value > peaks[c].force:
                peaks[c].force = -value
                peaks[c].time = t + theta * h

    def lack(self, c: int, target: float = 0.0) -> Callable[[], float]:
        """Return a function that tells how much longer the trial step should be [s].

        It should end where the gap of contact c is the target's [m]; zero if it does, or if the gap rests.
        """

        def correction() -> float:
            self.measure(self.stepper.y)
            gap, rate = float(self.table[c].gap) - target, float(self.table[c].rate)
            return 0.0 if abs(gap) <= self.tolerances[c] or rate == 0.0 else gap / rate

        return correction

    def words(self, c: int) -> str:
        """Return how deep a contact is at the present state, and how deep it may be."""
        self.measure(self.stepper.start)
        depth, limit = -float(self.table[c].gap), self.limits[c]
        name = self.system.contact_names[c]
        return f"contact {name} ({depth:.3g} m, limit {limit:.3g} m: {self.reasons[c]})"

    def compare_gaps(self) -> None:
        """Record how far coal's gaps are from the closed form at the end of the trial step."""
        if not self.uses_coal:
            return
        self.workspace.measure(self.stepper.y)
        self.measure(self.stepper.y)
        contacts = len(self.episodes)
        difference = np.abs(self.table["gap"][:contacts] - self.workspace.table["gap"][:contacts]).max()
        if difference > self.gap_difference:
            self.gap_difference = float(difference)
