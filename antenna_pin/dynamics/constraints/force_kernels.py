"""Forces of closures, motions and couplings at samples, compiled: of redundant equations the least."""

from __future__ import annotations

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.layout_kernels import (
    closure_at,
    coupled_at,
    driven_at,
    found_in,
    hold_at,
    place_at,
    plan_of,
)
from antenna_pin.dynamics.constraints.root_kernels import solve_back, solve_forth, write_root


@kernel
def least_forces(plan: Floats, work: Floats, room: Floats, out: Floats) -> None:
    """Write the multipliers of least norm equivalent to those of the last solution.

    Redundant rows share the forces of independent ones: of R = [R1 R2], the columns of independent rows and
    of the others, let S = R1^-1 R2. Then the others carry (1 + S^T S)^-1 S^T of the forces f of the
    independent ones, and these f less S times that.

    Args:
        plan: Plan of the constraints.
        work: With the factors and multipliers of the last solution.
        room: Scratch, (2 rows (rows + 1),).
        out: Multipliers, (rows,).
    """
    head, rank = plan_of(plan), found_in(plan, work).rank
    rows, width, order, triangle = head.rows, head.width, head.order, head.triangle
    for r in range(rows):
        out[r] = work[head.force + r]
    fewer = rows - rank
    if fewer == 0:
        return
    share = room[: rank * fewer]
    for c in range(fewer):
        for j in range(rank - 1, -1, -1):
            total = work[triangle + j * width + rank + c]
            for i in range(j + 1, rank):
                total -= work[triangle + j * width + i] * share[i * fewer + c]
            share[j * fewer + c] = total * work[head.inverses + j]
    at = rank * fewer
    square, at = room[at : at + fewer * fewer].reshape((fewer, fewer)), at + fewer * fewer
    root, at = room[at : at + fewer * fewer], at + fewer * fewer
    first, carried = room[at : at + fewer], room[at + fewer : at + 2 * fewer]
    for a in range(fewer):
        for b in range(fewer):
            total = 1.0 if a == b else 0.0
            for i in range(rank):
                total += share[i * fewer + a] * share[i * fewer + b]
            square[a, b] = total
        carried[a] = 0.0
        for i in range(rank):
            carried[a] += share[i * fewer + a] * work[head.force + int(work[order + i])]
    write_root(square, fewer, root, first)
    solve_forth(fewer, root, first, carried)
    solve_back(fewer, root, first, carried)
    for i in range(rank):
        r = int(work[order + i])
        for c in range(fewer):
            out[r] -= share[i * fewer + c] * carried[c]
    for c in range(fewer):
        out[int(work[order + rank + c])] = carried[c]


@inlined
def _axis(work: Floats, b: int, rotation: Floats, k: int) -> float:
    """Return world component k of the third axis of a frame on a body."""
    if b < 0:
        return float(rotation[k, 2])
    on = place_at(work, b).rotation
    return float(on[k, 0] * rotation[0, 2] + on[k, 1] * rotation[1, 2] + on[k, 2] * rotation[2, 2])


@inlined
def _on_first(work: Floats, b: int, rotation: Floats, vector: Floats, k: int) -> float:
    """Return component k of a vector of the world in the axes of a frame."""
    total = 0.0
    for i in range(3):
        axis = rotation[i, k]
        if b >= 0:
            on = place_at(work, b).rotation
            axis = on[i, 0] * rotation[0, k] + on[i, 1] * rotation[1, k] + on[i, 2] * rotation[2, k]
        total += axis * vector[i]
    return total


@kernel
def wrenches(plan: Floats, work: Floats, forces: Floats, out: Floats) -> None:
    """Write force [N] and moment [N m] of each closure on its second link.

    In axes of the first side's frame, the moment about the second side's point.

    Args:
        plan: Plan of the constraints.
        work: With the places of bodies in the state solved last.
        forces: Multipliers, (rows,).
        out: Written.
    """
    head = plan_of(plan)
    direction = place_at(work, head.bodies).slide
    for c in range(head.closures):
        closure = closure_at(plan, c)
        row = closure.row
        for k in range(3):
            out[c, 0, k] = out[c, 1, k] = 0.0
        for k in range(3):
            if closure.along[k] != 0:
                out[c, 0, k] = forces[row]
                row += 1
        for k in range(3):
            if closure.about[k] != 0:
                out[c, 1, k] = head.length * forces[row]
                row += 1
        if closure.square == 0:
            continue
        for n in range(3):
            i, j = (n + 1) % 3, (n + 2) % 3
            bi = _axis(work, closure.second, closure.second_rotation, i)
            bj = _axis(work, closure.second, closure.second_rotation, j)
            ai = _axis(work, closure.first, closure.first_rotation, i)
            aj = _axis(work, closure.first, closure.first_rotation, j)
            direction[n] = bi * aj - bj * ai
        for k in range(3):
            turned = _on_first(work, closure.first, closure.first_rotation, direction, k)
            out[c, 1, k] += head.length * forces[row] * turned


@kernel
def joint_forces(plan: Floats, forces: Floats, out: Floats) -> None:
    """Write constraint forces [N] and torques [N m] of motions and of couplings' followers.

    First those of the motions, then those of the couplings, then those of elements that hold.
    """
    head = plan_of(plan)
    for m in range(head.motions):
        driven = driven_at(plan, m)
        out[m] = forces[driven.row] * (1.0 if driven.slides != 0 else head.length)
    for k in range(head.couplings):
        coupled = coupled_at(plan, k)
        number = coupled.scale * (1.0 if coupled.slides != 0 else head.length)
        out[head.motions + k] = forces[coupled.row] * number
    for k in range(head.holds):
        held = hold_at(plan, k)
        out[head.motions + head.couplings + k] = forces[held.row] * (1.0 if held.slides != 0 else head.length)


@kernel
def write_holding(
    plan: Floats, work: Floats, room: Floats, forces: Floats, closures: Floats, joints: Floats
) -> None:
    """Write forces of closures, motions and couplings in the state solved last.

    Args:
        plan: Plan of the constraints.
        work: Work array of the last solution.
        room: Scratch, as for :func:`least_forces`.
        forces: Written: multipliers, (rows,).
        closures: Written as by :func:`wrenches`, (closures, 2, 3).
        joints: Written as by :func:`joint_forces`, (motions + couplings + holds,).
    """
    least_forces(plan, work, room, forces)
    head = plan_of(plan)
    for k in range(head.holds):
        own = hold_at(plan, k)
        # For a joint that is not held the multiplier's place has its friction by load.
        if work[head.jacobian + own.v * head.width + own.row] == 0.0:
            forces[own.row] = work[head.force + own.row]
    wrenches(plan, work, forces, closures)
    joint_forces(plan, forces, joints)
