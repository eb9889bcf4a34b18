"""Contact episodes from onset to release, and the search of steps for changes of contact."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import MEMORY, memory_numbers, memory_records
from antenna_pin.base.state import OpenContact, State
from antenna_pin.contact.onset import approach_speed_in_contact
from antenna_pin.dynamics import Workspace, inspect_kernels, peak_kernels, trial_kernels
from antenna_pin.joints.layout_kernels import BRISTLES
from antenna_pin.run.engine import CompiledStepper
from antenna_pin.run.engine import episode_kernels as kernels
from antenna_pin.run.simulation.samples import Samples

Array = NDArray[np.float64]

# --- contact episodes ---------------------------------------------------------------------------------------

_KEPT = ("memory", "peaks", "open", "moments", "states", "memories")  # of the book, of each contact
_STORED = ("onset", "approach_speed", "effective_mass", "impulse", "dissipated")  # of an open episode
_ROOM = 64  # episodes, to begin with
_TOLERANCE = 1e-9  # of the play, that a gap must come to at an event


class EpisodesSnapshot(NamedTuple):
    """Snapshot of the record of contacts."""

    arrays: Mapping[str, NDArray[Any]]  # arrays with one row per contact, by name
    touching: NDArray[np.int64]  # numbers of the open episodes
    episodes: NDArray[Any]  # open episodes, EPISODE
    number: int  # number of episodes


class Episodes:
    """Contact memory of a run, and the record of its contacts.

    Args:
        samples: Samples of the run, to which the states at peak forces are added.

    Attributes:
        book: Contact memory and record, as arrays for kernels.
        peaks: Largest force [N], when [s], largest depth [m] of each contact that touches, PEAK, (contacts,).
    """

    def __init__(
        self, workspace: Workspace, stepper: CompiledStepper, samples: Samples, begin: float
    ) -> None:
        """Begin without contact."""
        self.system = system = workspace.system
        self.stepper = stepper
        self.samples = samples
        self.begin = begin
        contacts = len(system.contact_names)
        self.peaks = np.zeros(contacts, peak_kernels.PEAK)
        first = system.model.nq + system.model.nv
        places = np.zeros(contacts, kernels.PLACES)
        places["impulse"] = first + system.impulse_x
        places["lost_normal"] = first + system.lost_normal_x
        places["lost_friction"] = first + system.lost_friction_x
        places["bristle"] = places["impulse"] + BRISTLES
        places["bristles"] = [j.stride - BRISTLES for j in system.clearances for _ in j.contact_names]
        places["floor"] = system.approach_speed_floors
        plays = [j.geometry.radial_clearance for j in system.clearances for _ in j.contact_names]
        places["tolerance"] = _TOLERANCE * np.array(plays)
        self.book = kernels.Book(
            memory=workspace.memory,
            peaks=self.peaks,
            open=np.full(contacts, -1),
            moments=np.full(contacts, math.nan),
            states=np.zeros((contacts, system.manifold.size)),
            memories=np.zeros((contacts, contacts), MEMORY),
            places=places,
            episodes=np.zeros(_ROOM, kernels.EPISODE),
            count=np.zeros(1, dtype=np.int64),
        )

    def __len__(self) -> int:
        """Return the number of contacts, touching or not."""
        return len(self.peaks)

    @property
    def all(self) -> NDArray[Any]:
        """Episodes of this record in the order of their onsets, EPISODE."""
        episodes: NDArray[Any] = self.book.episodes[: int(self.book.count[0])]
        return np.asarray(episodes[~(episodes["release"] < self.begin)])

    def make_room(self) -> None:
        """Enlarge the record for one more episode, if needed."""
        if int(self.book.count[0]) < len(self.book.episodes):
            return
        grown = np.zeros(2 * len(self.book.episodes), kernels.EPISODE)
        grown[: len(self.book.episodes)] = self.book.episodes
        self.book = self.book._replace(episodes=grown)

    def touch(self, c: int, rate: float) -> None:
        """Begin a contact at the present state, at a depth rate [m/s]."""
        self.make_room()
        y = self.stepper.start[: self.system.manifold.size]
        mass = float(kernels.effective_mass(c, y, self.stepper.numbers))
        self.stepper.answers.check()
        kernels.touch(self.book, c, self.stepper.t, rate, mass, self.stepper.start)

    def touch_at_start(self, c: int, depth: float, rate: float) -> None:
        """Begin a contact of the initial state, at a depth [m] and its rate [m/s]."""
        self.touch(c, rate)
        floor = self.system.approach_speed_floors[c]
        self.book.memory[c]["approach_speed"] = approach_speed_in_contact(depth, rate, floor)

    def close(self) -> None:
        """Complete the record of the contacts that touch at the end of a run."""
        book = self.book
        for c in range(len(self)):
            kernels.complete(book, c, self.stepper.start)
            if book.moments[c] >= self.begin:
                self.samples.insert(float(book.moments[c]), book.states[c], book.memories[c].copy())
            book.moments[c] = math.nan

    # --- snapshots ------------------------------------------------------------------------------------------

    def snapshot(self) -> EpisodesSnapshot:
        """Return a snapshot of the record, to be restored later."""
        book = self.book
        touching = book.open[book.open >= 0]
        arrays = {name: getattr(book, name).copy() for name in _KEPT}
        return EpisodesSnapshot(arrays, touching, book.episodes[touching], int(book.count[0]))

    def restore(self, snapshot: EpisodesSnapshot) -> None:
        """Restore the record of a snapshot."""
        for name, array in snapshot.arrays.items():
            getattr(self.book, name)[:] = array
        self.book.episodes[snapshot.touching] = snapshot.episodes
        self.book.count[0] = snapshot.number

    def forget_before(self, t: float) -> None:
        """Record from a time on [s]; earlier snapshots become invalid."""
        self.begin = t
        book, count = self.book, int(self.book.count[0])
        episodes: NDArray[Any] = book.episodes
        mine = ~(episodes["release"][:count] < t)
        numbers = np.cumsum(mine) - 1
        left = int(mine.sum())
        book.episodes[:left] = book.episodes[:count][mine]
        book.open[book.open >= 0] = numbers[book.open[book.open >= 0]]
        book.count[0] = left

    # --- as a value -----------------------------------------------------------------------------------------

    def take_up(self, state: State) -> None:
        """Continue with the contacts that touch in a state left by a run."""
        self.book.memory[:] = memory_records(state.memory)
        for one in state.contacts:
            self.make_room()
            book, c = self.book, one.contact
            number = int(book.count[0])
            episode = book.episodes[number]
            for name in ("contact", *_STORED):
                episode[name] = getattr(one, name)
            episode["release"] = episode["peak_time"] = math.nan
            book.open[c] = number
            book.count[0] = number + 1
            self.peaks[c] = one.peak
            if one.peak_state.size:
                book.moments[c] = one.peak[1]
                book.states[c] = one.peak_state
                book.memories[c] = memory_records(one.peak_memory)

    def value(self) -> tuple[OpenContact, ...]:
        """Return the contacts that touch, as a state stores them."""
        contacts, book = [], self.book
        for c in np.flatnonzero(book.open >= 0).tolist():
            episode = book.episodes[book.open[c]]
            kept = not math.isnan(book.moments[c])
            contacts.append(
                OpenContact(
                    contact=c,
                    **{name: float(episode[name]) for name in _STORED},
                    peak=self.peaks[c].item(),
                    peak_state=book.states[c].copy() if kept else np.zeros(0),
                    peak_memory=memory_numbers(book.memories[c]) if kept else np.zeros((0, 3)),
                )
            )
        return tuple(contacts)

    def numbers(self) -> dict[str, NDArray[Any]]:
        """Return the whole record as arrays."""
        book = self.book
        count = int(book.count[0])
        return {name: getattr(book, name) for name in _KEPT} | {"episodes": book.episodes[:count]}

    def take_up_all(self, numbers: Mapping[str, NDArray[Any]]) -> None:
        """Continue with the whole record of another run.

        Raises:
            ValueError: Contacts or episodes of the arrays do not exist.
        """
        number, contact = numbers["open"], numbers["episodes"]["contact"]
        if (number >= len(contact)).any() or (contact < 0).any() or (contact >= len(self)).any():
            raise ValueError(f"{len(contact)} episodes of {len(self)} contacts, and others")
        for name in _KEPT:
            getattr(self.book, name)[:] = numbers[name]
        count = len(numbers["episodes"])
        grown = np.zeros(max(2 * count, _ROOM), kernels.EPISODE)
        grown[:count] = numbers["episodes"]
        self.book.count[0] = count
        self.book = self.book._replace(episodes=grown)


# --- search of trial steps ----------------------------------------------------------------------------------


class ContactSearch:
    """Search of trial steps for changes of contact.

    Attributes:
        ignore: Changes of each contact at the present time, (contacts,).
        limits: Depths at which a run ends, (contacts,) [m].
        trial: Arrays for the search of a trial step.
        compared: Contacts whose gaps coal measures, as 1, (contacts,); of none: (0,).
        difference: Largest difference so far of such a gap and the closed form, (1,) [m].
    """

    def __init__(self, workspace: Workspace, stepper: CompiledStepper, episodes: Episodes) -> None:
        """Allocate once."""
        self.system = system = workspace.system
        self._workspace = workspace
        self._stepper = stepper
        contacts = len(system.contact_names)
        manifold, numbers = system.manifold, stepper.numbers
        self.ignore = np.zeros(contacts, dtype=np.int64)
        self.table = numbers.table
        self.nodes = np.zeros((inspect_kernels.NODE_SIZE, peak_kernels.NODES + 1, contacts))
        self.limits = np.array([limit for j in system.clearances for limit in j.depth_limits])
        self.reasons = [reason for j in system.clearances for reason in j.limit_reasons]
        self.tolerances = [one["tolerance"].item() for one in episodes.book.places]
        of_coal = [int(j.backend == "coal") for j in system.clearances for _ in j.contact_names]
        self.compared = np.array(of_coal if any(of_coal) else [], dtype=np.int64)
        self.difference = np.zeros(1)
        factors = [system.mechanism.joint(j.name).joint_id - 1 for j in system.clearances]
        self.trial = trial_kernels.TrialStep(
            layout=manifold.part(factors),
            dense=stepper.dense,
            work=stepper.work,
            start=stepper.start_row,
            program=workspace.program,
            memory=workspace.memory,
            out=np.zeros((2, manifold.size)),
            pose=numbers.pose,
            table=numbers.table,
            own=numbers.own,
            rates=np.zeros(manifold.nv + manifold.nx),
            outside=numbers.outside,
        )

    def measure(self, y: Array) -> None:
        """Evaluate the contact table for a state, by the geometry that locates changes."""
        self._workspace.locate(y, self.table)

    def depth_text(self, c: int) -> str:
        """Return depth and limit of a contact at the present state, as text."""
        self.measure(self._stepper.start)
        depth, limit = -float(self.table[c].gap), self.limits[c]
        name = self.system.contact_names[c]
        return f"contact {name} ({depth:.3g} m, limit {limit:.3g} m: {self.reasons[c]})"
