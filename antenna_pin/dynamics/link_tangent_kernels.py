"""Derivatives of generalized forces and rates of elements on links, compiled.

Such an element depends on all joints below its links: it is differentiated along each displacement as a
whole, and over each number of the system. ``room`` is
:class:`antenna_pin.dynamics.tangent_room_kernels.TangentRoom`.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.link_kernels import add_forces
from antenna_pin.dynamics.tangent_room_kernels import TangentRoom
from antenna_pin.integrate.difference_kernels import (
    differentiated,
    displace_words,
    note_words,
    put_back_words,
)
from antenna_pin.integrate.manifold_kernels import move_by_velocity, space_of
from antenna_pin.joints.slope_kernels import is_moved


@inlined
def _displace(y: Floats, way: Floats, h: float, room: TangentRoom) -> None:
    """Write the state displaced by h times a displacement to ``room.state``."""
    space, state = space_of(room.layout), room.state
    nq, nv = space.nq, space.nv
    for i in range(nq + nv + space.nx):
        state[0, i] = y[i]
    for i in range(nv):
        room.step[i] = h * way[i]
    move_by_velocity(room.layout, state, 0, room.step)
    for i in range(nv):
        state[0, nq + i] += h * way[nv + i]
    for i in range(room.bristles.shape[0]):
        state[0, nq + nv + room.bristles[i]] += h * way[2 * nv + i]


@kernel
def add_link_changes(
    t: float, y: Floats, ways: Floats, steps: Floats, room: TangentRoom, out: Floats
) -> None:
    """Add derivatives of elements on links along displacements and over system parameters.

    Args:
        t: Time [s].
        y: State, also in ``room.state``.
        ways: Displacements, row by row, (k, displacement).
        steps: Steps of the differences, (k,).
        room: Arrays.
        out: (kinds, k, nv + nx).
    """
    numbers = room.numbers
    for d in range(ways.shape[0]):
        if _moves(ways[d], room.first_number[0]) or ways[d, ways.shape[1] - 1] != 0.0:
            _differentiate_links(t, y, ways[d], -1, steps[d], room)
            _add_pull(1.0, d, room, out)
    for i in range(y.shape[0]):
        room.state[0, i] = y[i]
    shifts = room.shifts
    for m in range(shifts.steps.shape[0]):
        at = room.first_number[0] + m
        if shifts.acts[room.parts.shape[0], m] == 0 or not is_moved(ways, at):
            continue
        note_words(numbers.program, shifts.program, m)
        note_words(shifts.flat, shifts.tree, m)
        _differentiate_links(t, y, ways[0], m, shifts.steps[m], room)
        put_back_words(numbers.program, shifts.program, m)
        put_back_words(shifts.flat, shifts.tree, m)
        for d in range(ways.shape[0]):
            _add_pull(ways[d, at], d, room, out)


@inlined
def _moves(way: Floats, count: int) -> bool:
    """Return whether a displacement has any component of the state."""
    found = False
    for i in range(count):
        found = found or way[i] != 0.0
    return found


@inlined
def _pull_displaced(h: float, t: float, y: Floats, way: Floats, m: int, room: TangentRoom) -> None:
    """Write the actions of elements on links with one number, or the state, displaced."""
    numbers, shifts = room.numbers, room.shifts
    if m < 0:
        _displace(y, way, h, room)
        _pull(t + h * way[way.shape[0] - 1], room)
    else:
        displace_words(numbers.program, shifts.program, m, h)
        displace_words(shifts.flat, shifts.tree, m, h)
        _pull(t, room)


_differences = differentiated(_pull_displaced)


@kernel
def _differentiate_links(t: float, y: Floats, way: Floats, m: int, step: float, room: TangentRoom) -> None:
    """Write the derivatives of the actions of elements on links to ``room.column``.

    They are along a displacement if m is below 0, else over number m of the system.
    """
    whole, arrays = _pulls(room), (room.looked, room.weights, room.trial)
    _differences(step, (0, room.tau.shape[0], whole, whole), arrays, room.column, t, y, way, m, room)


@inlined
def _pulls(room: TangentRoom) -> int:
    """Return the count of output numbers of elements on links."""
    return int(room.rates.shape[0] - room.links_x[0])


@inlined
def _pull(t: float, room: TangentRoom) -> None:
    """Write what elements on links do in ``room.state`` to ``room.looked``."""
    numbers, tau, rates, first = room.numbers, room.tau, room.rates, room.links_x[0]
    nv = tau.shape[0]
    for k in range(nv):
        tau[k] = 0.0
    add_forces(t, room.state[0], numbers.program, numbers.tree, numbers.places, tau, rates)
    for k in range(nv):
        room.looked[k] = tau[k]
    for k in range(nv, _pulls(room)):
        room.looked[k] = rates[first + k]


@inlined
def _add_pull(share: float, d: int, room: TangentRoom, out: Floats) -> None:
    """Add a share of ``room.column`` to the derivatives along displacement d."""
    nv, first = room.tau.shape[0], room.links_x[0]
    if share == 0.0:
        return
    for kind in range(out.shape[0]):
        for k in range(_pulls(room)):
            out[kind, d, k if k < nv else first + k] += share * room.column[kind, k]
