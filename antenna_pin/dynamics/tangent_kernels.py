"""Derivatives of generalized forces and rates of elements at joints, compiled.

Such an element depends on angle and rate of one or two joints, its own states and time: its law is
differentiated over each of these, and over its numbers. Changes of its arguments and of its direction have
closed forms (:mod:`antenna_pin.dynamics.angle_change_kernels`). Its integrals also depend on its power,
effort times the rate along its direction. An element that acts on a journal's whole pose is differentiated
over the joint's freedoms. ``room`` is :class:`antenna_pin.dynamics.tangent_room_kernels.TangentRoom`.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.angle_change_kernels import (
    MOST,
    N,
    change_along,
    freedoms_of,
    turn_push,
    write_motion,
)
from antenna_pin.dynamics.kernels import (
    ABOUT_POSE,
    book_at,
    effort_at,
    efforts_between,
    element_at,
    element_forces,
)
from antenna_pin.dynamics.tangent_room_kernels import TangentRoom
from antenna_pin.integrate.difference_kernels import (
    differentiated,
    displace_words,
    note_words,
    put_back_words,
)
from antenna_pin.integrate.manifold_kernels import factor_of, space_of
from antenna_pin.joints.slope_kernels import TIMES, displace_joint, is_moved
from antenna_pin.joints.tangent_room_kernels import Part

#: Dependence of an element on a number of the system, added up: itself, frames of its joints.
ITSELF, FRAMES = 1, 2
#: Arguments of its law: angle (or displacement) and rate of its joint, those of its other joint, its power.
A_OTHER, A_POWER, ASKED = 2, 4, 5
#: Its results before the rates of x: efforts at one and the other joint.
EFFORTS = 2
# Variables of differentiation: displacement or rate of a joint, an own state, time, a number of the system,
# an argument of its law.
_WAY, _RATE, _STATE, _TIME, _NUMBER, _ASKED = range(6)
# First steps, over units; for powers, relative.
_OWN, _POWER = 1e-3, 0.125


@inlined
def _act(part: Part, t: float, room: TangentRoom) -> None:
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
def _say(part: Part, t: float, pushes: bool, room: TangentRoom) -> None:
    """Write the output of an element's law for ``room.asked`` to ``room.looked``."""
    p, b, rates, asked, out = room.numbers.program, part.block, room.rates, room.asked, room.looked
    e, space = element_at(p, b), space_of(room.layout)
    if e.partner != 0:
        seen = asked[0], asked[1], asked[A_OTHER], asked[A_OTHER + 1]
        out[0], out[1] = efforts_between(p, b, t, seen, rates, space.nv + e.x)
    else:
        own = room.state[0], space.nq + space.nv + e.x
        if pushes:
            out[0], out[1] = effort_at(p, b, (t, asked[0], asked[1]), own), 0.0
        book_at(p, b, (asked[0], asked[1], asked[A_POWER]), own, rates, space.nv + e.x)
    for x in range(part.x, part.x_end):
        out[EFFORTS + x - part.x] = rates[space.nv + x]


@inlined
def _move(part: Part, kind: int, s: int, n: int, y: Floats, h: float, room: TangentRoom) -> None:
    """Displace one input of an element's law."""
    space, state = space_of(room.layout), room.state[0]
    if kind == _WAY:
        own = factor_of(room.layout, part.factor[s])
        for k in range(own.nv):
            room.freedoms[k] = 0.0
        room.freedoms[part.v[s] + n - own.v] = 1.0
        displace_joint(part.factor[s], y, h, room.freedoms, room)
    elif kind == _RATE:
        i = space.nq + part.v[s] + n
        state[i] = y[i] + h
    elif kind == _STATE:
        i = space.nq + space.nv + room.bristles[n]
        state[i] = y[i] + h
    elif kind == _NUMBER:
        displace_words(room.numbers.program, room.shifts.program, n, h)


@inlined
def _act_displaced(
    h: float,
    part: Part,
    about: tuple[int, int, int, bool],
    t: float,
    y: Floats,
    here: float,
    room: TangentRoom,
) -> None:
    """Write an element's action, or the output of its law, with one number displaced."""
    kind, s, n, whole = about
    _move(part, kind, s, n, y, h, room)
    if whole:
        _act(part, t, room)
    elif h == 0.0:
        for i in range(EFFORTS + part.x_end - part.x):
            room.looked[i] = room.middle[i]
    else:
        if kind == _ASKED:
            room.asked[n] = here + h
        _say(part, t + h if kind == _TIME else t, kind != _ASKED or n != A_POWER, room)


_differences = differentiated(_act_displaced)


@kernel
def _differentiate(
    part: Part,
    about: tuple[int, int, int, bool],
    t: float,
    y: Floats,
    step: float,
    room: TangentRoom,
    out: Floats,
) -> None:
    """Write the derivatives of an element's action, or of its law, over one number.

    ``about``: variable, joint, index, and whether the action as a whole is examined.
    """
    kind, s, n, whole = about
    forces = part.freedoms[0] + part.freedoms[1] if whole else EFFORTS
    count, arrays = forces + part.x_end - part.x, (room.looked, room.weights, room.trial)
    here = room.asked[n] if kind == _ASKED else 0.0
    _differences(step, (0, forces, count, count), arrays, out, part, about, t, y, here, room)
    _move(part, kind, s, n, y, 0.0, room)
    if kind == _ASKED:
        room.asked[n] = here


@kernel
def _add_column(part: Part, at: int, ways: Floats, room: TangentRoom, out: Floats) -> None:
    """Add the derivatives over one number, times its displacements at ways[:, at]."""
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
def _look(part: Part, t: float, y: Floats, room: TangentRoom) -> float:
    """Write an element's inputs, outputs and force direction; return its working rate."""
    p, b, nq = room.numbers.program, part.block, space_of(room.layout).nq
    e, asked, sides = element_at(p, b), room.asked, room.sides
    for n in range(ASKED):
        asked[n] = 0.0
    angle, rate = write_motion(p, b, y, nq, room.tau, sides[0])
    if e.senses != 0:
        asked[0], asked[1] = angle, rate
    if e.partner != 0:
        asked[A_OTHER], asked[A_OTHER + 1] = write_motion(p, b + e.partner, y, nq, room.tau, sides[1])
    elif e.sensed != 0:
        asked[0], asked[1] = write_motion(p, b + e.sensed, y, nq, room.tau, sides[1])
    speed, (first, count) = 0.0, freedoms_of(p, b)
    for k in range(count):
        speed += sides[0, N, k] * y[nq + first + k]
    _say(part, t, True, room)
    if e.partner == 0:
        asked[A_POWER] = room.looked[0] * speed
        _say(part, t, False, room)
    for i in range(EFFORTS + part.x_end - part.x):
        room.middle[i] = room.looked[i]
    return speed


@kernel
def _differentiate_law(
    part: Part, t: float, y: Floats, ways: Floats, steps: Floats, room: TangentRoom
) -> int:
    """Write the derivatives of a law over displaced inputs; return their count.

    Those over its power are written to ``room.column``. ``room.over``: number of a displacement for each, or
    below zero the argument.
    """
    p, b, nv, over, found = room.numbers.program, part.block, room.tau.shape[0], room.over, room.of_law
    e, shifts, count = element_at(p, b), room.shifts, 0
    for n in range(A_POWER if e.partner != 0 else A_OTHER):
        if e.partner == 0 and e.sensed == 0 and e.senses == 0:
            break
        beyond = (e.partner if n >= A_OTHER else 0) if e.partner != 0 else e.sensed
        first, freedoms = freedoms_of(p, b + beyond)
        unit = room.units[(first if freedoms == MOST else first + freedoms - 1) + (n % 2) * nv]
        _differentiate(part, (_ASKED, 0, n, False), t, y, _OWN * unit, room, found[count])
        over[count] = -1 - n
        count += 1
    for n in range(part.bristle, part.bristle_end):
        at = 2 * nv + n
        if is_moved(ways, at):
            _differentiate(part, (_STATE, 0, n, False), t, y, _OWN * room.units[at], room, found[count])
            over[count] = at
            count += 1
    for m in range(shifts.steps.shape[0]):
        at = room.first_number[0] + m
        if shifts.acts[part.number, m] == ITSELF and is_moved(ways, at):
            note_words(p, shifts.program, m)
            _differentiate(part, (_NUMBER, 0, m, False), t, y, shifts.steps[m], room, found[count])
            put_back_words(p, shifts.program, m)
            over[count] = at
            count += 1
    if room.asks[TIMES] != 0:
        _differentiate(part, (_TIME, 0, 0, False), t, y, time_step(ways, steps), room, found[count])
        over[count] = ways.shape[1] - 1
        count += 1
    if e.partner == 0 and part.x_end > part.x:
        size = abs(room.asked[A_POWER])
        for i in range(part.x_end - part.x):
            size = max(size, abs(room.middle[EFFORTS + i]))
        step = _POWER * size if size > 0.0 else 1.0
        _differentiate(part, (_ASKED, 0, A_POWER, False), t, y, step, room, room.column)
    return count


@kernel
def _add_along(
    part: Part, count: int, speed: float, way: Floats, d: int, room: TangentRoom, out: Floats
) -> None:
    """Add how an element at joints changes forces and rates of x along displacement d."""
    p, b, nv, sides, found = room.numbers.program, part.block, room.tau.shape[0], room.sides, room.looked
    e, middle, books = element_at(p, b), room.middle, part.x_end - part.x
    first, freedoms = freedoms_of(p, b)
    beyond = e.partner if e.partner != 0 else e.sensed
    other, others = freedoms_of(p, b + beyond)
    angle, rate, faster = change_along(sides[0], first, freedoms, way, nv)
    far, far_rate = angle, rate
    if beyond != 0:
        far, far_rate, _ = change_along(sides[1], other, others, way, nv)
    if e.partner == 0:
        angle, rate = far, far_rate
    turned = room.step
    turn_push(sides[0], first, freedoms, way, middle[0], turned)
    if e.partner != 0:
        turn_push(sides[1], other, others, way, middle[1], turned)
    for kind in range(out.shape[0]):
        for i in range(EFFORTS + books):
            found[i] = 0.0
        for c in range(count):
            at = room.over[c]
            if at >= 0:
                share = way[at]
            elif at > -1 - A_OTHER:
                share = angle if at == -1 else rate
            else:
                share = far if at == -1 - A_OTHER else far_rate
            if share != 0.0:
                for i in range(EFFORTS + books):
                    found[i] += share * room.of_law[c, kind, i]
        own = out[kind, d]
        for k in range(freedoms):
            own[first + k] += found[0] * sides[0, N, k] + turned[first + k]
        if e.partner != 0:
            for k in range(others):
                own[other + k] += found[1] * sides[1, N, k] + turned[other + k]
        power = found[0] * speed + middle[0] * faster
        for i in range(books):
            more = room.column[kind, EFFORTS + i] * power if e.partner == 0 else 0.0
            own[nv + part.x + i] += found[EFFORTS + i] + more


@kernel
def add_element_changes(
    part: Part, t: float, y: Floats, ways: Floats, steps: Floats, room: TangentRoom, out: Floats
) -> None:
    """Add changes of generalized forces and rates of x by an element at joints.

    They are along displacements.

    Args:
        part: The element, ``PART``.
        t: Time [s].
        y: State, also in ``room.state``.
        ways: Displacements, row by row, (k, displacement).
        steps: Steps of differences along these as a whole, (k,).
        room: Arrays.
        out: (kinds, k, nv + nx).
    """
    nv, shifts, program = room.tau.shape[0], room.shifts, room.numbers.program
    whole = element_at(program, part.block).about == ABOUT_POSE
    if whole:
        for n in range(part.freedoms[0]):
            for kind in range(2):
                at = kind * nv + part.v[0] + n
                if is_moved(ways, at):
                    about = kind, 0, n, True
                    _differentiate(part, about, t, y, _OWN * room.units[at], room, room.column)
                    _add_column(part, at, ways, room, out)
    else:
        speed = _look(part, t, y, room)
        count = _differentiate_law(part, t, y, ways, steps, room)
        for d in range(ways.shape[0]):
            _add_along(part, count, speed, ways[d], d, room, out)
    for m in range(shifts.steps.shape[0]):
        acts, at = shifts.acts[part.number, m], room.first_number[0] + m
        if (acts & FRAMES != 0 or (whole and acts != 0)) and is_moved(ways, at):
            note_words(program, shifts.program, m)
            _differentiate(part, (_NUMBER, 0, m, True), t, y, shifts.steps[m], room, room.column)
            put_back_words(program, shifts.program, m)
            _add_column(part, at, ways, room, out)


@inlined
def time_step(ways: Floats, steps: Floats) -> float:
    """Return the step of differences over time: the largest of those along displacements."""
    at, step = ways.shape[1] - 1, 0.0
    for d in range(ways.shape[0]):
        own = steps[d] * abs(ways[d, at])
        if own > 0.0:
            step = max(step, own)
    return float(step)
