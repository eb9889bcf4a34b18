"""Contacts from onset to release, compiled: discrete state and episode records."""

from __future__ import annotations

import math
from typing import NamedTuple

from numpy.typing import NDArray

from antenna_pin.base.records import Floats, Ints, Memory, Record, Records, layout
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import kernel
from antenna_pin.dynamics.kernels import HEADER, block_at, head_of
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.dynamics.peak_kernels import Peak
from antenna_pin.dynamics.trial_kernels import locate
from antenna_pin.integrate.kernels import STATE_ROW, dense_state
from antenna_pin.joints.kernels import unit_normal_force
from antenna_pin.joints.layout_kernels import CLEARANCE, joint_at
from antenna_pin.joints.pose_kernels import journal_state
from antenna_pin.run.engine.step_kernels import accelerate


class Episode(Record):
    """Contact from onset to release."""

    contact: int  # index
    onset: float  # [s]
    approach_speed: float  # at the onset [m/s]
    effective_mass: float  # at the onset [kg]
    release: float  # [s]; not-a-number while it lasts
    peak_force: float  # [N]
    peak_time: float  # of the largest force [s]
    peak_depth: float  # [m]
    impulse: float  # of the normal force [N s]
    dissipated: float  # [J]


EPISODE = layout(Episode)


class Places(Record):
    """Places of a contact's numbers in a state, and its limits."""

    impulse: int  # place in y
    lost_normal: int  # place in y
    lost_friction: int  # place in y
    bristle: int  # place of the first in y
    bristles: int  # how many
    floor: float  # least stored approach speed [m/s]
    tolerance: float  # permitted error of its gap at an event [m]


PLACES = layout(Places)


@by_address
class Book(NamedTuple):
    """Contacts of a run, and their episode records.

    Attributes:
        memory: The contact memory, MEMORY, (contacts,).
        peaks: Largest force, its time, and largest depth of each touching contact, PEAK, (contacts,).
        open: Number of its episode in ``episodes``, -1 for none, (contacts,).
        moments: Time of the largest force so far, at the stored state; NaN for none, (contacts,) [s].
        states: [q, v, x] there, (contacts, size).
        memories: Contact memory there, MEMORY, (contacts, contacts).
        places: PLACES, (contacts,).
        episodes: EPISODE, (capacity,).
        count: Number of episodes, (1,).
    """

    memory: Records[Memory]
    peaks: Records[Peak]
    open: Ints
    moments: Floats
    states: Floats
    memories: NDArray[Memory]
    places: Records[Places]
    episodes: Records[Episode]
    count: Ints  # type: ignore[assignment]  # hides a method of tuples


@kernel
def touch(book: Book, c: int, t: float, rate: float, mass: float, y: Floats) -> None:
    """Begin a contact at t [s] with a depth rate [m/s] and effective mass [kg]."""
    place, memory, peak = book.places[c], book.memory[c], book.peaks[c]
    memory.touching = 1.0
    memory.approach_speed = max(rate, place.floor)
    memory.effective_mass = mass
    peak.force = 0.0
    peak.time = t
    peak.depth = 0.0
    number = book.count[0]
    book.count[0] = number + 1
    book.open[c] = number
    book.moments[c] = math.nan
    episode = book.episodes[number]
    episode.contact = c
    episode.onset = t
    episode.approach_speed = memory.approach_speed
    episode.effective_mass = mass
    episode.release = math.nan
    episode.peak_force = 0.0
    episode.peak_time = math.nan
    episode.peak_depth = 0.0
    # Integrals of the contact before the episode; subtracted at its end.
    episode.impulse = -y[place.impulse]
    episode.dissipated = -(y[place.lost_normal] + y[place.lost_friction])
    # A new contact has new bristles.
    for k in range(place.bristle, place.bristle + place.bristles):
        y[k] = 0.0


@kernel
def complete(book: Book, c: int, y: Floats) -> None:
    """Update a contact's episode, if any, by the state y."""
    number = book.open[c]
    if number < 0:
        return
    place, peak, episode = book.places[c], book.peaks[c], book.episodes[number]
    episode.peak_force = peak.force
    episode.peak_time = peak.time
    episode.peak_depth = peak.depth
    episode.impulse += y[place.impulse]
    episode.dissipated += y[place.lost_normal] + y[place.lost_friction]


@kernel
def release(book: Book, c: int, t: float, y: Floats) -> None:
    """End a contact at t [s] and y; its pending peak remains for sampling."""
    memory = book.memory[c]
    memory.touching = 0.0
    memory.approach_speed = 0.0
    memory.effective_mass = 0.0
    complete(book, c, y)
    if book.open[c] >= 0:
        book.episodes[book.open[c]].release = t
        book.open[c] = -1


@kernel
def keep_peaks(
    t: float, h: float, space: Ints, dense: Floats, work: Floats, start: int, out: Floats, book: Book
) -> None:
    """Store the state at each lasting contact's largest force in the present step."""
    for c in range(book.memory.shape[0]):
        if book.open[c] < 0:
            continue
        moment = book.peaks[c].time
        if t < moment <= t + h and book.moments[c] != moment:
            dense_state((moment - t) / h, space, dense, work, start, out)
            for k in range(book.states.shape[1]):
                book.states[c, k] = out[STATE_ROW, k]
            for k in range(book.memory.shape[0]):
                kept, memory = book.memories[c, k], book.memory[k]
                kept.touching = memory.touching
                kept.approach_speed = memory.approach_speed
                kept.effective_mass = memory.effective_mass
            book.moments[c] = moment


@kernel
def effective_mass(c: int, y: Floats, numbers: Numbers) -> float:
    """Return the effective mass along the normal of contact c at y [kg].

    The same as :meth:`antenna_pin.dynamics.Workspace.effective_mass`, by the compiled dynamics.
    """
    program, rates = numbers.program, numbers.rates
    head = head_of(program)
    nq, nv = head.nq, head.nv
    locate(y, program, numbers.pose, numbers.table, numbers.outside)
    direction = numbers.step
    for k in range(nv):
        direction[k] = 0.0
    b = HEADER
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        j = joint_at(program, b)
        if j.row <= c < j.row + j.contacts:
            journal_state(j, y, nq, numbers.pose[0])
            unit_normal_force(program, b, numbers.pose, numbers.table, c, direction)
        b += j.length
    # At rest: only M^-1 is needed, and the effects of motions and gravity cancel in the difference.
    rest = numbers.moved
    for k in range(y.shape[0]):
        rest[k] = y[k]
    for k in range(nv):
        rest[nq + k] = 0.0
        numbers.force[k] = 0.0
    accelerate(0.0, rest, numbers.force, numbers, rates[0], False)
    for k in range(nv):
        numbers.force[k] = direction[k]
    accelerate(0.0, rest, numbers.force, numbers, rates[1], False)
    total = 0.0
    for k in range(nv):
        total += direction[k] * (rates[1, k] - rates[0, k])
    return float(1.0 / total)
