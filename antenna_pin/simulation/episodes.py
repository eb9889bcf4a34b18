"""Contacts from onset to release: what they remember while they last, and what is recorded of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import MEMORY, memory_numbers, memory_records
from antenna_pin.base.state import OpenContact, State
from antenna_pin.contact.onset import approach_speed_in_contact
from antenna_pin.dynamics import Workspace, peak_kernels
from antenna_pin.engine import CompiledStepper
from antenna_pin.engine import episode_kernels as kernels
from antenna_pin.joints.layout_kernels import BRISTLES
from antenna_pin.simulation.samples import Samples

__all__ = ["Episodes", "Kept"]

Array = NDArray[np.float64]

_KEPT = ("memory", "peaks", "open", "moments", "states", "memories")  # of the book, of each contact
_ROOM = 64  # episodes, to begin with
_TOLERANCE = 1e-9  # of the play, that a gap must come to at an event


class Kept(NamedTuple):
    """What the record of contacts can go back to.

    Attributes:
        arrays: What is there once for each contact, by name.
        touching: Numbers of the episodes that lasted.
        episodes: These, EPISODE.
        number: How many episodes there were.
    """

    arrays: Mapping[str, NDArray[Any]]
    touching: NDArray[np.int64]
    episodes: NDArray[Any]
    number: int


class Episodes:
    """The contact memory of a run, and the record of its contacts.

    Args:
        workspace: The memory is its.
        stepper: The states are its.
        samples: Where the states at the largest forces go.
        begin: From when on the run records [s].

    Attributes:
        book: All of it, in numbers.
        peaks: Largest force [N], when [s], largest depth [m] of each contact that touches, PEAK, (contacts,).
    """

    def __init__(
        self, workspace: Workspace, stepper: CompiledStepper, samples: Samples, begin: float
    ) -> None:
        """Begin with nothing that touches."""
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
        """How many contacts there are, touching or not."""
        return len(self.peaks)

    @property
    def all(self) -> NDArray[Any]:
        """Episodes in the order of their onsets, EPISODE; without those that ended before the run began."""
        episodes = self.book.episodes[: int(self.book.count[0])]
        own: NDArray[Any] = episodes[~(episodes["release"] < self.begin)]
        return own

    def make_room(self) -> None:
        """Let there be room for an episode more."""
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
        """Begin a contact that a run starts in, at a depth [m] and its rate [m/s]."""
        self.touch(c, rate)
        floor = self.system.approach_speed_floors[c]
        self.book.memory["approach_speed"][c] = approach_speed_in_contact(depth, rate, floor)

    def close(self) -> None:
        """Complete the record of the contacts that still touch at the end of a run."""
        book = self.book
        for c in range(len(self)):
            kernels.complete(book, c, self.stepper.start)
            if book.moments[c] >= self.begin:
                self.samples.insert(float(book.moments[c]), book.states[c], book.memories[c].copy())
            book.moments[c] = math.nan

    # --- to go back -----------------------------------------------------------------------------------------

    def kept(self) -> Kept:
        """Return what is needed to go back to this record, whatever comes to it."""
        book = self.book
        touching = book.open[book.open >= 0]
        arrays = {name: getattr(book, name).copy() for name in _KEPT}
        return Kept(arrays, touching, book.episodes[touching], int(book.count[0]))

    def go_back(self, kept: Kept) -> None:
        """Hold the record that was held when this was kept."""
        for name, array in kept.arrays.items():
            getattr(self.book, name)[:] = array
        self.book.episodes[kept.touching] = kept.episodes
        self.book.count[0] = kept.number

    def forget_before(self, t: float) -> None:
        """Record from a time on [s]; what was kept before is of no use any more."""
        self.begin = t
        book, count = self.book, int(self.book.count[0])
        mine = ~(book.episodes["release"][:count] < t)
        numbers = np.cumsum(mine) - 1
        left = int(mine.sum())
        book.episodes[:left] = book.episodes[:count][mine]
        book.open[book.open >= 0] = numbers[book.open[book.open >= 0]]
        book.count[0] = left

    # --- as a value -----------------------------------------------------------------------------------------

    def take_up(self, state: State) -> None:
        """Go on with the contacts that touch in a state that a run left."""
        self.book.memory[:] = memory_records(state.memory)
        for one in state.contacts:
            self.make_room()
            book, c = self.book, one.contact
            number = int(book.count[0])
            episode = book.episodes[number]
            for name in ("contact", "onset", "approach_speed", "effective_mass", "impulse", "dissipated"):
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
        """Return the contacts that touch, as a state holds them."""
        contacts, book = [], self.book
        for c in np.flatnonzero(book.open >= 0).tolist():
            episode = book.episodes[book.open[c]]
            names = ("onset", "approach_speed", "effective_mass", "impulse", "dissipated")
            kept = not math.isnan(book.moments[c])
            contacts.append(
                OpenContact(
                    contact=c,
                    **{name: float(episode[name]) for name in names},
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
        """Go on with the whole record of another."""
        for name in _KEPT:
            getattr(self.book, name)[:] = numbers[name]
        count = len(numbers["episodes"])
        grown = np.zeros(max(2 * count, _ROOM), kernels.EPISODE)
        grown[:count] = numbers["episodes"]
        self.book.count[0] = count
        self.book = self.book._replace(episodes=grown)
