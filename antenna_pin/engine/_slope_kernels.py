"""Derivatives of a system's rates along displacements of a state, compiled.

A displacement is laid out as [way (nv), rate (nv), bristles, logarithm of approach speeds (contacts), of
effective masses (contacts), time]; ways are in the coordinates of velocities.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from antenna_pin._compile import inlined, kernel
from antenna_pin.constraints._layout_kernels import plan_of
from antenna_pin.constraints._rows_kernels import write_rows
from antenna_pin.engine._step_kernels import derivative
from antenna_pin.integrate._manifold_kernels import move_by_velocity, space_of


class Room(NamedTuple):
    """What derivatives are computed with.

    Attributes:
        weights: Of differences at 1, 2, ... steps, of each kind, (kinds, points).
        layout: Of the manifold.
        bristles: Their places in x, (bristles,).
        numbers: The system; its contact memory is as it was in the end.
        rows: Scratch, (2, size).
        kept: Contact memory of the state itself, MEMORY, (contacts,).
    """

    weights: Any
    layout: Any
    bristles: Any
    numbers: Any
    rows: Any
    kept: Any


@inlined
def _displace(y: Any, way: Any, h: float, room: Any) -> None:
    """Write the state displaced by h times a displacement to the first row, and contact memory likewise."""
    space, memory = space_of(room.layout), room.numbers.memory
    nq, nv = space.nq, space.nv
    state, step = room.rows[0], room.numbers.step
    bristles, contacts = room.bristles.shape[0], memory.shape[0]
    for i in range(nq + nv + space.nx):
        state[i] = y[i]
    for i in range(nv):
        step[i] = h * way[i]
    move_by_velocity(room.layout, room.rows, 0, step)
    for i in range(nv):
        state[nq + i] += h * way[nv + i]
    for i in range(bristles):
        state[nq + nv + room.bristles[i]] += h * way[2 * nv + i]
    speeds = 2 * nv + bristles
    for c in range(contacts):
        memory[c].approach_speed = room.kept[c].approach_speed * math.exp(h * way[speeds + c])
        memory[c].effective_mass = room.kept[c].effective_mass * math.exp(h * way[speeds + contacts + c])


@inlined
def _keep(room: Any) -> None:
    memory = room.numbers.memory
    for c in range(memory.shape[0]):
        room.kept[c].approach_speed = memory[c].approach_speed
        room.kept[c].effective_mass = memory[c].effective_mass


@inlined
def _give_back(room: Any) -> None:
    memory = room.numbers.memory
    for c in range(memory.shape[0]):
        memory[c].approach_speed = room.kept[c].approach_speed
        memory[c].effective_mass = room.kept[c].effective_mass


@kernel
def write_slopes(t: float, y: Any, ways: Any, steps: Any, room: Any, out: Any) -> None:
    """Write central differences of the rates along displacements.

    Args:
        t: Time [s].
        y: State.
        ways: Displacements, row by row, (k, displacement).
        steps: Of the differences, over a displacement, (k,).
        room: What to compute with.
        out: To write to, (kinds, k, nv + nx).
    """
    rates = room.rows[1, : out.shape[2]]
    _keep(room)
    out[:] = 0.0
    for k in range(ways.shape[0]):
        for point in range(room.weights.shape[1]):
            for side in (1.0, -1.0):
                h = side * (point + 1.0) * steps[k]
                _displace(y, ways[k], h, room)
                derivative(t + h * ways[k, ways.shape[1] - 1], room.rows[0], room.numbers, rates, False)
                for kind in range(out.shape[0]):
                    weight = side * room.weights[kind, point] / steps[k]
                    for i in range(out.shape[2]):
                        out[kind, k, i] += weight * rates[i]
    _give_back(room)


@kernel
def write_speed_slopes(t: float, y: Any, ways: Any, steps: Any, room: Any, out: Any) -> None:
    """Write central differences of how fast constraints are violated along displacements.

    Args:
        t: Time [s].
        y: State.
        ways: As for :func:`write_slopes`.
        steps: Likewise.
        room: Likewise.
        out: To write to, (kinds, k, rows).
    """
    numbers = room.numbers
    speed = plan_of(numbers.plan).speed
    _keep(room)
    out[:] = 0.0
    for k in range(ways.shape[0]):
        for point in range(room.weights.shape[1]):
            for side in (1.0, -1.0):
                h = side * (point + 1.0) * steps[k]
                _displace(y, ways[k], h, room)
                time = t + h * ways[k, ways.shape[1] - 1]
                write_rows(time, room.rows[0], numbers.program, numbers.plan, numbers.held)
                for kind in range(out.shape[0]):
                    weight = side * room.weights[kind, point] / steps[k]
                    for i in range(out.shape[2]):
                        out[kind, k, i] += weight * numbers.held[speed + i]
    _give_back(room)
