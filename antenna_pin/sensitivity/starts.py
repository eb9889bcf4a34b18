"""A run that goes on from a state: what the keys of the scenario's start change of that state."""

from __future__ import annotations

import dataclasses

import numpy as np
from scipy.spatial.transform import Rotation

from antenna_pin.assemble import initial_angles, initial_state
from antenna_pin.base.state import State
from antenna_pin.dynamics import System, Workspace
from antenna_pin.errors import InvalidParameterError
from antenna_pin.nonlinear.coordinates import way_between
from antenna_pin.scenario import Scenario

__all__ = ["begun_from", "check_start_keys", "is_of_start"]


def is_of_start(key: str) -> bool:
    """Whether a key is one of the first state."""
    return key.split(".")[0] == "initial"


def check_start_keys(keys: tuple[str, ...], system: System) -> None:
    """Refuse keys of the first state where a run goes on from one that closures hold."""
    if system.plan is None:
        return
    for key in keys:
        if is_of_start(key):
            rule = "none of initial.* where a run of closed loops or motions goes on from a state (start)"
            raise InvalidParameterError("sensitivities", "key", rule, said=key)


def begun_from(start: State, scenario: Scenario, other: Scenario, system: System) -> State:
    """Return a state as far from another as a scenario's own start is from another's.

    What differs in a joint's place and rate differs in the state: along the joint's axis, of a joint with
    play in its bearing's axes, of the base in the world's, its velocities in its own.

    Args:
        start: The state.
        scenario: The scenario.
        other: One that differs from it in its start, ``initial``.
        system: Of both.
    """
    here, there = (
        system.state(*initial_state(one, system), initial_angles(one, system)) for one in (scenario, other)
    )
    model, mechanism = system.model, system.mechanism
    nq, nv = model.nq, model.nv
    way, change = way_between(system, here[:nq], there[:nq]), (there - here)[nq : nq + nv]
    free = [(slice(0, 7), slice(0, 6), False)] if mechanism.base == "free" else []
    free += [
        (slot.q, slot.v, True)
        for slot in (mechanism.joint(one.name) for one in system.clearances)
        if slot.kind == "floating"
    ]
    for q, v, play in free:
        turn = _rotation(start.q[q]).T @ _rotation(here[q])
        first = v.start
        way[first : first + 3] = turn @ way[first : first + 3]
        if play:
            change[first : first + 3] = turn @ change[first : first + 3]
            change[first + 3 : first + 6] = turn @ change[first + 3 : first + 6]
    y = start.y
    Workspace(system).retract(y, way)
    y[nq : nq + nv] += change
    system.turn_on(y)
    return dataclasses.replace(start, q=y[:nq].copy(), v=y[nq : nq + nv].copy(), x=y[nq + nv :].copy())


def _rotation(pose: np.ndarray) -> np.ndarray:
    """Return the rotation of a pose, (7,)."""
    return np.asarray(Rotation.from_quat(pose[3:7]).as_matrix())
