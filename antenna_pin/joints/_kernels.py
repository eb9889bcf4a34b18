"""The clearance joint on flat parameters, compiled: from pose and twist to the generalized force.

A joint is a block of floats in a larger program::

    [kind, length, mode, start in q, start in v, first contact, contacts, start in x, stride in x, place of
     the turned angle in x, A (9, row-major; its columns are the bearing frame's axes in the joint frame),
     c (3, bearing centre in the joint frame), shape (6), then per contact: normal law (16), friction law
     (12); with distributed load then: strips, sectors, first of their rows, sectors' radius, two numbers of
     each sector]

and its contacts are rows of a table of ``TABLE_WIDTH`` columns::

    [gap, normal (3), point (3), depth rate, slip (3), normal force, friction force (3), elastic force, ...]

all in bearing axes. Under distributed load the four contacts are patches (two halves of the bore, two
flanges) whose rows sum up those of their strips and sectors, which follow behind the contacts of all joints.
``memory`` has a row per contact: [touching, approach speed, effective mass at the onset]. What a contact
integrates lies in x from its own start on: [impulse, work lost to normal contact, work lost to friction,
bristle...].

A point load at a flange acts at the deepest point of the rim, or nearer to the axis where the whole annulus
presses (:func:`lever`); its depth, and so its force and the energy stored, stay those of the deepest point.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.contact._friction_kernels import FRICTION_SIZE, bristle_force, friction_force
from antenna_pin.contact._kernels import NORMAL_SIZE, damped_force, elastic_energy, elastic_force
from antenna_pin.geometry._kernels import (
    SHARE,
    bore_contact,
    coal_place,
    flange_contact,
    planar_contact,
    revolute_contacts,
    sector_contacts,
    spherical_contact,
    strip_contacts,
)

REVOLUTE = 1.0
PLANAR = 2.0
SPHERICAL = 3.0
DISTRIBUTED = 4.0
LAST_KIND = 9.0  # kinds of other force elements lie above

MODE = 2
GEOMETRY_GIVEN = 1.0  # rows already hold gap, normal and point (coal)
FORCES_GIVEN = 2.0  # rows already hold forces too (laws in Python)

FIRST_CONTACT = 5
CONTACTS = 6
START_X = 7
STRIDE_X = 8
TURN = 9
AXES = 10
CENTRE = 19
SHAPE = 22
LAWS = 28
LAW_SIZE = NORMAL_SIZE + FRICTION_SIZE

RATE = 7
SLIP = 8
FORCE = 11
FRICTION = 12
ELASTIC = 15

# Of a patch under distributed load: power lost in normal direction and to friction.
PATCH_LOST_NORMAL = 16
PATCH_LOST_FRICTION = 17

# Of a flange under point load (3): from the force's point to the deepest point.
ARM = 19

# Behind the laws of a joint with distributed load: strips, sectors, first of their rows, radius, (sin t,
# cos t / sectors)...
STRIPS = 0
SECTORS = 1
FIRST_STRIP = 2
SECTOR_RADIUS = 3
SECTOR_NODES = 4
DISTRIBUTED_TAIL = LAWS + 4 * LAW_SIZE

IMPULSE = 0
LOST_NORMAL = 1
LOST_FRICTION = 2
BRISTLE_START = 3

TOUCHING = 0
APPROACH = 1
MASS = 2
MEMORY_WIDTH = 3

# Pose and twist of a journal: centre (3), axis (3), rotation child -> H (9, row-major), velocity of the
# centre (3) and angular velocity (3), all in H.
POSE_SIZE = 21
POSE_BUFFER = 27  # with room for a resultant behind


@inlined
def journal_state(p: Any, b: int, y: Any, nq: int, pose: Any) -> None:
    """Write the journal's pose and twist relative to the bearing, in bearing axes."""
    i = int(p[b + 3])
    j = nq + int(p[b + 4])
    if p[b] == PLANAR:
        c = y[i + 2]
        s = y[i + 3]
        pose[0] = y[i]
        pose[1] = y[i + 1]
        pose[2] = 0.0
        pose[3] = 0.0
        pose[4] = 0.0
        pose[5] = 1.0
        pose[6], pose[7], pose[8] = c, -s, 0.0
        pose[9], pose[10], pose[11] = s, c, 0.0
        pose[12], pose[13], pose[14] = 0.0, 0.0, 1.0
        pose[15] = c * y[j] - s * y[j + 1]
        pose[16] = s * y[j] + c * y[j + 1]
        pose[17] = 0.0
        pose[18] = 0.0
        pose[19] = 0.0
        pose[20] = y[j + 2]
        return
    qx, qy, qz, qw = y[i + 3], y[i + 4], y[i + 5], y[i + 6]
    # Rotation child -> joint frame.
    r00 = 1.0 - 2.0 * (qy * qy + qz * qz)
    r01 = 2.0 * (qx * qy - qz * qw)
    r02 = 2.0 * (qx * qz + qy * qw)
    r10 = 2.0 * (qx * qy + qz * qw)
    r11 = 1.0 - 2.0 * (qx * qx + qz * qz)
    r12 = 2.0 * (qy * qz - qx * qw)
    r20 = 2.0 * (qx * qz - qy * qw)
    r21 = 2.0 * (qy * qz + qx * qw)
    r22 = 1.0 - 2.0 * (qx * qx + qy * qy)
    a = b + AXES
    cx, cy, cz = p[b + CENTRE], p[b + CENTRE + 1], p[b + CENTRE + 2]
    px, py, pz = y[i] - cx, y[i + 1] - cy, y[i + 2] - cz
    vx = y[j] + y[j + 4] * cz - y[j + 5] * cy
    vy = y[j + 1] + y[j + 5] * cx - y[j + 3] * cz
    vz = y[j + 2] + y[j + 3] * cy - y[j + 4] * cx
    wx, wy, wz = y[j + 3], y[j + 4], y[j + 5]
    zx, zy, zz = p[a + 2], p[a + 5], p[a + 8]  # journal axis in the child frame
    for k in range(3):
        a0, a1, a2 = p[a + k], p[a + 3 + k], p[a + 6 + k]  # axis k of H in the joint frame
        w0 = a0 * r00 + a1 * r10 + a2 * r20
        w1 = a0 * r01 + a1 * r11 + a2 * r21
        w2 = a0 * r02 + a1 * r12 + a2 * r22
        pose[6 + 3 * k] = w0
        pose[7 + 3 * k] = w1
        pose[8 + 3 * k] = w2
        pose[k] = a0 * px + a1 * py + a2 * pz + w0 * cx + w1 * cy + w2 * cz
        pose[3 + k] = w0 * zx + w1 * zy + w2 * zz
        pose[15 + k] = w0 * vx + w1 * vy + w2 * vz
        pose[18 + k] = w0 * wx + w1 * wy + w2 * wz


@kernel
def centre_and_axis(pose: Any) -> tuple[float, float, float, float, float, float]:
    """Return the first six numbers of a pose: the journal's centre and its axis."""
    return pose[0], pose[1], pose[2], pose[3], pose[4], pose[5]


@kernel
def _distributed_geometry(p: Any, b: int, pose: Any, table: Any, row: int, bore: bool, flanges: bool) -> None:
    """Fill strips and sectors of a joint with distributed load, and its patches, or one kind only."""
    shape = p[b + SHAPE : b + SHAPE + 6]
    tail = b + DISTRIBUTED_TAIL
    strips = int(p[tail + STRIPS])
    count = int(p[tail + SECTORS])
    first = int(p[tail + FIRST_STRIP])
    ox, oy, oz, zx, zy, zz = pose[0], pose[1], pose[2], pose[3], pose[4], pose[5]
    if bore:
        strip_contacts(shape, strips, ox, oy, oz, zx, zy, zz, table, row, first)
    if flanges:
        nodes = p[tail + SECTOR_NODES : tail + SECTOR_NODES + 2 * count]
        radius = p[tail + SECTOR_RADIUS]
        sector_contacts(shape, nodes, count, radius, ox, oy, oz, zx, zy, zz, table, row + 2, first + strips)


@kernel
def contact_geometry(p: Any, b: int, pose: Any, table: Any, row: int) -> None:
    """Fill gap, normal and point of a joint's rows in closed form.

    A block may have no contacts: an ideal hinge's.
    """
    if p[b + CONTACTS] == 0.0:
        return
    shape = p[b + SHAPE : b + SHAPE + 6]
    if p[b] == PLANAR:
        planar_contact(shape, pose[0], pose[1], table, row)
    elif p[b] == SPHERICAL:
        spherical_contact(shape, pose[0], pose[1], pose[2], table, row)
    elif p[b] == DISTRIBUTED:
        _distributed_geometry(p, b, pose, table, row, True, True)
    else:
        revolute_contacts(shape, pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], table, row)


@inlined
def touching_geometry(p: Any, b: int, pose: Any, memory: Any, table: Any, row: int) -> None:
    """Fill gap, normal and point of the contacts that touch; the others have no force, whatever their gap."""
    if p[b] == DISTRIBUTED:
        bore = memory[row, TOUCHING] != 0.0 or memory[row + 1, TOUCHING] != 0.0
        flanges = memory[row + 2, TOUCHING] != 0.0 or memory[row + 3, TOUCHING] != 0.0
        _distributed_geometry(p, b, pose, table, row, bore, flanges)
        return
    if p[b] != REVOLUTE:
        contact_geometry(p, b, pose, table, row)
        return
    shape = p[b + SHAPE : b + SHAPE + 6]
    ox, oy, oz, zx, zy, zz = pose[0], pose[1], pose[2], pose[3], pose[4], pose[5]
    sine = math.sqrt(zx * zx + zy * zy)
    for k in range(int(p[b + CONTACTS])):
        if memory[row + k, TOUCHING] == 0.0:
            continue
        side = 1.0 - 2.0 * (k % 2)
        if k < 2:
            bore_contact(shape, side, ox, oy, oz, zx, zy, zz, sine, table, row + k)
        else:
            flange_contact(shape, side, ox, oy, oz, zx, zy, zz, sine, table, row + k)


@inlined
def _row_rates(pose: Any, table: Any, r: int) -> None:
    """Fill depth rate and slip of a row: the relative velocity of the two material points at the contact."""
    rx = table[r, 4] - pose[0]
    ry = table[r, 5] - pose[1]
    rz = table[r, 6] - pose[2]
    vx = pose[15] + pose[19] * rz - pose[20] * ry
    vy = pose[16] + pose[20] * rx - pose[18] * rz
    vz = pose[17] + pose[18] * ry - pose[19] * rx
    nx, ny, nz = table[r, 1], table[r, 2], table[r, 3]
    opening = vx * nx + vy * ny + vz * nz
    table[r, RATE] = -opening
    table[r, SLIP] = vx - opening * nx
    table[r, SLIP + 1] = vy - opening * ny
    table[r, SLIP + 2] = vz - opening * nz


@kernel
def lever(depth: float, whole: float) -> float:
    """Return where a flange's point load acts: 0 on the axis, 1 at the deepest point of the rim.

    With the far edge of the annulus free (``whole``, the difference in depth across it, above the depth) it
    acts at the rim. Else both edges press: the force's point moves from the rim to the axis as the tilt goes
    to zero, by g(s) = s^3 (10 - 15 s + 6 s^2) of s = whole / depth, which has two derivatives of zero at both
    ends: smooth at the rim, and so flat at the axis that a tilt of round-off size does nothing at all.

    No potential belongs to that. One whose force is F(depth) at the rim and on the axis, with the lever in
    between, would need the lever of the rim all the way to the axis. So the work of tilting a flange that
    presses flat differs from what its spring stores, by at most F depth / 4 from flat to its edge; it is
    counted with the losses in normal direction, and may be negative. (A load that is ``distributed`` has a
    potential.)
    """
    if whole >= depth:
        return 1.0
    s = whole / depth
    return s * s * s * (10.0 - s * (15.0 - 6.0 * s))


@kernel
def _place_flange_force(p: Any, b: int, pose: Any, table: Any, r: int, side: float) -> None:
    """Move a flange row's point, the deepest of the rim, to where the force acts, and take the rates there.

    The depth stays the deepest point's. Its own rate jumps where the deepest point goes from one side of the
    rim to the other; that of the force's point does not.
    """
    for i in range(3):
        table[r, ARM + i] = 0.0
    outer, flange = p[b + SHAPE + 2], p[b + SHAPE + 4]
    whole = 2.0 * min(outer, flange) * math.hypot(pose[3], pose[4])
    if whole >= -table[r, 0]:
        return
    rest = 1.0 - lever(-table[r, 0], whole)
    # The middle of the annulus: of the bearing's end face, or of the smaller flange.
    if flange >= outer:
        mx, my, mz = 0.0, 0.0, side * p[b + SHAPE + 1]
    else:
        reach = side * p[b + SHAPE + 5]
        mx = pose[0] + reach * pose[3]
        my = pose[1] + reach * pose[4]
        mz = pose[2] + reach * pose[5]
    table[r, ARM] = rest * (table[r, 4] - mx)
    table[r, ARM + 1] = rest * (table[r, 5] - my)
    table[r, ARM + 2] = rest * (table[r, 6] - mz)
    for i in range(3):
        table[r, 4 + i] -= table[r, ARM + i]
    _row_rates(pose, table, r)


@inlined
def contact_rates(p: Any, b: int, pose: Any, table: Any, row: int) -> None:
    """Fill depth rate and slip of a joint's contacts; with distributed load of its loaded strips too.

    A point load at a flange that presses flat is moved to where it acts.
    """
    for r in range(row, row + int(p[b + CONTACTS])):
        _row_rates(pose, table, r)
    if p[b] == REVOLUTE and p[b + CONTACTS] > 0.0:
        for k in range(2):
            _place_flange_force(p, b, pose, table, row + 2 + k, 1.0 - 2.0 * k)
    if p[b] == DISTRIBUTED:
        tail = b + DISTRIBUTED_TAIL
        first = int(p[tail + FIRST_STRIP])
        for r in range(first, first + int(p[tail + STRIPS]) + 2 * int(p[tail + SECTORS])):
            if table[r, 0] < 0.0:
                _row_rates(pose, table, r)


@kernel
def _row_forces(p: Any, law: int, approach: float, mass: float, table: Any, r: int) -> None:
    """Fill the forces of a row from the laws at p[law:]; friction with bristles comes after."""
    normal = p[law : law + NORMAL_SIZE]
    friction = p[law + NORMAL_SIZE : law + LAW_SIZE]
    depth = -table[r, 0]
    elastic = elastic_force(normal, depth)
    force = damped_force(normal, elastic, depth, table[r, RATE], approach, mass)
    table[r, FORCE] = force
    table[r, ELASTIC] = elastic
    fx, fy, fz = friction_force(friction, force, table[r, SLIP], table[r, SLIP + 1], table[r, SLIP + 2])
    table[r, FRICTION] = fx
    table[r, FRICTION + 1] = fy
    table[r, FRICTION + 2] = fz


@kernel
def _bristles(
    p: Any, b: int, y: Any, x0: int, memory: Any, first: int, table: Any, row: int, rates: Any, r0: int
) -> None:
    """Fill the friction of a joint whose law has bristles, and the rates of what they remember.

    The bristle of a contact that is apart does not change; at the onset it is set to zero.
    """
    start = int(p[b + START_X]) + BRISTLE_START
    stride = int(p[b + STRIDE_X])
    for k in range(int(p[b + CONTACTS])):
        own = start + k * stride
        if memory[first + k, TOUCHING] == 0.0:
            for i in range(stride - BRISTLE_START):
                rates[r0 + own + i] = 0.0
            continue
        r = row + k
        fx, fy, fz = bristle_force(
            p,
            b + LAWS + k * LAW_SIZE + NORMAL_SIZE,
            table[r, FORCE],
            table[r, SLIP],
            table[r, SLIP + 1],
            table[r, SLIP + 2],
            table[r, 1],
            table[r, 2],
            table[r, 3],
            y,
            x0 + own,
            rates,
            r0 + own,
        )
        table[r, FRICTION] = fx
        table[r, FRICTION + 1] = fy
        table[r, FRICTION + 2] = fz


@inlined
def patch_rows(p: Any, b: int, k: int) -> tuple[int, int]:
    """Return the range of table rows of patch k: bore at +z, bore at -z, flange at +z, flange at -z."""
    tail = b + DISTRIBUTED_TAIL
    first = int(p[tail + FIRST_STRIP])
    strips = int(p[tail + STRIPS])
    sectors = int(p[tail + SECTORS])
    if k == 0:
        return first + strips // 2, first + strips
    if k == 1:
        return first, first + strips // 2
    start = first + strips + (k - 2) * sectors
    return start, start + sectors


@kernel
def _tune_sectors(p: Any, b: int, normal: Any, table: Any, r: int, first: int) -> tuple[float, float]:
    r"""Return alpha and gamma: the forces of a flange's sectors times 1 + alpha + gamma x^2 have a potential.

    The sectors of a partly loaded ring move with the ends of its loaded arc, so that the forces that they
    sample are not quite the derivatives of the energy that they sample,

        V(d, a) = sum_k W_k(sigma) U(d (1 - x_k^2)),   sigma^2 = d / (2 a),

    with the depth d of the deepest point and the part 2 a that the depth falls over the ring. Asked of the
    factor are V's two derivatives, dV/dd = sum F_k and dV/da = -2 sigma^2 sum F_k x_k^2; with F_k = W_k f_k,
    b_n = sum F_k x_k^n and W' = W / (sigma (1 - sigma^2 x^2)) both ask for the same

        alpha b_0 + gamma b_2 = alpha b_2 + gamma b_4 = sum W_k U_k / (2 d (1 - sigma^2 x_k^2)) - b_2,

    which is zero but for the error of the sums.
    """
    nodes = b + DISTRIBUTED_TAIL + SECTOR_NODES
    depth = -table[r, 0]
    square = table[r, SHARE] * table[r, SHARE]
    b0 = 0.0
    b2 = 0.0
    b4 = 0.0
    asked = 0.0
    for k in range(int(p[b + DISTRIBUTED_TAIL + SECTORS])):
        x = p[nodes + 2 * k] * p[nodes + 2 * k]
        d = -table[first + k, 0]
        weight = table[first + k, SHARE]
        force = weight * elastic_force(normal, d)
        b0 += force
        b2 += force * x
        b4 += force * x * x
        asked += weight * elastic_energy(normal, d) / (1.0 - square * x)
    asked = 0.5 * asked / depth - b2
    determinant = b0 * b4 - b2 * b2
    if determinant <= 0.0:
        return 0.0, 0.0
    return asked * (b4 - b2) / determinant, asked * (b0 - b2) / determinant


@kernel
def _patch_forces(p: Any, b: int, k: int, law: int, approach: float, mass: float, table: Any, r: int) -> None:
    """Fill the forces of the loaded strips or sectors of patch k, and their sums in the patch's row r.

    The law is the patch's; at its own depth, rate and slip each strip or sector has its share of it.
    """
    first, last = patch_rows(p, b, k)
    alpha = 0.0
    gamma = 0.0
    if k >= 2 and table[r, SHARE] < 1.0 and table[r, 0] < 0.0:
        alpha, gamma = _tune_sectors(p, b, p[law : law + NORMAL_SIZE], table, r, first)
    nodes = b + DISTRIBUTED_TAIL + SECTOR_NODES
    for s in range(first, last):
        if table[s, 0] >= 0.0:
            continue
        _row_forces(p, law, approach, mass, table, s)
        share = table[s, SHARE]
        if k >= 2:
            x = p[nodes + 2 * (s - first)]
            share *= 1.0 + alpha + gamma * x * x
        for column in range(FORCE, ELASTIC + 1):
            table[s, column] *= share
        table[r, FORCE] += table[s, FORCE]
        table[r, ELASTIC] += table[s, ELASTIC]
        power = 0.0
        for i in range(3):
            table[r, FRICTION + i] += table[s, FRICTION + i]
            power += table[s, FRICTION + i] * table[s, SLIP + i]
        table[r, PATCH_LOST_NORMAL] += (table[s, FORCE] - table[s, ELASTIC]) * table[s, RATE]
        table[r, PATCH_LOST_FRICTION] -= power


@kernel
def patch_energy(p: Any, b: int, k: int, table: Any) -> float:
    """Energy stored by the loaded strips or sectors of patch k [J]; gaps from the table."""
    first, last = patch_rows(p, b, k)
    law = b + LAWS + k * LAW_SIZE
    normal = p[law : law + NORMAL_SIZE]
    energy = 0.0
    for s in range(first, last):
        if table[s, 0] < 0.0:
            energy += table[s, SHARE] * elastic_energy(normal, -table[s, 0])
    return energy


@inlined
def contact_forces(
    p: Any, b: int, y: Any, x0: int, memory: Any, first: int, table: Any, row: int, rates: Any, r0: int
) -> None:
    """Fill the forces of a joint's rows from its laws; contacts that do not touch have none.

    x starts at y[x0] and its rates at rates[r0]; ``first`` is the joint's first row in ``memory``.
    """
    distributed = p[b] == DISTRIBUTED
    for k in range(int(p[b + CONTACTS])):
        r = row + k
        if memory[first + k, TOUCHING] == 0.0:
            # Both are zero only if all columns between are; most contacts are apart, and stay so.
            if table[r, FORCE] != 0.0 or table[r, ELASTIC] != 0.0:
                for column in range(FORCE, PATCH_LOST_FRICTION + 1):
                    table[r, column] = 0.0
            continue
        law = b + LAWS + k * LAW_SIZE
        if distributed:
            for column in range(FORCE, PATCH_LOST_FRICTION + 1):
                table[r, column] = 0.0
            _patch_forces(p, b, k, law, memory[first + k, APPROACH], memory[first + k, MASS], table, r)
        else:
            _row_forces(p, law, memory[first + k, APPROACH], memory[first + k, MASS], table, r)
    if p[b + STRIDE_X] > BRISTLE_START:
        _bristles(p, b, y, x0, memory, first, table, row, rates, r0)


@inlined
def _row_wrench(pose: Any, table: Any, r: int) -> tuple[float, float, float, float, float, float]:
    """Return force and torque about the journal's centre of one row, in bearing axes."""
    force = table[r, FORCE]
    gx = force * table[r, 1] + table[r, FRICTION]
    gy = force * table[r, 2] + table[r, FRICTION + 1]
    gz = force * table[r, 3] + table[r, FRICTION + 2]
    rx = table[r, 4] - pose[0]
    ry = table[r, 5] - pose[1]
    rz = table[r, 6] - pose[2]
    return gx, gy, gz, ry * gz - rz * gy, rz * gx - rx * gz, rx * gy - ry * gx


@kernel
def _patch_wrench(p: Any, b: int, pose: Any, table: Any, out: Any, at: int) -> None:
    """Write force and torque of all loaded strips and sectors into out[at:at + 6]."""
    for i in range(6):
        out[at + i] = 0.0
    for k in range(int(p[b + CONTACTS])):
        if table[int(p[b + FIRST_CONTACT]) + k, FORCE] == 0.0:
            continue
        first, last = patch_rows(p, b, k)
        for s in range(first, last):
            if table[s, 0] < 0.0:
                gx, gy, gz, hx, hy, hz = _row_wrench(pose, table, s)
                out[at] += gx
                out[at + 1] += gy
                out[at + 2] += gz
                out[at + 3] += hx
                out[at + 4] += hy
                out[at + 5] += hz


@inlined
def _onto_joint(
    p: Any,
    b: int,
    pose: Any,
    fx: float,
    fy: float,
    fz: float,
    mx: float,
    my: float,
    mz: float,
    tau: Any,
) -> None:
    """Add a force and a torque about the journal's centre, in bearing axes, to tau, in the child's own."""
    j = int(p[b + 4])
    if p[b] == PLANAR:
        tau[j] += pose[6] * fx + pose[9] * fy
        tau[j + 1] += pose[7] * fx + pose[10] * fy
        tau[j + 2] += mz
        return
    cx, cy, cz = p[b + CENTRE], p[b + CENTRE + 1], p[b + CENTRE + 2]
    ux = pose[6] * fx + pose[9] * fy + pose[12] * fz
    uy = pose[7] * fx + pose[10] * fy + pose[13] * fz
    uz = pose[8] * fx + pose[11] * fy + pose[14] * fz
    tau[j] += ux
    tau[j + 1] += uy
    tau[j + 2] += uz
    tau[j + 3] += pose[6] * mx + pose[9] * my + pose[12] * mz + cy * uz - cz * uy
    tau[j + 4] += pose[7] * mx + pose[10] * my + pose[13] * mz + cz * ux - cx * uz
    tau[j + 5] += pose[8] * mx + pose[11] * my + pose[14] * mz + cx * uy - cy * ux


@inlined
def contact_wrench(p: Any, b: int, pose: Any, table: Any, row: int, tau: Any, rates: Any, r0: int) -> None:
    """Add the forces of a joint's rows to tau (in the child's own axes) and write what they integrate."""
    fx = 0.0
    fy = 0.0
    fz = 0.0
    mx = 0.0
    my = 0.0
    mz = 0.0
    distributed = p[b] == DISTRIBUTED
    start = r0 + int(p[b + START_X])
    stride = int(p[b + STRIDE_X])
    for k in range(int(p[b + CONTACTS])):
        r = row + k
        own = start + k * stride
        force = table[r, FORCE]
        elastic = table[r, ELASTIC]
        if force == 0.0 and elastic == 0.0:
            rates[own + IMPULSE] = 0.0
            rates[own + LOST_NORMAL] = 0.0
            rates[own + LOST_FRICTION] = 0.0
            continue
        rates[own + IMPULSE] = force
        # Where a law without adhesion is cut off at zero, what the spring gives back is lost too.
        rates[own + LOST_NORMAL] = (force - elastic) * table[r, RATE]
        if k >= 2 and not distributed:
            # The spring is pressed at the deepest point, not at the force's.
            ax, ay, az = table[r, ARM], table[r, ARM + 1], table[r, ARM + 2]
            vx = pose[19] * az - pose[20] * ay
            vy = pose[20] * ax - pose[18] * az
            vz = pose[18] * ay - pose[19] * ax
            opening = vx * table[r, 1] + vy * table[r, 2] + vz * table[r, 3]
            rates[own + LOST_NORMAL] += elastic * opening
        rates[own + LOST_FRICTION] = 0.0
        if force == 0.0 or distributed:
            continue
        rates[own + LOST_FRICTION] = -(
            table[r, FRICTION] * table[r, SLIP]
            + table[r, FRICTION + 1] * table[r, SLIP + 1]
            + table[r, FRICTION + 2] * table[r, SLIP + 2]
        )
        gx, gy, gz, hx, hy, hz = _row_wrench(pose, table, r)
        fx += gx
        fy += gy
        fz += gz
        mx += hx
        my += hy
        mz += hz
    if distributed:
        for k in range(4):
            own = start + k * stride
            rates[own + LOST_NORMAL] = table[row + k, PATCH_LOST_NORMAL]
            rates[own + LOST_FRICTION] = table[row + k, PATCH_LOST_FRICTION]
        _patch_wrench(p, b, pose, table, pose, POSE_SIZE)
        fx, fy, fz = pose[POSE_SIZE], pose[POSE_SIZE + 1], pose[POSE_SIZE + 2]
        mx, my, mz = pose[POSE_SIZE + 3], pose[POSE_SIZE + 4], pose[POSE_SIZE + 5]
    _onto_joint(p, b, pose, fx, fy, fz, mx, my, mz, tau)


@kernel
def unit_normal_force(p: Any, b: int, pose: Any, table: Any, r: int, tau: Any) -> None:
    """Add to tau the generalized force of one newton along the normal of row r."""
    nx, ny, nz = table[r, 1], table[r, 2], table[r, 3]
    rx = table[r, 4] - pose[0]
    ry = table[r, 5] - pose[1]
    rz = table[r, 6] - pose[2]
    _onto_joint(p, b, pose, nx, ny, nz, ry * nz - rz * ny, rz * nx - rx * nz, rx * ny - ry * nx, tau)


@kernel
def wrench_on_journal(p: Any, b: int, pose: Any, table: Any, row: int, out: Any) -> None:
    """Write the contacts' force and torque about the journal's centre, in bearing axes, into out[0:6]."""
    if p[b] == DISTRIBUTED:
        _patch_wrench(p, b, pose, table, out, 0)
        return
    for k in range(6):
        out[k] = 0.0
    for r in range(row, row + int(p[b + CONTACTS])):
        if table[r, FORCE] == 0.0:
            continue
        gx, gy, gz, hx, hy, hz = _row_wrench(pose, table, r)
        out[0] += gx
        out[1] += gy
        out[2] += gz
        out[3] += hx
        out[4] += hy
        out[5] += hz


@inlined
def clearance_joint(
    p: Any, b: int, y: Any, nq: int, nv: int, memory: Any, table: Any, pose: Any, tau: Any, rates: Any
) -> None:
    """Add a clearance joint's generalized force to tau; write the rates of what it integrates.

    Of the table only the rows of touching contacts are brought up to date (see ``contact_geometry`` for all).
    """
    row = int(p[b + FIRST_CONTACT])
    journal_state(p, b, y, nq, pose)
    mode = p[b + MODE]
    if mode < FORCES_GIVEN:
        if mode < GEOMETRY_GIVEN:
            touching_geometry(p, b, pose, memory, table, row)
        contact_rates(p, b, pose, table, row)
        contact_forces(p, b, y, nq + nv, memory, row, table, row, rates, nv)
    contact_wrench(p, b, pose, table, row, tau, rates, nv)


@kernel
def place_for_coal(p: Any, b: int, y: Any, nq: int, shape: Any, pose: Any, work: Any) -> float:
    """Place a revolute joint's bearing in the journal frame for coal; return the sine of the tilt."""
    journal_state(p, b, y, nq, pose)
    coal_place(shape, pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], work)
    return math.hypot(pose[3], pose[4])


@kernel
def wrapped_angle(p: Any, b: int, y: Any) -> tuple[float, float, float]:
    """Rotation of the journal about the bearing axis (swing-twist) and where its rate comes from.

    Returns the angle [rad] in (-pi, pi] and gx, gy: its rate is gx wx + gy wy + wz for the angular velocity w
    of the journal in its own axes (z along the journal).
    """
    i = int(p[b + 3])
    if p[b] == PLANAR:
        return math.atan2(y[i + 3], y[i + 2]), 0.0, 0.0
    a = b + AXES
    qx, qy, qz, qw = y[i + 3], y[i + 4], y[i + 5], y[i + 6]
    # The vector part in bearing axes; the same rotation seen in a frame whose z is the joint's axis.
    hx = p[a] * qx + p[a + 3] * qy + p[a + 6] * qz
    hy = p[a + 1] * qx + p[a + 4] * qy + p[a + 7] * qz
    hz = p[a + 2] * qx + p[a + 5] * qy + p[a + 8] * qz
    square = hz * hz + qw * qw
    if qw < 0.0:
        angle = 2.0 * math.atan2(-hz, -qw)
    else:
        angle = 2.0 * math.atan2(hz, qw)
    if square == 0.0:
        return angle, 0.0, 0.0
    return angle, (hz * hx - qw * hy) / square, (qw * hx + hz * hy) / square


@inlined
def unwrapped(angle: float, near: float) -> float:
    """Return the angle that is ``angle`` but for whole turns and within half a turn of ``near`` [rad]."""
    return angle + 2.0 * math.pi * math.floor((near - angle) / (2.0 * math.pi) + 0.5)


@kernel
def motion_angle(p: Any, b: int, y: Any, x0: int) -> tuple[float, float, float]:
    """Return :func:`wrapped_angle` with its whole turns, from the turned angle in the state's x at y[x0:]."""
    angle, gx, gy = wrapped_angle(p, b, y)
    return unwrapped(angle, y[x0 + int(p[b + TURN])]), gx, gy
