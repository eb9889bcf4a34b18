"""Derivative of a system's rates along displacements of a state, part by part, compiled.

The layout of displacements is that of :mod:`antenna_pin.run.engine.slope_kernels`. Forces and accelerations
of the state itself are computed once. Joints with play and elements are differentiated with respect to their
own arguments (:mod:`antenna_pin.joints.tangent_kernels`, :mod:`antenna_pin.dynamics.tangent_kernels`); the
tree in closed form (:mod:`antenna_pin.mechanism.tangent_kernels`), and constraints with it
(:mod:`antenna_pin.run.engine.row_tangent_kernels`).
"""

from __future__ import annotations

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.kernels import evaluate, head_of
from antenna_pin.dynamics.link_kernels import add_forces
from antenna_pin.dynamics.link_tangent_kernels import add_link_changes
from antenna_pin.dynamics.tangent_kernels import add_element_changes, time_step
from antenna_pin.dynamics.tangent_room_kernels import TangentRoom
from antenna_pin.joints.slope_kernels import REMEMBERED, TIMES, is_moved
from antenna_pin.joints.tangent_kernels import add_joint_changes
from antenna_pin.mechanism.number_kernels import write_number_changes
from antenna_pin.mechanism.tangent_kernels import (
    prepare_changes,
    solve_trees,
    subtract_wrenches,
    write_changes,
)
from antenna_pin.run.engine.row_tangent_kernels import (
    change_rows,
    differentiate_over_time,
    has_rows,
    prepare_rows,
    shift_rows,
    solve_held,
)


@kernel
def _prepare(t: float, y: Floats, ways: Floats, room: TangentRoom) -> None:
    """Evaluate the unperturbed state, and find the components of displacements."""
    numbers, asks = room.numbers, room.asks
    head = head_of(numbers.program)
    nv, contacts = head.nv, numbers.memory.shape[0]
    first = 2 * nv + room.bristles.shape[0]
    asks[REMEMBERED] = 0
    for i in range(first, first + 2 * contacts):
        if is_moved(ways, i):
            asks[REMEMBERED] = 1
    asks[TIMES] = 1 if is_moved(ways, ways.shape[1] - 1) else 0
    for i in range(y.shape[0]):
        room.state[0, i] = y[i]
    tau = numbers.work[:nv]
    evaluate(t, y, numbers.program, numbers.work, room.rates)
    if head.points < numbers.program.shape[0]:
        add_forces(t, y, numbers.program, numbers.tree, numbers.places, tau, room.rates)
    if has_rows(room):
        prepare_rows(t, y, tau, room)
    else:
        space, scratch = (numbers.tree, room.below), (room.places, room.room, room.mass, room.acceleration)
        prepare_changes(y, head.nq, space, numbers.gravity, tau, scratch, room.bodies)
    for k in range(room.drift.shape[0]):
        room.drift[k] = room.rates[nv + k]


@inlined
def _shift_tree(t: float, ways: Floats, room: TangentRoom) -> None:
    """Write to ``room.shifts`` what changes of the tree itself, of gravity and of constraints do."""
    shifts, numbers = room.shifts, room.numbers
    ground = room.bodies[numbers.tree.shape[0]]
    for m in range(shifts.steps.shape[0]):
        if shifts.heavy[m] == 0 or not is_moved(ways, room.first_number[0] + m):
            continue
        own = shifts.forces[m]
        for k in range(own.shape[0]):
            own[k] = 0.0
        pulls, scratch = (numbers.gravity, shifts.gravity[m]), (room.acceleration, room.body)
        space = numbers.tree, room.places
        write_number_changes(shifts.bodies[m], space, pulls, scratch, room.bodies, own)
        if has_rows(room):
            for k in range(3):
                ground.acceleration_change[k] = -shifts.gravity[m, k]
            shift_rows(t, m, room, own)
            for k in range(3):
                ground.acceleration_change[k] = 0.0
        subtract_wrenches(numbers.tree, room.places, room.bodies, own)


@kernel
def write_tangent(t: float, y: Floats, ways: Floats, steps: Floats, room: TangentRoom, out: Floats) -> None:
    """Write the derivatives of the rates along displacements.

    Args:
        t: Time [s].
        y: State.
        ways: Displacements, row by row, (k, displacement).
        steps: Steps of differences of whole rates along these, where used, (k,).
        room: Arrays.
        out: Results, (kinds, k, nv + nx): by differences of sixth and of fourth order where used, or the
            first alone.
    """
    numbers, nv = room.numbers, room.tau.shape[0]
    out[:] = 0.0
    _prepare(t, y, ways, room)
    for i in range(room.parts.shape[0]):
        part = room.parts[i]
        if part.element != 0:
            add_element_changes(part, t, y, ways, steps, room, out)
        else:
            add_joint_changes(numbers.program, part, y, ways, room, out)
    if head_of(numbers.program).points < numbers.program.shape[0]:
        add_link_changes(t, y, ways, steps, room, out)
    _shift_tree(t, ways, room)
    if has_rows(room) and room.asks[TIMES] != 0:
        differentiate_over_time(t, time_step(ways, steps), room)
    shifts, differs = room.shifts, False
    for d in range(ways.shape[0]):
        own = out[0, d, :nv]
        for kind in range(1, out.shape[0]):
            for k in range(nv):
                out[kind, d, k] -= own[k]
                differs = differs or out[kind, d, k] != 0.0
        write_changes(ways[d], nv, numbers.tree, room.places, numbers.gravity, room.bodies)
        if has_rows(room):
            change_rows(y, ways[d], room, own)
        subtract_wrenches(numbers.tree, room.places, room.bodies, own)
        for m in range(shifts.steps.shape[0]):
            share = ways[d, room.first_number[0] + m]
            if share != 0.0 and shifts.heavy[m] != 0:
                for k in range(nv):
                    own[k] += share * shifts.forces[m, k]
        if has_rows(room):
            solve_held(y, d, room, out)
    if not has_rows(room):
        _solve(differs, room, out)


@inlined
def _solve(differs: bool, room: TangentRoom, out: Floats) -> None:
    """Convert forces to accelerations; higher-order ones by their differences, where any."""
    nv = room.tau.shape[0]
    solve_trees(room.mass, room.below, room.lanes, out[0, :, :nv])
    for kind in range(1, out.shape[0]):
        if differs:
            solve_trees(room.mass, room.below, room.lanes, out[kind, :, :nv])
        for d in range(out.shape[1]):
            for k in range(nv):
                out[kind, d, k] += out[0, d, k]
