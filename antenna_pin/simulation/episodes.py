"""Contacts from onset to release: what they remember while they last, and what is recorded of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Workspace, _inspect
from antenna_pin.integrate import Stepper
from antenna_pin.joints._layout_kernels import BRISTLES
from antenna_pin.records import memory_numbers, memory_records
from antenna_pin.simulation.samples import Samples
from antenna_pin.state import OpenContact, State

__all__ = ["Episode", "Episodes"]

Array = NDArray[np.float64]


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


class Episodes:
    """The contact memory of a run, and the record of its contacts.

    Args:
        workspace: The memory is its.
        stepper: The states are its.
        samples: Where the states at the largest forces go.
        begin: From when on the run records [s].

    Attributes:
        all: Episodes in the order of their onsets.
        peaks: Largest force [N], when [s], largest depth [m] of each contact that touches, PEAK, (contacts,).
    """

    def __init__(self, workspace: Workspace, stepper: Stepper, samples: Samples, begin: float) -> None:
        """Begin with nothing that touches."""
        self.system = system = workspace.system
        self.workspace = workspace
        self.stepper = stepper
        self.samples = samples
        self.begin = begin
        contacts = len(system.contact_names)
        self.all: list[Episode] = []
        self.peaks = np.zeros(contacts, _inspect.PEAK)
        self._open: list[Episode | None] = [None] * contacts
        self._at_peaks: list[tuple[float, Array, Array] | None] = [None] * contacts
        self._floors = system.approach_speed_floors
        self._bristles = [j.stride - BRISTLES for j in system.clearances for _ in j.contact_names]

    def __len__(self) -> int:
        """How many contacts there are, touching or not."""
        return len(self._open)

    @property
    def pattern(self) -> bytes:
        """Which contacts touch."""
        return self.workspace.memory["touching"].tobytes()

    def flip(self, c: int, rate: float) -> None:
        """Let a contact touch, at a depth rate [m/s], or part."""
        if self.workspace.memory[c].touching != 0.0:
            self.release(c)
        else:
            self.touch(c, rate)

    def touch(self, c: int, rate: float) -> None:
        """Begin a contact."""
        speed = max(rate, self._floors[c])
        mass = self.workspace.effective_mass(self.stepper.start[: self.system.manifold.size], c)
        self.workspace.memory[c] = 1.0, speed, mass
        episode = Episode(contact=c, onset=self.stepper.t, approach_speed=speed, effective_mass=mass)
        self.peaks[c] = (0.0, self.stepper.t, 0.0)
        x = self.stepper.start[self.system.model.nq + self.system.model.nv :]
        # What the contact has integrated before; taken off at its end.
        episode.impulse = -float(x[self.system.impulse_x[c]])
        episode.dissipated = -self._lost(c, x)
        self._open[c] = episode
        self.all.append(episode)
        # A new contact has new bristles.
        first = len(self.stepper.start) - len(x) + int(self.system.impulse_x[c]) + BRISTLES
        self.stepper.start[first : first + self._bristles[c]] = 0.0

    def release(self, c: int) -> None:
        """End a contact."""
        self.workspace.memory[c] = 0.0, 0.0, 0.0
        self._close(c)
        episode = self._open[c]
        if episode is not None:
            episode.release = self.stepper.t
            if episode.release < self.begin:  # it is the run's that was before
                self.all.remove(episode)
        self._open[c] = None

    def close(self) -> None:
        """Complete the record of the contacts that still touch at the end of a run."""
        for c in range(len(self)):
            self._close(c)

    def _close(self, c: int) -> None:
        episode = self._open[c]
        if episode is None:
            return
        x = self.stepper.start[self.system.model.nq + self.system.model.nv :]
        episode.peak_force, episode.peak_time, episode.peak_depth = self.peaks[c].item()
        peak = self._at_peaks[c]
        if peak is not None and peak[0] >= self.begin:
            self.samples.insert(*peak)
            self._at_peaks[c] = None
        episode.impulse += float(x[self.system.impulse_x[c]])
        episode.dissipated += self._lost(c, x)

    def _lost(self, c: int, x: Array) -> float:
        return float(x[self.system.lost_normal_x[c]] + x[self.system.lost_friction_x[c]])

    def keep_peaks(self) -> None:
        """Keep the state at the largest force so far of each touching contact, to sample it at the end."""
        t, h = self.stepper.t, self.stepper.h
        for c, episode in enumerate(self._open):
            if episode is None:
                continue
            moment = float(self.peaks[c].time)
            kept = self._at_peaks[c]
            if t < moment <= t + h and (kept is None or kept[0] != moment):
                state = np.empty(self.system.manifold.size)
                self.stepper.interpolate((moment - t) / h, state)
                self._at_peaks[c] = (moment, state, self.workspace.memory.copy())

    def keep(self, moments: Array, states: Array) -> None:
        """Keep the states at the largest forces so far that compiled steps have kept.

        Args:
            moments: When, of each contact; not-a-number for none, (contacts,) [s].
            states: [q, v, x] there, (contacts, size); copied.
        """
        for c, episode in enumerate(self._open):
            kept, moment = self._at_peaks[c], float(moments[c])
            if episode is not None and moment == float(self.peaks[c].time):
                if kept is None or kept[0] != moment:
                    self._at_peaks[c] = (moment, states[c].copy(), self.workspace.memory.copy())

    # --- as a value -----------------------------------------------------------------------------------------

    def take_up(self, state: State) -> None:
        """Go on with the contacts that touch in a state that a run left."""
        self.workspace.memory[:] = memory_records(state.memory)
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
            self.all.append(episode)
            self.peaks[one.contact] = one.peak
            if one.peak_state.size:
                kept = memory_records(one.peak_memory)
                self._at_peaks[one.contact] = (one.peak[1], one.peak_state.copy(), kept)

    def value(self) -> tuple[OpenContact, ...]:
        """Return the contacts that touch, as a state holds them."""
        contacts = []
        for c, episode in enumerate(self._open):
            if episode is None:
                continue
            kept = self._at_peaks[c]
            contacts.append(
                OpenContact(
                    contact=c,
                    onset=episode.onset,
                    approach_speed=episode.approach_speed,
                    effective_mass=episode.effective_mass,
                    impulse=episode.impulse,
                    dissipated=episode.dissipated,
                    peak=self.peaks[c].item(),
                    peak_state=np.zeros(0) if kept is None else kept[1].copy(),
                    peak_memory=np.zeros((0, 3)) if kept is None else memory_numbers(kept[2]),
                )
            )
        return tuple(contacts)
