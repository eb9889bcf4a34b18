"""Energies and momenta of a tree of bodies in one state, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, Records, Triple, Vector3, layout
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.mechanism.tree_kernels import Body, Place, place_bodies


class AuditRecord(Record):
    """Energies and momenta of a state; those of contacts and springs are written elsewhere."""

    kinetic: float  # [J]
    contacts: float  # energy of contacts [J]
    springs: float  # energy of springs [J]
    gravity: float  # [J]
    linear: Vector3  # linear momentum [kg m/s]
    angular: Vector3  # momentum about the mass centre [kg m^2/s]
    linear_scale: float  # [kg m/s]
    angular_scale: float  # [kg m^2/s]


AUDIT = layout(AuditRecord)


@kernel
def audit_state(
    y: Floats,
    nq: int,
    tree: Records[Body],
    gravity: Floats,
    places: Records[Place],
    audits: Records[AuditRecord],
) -> None:
    """Write the energies and momenta of a state but those of contacts and springs.

    Args:
        y: State, q and v first.
        nq: Start of v in it.
        tree: Bodies, parents first.
        gravity: (3,) [m/s^2].
        places: Written: PLACE, (bodies + 1,).
        audits: Written: AUDIT, (1,).
    """
    bodies = tree.shape[0]
    out = audits[0]
    out.kinetic = out.linear_scale = out.angular_scale = 0.0
    for k in range(3):
        out.linear[k] = 0.0
        out.angular[k] = 0.0
    place_bodies(y, nq, tree, places)
    mass = 0.0
    cx = cy = cz = 0.0
    for b in range(bodies):
        body, own = tree[b], places[b]
        sx, sy, sz = _lever(body, own)
        mass += body.mass
        cx += body.mass * (own.origin[0] + sx)
        cy += body.mass * (own.origin[1] + sy)
        cz += body.mass * (own.origin[2] + sz)
        px, py, pz, _, _, _, kinetic = _momenta(body, own, sx, sy, sz)
        out.linear[0] += px
        out.linear[1] += py
        out.linear[2] += pz
        out.kinetic += kinetic
    if mass > 0.0:  # a rotor may have inertia without mass
        cx, cy, cz = cx / mass, cy / mass, cz / mass
    out.gravity = -mass * (gravity[0] * cx + gravity[1] * cy + gravity[2] * cz)
    for b in range(bodies):
        body, own = tree[b], places[b]
        sx, sy, sz = _lever(body, own)
        px, py, pz, hx, hy, hz, _ = _momenta(body, own, sx, sy, sz)
        dx, dy, dz = own.origin[0] + sx - cx, own.origin[1] + sy - cy, own.origin[2] + sz - cz
        lx = hx + dy * pz - dz * py
        ly = hy + dz * px - dx * pz
        lz = hz + dx * py - dy * px
        out.angular[0] += lx
        out.angular[1] += ly
        out.angular[2] += lz
        if body.counts != 0:
            out.linear_scale += math.sqrt(px * px + py * py + pz * pz)
            out.angular_scale += math.sqrt(lx * lx + ly * ly + lz * lz)


@kernel
def energy_of(tree: Records[Body], places: Records[Place], gravity: Floats) -> float:
    """Return kinetic energy and that of gravity, of a tree whose bodies are placed [J]."""
    total = 0.0
    for b in range(tree.shape[0]):
        body, own = tree[b], places[b]
        sx, sy, sz = _lever(body, own)
        _, _, _, _, _, _, kinetic = _momenta(body, own, sx, sy, sz)
        x, y, z = own.origin[0] + sx, own.origin[1] + sy, own.origin[2] + sz
        total += kinetic - body.mass * (gravity[0] * x + gravity[1] * y + gravity[2] * z)
    return total


@kernel
def mass_centre(tree: Records[Body], places: Records[Place], out: Floats) -> None:
    """Write the mass centre of a tree whose bodies are placed, (3,) [m]."""
    mass = x = y = z = 0.0
    for b in range(tree.shape[0]):
        body, own = tree[b], places[b]
        sx, sy, sz = _lever(body, own)
        mass += body.mass
        x += body.mass * (own.origin[0] + sx)
        y += body.mass * (own.origin[1] + sy)
        z += body.mass * (own.origin[2] + sz)
    whole = mass if mass > 0.0 else 1.0  # rotors may have inertia without mass
    out[0], out[1], out[2] = x / whole, y / whole, z / whole


@inlined
def _lever(body: Body, own: Place) -> Triple:
    """Mass centre of a body from its origin, in the world [m]."""
    r, c = own.rotation, body.centre
    return (
        r[0, 0] * c[0] + r[0, 1] * c[1] + r[0, 2] * c[2],
        r[1, 0] * c[0] + r[1, 1] * c[1] + r[1, 2] * c[2],
        r[2, 0] * c[0] + r[2, 1] * c[1] + r[2, 2] * c[2],
    )


@inlined
def _momenta(
    body: Body, own: Place, sx: float, sy: float, sz: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return a body's momenta about its mass centre, in the world, and kinetic energy.

    The armature of its joint counts in the energy, not in the momenta.
    """
    wx, wy, wz = own.spin[0], own.spin[1], own.spin[2]
    ux = own.velocity[0] + wy * sz - wz * sy
    uy = own.velocity[1] + wz * sx - wx * sz
    uz = own.velocity[2] + wx * sy - wy * sx
    # In the body's own axes.
    r = own.rotation
    ax = r[0, 0] * wx + r[1, 0] * wy + r[2, 0] * wz
    ay = r[0, 1] * wx + r[1, 1] * wy + r[2, 1] * wz
    az = r[0, 2] * wx + r[1, 2] * wy + r[2, 2] * wz
    inertia = body.inertia
    hx = inertia[0, 0] * ax + inertia[0, 1] * ay + inertia[0, 2] * az
    hy = inertia[1, 0] * ax + inertia[1, 1] * ay + inertia[1, 2] * az
    hz = inertia[2, 0] * ax + inertia[2, 1] * ay + inertia[2, 2] * az
    tx, ty, tz = own.turn[0], own.turn[1], own.turn[2]
    px, py, pz = body.mass * ux, body.mass * uy, body.mass * uz
    return (
        px,
        py,
        pz,
        r[0, 0] * hx + r[0, 1] * hy + r[0, 2] * hz,
        r[1, 0] * hx + r[1, 1] * hy + r[1, 2] * hz,
        r[2, 0] * hx + r[2, 1] * hy + r[2, 2] * hz,
        0.5 * (px * ux + py * uy + pz * uz + ax * hx + ay * hy + az * hz)
        + 0.5 * body.armature * (tx * tx + ty * ty + tz * tz),
    )
