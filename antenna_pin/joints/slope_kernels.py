"""Derivatives of contact laws over their arguments and parameters, compiled.

Friction without bristles is along slip: its argument is the size of the slip, its result the force along it.
:mod:`antenna_pin.joints.tangent_kernels` assembles the results.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.contact.kernels import NORMAL_SIZE, bristle_force
from antenna_pin.contact.records import FRICTION_SIZE
from antenna_pin.integrate.difference_kernels import clear, differentiated
from antenna_pin.integrate.manifold_kernels import factor_of, factor_size, move_factor
from antenna_pin.joints.layout_kernels import BRISTLES, friction_at, joint_at, normal_at
from antenna_pin.joints.row_kernels import row_forces
from antenna_pin.joints.tangent_room_kernels import JointRoom

# Arguments of a law: gap, depth rate, slip, normal, logarithms of the memory, bristles. Results: force, its
# elastic part, friction, rates of bristles. Without bristles the first of slip, and
# of friction, are those along it, and there are no others.
A_GAP, A_RATE, A_SLIP, A_NORMAL, A_SPEED, A_MASS, A_BRISTLE = 0, 1, 2, 5, 8, 9, 10
V_ELASTIC, V_FRICTION, V_BRISTLE = 1, 2, 5
#: Largest number of bristle states of a law: a deflection, and its dwell.
STATES = 4
# Places in ``room.asks``: whether any requested displacement has parts of the contact memory, or of time.
REMEMBERED, TIMES = 0, 1
# First steps: of depths, relative (so small that orders agree on depth^1.5 at once), at least over a play;
# of speeds, over their unit or themselves; of the parts of a normal and of logarithms.
_DEPTH, _SHALLOW, _SPEED, _PURE = 2e-3, 1e-12, 1e-3, 1e-3


@inlined
def is_moved(ways: Floats, i: int) -> bool:
    """Return whether any displacement has number i."""
    moved = False
    for d in range(ways.shape[0]):
        moved = moved or ways[d, i] != 0.0
    return moved


@kernel
def displace_joint(f: int, y: Floats, h: float, way: Floats, room: JointRoom) -> None:
    """Write the configuration of factor f, displaced by h along a way (nv,), to ``room.state``."""
    factor = factor_of(room.layout, f)
    for k in range(factor.q, factor.q + factor_size(factor)):
        room.state[0, k] = y[k]
    for k in range(factor.nv):
        room.step[factor.v + k] = h * way[k]
    move_factor(factor, room.state, 0, room.step)


@inlined
def _say(p: Floats, b: int, k: int, room: JointRoom) -> None:
    """Write the results of a contact's laws, at the arguments of the workspace."""
    j, asked, said = joint_at(p, b), room.asked, room.said
    row, remembered, was = room.numbers.table[j.row + k], room.remembered[0], room.numbers.memory[j.row + k]
    row.gap, row.rate = asked[A_GAP], asked[A_RATE]
    for i in range(3):
        row.slip[i] = asked[A_SLIP + i]
    remembered.approach_speed = was.approach_speed * math.exp(asked[A_SPEED])
    remembered.effective_mass = was.effective_mass * math.exp(asked[A_MASS])
    normal, law = normal_at(b, k), friction_at(b, k)
    row_forces(p[normal : normal + NORMAL_SIZE], p[law : law + FRICTION_SIZE], remembered, row)
    said[0], said[V_ELASTIC] = row.force, row.elastic
    fx, fy, fz = row.friction[0], row.friction[1], row.friction[2]
    if j.stride > BRISTLES:
        slip = (asked[A_SLIP], asked[A_SLIP + 1], asked[A_SLIP + 2])
        way = (asked[A_NORMAL], asked[A_NORMAL + 1], asked[A_NORMAL + 2])
        own = p[law : law + FRICTION_SIZE]
        fx, fy, fz = bristle_force(own, row.force, slip, way, asked[A_BRISTLE:], said[V_BRISTLE:])
    said[V_FRICTION], said[V_FRICTION + 1], said[V_FRICTION + 2] = fx, fy, fz


@inlined
def slip_speed(row: Contact) -> float:
    """Return the size of a contact's slip [m/s]."""
    x, y, z = row.slip[0], row.slip[1], row.slip[2]
    return math.sqrt(x * x + y * y + z * z)


@inlined
def _ask_with(p: Floats, b: int, k: int, y: Floats, x0: int, row: Contact, room: JointRoom) -> None:
    """Write the arguments of a contact's laws."""
    j, asked = joint_at(p, b), room.asked
    asked[A_GAP], asked[A_RATE], asked[A_SPEED], asked[A_MASS] = row.gap, row.rate, 0.0, 0.0
    for i in range(3):
        asked[A_SLIP + i] = row.slip[i]
        asked[A_NORMAL + i] = row.normal[i]
    if j.stride == BRISTLES:
        asked[A_SLIP], asked[A_SLIP + 1], asked[A_SLIP + 2] = slip_speed(row), 0.0, 0.0
    for i in range(j.stride - BRISTLES):
        asked[A_BRISTLE + i] = y[x0 + j.x + k * j.stride + BRISTLES + i]


@inlined
def _first_step(p: Floats, b: int, k: int, i: int, room: JointRoom) -> float:
    """Return the first step of the arguments of a contact's laws."""
    j, asked, units, nv = joint_at(p, b), room.asked, room.units, room.tau.shape[0]
    if i == A_GAP:
        return float(max(_DEPTH * abs(asked[A_GAP]), _SHALLOW * units[j.v]))
    if i < A_NORMAL:
        return float(_SPEED * max(units[nv + j.v], abs(asked[A_RATE]) if i == A_RATE else 0.0))
    if i < A_BRISTLE:
        return _PURE
    return float(_SPEED * units[2 * nv + room.bristle_of[j.x + k * j.stride + BRISTLES + i - A_BRISTLE]])


@inlined
def said_by(p: Floats, b: int) -> int:
    """Return the number of results of a joint's contact laws."""
    states = joint_at(p, b).stride - BRISTLES
    return V_BRISTLE + states if states > 0 else V_FRICTION + 1


@inlined
def _say_displaced(
    h: float, p: Floats, b: int, k: int, about: tuple[int, int], was: tuple[float, float], room: JointRoom
) -> None:
    """Write the laws' results with one number displaced."""
    i, word = about
    if h == 0.0:
        for n in range(said_by(p, b)):
            room.said[n] = room.middle[n]
        return
    if i < 0:
        p[word] = was[1] + h
    else:
        room.asked[i] = was[0] + h
    _say(p, b, k, room)


_differences = differentiated(_say_displaced)


@kernel
def _differentiate(
    p: Floats, b: int, k: int, about: tuple[int, int], step: float, room: JointRoom, out: Floats
) -> None:
    """Write the derivatives of the laws' results over one number, (kinds, results).

    ``about``: index of the argument, or of the program's number if none (-1).
    """
    i, word = about
    said, was = said_by(p, b), (room.asked[max(i, 0)], p[max(word, 0)])
    parts, arrays = (0, min(said, V_BRISTLE), said, said), (room.said, room.weights, room.trial)
    _differences(step, parts, arrays, out, p, b, k, about, was, room)
    if i < 0:
        p[word] = was[1]
    else:
        room.asked[i] = was[0]


@inlined
def _is_asked(i: int, states: int, room: JointRoom) -> bool:
    """Return whether argument i of the laws is active and depends on displacements."""
    if states == 0 and A_SLIP < i < A_SPEED:
        return False
    return not (A_SPEED <= i < A_BRISTLE) or room.asks[REMEMBERED] != 0


@kernel
def differentiate_laws(p: Floats, b: int, k: int, y: Floats, x0: int, row: Contact, room: JointRoom) -> None:
    """Write the derivatives of the laws' results to ``room.laws[k]``, (arguments, kinds, results).

    Those over numbers of the laws that depend on any of ``room.seen`` are written to ``room.shifts.laws[k]``.
    """
    j, rules = joint_at(p, b), room.shifts.rules
    states, said, first = j.stride - BRISTLES, said_by(p, b), rules.first[j.row + k]
    _ask_with(p, b, k, y, x0, row, room)
    _say(p, b, k, room)
    for n in range(said):
        room.middle[n] = room.said[n]
    for i in range(A_BRISTLE + states):
        if _is_asked(i, states, room):
            _differentiate(p, b, k, (i, -1), _first_step(p, b, k, i, room), room, room.laws[k, i])
        else:
            clear(room.laws[k, i], said)
    for n in range(first, rules.first[j.row + k + 1]):
        moved = False
        for m in range(room.seen.shape[0]):
            moved = moved or (room.seen[m] != 0 and rules.slopes[n, m] != 0.0)
        if moved:
            about = -1, rules.at[n]
            _differentiate(p, b, k, about, rules.steps[n], room, room.shifts.laws[k, n - first])
        else:
            clear(room.shifts.laws[k, n - first], said)
