"""Laws that are functions of a user's, compiled ones: asked by their addresses."""

from __future__ import annotations

from antenna_pin.base.records import Record
from antenna_pin.compiled.calls import call_1, call_3
from antenna_pin.compiled.decorators import inlined
from antenna_pin.contact.records import dissipation_record, elastic_record, friction_record

CALLED = 100.0  # as a kind of elastic law
CALLED_WHOLE = 100.0  # as a kind of dissipation
CALLED_FRICTION = 20.0


class CalledLaw(Record):
    """A user's elastic law."""

    address: float  # of its force
    energy: float  # address of its energy
    limit: float  # depth at whose end it is called past it [m]


CALLED_LAW = elastic_record(CalledLaw)


class CalledWholeLaw(Record):
    """A user's law of force over depth and rate."""

    whole: float  # address
    end: float  # depth at whose end it is called past it [m]


CALLED_WHOLE_LAW = dissipation_record(CalledWholeLaw)


class CalledFrictionLaw(Record):
    """A user's friction law."""

    address: float  # of its coefficient


CALLED_FRICTION_LAW = friction_record(CalledFrictionLaw)


@inlined
def called_force(law: CalledLaw, depth: float) -> float:
    """Elastic force [N]."""
    return float(call_1(law.address, min(depth, law.limit))) if depth > 0.0 else 0.0


@inlined
def called_energy(law: CalledLaw, depth: float) -> float:
    """Energy stored [J]."""
    return float(call_1(law.energy, min(depth, law.limit)))


@inlined
def called_whole(law: CalledWholeLaw, depth: float, rate: float, approach_speed: float) -> float:
    """Whole normal force [N]; never adhesive."""
    if depth <= 0.0:
        return 0.0
    force = float(call_3(law.whole, min(depth, law.end), rate, approach_speed))
    return force if not force < 0.0 else 0.0  # NaN stays NaN


@inlined
def called_ratio(law: CalledFrictionLaw, speed: float) -> float:
    """Friction coefficient over slip speed [s/m]; none at rest."""
    return float(call_1(law.address, speed)) / speed if speed > 0.0 else 0.0
