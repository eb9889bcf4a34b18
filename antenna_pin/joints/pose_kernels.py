"""A journal in its bearing, compiled: state to pose, forces back.

A joint has a frame on its parent and one on its child, which coincide at zero; with R and p the pose of the
child's in the parent's, A the axes of bearing and journal and c their centre in either frame, the journal on
the child is in the bearing at A^T (p + R c - c), rotated by A^T R A. With the bearing on the child it is the
inverse: the journal's centre is at d = R^T (c - p) in the child's frame, in the bearing at A^T (d - c),
rotated by A^T R^T A.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Pose, Records, Six, Triple
from antenna_pin.compiled.decorators import deferred, inlined, kernel
from antenna_pin.joints.layout_kernels import JointRecord, joint_at
from antenna_pin.mechanism.spatial_kernels import twist_angle
from antenna_pin.mechanism.tree_kernels import unwrapped


@inlined
def journal_state(j: JointRecord, y: Floats, nq: int, pose: Pose) -> None:
    """Write the journal's pose and twist relative to the bearing, in bearing axes."""
    if j.on_child != 0:
        journal_on_parent(j, y, nq, pose)
        return
    i = j.q
    k = nq + j.v
    if j.planar != 0:
        c = y[i + 2]
        s = y[i + 3]
        pose.centre[0], pose.centre[1], pose.centre[2] = y[i], y[i + 1], 0.0
        pose.axis[0], pose.axis[1], pose.axis[2] = 0.0, 0.0, 1.0
        pose.sine = 0.0
        pose.rotation[0, 0], pose.rotation[0, 1], pose.rotation[0, 2] = c, -s, 0.0
        pose.rotation[1, 0], pose.rotation[1, 1], pose.rotation[1, 2] = s, c, 0.0
        pose.rotation[2, 0], pose.rotation[2, 1], pose.rotation[2, 2] = 0.0, 0.0, 1.0
        pose.velocity[0] = c * y[k] - s * y[k + 1]
        pose.velocity[1] = s * y[k] + c * y[k + 1]
        pose.velocity[2] = 0.0
        pose.spin[0], pose.spin[1], pose.spin[2] = 0.0, 0.0, y[k + 2]
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
    cx, cy, cz = j.centre[0], j.centre[1], j.centre[2]
    px, py, pz = y[i] - cx, y[i + 1] - cy, y[i + 2] - cz
    wx, wy, wz = y[k + 3], y[k + 4], y[k + 5]
    vx = y[k] + wy * cz - wz * cy
    vy = y[k + 1] + wz * cx - wx * cz
    vz = y[k + 2] + wx * cy - wy * cx
    zx, zy, zz = j.axes[0, 2], j.axes[1, 2], j.axes[2, 2]  # journal axis in the child frame
    for m in range(3):
        a0, a1, a2 = j.axes[0, m], j.axes[1, m], j.axes[2, m]  # axis m of H in the joint frame
        w0 = a0 * r00 + a1 * r10 + a2 * r20
        w1 = a0 * r01 + a1 * r11 + a2 * r21
        w2 = a0 * r02 + a1 * r12 + a2 * r22
        pose.rotation[m, 0] = w0
        pose.rotation[m, 1] = w1
        pose.rotation[m, 2] = w2
        pose.centre[m] = a0 * px + a1 * py + a2 * pz + w0 * cx + w1 * cy + w2 * cz
        pose.axis[m] = w0 * zx + w1 * zy + w2 * zz
        pose.velocity[m] = w0 * vx + w1 * vy + w2 * vz
        pose.spin[m] = w0 * wx + w1 * wy + w2 * wz
    pose.sine = math.sqrt(pose.axis[0] * pose.axis[0] + pose.axis[1] * pose.axis[1])


@deferred
def journal_on_parent(j: JointRecord, y: Floats, nq: int, pose: Pose) -> None:
    """:func:`journal_state` of a joint whose bearing is on its child."""
    k = nq + j.v
    dx, dy, dz = centre_from_child(j, y)
    if j.planar != 0:
        c, s, w = y[j.q + 2], y[j.q + 3], y[k + 2]
        pose.centre[0], pose.centre[1], pose.centre[2] = dx, dy, 0.0
        pose.axis[0], pose.axis[1], pose.axis[2] = 0.0, 0.0, 1.0
        pose.sine = 0.0
        pose.rotation[0, 0], pose.rotation[0, 1], pose.rotation[0, 2] = c, s, 0.0
        pose.rotation[1, 0], pose.rotation[1, 1], pose.rotation[1, 2] = -s, c, 0.0
        pose.rotation[2, 0], pose.rotation[2, 1], pose.rotation[2, 2] = 0.0, 0.0, 1.0
        pose.velocity[0] = w * dy - y[k]
        pose.velocity[1] = -w * dx - y[k + 1]
        pose.velocity[2] = 0.0
        pose.spin[0], pose.spin[1], pose.spin[2] = 0.0, 0.0, -w
        return
    wx, wy, wz = y[k + 3], y[k + 4], y[k + 5]
    # d' = -v - w x d, in the child's axes.
    vx = wz * dy - wy * dz - y[k]
    vy = wx * dz - wz * dx - y[k + 1]
    vz = wy * dx - wx * dy - y[k + 2]
    px, py, pz = dx - j.centre[0], dy - j.centre[1], dz - j.centre[2]
    zx, zy, zz = j.axes[0, 2], j.axes[1, 2], j.axes[2, 2]  # journal axis in the parent's frame
    qx, qy, qz, qw = y[j.q + 3], y[j.q + 4], y[j.q + 5], y[j.q + 6]
    for m in range(3):
        ax, ay, az = j.axes[0, m], j.axes[1, m], j.axes[2, m]  # axis m of H in the child's frame
        r0, r1, r2 = rotated(qx, qy, qz, qw, ax, ay, az)
        pose.rotation[m, 0] = r0
        pose.rotation[m, 1] = r1
        pose.rotation[m, 2] = r2
        pose.centre[m] = ax * px + ay * py + az * pz
        pose.axis[m] = r0 * zx + r1 * zy + r2 * zz
        pose.velocity[m] = ax * vx + ay * vy + az * vz
        pose.spin[m] = -(ax * wx + ay * wy + az * wz)
    pose.sine = math.sqrt(pose.axis[0] * pose.axis[0] + pose.axis[1] * pose.axis[1])


@inlined
def journal_place(j: JointRecord, y: Floats) -> Six:
    """Return the journal's centre [m] and axis in bearing axes."""
    i = j.q
    if j.planar != 0:
        x, z = y[i], y[i + 1]
        if j.on_child != 0:
            x, z, _ = centre_from_child(j, y)
        return x, z, 0.0, 0.0, 0.0, 1.0
    qx, qy, qz, qw = y[i + 3], y[i + 4], y[i + 5], y[i + 6]
    cx, cy, cz = j.centre[0], j.centre[1], j.centre[2]
    if j.on_child != 0:
        qx, qy, qz = -qx, -qy, -qz
        px, py, pz = centre_from_child(j, y)
    else:
        px, py, pz = rotated(qx, qy, qz, qw, cx, cy, cz)
        px, py, pz = px + y[i], py + y[i + 1], pz + y[i + 2]
    px, py, pz = px - cx, py - cy, pz - cz
    ux, uy, uz = rotated(qx, qy, qz, qw, j.axes[0, 2], j.axes[1, 2], j.axes[2, 2])
    a = j.axes
    return (
        a[0, 0] * px + a[1, 0] * py + a[2, 0] * pz,
        a[0, 1] * px + a[1, 1] * py + a[2, 1] * pz,
        a[0, 2] * px + a[1, 2] * py + a[2, 2] * pz,
        a[0, 0] * ux + a[1, 0] * uy + a[2, 0] * uz,
        a[0, 1] * ux + a[1, 1] * uy + a[2, 1] * uz,
        a[0, 2] * ux + a[1, 2] * uy + a[2, 2] * uz,
    )


@kernel
def place_journal(program: Floats, block: int, y: Floats, nq: int, pose: Records[Pose]) -> None:
    """:func:`journal_state`, called from outside: of the joint whose block stands there; POSE, (1,)."""
    journal_state(joint_at(program, block), y, nq, pose[0])


@inlined
def onto_joint(j: JointRecord, pose: Pose, force: Triple, moment: Triple, tau: Floats) -> None:
    """Add force and torque about the journal's centre, in bearing axes, to tau."""
    if j.on_child != 0:
        onto_bearing(j, pose, force, moment, tau)
        return
    fx, fy, fz = force
    mx, my, mz = moment
    k = j.v
    if j.planar != 0:
        tau[k] += pose.rotation[0, 0] * fx + pose.rotation[1, 0] * fy
        tau[k + 1] += pose.rotation[0, 1] * fx + pose.rotation[1, 1] * fy
        tau[k + 2] += mz
        return
    cx, cy, cz = j.centre[0], j.centre[1], j.centre[2]
    ux = pose.rotation[0, 0] * fx + pose.rotation[1, 0] * fy + pose.rotation[2, 0] * fz
    uy = pose.rotation[0, 1] * fx + pose.rotation[1, 1] * fy + pose.rotation[2, 1] * fz
    uz = pose.rotation[0, 2] * fx + pose.rotation[1, 2] * fy + pose.rotation[2, 2] * fz
    tau[k] += ux
    tau[k + 1] += uy
    tau[k + 2] += uz
    tau[k + 3] += (
        pose.rotation[0, 0] * mx + pose.rotation[1, 0] * my + pose.rotation[2, 0] * mz + cy * uz - cz * uy
    )
    tau[k + 4] += (
        pose.rotation[0, 1] * mx + pose.rotation[1, 1] * my + pose.rotation[2, 1] * mz + cz * ux - cx * uz
    )
    tau[k + 5] += (
        pose.rotation[0, 2] * mx + pose.rotation[1, 2] * my + pose.rotation[2, 2] * mz + cx * uy - cy * ux
    )


@deferred
def onto_bearing(j: JointRecord, pose: Pose, force: Triple, moment: Triple, tau: Floats) -> None:
    """:func:`onto_joint` of a joint whose bearing is on its child, which has the reaction."""
    fx, fy, fz = force
    mx, my, mz = moment
    k = j.v
    rx, ry, rz = pose.centre[0], pose.centre[1], pose.centre[2]
    if j.planar != 0:
        tau[k] -= fx
        tau[k + 1] -= fy
        tau[k + 2] -= mz + rx * fy - ry * fx
        return
    # About the bearing's centre.
    mx, my, mz = mx + ry * fz - rz * fy, my + rz * fx - rx * fz, mz + rx * fy - ry * fx
    cx, cy, cz = j.centre[0], j.centre[1], j.centre[2]
    ux = j.axes[0, 0] * fx + j.axes[0, 1] * fy + j.axes[0, 2] * fz
    uy = j.axes[1, 0] * fx + j.axes[1, 1] * fy + j.axes[1, 2] * fz
    uz = j.axes[2, 0] * fx + j.axes[2, 1] * fy + j.axes[2, 2] * fz
    tau[k] -= ux
    tau[k + 1] -= uy
    tau[k + 2] -= uz
    tau[k + 3] -= j.axes[0, 0] * mx + j.axes[0, 1] * my + j.axes[0, 2] * mz + cy * uz - cz * uy
    tau[k + 4] -= j.axes[1, 0] * mx + j.axes[1, 1] * my + j.axes[1, 2] * mz + cz * ux - cx * uz
    tau[k + 5] -= j.axes[2, 0] * mx + j.axes[2, 1] * my + j.axes[2, 2] * mz + cx * uy - cy * ux


@kernel
def wrapped_angle(j: JointRecord, y: Floats) -> Triple:
    """Rotation of the child about the joint's axis (swing-twist) and source of its rate.

    It is the journal's in the bearing, or with the bearing on the child the opposite: the twist about an axis
    is of opposite sign in the inverse of a rotation, and nothing else changes, so that the joint's angle does
    not depend on the part with the bore.

    Returns the angle [rad] in (-pi, pi] and gx, gy: its rate is gx wx + gy wy + wz for the angular velocity w
    of the child in its own axes (z along the axis of journal or bearing there).
    """
    i = j.q
    if j.planar != 0:
        return math.atan2(y[i + 3], y[i + 2]), 0.0, 0.0
    qx, qy, qz, qw = y[i + 3], y[i + 4], y[i + 5], y[i + 6]
    # The vector part in bearing axes; the same rotation in a frame whose z is the joint's axis.
    hx = j.axes[0, 0] * qx + j.axes[1, 0] * qy + j.axes[2, 0] * qz
    hy = j.axes[0, 1] * qx + j.axes[1, 1] * qy + j.axes[2, 1] * qz
    hz = j.axes[0, 2] * qx + j.axes[1, 2] * qy + j.axes[2, 2] * qz
    return twist_angle(hx, hy, hz, qw)


@kernel
def motion_angle(j: JointRecord, y: Floats, x0: int) -> Triple:
    """Return :func:`wrapped_angle` with whole turns, from the turned angle at y[x0:]."""
    angle, gx, gy = wrapped_angle(j, y)
    return unwrapped(angle, y[x0 + j.turn]), gx, gy


@inlined
def rotated(qx: float, qy: float, qz: float, qw: float, x: float, y: float, z: float) -> Triple:
    """Return a vector rotated by a quaternion."""
    tx = 2.0 * (qy * z - qz * y)
    ty = 2.0 * (qz * x - qx * z)
    tz = 2.0 * (qx * y - qy * x)
    return (x + qw * tx + qy * tz - qz * ty, y + qw * ty + qz * tx - qx * tz, z + qw * tz + qx * ty - qy * tx)


@inlined
def axis_of_parent(j: JointRecord, y: Floats) -> Triple:
    """Return the axis of the parent's part, bearing or journal, in child axes."""
    i = j.q + 3
    return rotated(-y[i], -y[i + 1], -y[i + 2], y[i + 3], j.axes[0, 2], j.axes[1, 2], j.axes[2, 2])


@inlined
def centre_from_child(j: JointRecord, y: Floats) -> Triple:
    """Return the centre of the parent's part, bearing or journal, in the child's frame [m]."""
    i = j.q
    if j.planar != 0:
        c, s = y[i + 2], y[i + 3]
        return -(c * y[i] + s * y[i + 1]), s * y[i] - c * y[i + 1], 0.0
    px, py, pz = j.centre[0] - y[i], j.centre[1] - y[i + 1], j.centre[2] - y[i + 2]
    return rotated(-y[i + 3], -y[i + 4], -y[i + 5], y[i + 6], px, py, pz)


@inlined
def journal_centre(j: JointRecord, y: Floats) -> Triple:
    """Return the journal's centre in the child's own frame [m]."""
    if j.on_child != 0:
        return centre_from_child(j, y)
    return j.centre[0], j.centre[1], j.centre[2]


@inlined
def along_bearing(j: JointRecord, y: Floats) -> tuple[float, float, float, float, float, float, float]:
    """Return a sliding child's position along the bearing's axis [m], and its gradient.

    It is that of the journal's centre, or with the bearing on the child its opposite. The gradient is over
    the joint's twist: the rate of the position is gradient . twist, and a force on the child along the axis
    at the journal's centre is the force times the gradient.
    """
    cx, cy, cz = j.centre[0], j.centre[1], j.centre[2]
    ax, ay, az = j.axes[0, 2], j.axes[1, 2], j.axes[2, 2]
    if j.on_child != 0:
        dx, dy, dz = centre_from_child(j, y)
        way = ax * (cx - dx) + ay * (cy - dy) + az * (cz - dz)
        return way, ax, ay, az, dy * az - dz * ay, dz * ax - dx * az, dx * ay - dy * ax
    wx, wy, wz = axis_of_parent(j, y)
    way = ax * (y[j.q] - cx) + ay * (y[j.q + 1] - cy) + az * (y[j.q + 2] - cz) + wx * cx + wy * cy + wz * cz
    return way, wx, wy, wz, cy * wz - cz * wy, cz * wx - cx * wz, cx * wy - cy * wx
