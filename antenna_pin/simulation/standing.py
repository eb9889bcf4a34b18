"""A run between two steps, as a value to go on from."""

from __future__ import annotations

from typing import Any

from antenna_pin.base.records import memory_numbers
from antenna_pin.base.state import State

__all__ = ["state_of", "take_up"]


def state_of(run: Any) -> State:
    """Return the state of a run (:class:`antenna_pin.simulation.loop.Run`) at this moment."""
    nq, nv, y = run.system.model.nq, run.system.model.nv, run.here
    return State(
        time=run.stepper.t,
        reached=run.stepper.t,
        q=y[:nq].copy(),
        v=y[nq : nq + nv].copy(),
        x=y[nq + nv :].copy(),
        memory=memory_numbers(run.workspace.memory),
        contacts=run.contacts.value(),
        step=run.following,
        error=run.control.error,
        sizes=run.control.sizes.value(),
        changed=tuple(run.search.ignore.tolist()),
        events=run.watch.value(),
        adjusted=tuple(run.actions.adjustments.values.items()),
        controllers=run.ticks.value(),
    )


def take_up(run: Any, state: State) -> None:
    """Let a run that has just been made, or has gone back to its numbers, go on from a state."""
    run.contacts.take_up(state)
    for place, value in state.adjusted:
        if run.actions.adjustments.values.get(place) != value:
            run.actions.set(place, value)
    run.stepper.restart(state.time, state.y)
    run.actions.motions.renew(state.time)
    run.control.spin = run.system.turn_on(run.stepper.start)
    run.control.sizes.take_up(state.sizes)
    run.search.ignore[:] = state.changed
    run.following = state.step
    run.control.error = state.error
    run.watch.take_up(state.events, state.time)
    run.watch.renew()
    run.ticks.take_up(state.controllers, state.reached)
    if state.time == state.reached:
        run.samples.add(state.time, state.y)
