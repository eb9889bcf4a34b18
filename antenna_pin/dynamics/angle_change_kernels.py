"""Changes of joint motion and force direction of elements with the joint's state, compiled.

An element at a joint depends on its angle, or displacement, s and the rate s' = g . v, and acts along n: its
generalized force is its effort times n, its power the effort times n . v. A displacement (w, dv) of the joint
gives

    ds = g . w,    ds' = g . dv + Dg(w) . v,    dn = Dn(w),    d(n . v) = n . dv + Dn(w) . v

with g and n of :func:`antenna_pin.dynamics.kernels.own_motion` and ``act_at``. All have closed forms: as the
child rotates by w, the axis of the parent changes by n x w, its centre by -w - w x d.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Triple
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.kernels import (
    ABOUT_JOURNAL,
    ABOUT_MOTION,
    ElementHead,
    act_at,
    element_at,
    own_motion,
)
from antenna_pin.joints.layout_kernels import JointRecord, joint_at
from antenna_pin.joints.pose_kernels import axis_of_parent, journal_centre
from antenna_pin.mechanism.spatial_kernels import twist_slopes

#: Rows written for a joint, each over its freedoms: g and Dg . v, n and Dn . v, then Dn along each
#: of the freedoms.
G, G_CHANGE, N, N_CHANGE, N_CHANGES = 0, 1, 2, 3, 4
#: Largest number of rows, and of freedoms.
ROWS, MOST = 10, 6


@inlined
def freedoms_of(p: Floats, b: int) -> tuple[int, int]:
    """Return the first velocity index of an element's freedoms, and their number."""
    e = element_at(p, b)
    if e.play < 0:
        return e.v, 1
    j = joint_at(p, e.play)
    if j.slides != 0:
        return e.v, 6
    return (e.v + 2, 1) if j.planar != 0 else (e.v + 3, 3)


@inlined
def _cross(a: Triple, b: Triple) -> Triple:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def _unit(k: int) -> Triple:
    return 1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0


@inlined
def _axis_goes(j: JointRecord, e: ElementHead) -> bool:
    """Return whether the effort acts along the parent's axis."""
    return bool((e.about == ABOUT_JOURNAL) == (j.on_child != 0))


@inlined
def _write_turned(
    j: JointRecord, e: ElementHead, y: Floats, row: int, slope: tuple[float, float], out: Floats
) -> None:
    """Write the rows of a turning joint with play; ``slope``: gx and gy."""
    a, i = j.axes, j.q + 3
    gx, gy = slope
    hx = a[0, 0] * y[i] + a[1, 0] * y[i + 1] + a[2, 0] * y[i + 2]
    hy = a[0, 1] * y[i] + a[1, 1] * y[i + 1] + a[2, 1] * y[i + 2]
    hz = a[0, 2] * y[i] + a[1, 2] * y[i + 1] + a[2, 2] * y[i + 2]
    wx = a[0, 0] * y[row] + a[1, 0] * y[row + 1] + a[2, 0] * y[row + 2]
    wy = a[0, 1] * y[row] + a[1, 1] * y[row + 1] + a[2, 1] * y[row + 2]
    n = out[N]
    for k in range(3):
        out[G, k] = gx * a[k, 0] + gy * a[k, 1] + a[k, 2]
        fx, fy = twist_slopes((hx, hy, hz), y[i + 3], (a[k, 0], a[k, 1], a[k, 2]))
        out[G_CHANGE, k] = fx * wx + fy * wy
        if e.about == ABOUT_MOTION:
            for m in range(3):
                out[N_CHANGES + k, m] = fx * a[m, 0] + fy * a[m, 1]
        elif _axis_goes(j, e):
            c = out[N_CHANGES + k]
            c[0], c[1], c[2] = _cross((n[0], n[1], n[2]), _unit(k))


@inlined
def _write_slid(j: JointRecord, e: ElementHead, y: Floats, row: int, out: Floats) -> None:
    """Write the rows of a joint with play that slides, but for n.

    Its displacement has the gradient (a, c x a), with the parent's axis a and the child's centre c, or with
    the bearing on the child its axis and the journal's centre; the force acts along the same.
    """
    fixed = j.axes[0, 2], j.axes[1, 2], j.axes[2, 2]
    turned = axis_of_parent(j, y)
    centre = journal_centre(j, y)
    seen = fixed if j.on_child != 0 else turned
    along = turned if _axis_goes(j, e) else fixed
    arm = _cross(centre, seen)
    for k in range(3):
        out[G, k], out[G, 3 + k] = seen[k], arm[k]
    for k in range(6):
        went, axis, pushed = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if k >= 3:
            turn = _cross(turned, _unit(k - 3))
            axis = turn if j.on_child == 0 else axis
            pushed = turn if _axis_goes(j, e) else pushed
        if j.on_child != 0:
            went = _cross(centre, _unit(k - 3)) if k >= 3 else (-_unit(k)[0], -_unit(k)[1], -_unit(k)[2])
        out[G_CHANGE, k] = 0.0
        one, two = _cross(went, seen), _cross(centre, axis)
        three, four = _cross(went, along), _cross(centre, pushed)
        for m in range(3):
            out[G_CHANGE, k] += axis[m] * y[row + m] + (one[m] + two[m]) * y[row + 3 + m]
            out[N_CHANGES + k, m], out[N_CHANGES + k, 3 + m] = pushed[m], three[m] + four[m]


@kernel
def write_motion(p: Floats, b: int, y: Floats, nq: int, tau: Floats, out: Floats) -> tuple[float, float]:
    """Write joint motion and force direction of an element's head, and their changes.

    Args:
        p: Program.
        b: Place of the head.
        y: State.
        nq: Start of v in it.
        tau: Scratch, (nv,).
        out: Rows over the freedoms, (ROWS, MOST).

    Returns:
        Angle (or displacement) and its rate.
    """
    e = element_at(p, b)
    first, count = freedoms_of(p, b)
    angle, rate, gx, gy = own_motion(p, b, y, nq)
    for k in range(count):
        tau[first + k] = 0.0
        for i in range(N_CHANGES + count):
            out[i, k] = 0.0
    act_at(p, b, 1.0, (gx, gy), y, nq, tau)
    for k in range(count):
        out[N, k] = tau[first + k]
    if count == 1:
        out[G, 0] = 1.0
        return angle, rate
    j = joint_at(p, e.play)
    if j.slides != 0:
        _write_slid(j, e, y, nq + first, out)
    else:
        _write_turned(j, e, y, nq + first, (gx, gy), out)
    for k in range(count):
        for m in range(count):
            out[N_CHANGE, k] += out[N_CHANGES + k, m] * y[nq + first + m]
    return angle, rate


@inlined
def change_along(rows: Floats, row: int, count: int, way: Floats, nv: int) -> Triple:
    """Return changes of an angle, its rate, and its working rate along a displacement."""
    angle, rate, speed = 0.0, 0.0, 0.0
    for k in range(count):
        w, dv = way[row + k], way[nv + row + k]
        angle += rows[G, k] * w
        rate += rows[G, k] * dv + rows[G_CHANGE, k] * w
        speed += rows[N, k] * dv + rows[N_CHANGE, k] * w
    return angle, rate, speed


@inlined
def turn_push(rows: Floats, row: int, count: int, way: Floats, effort: float, out: Floats) -> None:
    """Write how an effort along a joint changes along a displacement with the joint alone."""
    for k in range(count):
        out[row + k] = 0.0
        for m in range(count if count > 1 else 0):
            out[row + k] += effort * way[row + m] * rows[N_CHANGES + m, k]
