"""What is looked at of a joint with play, and what its laws say, each along its own arguments, compiled.

See :mod:`antenna_pin.joints.tangent_kernels`, which puts them together.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.contact.friction_kernels import FRICTION_SIZE, bristle_force
from antenna_pin.contact.kernels import NORMAL_SIZE
from antenna_pin.geometry.kernels import FLANGE
from antenna_pin.integrate.difference_kernels import BEGIN, FINER, OFTEN, add, clear, judge, keep, settle
from antenna_pin.integrate.manifold_kernels import factor_of, factor_size, move_factor, space_of
from antenna_pin.integrate.word_kernels import displace_words, note_words, put_back_words
from antenna_pin.joints.kernels import contact_motion
from antenna_pin.joints.layout_kernels import BRISTLES, friction_at, joint_at, normal_at, primitive_of
from antenna_pin.joints.pose_kernels import journal_state, onto_joint
from antenna_pin.joints.row_kernels import row_forces

# What is looked at of a joint: its journal's centre, what the wrench as it is does along its freedoms; then
# of each contact.
CENTRE, CARRIED, FIRST = 0, 3, 9
GAP, NORMAL, POINT, RATE, SLIP, TWIRL, LOOKED = 0, 1, 4, 7, 8, 11, 12
# What a law is asked with: gap, depth rate, slip, normal, logarithms of what is remembered, bristles. And
# what it says: force, its elastic part, friction, rates of bristles.
A_RATE, A_SLIP, A_NORMAL, A_SPEED, A_MASS, A_BRISTLE = 1, 2, 5, 8, 9, 10
V_ELASTIC, V_FRICTION, V_BRISTLE = 1, 2, 5
#: What a law has of bristles at most: a deflection, and its dwell.
STATES = 4
# Places in ``room.asks``: whether any displacement that is asked for has what contacts remember, or time; and
# whether they are fewer than a joint has freedoms: then geometry is differentiated along each of them.
REMEMBERED, TIMES, FEW = 0, 1, 2
# First steps: of ways, over their units; of depths, over these, and at least over a play; of speeds, over
# their unit or themselves; of the parts of a normal and of logarithms.
_WAY, _DEPTH, _SHALLOW, _SPEED, _PURE = 1e-3, 1e-2, 1e-12, 1e-3, 1e-3
#: What of a joint's block goes with a number of the system, added up: where things are, laws.
MOVES, RULES = 1, 2


@inlined
def is_moved(ways: Any, i: int) -> bool:
    """Whether any displacement has number i."""
    moved = False
    for d in range(ways.shape[0]):
        moved = moved or ways[d, i] != 0.0
    return moved


@kernel
def displace_joint(f: int, y: Any, h: float, way: Any, room: Any) -> None:
    """Write the configuration of factor f, displaced by h times a way, (factor's nv,), to ``room.state``."""
    factor = factor_of(room.layout, f)
    for k in range(factor.q, factor.q + factor_size(factor)):
        room.state[0, k] = y[k]
    for k in range(factor.nv):
        room.step[factor.v + k] = h * way[k]
    move_factor(factor, room.state, 0, room.step)


@inlined
def look(p: Any, b: int, k: int, pose: Any, row: Any, out: Any) -> None:
    """Write what is looked at of a contact."""
    at = FIRST + k * LOOKED
    out[at + GAP] = row.gap
    for i in range(3):
        out[at + NORMAL + i] = row.normal[i]
        out[at + POINT + i] = row.point[i]
        out[at + SLIP + i] = row.slip[i]
    out[at + RATE] = row.rate
    out[at + TWIRL] = 0.0
    if primitive_of(p, b, k) == FLANGE:
        a, w, n = row.arm, pose.spin, row.normal
        x, y, z = w[1] * a[2] - w[2] * a[1], w[2] * a[0] - w[0] * a[2], w[0] * a[1] - w[1] * a[0]
        out[at + TWIRL] = x * n[0] + y * n[1] + z * n[2]


@kernel
def _look_at_joint(p: Any, b: int, room: Any) -> None:
    """Write what is looked at of a joint in ``room.state`` to ``room.looked``."""
    j, pose, out, tau = joint_at(p, b), room.poses[1], room.looked, room.tau
    memory, table = room.numbers.memory, room.numbers.table
    journal_state(j, room.state[0], space_of(room.layout).nq, pose)
    count = 3 if j.planar != 0 else 6
    for k in range(count):
        tau[j.v + k] = 0.0
    f, m = room.poses[0].force, room.poses[0].moment
    onto_joint(j, pose, (f[0], f[1], f[2]), (m[0], m[1], m[2]), tau)
    for k in range(3):
        out[CENTRE + k] = pose.centre[k]
    for k in range(count):
        out[CARRIED + k] = tau[j.v + k]
    for k in range(j.contacts):
        if memory[j.row + k].touching != 0.0:
            contact_motion(p, b, k, pose, table)
            look(p, b, k, pose, table[j.row + k], out)


@inlined
def _geometry_apart(p: Any, b: int, step: float, room: Any) -> float:
    """Return by how much the orders of a trial of geometry differ: of gaps, normals, points, rates."""
    j, worst = joint_at(p, b), 0.0
    for k in range(j.contacts):
        if room.numbers.memory[j.row + k].touching != 0.0:
            at, trial = FIRST + k * LOOKED, room.trial
            for first, last in ((GAP, NORMAL), (NORMAL, POINT), (POINT, RATE), (RATE, TWIRL)):
                worst = max(worst, judge(trial, room.looked, step, (at + first, at + last)))
    return worst


@kernel
def differentiate_geometry(p: Any, b: int, f: int, y: Any, way: Any, room: Any, out: Any) -> None:
    """Write the derivatives of what is looked at along a way of a joint, (kinds, looked)."""
    j, units, points = joint_at(p, b), room.units, room.weights.shape[1]
    count = FIRST + j.contacts * LOOKED
    size = 0.0
    for k in range(3 if j.planar != 0 else 6):
        size = max(size, abs(way[k]) / units[j.v + k])
    if size == 0.0:
        clear(out, count)
        return
    step, best = _WAY / size, -1.0
    for _ in range(OFTEN):
        clear(room.trial, count)
        for place in range(-points, points + 1):
            displace_joint(f, y, place * step, way, room)
            _look_at_joint(p, b, room)
            add(room.looked, count, place, step, room.weights, room.trial)
        off = _geometry_apart(p, b, step, room)
        best, goes_on = keep(room.trial, (0, count), off, best, out)
        if not goes_on:
            break
        step /= FINER
    displace_joint(f, y, 0.0, way, room)


@kernel
def differentiate_geometry_over(p: Any, b: int, m: int, room: Any, out: Any) -> None:
    """Write the derivatives of what is looked at over number m of the system, (kinds, looked)."""
    words, count = room.shifts.program, FIRST + joint_at(p, b).contacts * LOOKED
    step, best, points = room.shifts.steps[m], -1.0, room.weights.shape[1]
    note_words(p, words, m)
    for _ in range(OFTEN):
        clear(room.trial, count)
        for place in range(-points, points + 1):
            displace_words(p, words, m, place * step)
            _look_at_joint(p, b, room)
            add(room.looked, count, place, step, room.weights, room.trial)
        off = _geometry_apart(p, b, step, room)
        best, goes_on = keep(room.trial, (0, count), off, best, out)
        if not goes_on:
            break
        step /= FINER
    put_back_words(p, words, m)


@inlined
def _say(p: Any, b: int, k: int, room: Any) -> None:
    """Write what the laws of a contact say of ``room.asked`` to ``room.said``."""
    j, asked, said = joint_at(p, b), room.asked, room.said
    row, remembered, was = room.numbers.table[j.row + k], room.remembered[0], room.numbers.memory[j.row + k]
    row.gap, row.rate = asked[GAP], asked[A_RATE]
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
def _ask_with(p: Any, b: int, k: int, y: Any, x0: int, row: Any, room: Any) -> None:
    """Write what the laws of a contact are asked with."""
    j, asked = joint_at(p, b), room.asked
    asked[GAP], asked[A_RATE], asked[A_SPEED], asked[A_MASS] = row.gap, row.rate, 0.0, 0.0
    for i in range(3):
        asked[A_SLIP + i] = row.slip[i]
        asked[A_NORMAL + i] = row.normal[i]
    for i in range(j.stride - BRISTLES):
        asked[A_BRISTLE + i] = y[x0 + j.x + k * j.stride + BRISTLES + i]


@inlined
def _first_step(p: Any, b: int, k: int, i: int, room: Any) -> float:
    """Return the first step of what the laws of a contact are asked with."""
    j, asked, units, nv = joint_at(p, b), room.asked, room.units, room.tau.shape[0]
    if i == GAP:
        return float(max(_DEPTH * abs(asked[GAP]), _SHALLOW * units[j.v]))
    if i < A_NORMAL:
        return float(_SPEED * max(units[nv + j.v], abs(asked[A_RATE]) if i == A_RATE else 0.0))
    if i < A_BRISTLE:
        return _PURE
    return float(_SPEED * units[2 * nv + room.bristle_of[j.x + k * j.stride + BRISTLES + i - A_BRISTLE]])


@kernel
def differentiate_laws(p: Any, b: int, k: int, y: Any, x0: int, row: Any, room: Any) -> None:
    """Write the derivatives of what the laws of a contact say to ``room.laws[k]``, (asked, kinds, said)."""
    j, points = joint_at(p, b), room.weights.shape[1]
    states, said = j.stride - BRISTLES, V_BRISTLE + j.stride - BRISTLES
    _ask_with(p, b, k, y, x0, row, room)
    for i in range(A_BRISTLE + states):
        if (states == 0 and A_NORMAL <= i < A_SPEED) or (
            room.asks[REMEMBERED] == 0 and A_SPEED <= i < A_BRISTLE
        ):
            clear(room.laws[k, i], said)
            continue
        here, step, one, other = room.asked[i], _first_step(p, b, k, i, room), BEGIN, BEGIN
        for _ in range(OFTEN):
            clear(room.trial, said)
            for place in range(-points, points + 1):
                room.asked[i] = here + place * step
                _say(p, b, k, room)
                add(room.said, said, place, step, room.weights, room.trial)
            one = settle(room.trial, room.said, step, (0, V_BRISTLE), one, room.laws[k, i])
            other = settle(room.trial, room.said, step, (V_BRISTLE, said), other, room.laws[k, i])
            if not (one[1] or other[1]):
                break
            step /= FINER
        room.asked[i] = here


@kernel
def differentiate_laws_over(p: Any, b: int, k: int, m: int, room: Any, out: Any) -> None:
    """Write the derivatives of what the laws of a contact say over number m of the system, (kinds, said).

    They are asked with what :func:`differentiate_laws` has left.
    """
    words, said = room.shifts.program, V_BRISTLE + joint_at(p, b).stride - BRISTLES
    step, points, one, other = room.shifts.steps[m], room.weights.shape[1], BEGIN, BEGIN
    note_words(p, words, m)
    for _ in range(OFTEN):
        clear(room.trial, said)
        for place in range(-points, points + 1):
            displace_words(p, words, m, place * step)
            _say(p, b, k, room)
            add(room.said, said, place, step, room.weights, room.trial)
        one = settle(room.trial, room.said, step, (0, V_BRISTLE), one, out)
        other = settle(room.trial, room.said, step, (V_BRISTLE, said), other, out)
        if not (one[1] or other[1]):
            break
        step /= FINER
    put_back_words(p, words, m)
