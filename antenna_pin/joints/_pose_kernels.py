"""A journal in its bearing, compiled: from the joint's part of the state to its pose, and back to forces."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.joints._layout_kernels import joint_at


@inlined
def journal_state(j: Any, y: Any, nq: int, pose: Any) -> None:
    """Write the journal's pose and twist relative to the bearing, in bearing axes."""
    i = j.q
    k = nq + j.v
    if j.planar != 0:
        c = y[i + 2]
        s = y[i + 3]
        pose.centre[0], pose.centre[1], pose.centre[2] = y[i], y[i + 1], 0.0
        pose.axis[0], pose.axis[1], pose.axis[2] = 0.0, 0.0, 1.0
        pose.sine = 0.0
        pose.child[0, 0], pose.child[0, 1], pose.child[0, 2] = c, -s, 0.0
        pose.child[1, 0], pose.child[1, 1], pose.child[1, 2] = s, c, 0.0
        pose.child[2, 0], pose.child[2, 1], pose.child[2, 2] = 0.0, 0.0, 1.0
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
        pose.child[m, 0] = w0
        pose.child[m, 1] = w1
        pose.child[m, 2] = w2
        pose.centre[m] = a0 * px + a1 * py + a2 * pz + w0 * cx + w1 * cy + w2 * cz
        pose.axis[m] = w0 * zx + w1 * zy + w2 * zz
        pose.velocity[m] = w0 * vx + w1 * vy + w2 * vz
        pose.spin[m] = w0 * wx + w1 * wy + w2 * wz
    pose.sine = math.sqrt(pose.axis[0] * pose.axis[0] + pose.axis[1] * pose.axis[1])


@kernel
def place_journal(program: Any, block: int, y: Any, nq: int, pose: Any) -> None:
    """:func:`journal_state`, called from outside: of the joint whose block stands there; POSE, (1,)."""
    journal_state(joint_at(program, block), y, nq, pose[0])


@inlined
def onto_joint(
    j: Any, pose: Any, fx: float, fy: float, fz: float, mx: float, my: float, mz: float, tau: Any
) -> None:
    """Add a force and a torque about the journal's centre, in bearing axes, to tau, in the child's own."""
    k = j.v
    if j.planar != 0:
        tau[k] += pose.child[0, 0] * fx + pose.child[1, 0] * fy
        tau[k + 1] += pose.child[0, 1] * fx + pose.child[1, 1] * fy
        tau[k + 2] += mz
        return
    cx, cy, cz = j.centre[0], j.centre[1], j.centre[2]
    ux = pose.child[0, 0] * fx + pose.child[1, 0] * fy + pose.child[2, 0] * fz
    uy = pose.child[0, 1] * fx + pose.child[1, 1] * fy + pose.child[2, 1] * fz
    uz = pose.child[0, 2] * fx + pose.child[1, 2] * fy + pose.child[2, 2] * fz
    tau[k] += ux
    tau[k + 1] += uy
    tau[k + 2] += uz
    tau[k + 3] += pose.child[0, 0] * mx + pose.child[1, 0] * my + pose.child[2, 0] * mz + cy * uz - cz * uy
    tau[k + 4] += pose.child[0, 1] * mx + pose.child[1, 1] * my + pose.child[2, 1] * mz + cz * ux - cx * uz
    tau[k + 5] += pose.child[0, 2] * mx + pose.child[1, 2] * my + pose.child[2, 2] * mz + cx * uy - cy * ux


@inlined
def unwrapped(angle: float, near: float) -> float:
    """Return the angle that is ``angle`` but for whole turns and within half a turn of ``near`` [rad]."""
    return angle + 2.0 * math.pi * math.floor((near - angle) / (2.0 * math.pi) + 0.5)


@kernel
def wrapped_angle(j: Any, y: Any) -> tuple[float, float, float]:
    """Rotation of the journal about the bearing axis (swing-twist) and where its rate comes from.

    Returns the angle [rad] in (-pi, pi] and gx, gy: its rate is gx wx + gy wy + wz for the angular velocity w
    of the journal in its own axes (z along the journal).
    """
    i = j.q
    if j.planar != 0:
        return math.atan2(y[i + 3], y[i + 2]), 0.0, 0.0
    qx, qy, qz, qw = y[i + 3], y[i + 4], y[i + 5], y[i + 6]
    # The vector part in bearing axes; the same rotation seen in a frame whose z is the joint's axis.
    hx = j.axes[0, 0] * qx + j.axes[1, 0] * qy + j.axes[2, 0] * qz
    hy = j.axes[0, 1] * qx + j.axes[1, 1] * qy + j.axes[2, 1] * qz
    hz = j.axes[0, 2] * qx + j.axes[1, 2] * qy + j.axes[2, 2] * qz
    square = hz * hz + qw * qw
    if qw < 0.0:
        angle = 2.0 * math.atan2(-hz, -qw)
    else:
        angle = 2.0 * math.atan2(hz, qw)
    if square == 0.0:
        return angle, 0.0, 0.0
    return angle, (hz * hx - qw * hy) / square, (qw * hx + hz * hy) / square


@kernel
def motion_angle(j: Any, y: Any, x0: int) -> tuple[float, float, float]:
    """Return :func:`wrapped_angle` with its whole turns, from the turned angle in the state's x at y[x0:]."""
    angle, gx, gy = wrapped_angle(j, y)
    return unwrapped(angle, y[x0 + j.turn]), gx, gy


@inlined
def about_bearing(j: Any, y: Any) -> tuple[float, float, float]:
    """Return the bearing's axis, seen from the journal: in the child's own axes."""
    nx, ny, nz = j.axes[0, 2], j.axes[1, 2], j.axes[2, 2]
    # Rotate by the inverse of the joint's quaternion.
    i = j.q + 3
    qx, qy, qz, qw = -y[i], -y[i + 1], -y[i + 2], y[i + 3]
    tx = 2.0 * (qy * nz - qz * ny)
    ty = 2.0 * (qz * nx - qx * nz)
    tz = 2.0 * (qx * ny - qy * nx)
    return (
        nx + qw * tx + qy * tz - qz * ty,
        ny + qw * ty + qz * tx - qx * tz,
        nz + qw * tz + qx * ty - qy * tx,
    )


@inlined
def along_bearing(j: Any, y: Any) -> tuple[float, float, float, float, float, float, float]:
    """Return the way of a sliding journal's centre along the bearing's axis [m], and its gradient.

    The gradient is over the joint's twist: the way's rate is gradient . twist, and a force along the axis at
    the journal's centre is the force times the gradient.
    """
    wx, wy, wz = about_bearing(j, y)
    cx, cy, cz = j.centre[0], j.centre[1], j.centre[2]
    ax, ay, az = j.axes[0, 2], j.axes[1, 2], j.axes[2, 2]
    way = ax * (y[j.q] - cx) + ay * (y[j.q + 1] - cy) + az * (y[j.q + 2] - cz) + wx * cx + wy * cy + wz * cz
    return way, wx, wy, wz, cy * wz - cz * wy, cz * wx - cx * wz, cx * wy - cy * wx
