"""A state of one system as the start of another whose parameters differ: how a branch is followed."""

from __future__ import annotations

import dataclasses

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import OpenContact, State
from antenna_pin.dynamics import Adjustments, System, Workspace, modes_in_another, modes_kept
from antenna_pin.simulation.inputs import check_sizes
from antenna_pin.simulation.loop import Run

__all__ = ["carried"]


@takes()
def carried(state: State, system: System, *, scale: float = 1.0) -> State:
    """Return a state as a start of another system of the same shape.

    Positions, velocities, integrals and time go over as they are, but for what the other system cannot have:
    they are brought onto its closures and motions, a contact touches if its gap is closed there, and what
    contacts that touch on either side remember is kept. Elements go on in the modes that they are in, joints
    that they hold are held where they hold them there, and a stop that gives way touches if the joint is
    beyond it there. Step sizes start anew.

    Args:
        state: What a run of the one system left.
        system: The other.
        scale: By which time is stretched [-]: the new period of a drive over its old one, so that its phase
            stays where it was.

    Raises:
        InvalidParameterError: The state is not as large as one of the other system, or has a joint beyond a
            rigid stop of it.
    """
    check_sizes(system, state)
    time = state.time * scale
    shift = time - state.time
    y = state.y
    workspace, kept = Workspace(system), modes_kept(system, state.adjusted)
    adjustments = Adjustments(system, workspace.program)
    for place, value in kept:
        adjustments.set(place, value)
    if workspace.constraints is not None:
        workspace.hold(time, y, workspace.program)
    system.turn_on(y)
    adjusted = modes_in_another(system, y, time, kept)
    nq, nv = system.model.nq, system.model.nv
    moved = dataclasses.replace(
        state,
        time=time,
        reached=state.reached + shift,
        q=y[:nq].copy(),
        v=y[nq : nq + nv].copy(),
        x=y[nq + nv :].copy(),
        sizes=(),
        error=0.0,
        changed=tuple(0 for _ in state.changed),
        # Events of its own count from their own beginning; which side they are on is looked at anew.
        events=(),
        adjusted=adjusted,
        contacts=tuple(_later(one, shift) for one in state.contacts),
    )
    if not len(state.memory):
        return moved
    # As if for the first time: which contacts touch there, by the rule of every start.
    begun = Run(system, y, max(1.0, time), RunSettings()).present()
    old = state.memory[:, 0] != 0.0
    new = begun.memory[:, 0] != 0.0
    memory = np.where((old & new)[:, None], state.memory, begun.memory)
    going_on = {one.contact: one for one in moved.contacts if new[one.contact]}
    fresh = {
        one.contact: dataclasses.replace(one, onset=time, peak=(one.peak[0], time, one.peak[2]))
        for one in begun.contacts
    }
    contacts = tuple((fresh | going_on)[c] for c in sorted(fresh | going_on))
    return dataclasses.replace(moved, memory=memory, contacts=contacts)


def _later(contact: OpenContact, shift: float) -> OpenContact:
    """Return what is kept of a contact with its times [s] moved."""
    force, when, depth = contact.peak
    return dataclasses.replace(contact, onset=contact.onset + shift, peak=(force, when + shift, depth))
