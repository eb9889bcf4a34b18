"""A system in one state, for people: a workspace is made for each question."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.records import memory_numbers, memory_records
from antenna_pin.dynamics.system import System
from antenna_pin.dynamics.workspace import Workspace

__all__ = ["acceleration", "contact_memory"]

Array = NDArray[np.float64]


def contact_memory(system: System, y: Array) -> Array:
    """Return the contact memory of a state that comes without one, (contacts, 3).

    Contacts with a gap of zero or less touch, with the effective mass there and then. At the surface the
    approach speed is the depth rate there and then, at least the floor; deeper in there is none
    (:func:`antenna_pin.contact.onset.approach_speed_in_contact`).

    Args:
        system: The system.
        y: State [q, v, x].
    """
    return memory_numbers(Workspace(system).first_memory(y))


def acceleration(
    system: System, t: float, q: ArrayLike, v: ArrayLike, memory: ArrayLike | None = None
) -> Array:
    """Return the generalized acceleration in a state, (nv,).

    Args:
        system: The system.
        t: Time [s].
        q: Configuration, (nq,).
        v: Velocity, (nv,).
        memory: Of the contacts, (contacts, 3); by the rule of :func:`contact_memory` if not given.
    """
    y = system.state(q, v)
    workspace = Workspace(system)
    workspace.memory[:] = workspace.first_memory(y) if memory is None else memory_records(memory)
    rates = np.zeros(system.model.nv + system.manifold.nx)
    workspace.derivative(t, y, rates)
    return rates[: system.model.nv].copy()
