"""Multiple shooting: a record in pieces, each from a state of its own, and how far they are from joining.

A motion with blows forgets where it started: over a long record the sum of squares has a valley for each way
in which blows can follow one another. Over a piece it does not, and what joins the pieces is one more thing
that is fitted (Bock 1981, Springer Series in Chemical Physics 18, 102-125).
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from numpy.typing import NDArray

from antenna_pin.assemble import build_system
from antenna_pin.base.state import OpenContact, State
from antenna_pin.dynamics import System, contact_memory
from antenna_pin.nonlinear import Chart
from antenna_pin.nonlinear.coordinates import way_between
from antenna_pin.scenario import Scenario

__all__ = ["from_origin", "instants_of", "piece_start", "touching", "ways_of"]

Array = NDArray[np.float64]


def instants_of(length: float, until: float) -> tuple[float, ...]:
    """Return when pieces of a length [s] begin and the last one ends [s]; it may be shorter, or longer."""
    count = max(1, round(until / length))
    return (*(k * length for k in range(count)), until)


@functools.lru_cache(maxsize=4)
def _system(begun: str) -> System:
    return build_system(Scenario.model_validate_json(begun))


@functools.lru_cache(maxsize=1024)
def _chart(begun: str, origin: str) -> Chart:
    """Return the coordinates about an origin; their units are those of the start values, and stay."""
    return Chart(_system(begun), State.from_json(origin))


def ways_of(begun: str, origin: str) -> int:
    """Return in how many coordinates a piece's start is told: its ways and as many rates.

    Args:
        begun: The scenario with the start values, as JSON.
        origin: A state of it, as text.
    """
    return 2 * _chart(begun, origin).ways


def piece_start(begun: str, origin: str, z: Array, system: System) -> State:
    """Return the state at coordinates z about an origin, (ways,), in error scales, of a system.

    A journal that is in the wall there, and was not touching at the origin, touches as one does that a
    scenario starts from: with its speed there as that of its approach.
    """
    chart = _chart(begun, origin)
    whole = np.zeros(chart.size)
    whole[: len(z)] = z
    return touching(chart.state(whole, system), system)


def touching(state: State, system: System) -> State:
    """Return a state in which contacts without a gap touch: those that did not before as if they began.

    Without it a run from inside the wall would find them begun in its first step, at an instant that no
    neighbour's depth and speed there move.
    """
    if not system.contact_names:
        return state
    first, books = contact_memory(system, state.y), state.x
    new = np.flatnonzero((first[:, 0] != 0.0) & (state.memory[:, 0] == 0.0)).tolist()
    if not new:
        return state
    memory = state.memory.copy()
    memory[new] = first[new]
    contacts = [
        OpenContact(
            contact=c,
            onset=state.time,
            approach_speed=float(first[c, 1]),
            effective_mass=float(first[c, 2]),
            impulse=-float(books[system.impulse_x[c]]),
            dissipated=-float(books[system.lost_normal_x[c]] + books[system.lost_friction_x[c]]),
            peak=(0.0, state.time, 0.0),
            peak_state=np.zeros(0),
            peak_memory=np.zeros((0, 3)),
        )
        for c in new
    ]
    every = sorted((*state.contacts, *contacts), key=lambda one: one.contact)
    return dataclasses.replace(state, memory=memory, contacts=tuple(every))


def from_origin(begun: str, origin: str, q: Array, v: Array) -> Array:
    """Return the way from an origin to a configuration and velocity, (2 nv,), in error scales."""
    chart = _chart(begun, origin)
    way = way_between(chart.system, chart.origin.q, q) / chart.units.way
    return np.concatenate([way, (v - chart.origin.v) / chart.units.rate])
