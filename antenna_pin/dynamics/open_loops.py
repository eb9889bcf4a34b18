"""What is said of loops that are open: by how much, and whether it is a motion that is too fast for them."""

from __future__ import annotations

from typing import Any

from antenna_pin.base.readable import number
from antenna_pin.dynamics.system import System
from antenna_pin.elements import Motion

__all__ = ["said_of_open"]

# Of a motion's rate: what loops are open by in speed is round-off.
_ROUND_OFF = 1e-12


def said_of_open(system: System, found: Any, length: float) -> str:
    """Return in words by how much loops are open at the start, and the way out.

    Args:
        system: The system.
        found: Residuals of its constraints, FOUND.
        length: Of the mechanism, by which ways count as turns [m].
    """
    speed = max(found.speed / length, found.spin)
    rates = {
        name: abs(drive.profile()(0.0)[1])
        for name, drive in system.drives.items()
        if isinstance(drive, Motion)
    }
    fastest = max(rates, key=rates.__getitem__, default="")
    if fastest and max(found.gap / length, found.turn) <= speed <= _ROUND_OFF * rates[fastest]:
        joint = system.drives[fastest].joint
        unit = "m/s" if system.mechanism.joint(joint).kind == "prismatic" else "rad/s"
        return (
            f"motion {fastest!r} is too fast: it moves joint {joint!r} by {number(rates[fastest])} "
            f"{unit} at t = 0, and its loops cannot be closed better than to the round-off of that, "
            f"{number(found.speed)} m/s, {number(found.spin)} rad/s; make it slower"
        )
    return (
        f"its loops are open: {number(found.gap)} m, {number(found.turn)} rad, {number(found.speed)} m/s, "
        f"{number(found.spin)} rad/s; close it by antenna_pin.assembled"
    )
