"""Distributed load, compiled: laws distributed over strips and sectors.

The four contacts of a revolute joint are then patches, whose rows sum up those of their strips and sectors,
which follow after the contacts of all joints.
"""

from __future__ import annotations

from antenna_pin.base.records import Contact, Floats, Memory, Pose, Records, words_of
from antenna_pin.compiled.decorators import deferred, inlined, kernel
from antenna_pin.contact.kernels import NORMAL_SIZE, elastic_energy, elastic_force
from antenna_pin.contact.records import FRICTION_SIZE
from antenna_pin.joints.geometry.patch_kernels import NODE, sector_contacts, strip_contacts
from antenna_pin.joints.layout_kernels import (
    friction_at,
    joint_at,
    nodes_at,
    normal_at,
    patches_at,
    revolute_of,
)
from antenna_pin.joints.row_kernels import add_wrench, friction_power, no_wrench, row_forces, row_rates

NODE_WORDS = words_of(NODE)


@deferred
def patch_geometry(p: Floats, b: int, pose: Pose, table: Records[Contact], bore: bool, flanges: bool) -> None:
    """Fill strips, sectors and patches under distributed load, or one kind only."""
    row = joint_at(p, b).row
    shape = revolute_of(p, b, 0)
    patches = patches_at(p, b)
    if bore:
        strip_contacts(shape, patches.strips, pose, table, row, patches.first)
    if flanges:
        at = nodes_at(b)
        nodes = p[at : at + patches.sectors * NODE_WORDS].view(NODE)
        first = patches.first + patches.strips
        sector_contacts(shape, nodes, patches.radius, pose, table, row + 2, first)


@deferred
def loaded_rates(p: Floats, b: int, pose: Pose, table: Records[Contact]) -> None:
    """Fill depth rate and slip of the loaded strips and sectors."""
    patches = patches_at(p, b)
    for r in range(patches.first, patches.first + patches.strips + 2 * patches.sectors):
        if table[r].gap < 0.0:
            row_rates(pose, table[r])


@inlined
def patch_rows(p: Floats, b: int, k: int) -> tuple[int, int]:
    """Return patch k's range of table rows: bore at +z, -z, flange at +z, -z."""
    patches = patches_at(p, b)
    half = patches.strips // 2
    if k == 0:
        return patches.first + half, patches.first + patches.strips
    if k == 1:
        return patches.first, patches.first + half
    start = patches.first + patches.strips + (k - 2) * patches.sectors
    return start, start + patches.sectors


@kernel
def _tune_sectors(
    p: Floats, b: int, normal: Floats, table: Records[Contact], patch: Contact, start: int
) -> tuple[float, float]:
    r"""Return alpha and gamma, with which a flange's forces have a potential.

    The forces of its sectors are multiplied by 1 + alpha + gamma x^2.

    The sectors of a partly loaded ring move with the ends of its loaded arc, so that the forces that they
    sample are not quite the derivatives of the energy that they sample,

        V(d, a) = sum_k W_k(sigma) U(d (1 - x_k^2)),   sigma^2 = d / (2 a),

    with the depth d of the deepest point and the part 2 a that the depth falls over the ring. Asked of the
    factor are V's two derivatives, dV/dd = sum F_k and dV/da = -2 sigma^2 sum F_k x_k^2; with F_k = W_k f_k,
    b_n = sum F_k x_k^n and W' = W / (sigma (1 - sigma^2 x^2)) both require the same

        alpha b_0 + gamma b_2 = alpha b_2 + gamma b_4 = sum W_k U_k / (2 d (1 - sigma^2 x_k^2)) - b_2,

    which is zero except for the error of the sums.
    """
    at = nodes_at(b)
    nodes = p[at : at + patches_at(p, b).sectors * NODE_WORDS].view(NODE)
    depth = -patch.gap
    square = patch.share * patch.share
    b0 = 0.0
    b2 = 0.0
    b4 = 0.0
    asked = 0.0
    for k in range(nodes.shape[0]):
        x = nodes[k].sine * nodes[k].sine
        sector = table[start + k]
        force = sector.share * elastic_force(normal, -sector.gap)
        b0 += force
        b2 += force * x
        b4 += force * x * x
        asked += sector.share * elastic_energy(normal, -sector.gap) / (1.0 - square * x)
    asked = 0.5 * asked / depth - b2
    determinant = b0 * b4 - b2 * b2
    if determinant <= 0.0:
        return 0.0, 0.0
    return asked * (b4 - b2) / determinant, asked * (b0 - b2) / determinant


@deferred
def patch_forces(p: Floats, b: int, k: int, remembered: Memory, table: Records[Contact]) -> None:
    """Fill the forces of the loaded parts of patch k, and their sums.

    The sums are in the patch's row.

    The law is the patch's; each strip or sector has its share at its own depth, rate and slip.
    """
    patch = table[joint_at(p, b).row + k]
    at = normal_at(b, k)
    normal = p[at : at + NORMAL_SIZE]
    at = friction_at(b, k)
    friction = p[at : at + FRICTION_SIZE]
    first, last = patch_rows(p, b, k)
    alpha = 0.0
    gamma = 0.0
    if k >= 2 and patch.share < 1.0 and patch.gap < 0.0:
        alpha, gamma = _tune_sectors(p, b, normal, table, patch, first)
    at = nodes_at(b)
    nodes = p[at : at + patches_at(p, b).sectors * NODE_WORDS].view(NODE)
    for s in range(first, last):
        part = table[s]
        if part.gap >= 0.0:
            continue
        row_forces(normal, friction, remembered, part)
        share = part.share
        if k >= 2:
            x = nodes[s - first].sine
            share *= 1.0 + alpha + gamma * x * x
        part.force *= share
        part.elastic *= share
        patch.force += part.force
        patch.elastic += part.elastic
        for i in range(3):
            part.friction[i] *= share
            patch.friction[i] += part.friction[i]
        patch.lost_normal += (part.force - part.elastic) * part.rate
        patch.lost_friction += friction_power(part)


@deferred
def patch_energy(p: Floats, b: int, k: int, table: Records[Contact]) -> float:
    """Return the energy of the loaded parts of patch k, by table gaps [J]."""
    first, last = patch_rows(p, b, k)
    at = normal_at(b, k)
    normal = p[at : at + NORMAL_SIZE]
    energy = 0.0
    for s in range(first, last):
        if table[s].gap < 0.0:
            energy += table[s].share * elastic_energy(normal, -table[s].gap)
    return energy


@deferred
def patch_wrench(p: Floats, b: int, pose: Pose, table: Records[Contact]) -> None:
    """Write force and torque of all loaded strips and sectors into the pose."""
    no_wrench(pose)
    j = joint_at(p, b)
    for k in range(j.contacts):
        if table[j.row + k].force == 0.0:
            continue
        first, last = patch_rows(p, b, k)
        for s in range(first, last):
            if table[s].gap < 0.0:
                add_wrench(pose, table[s])
