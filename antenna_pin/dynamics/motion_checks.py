"""Motions before a run: their joints' limits, and jumps that no joint can follow."""

from __future__ import annotations

import numpy as np

from antenna_pin.base.readable import number
from antenna_pin.dynamics.system import System
from antenna_pin.elements import Motion, PrescribedMotion
from antenna_pin.errors import MechanismError

__all__ = ["check_jumps", "check_limits"]

# Times at which a motion is compared with its joint's limits.
_LOOKS = 1001


def check_limits(system: System, name: str, motion: Motion, begin: float, end: float) -> None:
    """Refuse a motion that leaves its joint's limits in the URDF, from a time to another [s]."""
    limit = system.mechanism.urdf.joint(motion.joint).limit
    kind = system.mechanism.joint(motion.joint).kind
    if limit is None or limit.lower is None or limit.upper is None or kind == "continuous":
        return
    unit = "m" if kind == "prismatic" else "rad"
    profile = motion.profile()
    for t in np.linspace(begin, end, _LOOKS):
        position = profile(float(t))[0]
        if not limit.lower <= position <= limit.upper:
            raise MechanismError(
                f"motion {name!r}: joint {motion.joint!r} must stay from {number(limit.lower)} to "
                f"{number(limit.upper)} {unit} by its <limit>, got {number(position)} {unit} at t = "
                f"{number(float(t))} s; change the motion, or the limit in the URDF or by "
                f"mechanism.joints.{motion.joint}"
            )


def check_jumps(system: System, name: str, motion: Motion, begin: float, end: float) -> None:
    """Refuse a motion along a reference that jumps, or whose rate does and must not, within a run [s]."""
    if not isinstance(motion, PrescribedMotion):
        return
    unit = "m" if system.slides(motion.joint) else "rad"
    for one in motion.jumps:
        if one.again:
            size = f"{number(one.rate)} {unit}/s" if one.rate else f"{number(one.value)} {unit}"
            raise MechanismError(
                f"motion {name!r}: its reference must be without jumps that come again for ever, got one of "
                f"{size} every {number(one.again)} s; join the table's points by interpolation = 'smooth', "
                "or write them down without periodic"
            )
        if not begin < one.time <= end or not (one.value or motion.rate_jumps == "refused"):
            continue
        what, size, way = (
            ("position", f"{number(one.value)} {unit}", "have a pd drive follow it")
            if one.value
            else ("rate", f"{number(one.rate)} {unit}/s", "take rate_jumps = 'impulse'")
        )
        raise MechanismError(
            f"motion {name!r}: the {what} of its reference must not jump within the run, got {size} at t = "
            f"{number(one.time)} s; {way}, or a reference that is smooth there"
        )
