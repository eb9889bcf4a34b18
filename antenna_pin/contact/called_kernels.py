"""Laws that are functions of a user's, compiled ones: asked by their addresses."""

from __future__ import annotations

from typing import Any

from antenna_pin.compiled.calls import call_1, call_3
from antenna_pin.compiled.decorators import inlined
from antenna_pin.contact.records import dissipation_record, elastic_record, friction_record

CALLED = 100.0  # as a kind of elastic law
CALLED_WHOLE = 100.0  # as a kind of dissipation
CALLED_FRICTION = 20.0

# Addresses of the functions, and the depth at whose end they are asked past it [m].
CALLED_LAW = elastic_record("address", "energy", "limit")
CALLED_WHOLE_LAW = dissipation_record("whole", "end")
CALLED_FRICTION_LAW = friction_record("address")


@inlined
def called_force(law: Any, depth: float) -> float:
    """Elastic force [N]."""
    return float(call_1(law.address, min(depth, law.limit))) if depth > 0.0 else 0.0


@inlined
def called_energy(law: Any, depth: float) -> float:
    """Energy stored [J]."""
    return float(call_1(law.energy, min(depth, law.limit)))


@inlined
def called_whole(law: Any, depth: float, rate: float, approach_speed: float) -> float:
    """Whole normal force [N]; never adhesive."""
    if depth <= 0.0:
        return 0.0
    force = float(call_3(law.whole, min(depth, law.end), rate, approach_speed))
    return force if not force < 0.0 else 0.0  # NaN stays NaN


@inlined
def called_ratio(law: Any, speed: float) -> float:
    """Friction coefficient over slip speed [s/m]; none at rest."""
    return float(call_1(law.address, speed)) / speed if speed > 0.0 else 0.0
