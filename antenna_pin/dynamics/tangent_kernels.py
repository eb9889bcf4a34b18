"""How generalized forces of elements, and the rates of what they integrate, change with the state, compiled.

An element at joints knows the numbers of these, its own states and time: it is differentiated over each of
them that a displacement moves, by itself. Elements on links see all joints below these, and are so along
each displacement as a whole. ``room`` is :class:`antenna_pin.engine.tangent_kernels.TangentRoom`.
"""

from __future__ import annotations

from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.dynamics.kernels import element_forces
from antenna_pin.dynamics.link_kernels import add_forces
from antenna_pin.integrate.difference_kernels import BEGIN, FINER, OFTEN, add, clear, settle
from antenna_pin.integrate.manifold_kernels import factor_of, move_by_velocity, space_of
from antenna_pin.integrate.word_kernels import displace_words, note_words, put_back_words
from antenna_pin.joints.slope_kernels import TIMES, displace_joint, is_moved
from antenna_pin.records import layout

#: What acts, a joint with play (``element`` 0) or an element at joints: its number among these; its block in
#: the program; the joint's
#: freedoms in v and its factor of the configuration space, twice, the other joint's of an element that knows
#: two (none: of no freedoms); where in x what it integrates begins and ends, and its bristles among all.
PART = layout(
    ("element", "i8"),
    ("number", "i8"),
    ("block", "i8"),
    ("v", "i8", (2,)),
    ("freedoms", "i8", (2,)),
    ("factor", "i8", (2,)),
    ("x", "i8"),
    ("x_end", "i8"),
    ("bristle", "i8"),
    ("bristle_end", "i8"),
)

# First steps, over units.
_OWN = 1e-3


@inlined
def _act(part: Any, t: float, room: Any) -> None:
    """Write what an element does in ``room.state`` to ``room.looked``."""
    tau, rates, out = room.tau, room.rates, room.looked
    nv = tau.shape[0]
    for s in range(2):
        for k in range(part.freedoms[s]):
            tau[part.v[s] + k] = 0.0
    element_forces(room.numbers.program, part.block, t, room.state[0], room.poses[1], tau, rates)
    count = 0
    for s in range(2):
        for k in range(part.freedoms[s]):
            out[count] = tau[part.v[s] + k]
            count += 1
    for x in range(part.x, part.x_end):
        out[count] = rates[nv + x]
        count += 1


@inlined
def _move(part: Any, kind: int, s: int, n: int, y: Any, h: float, room: Any) -> None:
    """Displace one number that an element knows.

    It is a way (0) or rate (1) of a joint of its, a state (2), or one of the system (4).
    """
    space, state = space_of(room.layout), room.state[0]
    if kind == 0:
        own = factor_of(room.layout, part.factor[s])
        for k in range(own.nv):
            room.freedoms[k] = 0.0
        room.freedoms[part.v[s] + n - own.v] = 1.0
        displace_joint(part.factor[s], y, h, room.freedoms, room)
    elif kind == 1:
        i = space.nq + part.v[s] + n
        state[i] = y[i] + h
    elif kind == 2:
        i = space.nq + space.nv + room.bristles[n]
        state[i] = y[i] + h
    elif kind == 4:
        displace_words(room.numbers.program, room.shifts.program, n, h)


@kernel
def _differentiate(part: Any, about: Any, t: float, y: Any, step: float, room: Any) -> None:
    """Write the derivatives of what an element does over one number to ``room.column``."""
    kind, s, n = about
    trial, looked, points = room.trial, room.looked, room.weights.shape[1]
    forces = part.freedoms[0] + part.freedoms[1]
    whole, one, other = forces + part.x_end - part.x, BEGIN, BEGIN
    for _ in range(OFTEN):
        clear(trial, whole)
        for place in range(-points, points + 1):
            _move(part, kind, s, n, y, place * step, room)
            _act(part, t + place * step if kind == 3 else t, room)
            add(looked, whole, place, step, room.weights, trial)
        one = settle(trial, looked, step, (0, forces), one, room.column)
        other = settle(trial, looked, step, (forces, whole), other, room.column)
        if not (one[2] or other[2]):
            break
        step /= FINER
    _move(part, kind, s, n, y, 0.0, room)


@kernel
def _add_column(part: Any, at: int, ways: Any, room: Any, out: Any) -> None:
    """Add the derivatives over one number times what each displacement has of it, at ways[:, at]."""
    nv = room.tau.shape[0]
    for d in range(ways.shape[0]):
        share = ways[d, at]
        if share == 0.0:
            continue
        for kind in range(out.shape[0]):
            count = 0
            for s in range(2):
                for k in range(part.freedoms[s]):
                    out[kind, d, part.v[s] + k] += share * room.column[kind, count]
                    count += 1
            for x in range(part.x, part.x_end):
                out[kind, d, nv + x] += share * room.column[kind, count]
                count += 1


@kernel
def add_element_changes(part: Any, t: float, y: Any, ways: Any, steps: Any, room: Any, out: Any) -> None:
    """Add how an element at joints changes generalized forces and rates of x along displacements.

    Args:
        part: The element, ``PART``.
        t: Time [s].
        y: State; ``room.state`` is it too.
        ways: Displacements, row by row, (k, displacement).
        steps: Of differences along these as a whole, (k,).
        room: What to compute with.
        out: (kinds, k, nv + nx).
    """
    nv = room.tau.shape[0]
    for s in range(2):
        for n in range(part.freedoms[s]):
            for kind in range(2):
                at = kind * nv + part.v[s] + n
                if is_moved(ways, at):
                    _differentiate(part, (kind, s, n), t, y, _OWN * room.units[at], room)
                    _add_column(part, at, ways, room, out)
    for n in range(part.bristle, part.bristle_end):
        at = 2 * nv + n
        if is_moved(ways, at):
            _differentiate(part, (2, 0, n), t, y, _OWN * room.units[at], room)
            _add_column(part, at, ways, room, out)
    shifts, program = room.shifts, room.numbers.program
    for m in range(shifts.steps.shape[0]):
        at = room.first_number[0] + m
        if shifts.acts[part.number, m] != 0 and is_moved(ways, at):
            note_words(program, shifts.program, m)
            _differentiate(part, (4, 0, m), t, y, shifts.steps[m], room)
            put_back_words(program, shifts.program, m)
            _add_column(part, at, ways, room, out)
    if room.asks[TIMES] == 0:
        return
    _differentiate(part, (3, 0, 0), t, y, time_step(ways, steps), room)
    _add_column(part, ways.shape[1] - 1, ways, room, out)


@inlined
def time_step(ways: Any, steps: Any) -> float:
    """Return the step of differences over time: the largest of those along displacements."""
    at, step = ways.shape[1] - 1, 0.0
    for d in range(ways.shape[0]):
        own = steps[d] * abs(ways[d, at])
        if own > 0.0:
            step = max(step, own)
    return float(step)


@inlined
def _displace(y: Any, way: Any, h: float, room: Any) -> None:
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
def add_link_changes(t: float, y: Any, ways: Any, steps: Any, room: Any, out: Any) -> None:
    """Add how elements on links do, by differences along each displacement, and over numbers of the system.

    Args:
        t: Time [s].
        y: State; ``room.state`` is it too.
        ways: Displacements, row by row, (k, displacement).
        steps: Of the differences, over a displacement, (k,).
        room: What to compute with.
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
def _moves(way: Any, count: int) -> bool:
    """Whether a displacement has anything of the state."""
    found = False
    for i in range(count):
        found = found or way[i] != 0.0
    return found


@kernel
def _differentiate_links(t: float, y: Any, way: Any, m: int, step: float, room: Any) -> None:
    """Write the derivatives of what elements on links do to ``room.column``.

    They are along a displacement if m is below 0, else over number m of the system.
    """
    numbers, shifts, trial, looked = room.numbers, room.shifts, room.trial, room.looked
    nv, one, other = room.tau.shape[0], BEGIN, BEGIN
    whole, points = _pulls(room), room.weights.shape[1]
    for _ in range(OFTEN):
        clear(trial, whole)
        for place in range(-points, points + 1):
            h = place * step
            if m < 0:
                _displace(y, way, h, room)
                _pull(t + h * way[way.shape[0] - 1], room)
            else:
                displace_words(numbers.program, shifts.program, m, h)
                displace_words(shifts.flat, shifts.tree, m, h)
                _pull(t, room)
            add(looked, whole, place, step, room.weights, trial)
        one = settle(trial, looked, step, (0, nv), one, room.column)
        other = settle(trial, looked, step, (nv, whole), other, room.column)
        if not (one[2] or other[2]):
            break
        step /= FINER


@inlined
def _pulls(room: Any) -> int:
    """Return how many numbers elements on links change: forces, and the rates of what they integrate."""
    return int(room.rates.shape[0] - room.links_x[0])


@inlined
def _pull(t: float, room: Any) -> None:
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
def _add_pull(share: float, d: int, room: Any, out: Any) -> None:
    """Add a share of ``room.column`` to the derivatives along displacement d."""
    nv, first = room.tau.shape[0], room.links_x[0]
    if share == 0.0:
        return
    for kind in range(out.shape[0]):
        for k in range(_pulls(room)):
            out[kind, d, k if k < nv else first + k] += share * room.column[kind, k]
