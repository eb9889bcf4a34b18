"""Elements on links, compiled: their inputs, forces on the tree, and bookkeeping.

Their blocks are at the end of a program, from ``points`` of its head on, with the springs between points
(:mod:`antenna_pin.dynamics.point_kernels`) first: ``ELEMENT``, of which kind, length, x, on and partner are
used (start of the desk after this head; 0 of a spring between points), the record of its kind, and the desk
(:mod:`antenna_pin.elements.desk_kernels`), which is written at each evaluation.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, Records, Triple, Vector3, layout
from antenna_pin.compiled.decorators import deferred, inlined, kernel, record
from antenna_pin.dynamics.audit_kernels import mass_centre
from antenna_pin.dynamics.kernels import PARAMETERS, act_at, element_at, head_of, own_motion
from antenna_pin.dynamics.point_kernels import add_pull, add_wrench, draw, push, stored_between
from antenna_pin.elements import kernels as elements
from antenna_pin.elements.desk_kernels import (
    BOOK,
    BOOK_WORDS,
    JOINT,
    LINK,
    LINK_WORDS,
    SEEN_JOINT_WORDS,
    STATE,
    STATE_WORDS,
    WHOLE,
    WHOLE_WORDS,
    Desk,
    LinkRecord,
    LinksBook,
    clear,
)
from antenna_pin.mechanism.tree_kernels import Body, Place, place_bodies


class Applied(Record):
    """A force on a link at a sample, world axes."""

    force: Vector3  # [N]
    torque: Vector3  # about the point of application [N m]


APPLIED = layout(Applied)


@inlined
def desk_of(program: Floats, b: int) -> Desk:
    """Return the desk of the element at b: whole, links, joints, states."""
    first = b + element_at(program, b).partner
    whole = program[first : first + WHOLE_WORDS].view(WHOLE)
    first += WHOLE_WORDS
    second = first + whole[0].links * LINK_WORDS
    third = second + whole[0].joints * SEEN_JOINT_WORDS
    end = third + whole[0].states * STATE_WORDS
    links, joints = program[first:second].view(LINK), program[second:third].view(JOINT)
    return whole, links, joints, program[third:end].view(STATE)


@kernel
def see(t: float, y: Floats, program: Floats, b: int, places: Records[Place]) -> None:
    """Write the input of the element at b to its desk, from ``places`` of bodies."""
    head = head_of(program)
    whole, links, joints, states = desk_of(program, b)
    whole[0].time = t
    for i in range(links.shape[0]):
        _see_link(links[i], places)
    first = b + element_at(program, b).partner + WHOLE_WORDS + whole[0].links * LINK_WORDS
    for i in range(joints.shape[0]):
        joints[i].angle, joints[i].rate, _, _ = own_motion(program, first + i * SEEN_JOINT_WORDS, y, head.nq)
    x = head.nq + head.nv + element_at(program, b).x + BOOK_WORDS
    for i in range(states.shape[0]):
        states[i].value = y[x + i]


@inlined
def _see_link(link: LinkRecord, places: Records[Place]) -> None:
    p = link.point
    if link.body < 0:
        for k in range(3):
            link.place[k] = p[k]
            link.velocity[k] = 0.0
            link.spin[k] = 0.0
            for n in range(3):
                link.rotation[k, n] = link.axes[k, n]
        return
    own = places[link.body]
    r, v, w = own.rotation, own.velocity, own.spin
    x = r[0, 0] * p[0] + r[0, 1] * p[1] + r[0, 2] * p[2]
    y = r[1, 0] * p[0] + r[1, 1] * p[1] + r[1, 2] * p[2]
    z = r[2, 0] * p[0] + r[2, 1] * p[1] + r[2, 2] * p[2]
    link.place[0], link.place[1], link.place[2] = own.origin[0] + x, own.origin[1] + y, own.origin[2] + z
    link.velocity[0] = v[0] + w[1] * z - w[2] * y
    link.velocity[1] = v[1] + w[2] * x - w[0] * z
    link.velocity[2] = v[2] + w[0] * y - w[1] * x
    a = link.axes
    for k in range(3):
        link.spin[k] = w[k]
        for n in range(3):
            link.rotation[k, n] = r[k, 0] * a[0, n] + r[k, 1] * a[1, n] + r[k, 2] * a[2, n]


@kernel
def do(program: Floats, b: int) -> None:
    """Write what the element at b does to its desk, by what it sees there."""
    e = element_at(program, b)
    desk = desk_of(program, b)
    whole, links, _, _ = desk
    if e.on == 0.0:
        clear(desk)
        return
    elements.act(e.kind, program, b + PARAMETERS, whole[0].time, desk)
    if whole[0].internal == 0:
        return
    first = links[0]
    fx = fy = fz = mx = my = mz = 0.0
    for i in range(1, links.shape[0]):
        f, m, p = links[i].force, links[i].torque, links[i].place
        x, y, z = p[0] - first.place[0], p[1] - first.place[1], p[2] - first.place[2]
        fx += f[0]
        fy += f[1]
        fz += f[2]
        mx += m[0] + y * f[2] - z * f[1]
        my += m[1] + z * f[0] - x * f[2]
        mz += m[2] + x * f[1] - y * f[0]
    first.force[0], first.force[1], first.force[2] = -fx, -fy, -fz
    first.torque[0], first.torque[1], first.torque[2] = -mx, -my, -mz


@kernel
def _apply(
    y: Floats,
    program: Floats,
    b: int,
    tree: Records[Body],
    places: Records[Place],
    tau: Floats,
    rates: Floats,
) -> None:
    """Add the desk's forces of the element at b to tau, and book them.

    The mass centre of all bodies is in the scratch place of ``places``.
    """
    head, e = head_of(program), element_at(program, b)
    whole, links, joints, states = desk_of(program, b)
    x = head.nv + e.x
    book = record(rates[x : x + BOOK_WORDS], BOOK)
    centre = places[tree.shape[0]].origin
    for k in range(3):
        book.impulse[k] = 0.0
        book.angular_impulse[k] = 0.0
        book.central_impulse[k] = 0.0
    power = 0.0
    for i in range(links.shape[0]):
        link = links[i]
        f, m, p = link.force, link.torque, link.place
        power += f[0] * link.velocity[0] + f[1] * link.velocity[1] + f[2] * link.velocity[2]
        power += m[0] * link.spin[0] + m[1] * link.spin[1] + m[2] * link.spin[2]
        force, torque, place = (f[0], f[1], f[2]), (m[0], m[1], m[2]), (p[0], p[1], p[2])
        body = link.body
        if body >= 0:  # a force on the world does no work
            _book(book, force, torque, place, centre)
        while body >= 0:
            push(tree[body], places[body], force, torque, place, tau)
            body = tree[body].parent
    first = b + e.partner + WHOLE_WORDS + whole[0].links * LINK_WORDS
    for i in range(joints.shape[0]):
        at = first + i * SEEN_JOINT_WORDS
        _, _, gx, gy = own_motion(program, at, y, head.nq)
        power += joints[i].torque * act_at(program, at, joints[i].torque, (gx, gy), y, head.nq, tau)
    passive = whole[0].passive != 0
    book.work = 0.0 if passive else power
    book.gross_work = abs(book.work)
    book.loss = whole[0].loss if passive else 0.0
    for i in range(states.shape[0]):
        rates[x + BOOK_WORDS + i] = states[i].rate


@inlined
def _book(book: LinksBook, force: Triple, torque: Triple, place: Triple, centre: Floats) -> None:
    """Add a force at a place, and a torque, to the rates of impulses."""
    fx, fy, fz = force
    mx, my, mz = torque
    px, py, pz = place
    cx, cy, cz = px - centre[0], py - centre[1], pz - centre[2]
    book.impulse[0] += fx
    book.impulse[1] += fy
    book.impulse[2] += fz
    book.angular_impulse[0] += mx + py * fz - pz * fy
    book.angular_impulse[1] += my + pz * fx - px * fz
    book.angular_impulse[2] += mz + px * fy - py * fx
    book.central_impulse[0] += mx + cy * fz - cz * fy
    book.central_impulse[1] += my + cz * fx - cx * fz
    book.central_impulse[2] += mz + cx * fy - cy * fx


@deferred
def add_forces(
    t: float,
    y: Floats,
    program: Floats,
    tree: Records[Body],
    places: Records[Place],
    tau: Floats,
    rates: Floats,
) -> None:
    """Add the generalized forces of all elements on links; write their rates of x.

    Args:
        t: Time [s].
        y: State [q, v, x].
        program: Program of all force elements; desks are written.
        tree: Bodies, parents first.
        places: Written: PLACE, (bodies + 1,), places of the bodies; the last is scratch.
        tau: Generalized force, (nv,), added to.
        rates: Written behind rates[nv].
    """
    head = head_of(program)
    place_bodies(y, head.nq, tree, places)
    b = head.points
    while b < program.shape[0] and element_at(program, b).partner == 0:
        draw(program, b, tree, places, tau, rates)
        b += element_at(program, b).length
    if b < program.shape[0]:
        mass_centre(tree, places, places[tree.shape[0]].origin)
    while b < program.shape[0]:
        see(t, y, program, b, places)
        do(program, b)
        _apply(y, program, b, tree, places, tau, rates)
        b += element_at(program, b).length


@deferred
def write_wrenches(program: Floats, places: Records[Place], out: Floats) -> None:
    """Write the last wrenches of all elements on bodies: world axes, (6 bodies,).

    Of each body force [N], and moment about its origin [N m]; nothing if ``out`` is empty.
    """
    if out.shape[0] == 0:
        return
    for k in range(out.shape[0]):
        out[k] = 0.0
    b = head_of(program).points
    while b < program.shape[0]:
        if element_at(program, b).partner == 0:
            add_pull(program, b, places, out)
        else:
            _, links, _, _ = desk_of(program, b)
            for i in range(links.shape[0]):
                f, m, p = links[i].force, links[i].torque, links[i].place
                if links[i].body >= 0:
                    force, torque, point = (f[0], f[1], f[2]), (m[0], m[1], m[2]), (p[0], p[1], p[2])
                    add_wrench(links[i].body, places, force, torque, point, out)
        b += element_at(program, b).length


@kernel
def kept_on_links(y: Floats, program: Floats, b: int, places: Records[Place]) -> float:
    """Return the stored energy of the element at b [J].

    Bodies are at ``places``; the time is that of the last evaluation.
    """
    whole, _, _, _ = desk_of(program, b)
    if whole[0].passive == 0:
        return 0.0
    see(whole[0].time, y, program, b, places)
    do(program, b)
    return float(whole[0].energy)


@deferred
def stored(y: Floats, program: Floats, places: Records[Place]) -> float:
    """Return the energy stored in all elements on links [J]."""
    total = 0.0
    b = head_of(program).points
    while b < program.shape[0]:
        e = element_at(program, b)
        total += (
            stored_between(program, b, places) if e.partner == 0 else kept_on_links(y, program, b, places)
        )
        b += e.length
    return total


@deferred
def kink_on_links(
    t: float, y: Floats, program: Floats, b: int, tree: Records[Body], places: Records[Place]
) -> float:
    """Function of the element at b that passes zero where its forces have a kink."""
    place_bodies(y, head_of(program).nq, tree, places)
    see(t, y, program, b, places)
    do(program, b)
    whole, _, _, _ = desk_of(program, b)
    return float(whole[0].kink)


@deferred
def look_at_links(program: Floats, applied: Records[Applied], energies: Floats) -> None:
    """Write what stands on all desks: ``APPLIED`` of each place, (places,), energies stored, (elements,)."""
    k = n = 0
    b = head_of(program).points
    while b < program.shape[0]:
        e = element_at(program, b)
        if e.partner != 0:
            whole, links, _, _ = desk_of(program, b)
            for i in range(links.shape[0]):
                for j in range(3):
                    applied[k].force[j] = links[i].force[j]
                    applied[k].torque[j] = links[i].torque[j]
                k += 1
            energies[n] = whole[0].energy if whole[0].passive != 0 else 0.0
            n += 1
        b += e.length
