"""Arithmetic of Liu's pin joint, of :mod:`antenna_pin.contact.pin_joint`, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Record
from antenna_pin.compiled.decorators import kernel
from antenna_pin.contact.records import elastic_record


class PinJointLaw(Record):
    """Liu's pin joint."""

    factor: float  # (pi/2) E* L [N/m]
    journal_radius: float  # R_j [m]
    bearing_radius: float  # R_i [m]
    clearance: float  # dR [m]
    share: float  # of the depth that shapes the contact [-]


PIN_JOINT_LAW = elastic_record(PinJointLaw)


@kernel
def pin_joint_force(law: PinJointLaw, depth: float) -> float:
    """Elastic force [N] of a record of ``PIN_JOINT_LAW``; odd in the depth.

    Liu et al. 2013 (24) and (28); a^2 is written so that nothing cancels at small depth.
    """
    journal, bearing, clearance = law.journal_radius, law.bearing_radius, law.clearance
    size = abs(depth)
    d = min(size * law.share, math.sqrt((bearing + journal) * clearance) - clearance)
    s = clearance + d
    inner = 4.0 * bearing * clearance + 2.0 * (bearing + clearance) * d + d * d
    square = d * (2.0 * journal - d) * inner / (4.0 * s * s)
    if square < 1e-300:
        return 0.0
    force = law.factor * size / (math.log(16.0 * journal * journal / square) - 1.0)
    return float(force if depth > 0.0 else -force)
