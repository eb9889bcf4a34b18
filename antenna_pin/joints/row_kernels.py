"""Contact of a joint with play, compiled: rates, forces, their moments."""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Floats, Memory, Pose, Records, Six
from antenna_pin.compiled.decorators import deferred, inlined, kernel
from antenna_pin.contact.kernels import bristle_force, damped_force, elastic_force, friction_force
from antenna_pin.contact.records import FRICTION_SIZE
from antenna_pin.joints.geometry.revolute_kernels import Revolute
from antenna_pin.joints.layout_kernels import BRISTLES, friction_at, joint_at


@inlined
def row_rates(pose: Pose, out: Contact) -> None:
    """Fill depth rate and slip of the two material points at the contact."""
    rx = out.point[0] - pose.centre[0]
    ry = out.point[1] - pose.centre[1]
    rz = out.point[2] - pose.centre[2]
    vx = pose.velocity[0] + pose.spin[1] * rz - pose.spin[2] * ry
    vy = pose.velocity[1] + pose.spin[2] * rx - pose.spin[0] * rz
    vz = pose.velocity[2] + pose.spin[0] * ry - pose.spin[1] * rx
    nx, ny, nz = out.normal[0], out.normal[1], out.normal[2]
    opening = vx * nx + vy * ny + vz * nz
    out.rate = -opening
    out.slip[0] = vx - opening * nx
    out.slip[1] = vy - opening * ny
    out.slip[2] = vz - opening * nz


@inlined
def _press(normal: Floats, remembered: Memory, out: Contact) -> float:
    """Fill the normal force of a row and its elastic part; return the former [N]."""
    depth = -out.gap
    elastic = elastic_force(normal, depth)
    force = damped_force(
        normal, elastic, depth, out.rate, remembered.approach_speed, remembered.effective_mass
    )
    out.force = force
    out.elastic = elastic
    return float(force)


@kernel
def row_normal_force(normal: Floats, remembered: Memory, out: Contact) -> None:
    """Fill the normal force of a row; its friction is not looked at."""
    _press(normal, remembered, out)


@kernel
def row_forces(normal: Floats, friction: Floats, remembered: Memory, out: Contact) -> None:
    """Fill the forces of a row from its laws; friction with bristles comes after.

    Args:
        normal: The normal law's numbers.
        friction: The friction law's numbers.
        remembered: The contact's memory.
        out: The row.
    """
    force = _press(normal, remembered, out)
    fx, fy, fz = friction_force(friction, force, out.slip[0], out.slip[1], out.slip[2])
    out.friction[0] = fx
    out.friction[1] = fy
    out.friction[2] = fz


@inlined
def no_forces(out: Contact) -> None:
    """Clear the forces of a row."""
    out.force = 0.0
    out.elastic = 0.0
    out.lost_normal = 0.0
    out.lost_friction = 0.0
    for i in range(3):
        out.friction[i] = 0.0


@inlined
def friction_power(out: Contact) -> float:
    """Power that friction takes [W]."""
    power = out.friction[0] * out.slip[0] + out.friction[1] * out.slip[1] + out.friction[2] * out.slip[2]
    return -float(power)


@inlined
def row_wrench(pose: Pose, out: Contact) -> Six:
    """Return force and torque about the journal's centre of one row, in bearing axes."""
    gx = out.force * out.normal[0] + out.friction[0]
    gy = out.force * out.normal[1] + out.friction[1]
    gz = out.force * out.normal[2] + out.friction[2]
    rx = out.point[0] - pose.centre[0]
    ry = out.point[1] - pose.centre[1]
    rz = out.point[2] - pose.centre[2]
    return gx, gy, gz, ry * gz - rz * gy, rz * gx - rx * gz, rx * gy - ry * gx


@inlined
def add_wrench(pose: Pose, out: Contact) -> None:
    """Add force and torque of a row to the resultant in the pose."""
    gx, gy, gz, hx, hy, hz = row_wrench(pose, out)
    pose.force[0] += gx
    pose.force[1] += gy
    pose.force[2] += gz
    pose.moment[0] += hx
    pose.moment[1] += hy
    pose.moment[2] += hz


@inlined
def no_wrench(pose: Pose) -> None:
    """Clear the resultant."""
    for i in range(3):
        pose.force[i] = 0.0
        pose.moment[i] = 0.0


@deferred
def bristles(
    p: Floats,
    b: int,
    y: Floats,
    x0: int,
    memory: Records[Memory],
    table: Records[Contact],
    rates: Floats,
    r0: int,
) -> None:
    """Fill the friction of a bristle law, and the rates of its states.

    The bristle of a contact that is apart is constant; at the onset it is set to zero.
    """
    j = joint_at(p, b)
    for k in range(j.contacts):
        own = j.x + k * j.stride + BRISTLES
        r = j.row + k
        if memory[r].touching == 0.0:
            for i in range(j.stride - BRISTLES):
                rates[r0 + own + i] = 0.0
            continue
        out = table[r]
        law = friction_at(b, k)
        slip, normal = (out.slip[0], out.slip[1], out.slip[2]), (out.normal[0], out.normal[1], out.normal[2])
        fx, fy, fz = bristle_force(
            p[law : law + FRICTION_SIZE], out.force, slip, normal, y[x0 + own :], rates[r0 + own :]
        )
        out.friction[0] = fx
        out.friction[1] = fy
        out.friction[2] = fz


@kernel
def lever(depth: float, whole: float) -> float:
    """Return the place of a flange's force: 0 on the axis, 1 at the rim.

    The rim's point is its deepest.

    With the far edge of the annulus free (``whole``, the difference in depth across it, above the depth) it
    acts at the rim. Else both edges press: the force's point moves from the rim to the axis as the tilt goes
    to zero, by g(s) = s^3 (10 - 15 s + 6 s^2) of s = whole / depth, which has two zero derivatives at both
    ends: smooth at the rim, and so flat at the axis that a tilt of round-off size has no effect.

    This has no potential. A potential with the force F(depth) at the rim and on the axis would need the lever
    of the rim all the way to the axis. So the work of tilting a flange that presses flat differs from the
    stored energy, by at most F depth / 4 from flat to its edge; it is counted with the losses in normal
    direction, and may be negative. (A load that is ``distributed`` has a potential.)
    """
    if whole >= depth:
        return 1.0
    s = whole / depth
    return s * s * s * (10.0 - s * (15.0 - 6.0 * s))


@inlined
def lever_slope(s: float) -> float:
    """Return the slope of :func:`lever` over s = whole / depth, below 1."""
    return float(30.0 * s * s * (1.0 - s) * (1.0 - s))


@kernel
def place_flange_force(shape: Revolute, pose: Pose, out: Contact) -> None:
    """Shift a flange row's point to the point of the force, with its rates.

    Before, it is the deepest point of the rim.

    The depth remains the deepest point's. Its own rate jumps where the deepest point moves from one side of
    the rim to the other; that of the force's point does not. Without contact nothing is moved.
    """
    for i in range(3):
        out.arm[i] = 0.0
    if out.gap >= 0.0:
        return
    outer, flange = shape.outer_radius, shape.flange_radius
    whole = 2.0 * min(outer, flange) * math.hypot(pose.axis[0], pose.axis[1])
    if whole >= -out.gap:
        return
    rest = 1.0 - lever(-out.gap, whole)
    # The middle of the annulus: of the bearing's end face, or of the smaller flange.
    if flange >= outer:
        mx, my, mz = 0.0, 0.0, shape.side * shape.half_length
    else:
        reach = shape.side * shape.half_distance
        mx = pose.centre[0] + reach * pose.axis[0]
        my = pose.centre[1] + reach * pose.axis[1]
        mz = pose.centre[2] + reach * pose.axis[2]
    out.arm[0] = rest * (out.point[0] - mx)
    out.arm[1] = rest * (out.point[1] - my)
    out.arm[2] = rest * (out.point[2] - mz)
    for i in range(3):
        out.point[i] -= out.arm[i]
    row_rates(pose, out)


@inlined
def arm_power(pose: Pose, out: Contact) -> float:
    """Return the power of a flange's spring between deepest point and force [W]."""
    return float(out.elastic * arm_rate(pose, out))


@inlined
def arm_rate(pose: Pose, out: Contact) -> float:
    """Return the rate of both points' distance along the normal by spin [m/s]."""
    ax, ay, az = out.arm[0], out.arm[1], out.arm[2]
    vx = pose.spin[1] * az - pose.spin[2] * ay
    vy = pose.spin[2] * ax - pose.spin[0] * az
    vz = pose.spin[0] * ay - pose.spin[1] * ax
    return float(vx * out.normal[0] + vy * out.normal[1] + vz * out.normal[2])
