"""What a result holds of forces on links: what they do, what they bring in."""

from __future__ import annotations

from antenna_pin.trajectory.columns import Rule, Variable, rows

__all__ = ["FORCES"]

_SIZE = Rule(least=0.0)
_TOTAL = Rule(least=0.0, summed=True)

FORCES: tuple[Variable, ...] = (
    *rows(
        "derivative: time force_place axis",
        ("applied_force", "N", "force at the place, world axes"),
        ("applied_torque", "N m", "torque about the place, world axes"),
    ),
    *rows("derivative: time force", ("force_energy", "J", "energy stored, of one that puts nothing in")),
    *rows(
        "ledger: time force",
        ("force_work", "J", "work of the force since the start"),
        ("force_gross_work", "J", "integral of |power| of the force", _TOTAL),
        ("force_loss", "J", "energy lost, of one that puts nothing in"),
    ),
    *rows(
        "ledger: time force axis",
        ("force_impulse", "N s", "integral of the force, world axes"),
        ("force_angular_impulse", "N m s", "integral of its moment about the world's origin, world axes"),
        ("force_central_impulse", "N m s", "integral of its moment about the mass centre of all"),
    ),
    *rows(
        "summary: force",
        ("total_force_work", "J", "work of the force from start to end"),
        ("total_force_gross_work", "J", "integral of |power| of the force from start to end", _TOTAL),
        ("total_force_loss", "J", "energy lost in all, of one that puts nothing in"),
    ),
    *rows(
        "summary: force axis",
        ("total_impulse", "N s", "integral of the force from start to end, world axes"),
        ("total_angular_impulse", "N m s", "integral of its moment about the world's origin, world axes"),
    ),
    *rows(
        "summary: force_place",
        ("peak_applied_force", "N", "largest force there at a sample", _SIZE),
        ("peak_applied_torque", "N m", "largest torque about the place at a sample", _SIZE),
    ),
)
"""Their variables: series, then those of the whole run."""
