"""Derivatives of a system's rates along displacements of a state, compiled.

A displacement is [position (nv), rate (nv), bristles, logarithm of approach speeds (contacts), of effective
masses (contacts), time]; positions are in the coordinates of velocities.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from antenna_pin.base.records import Floats, Ints, Memory, Records
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.layout_kernels import plan_of
from antenna_pin.dynamics.constraints.rows_kernels import write_rows
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.integrate.manifold_kernels import move_by_velocity, space_of
from antenna_pin.run.engine.hold_kernels import set_motions
from antenna_pin.run.engine.step_kernels import derivative


@by_address
class Room(NamedTuple):
    """Arrays for the differences of rates."""

    weights: Floats  # weights of differences at 1, 2, ... steps, of each kind, (kinds, points)
    layout: Ints  # layout of the manifold
    bristles: Ints  # places of bristles in x, (bristles,)
    numbers: Numbers  # the system; its contact memory is restored at the end
    rows: Floats  # scratch, (2, size)
    kept: Records[Memory]  # contact memory of the undisplaced state, MEMORY, (contacts,)


@inlined
def _displace(y: Floats, way: Floats, h: float, room: Room) -> None:
    """Write the state and contact memory displaced by h to the first row."""
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
def _copy_memory(source: Records[Memory], out: Records[Memory]) -> None:
    """Copy what contacts remember and displacements change."""
    for c in range(source.shape[0]):
        out[c].approach_speed = source[c].approach_speed
        out[c].effective_mass = source[c].effective_mass


@inlined
def _add(values: Floats, side: float, point: int, step: float, room: Room, k: int, out: Floats) -> None:
    """Add what a neighbour's values are to the differences of each kind along displacement k."""
    for kind in range(out.shape[0]):
        weight = side * room.weights[kind, point] / step
        for i in range(out.shape[2]):
            out[kind, k, i] += weight * values[i]


@kernel
def write_slopes(
    t: float, y: Floats, ways: Floats, steps: Floats, of_speeds: bool, room: Room, out: Floats
) -> None:
    """Write central differences along displacements, of the rates or of constraint velocities.

    Args:
        t: Time [s].
        y: State.
        ways: Displacements, row by row, (k, displacement).
        steps: Steps of the differences, (k,).
        of_speeds: Whether constraint velocities are differentiated.
        room: Arrays.
        out: Results, (kinds, k, rates or rows of constraints).
    """
    state, found, numbers = room.rows[0], room.rows[1, : out.shape[2]], room.numbers
    if of_speeds:
        speed = plan_of(numbers.plan).speed
        found = numbers.held[speed : speed + out.shape[2]]
    _copy_memory(numbers.memory, room.kept)
    out[:] = 0.0
    for k in range(ways.shape[0]):
        for point in range(room.weights.shape[1]):
            for side in (1.0, -1.0):
                h = side * (point + 1.0) * steps[k]
                time = t + h * ways[k, ways.shape[1] - 1]
                _displace(y, ways[k], h, room)
                if of_speeds:
                    set_motions(time, state, numbers)
                    write_rows(time, state, numbers.program, numbers.plan, numbers.held)
                else:
                    derivative(time, state, numbers, found, False)
                _add(found, side, point, steps[k], room, k, out)
    _copy_memory(room.kept, numbers.memory)
