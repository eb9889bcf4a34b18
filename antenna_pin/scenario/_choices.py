"""Tables with a class by kind, in a file that is loaded at first use."""

from __future__ import annotations

from antenna_pin.base.lazy import Classes

__all__ = ["CONTROLLER_SPECS", "COUPLING_SPECS", "EVENT_SPECS", "FLEXIBLE_SPECS"]

_ROOM = "antenna_pin.scenario"

COUPLING_SPECS = Classes(
    _ROOM,
    {
        "ratio": "couplings.CouplingSpec",
        "differential": "couplings.DifferentialSpec",
        "planetary": "couplings.PlanetarySpec",
    },
)
"""Tables of couplings by their kind; the first is that of a table that does not say."""

FLEXIBLE_SPECS = Classes(
    _ROOM,
    {"modes": "flexible.ModesSpec", "petals": "flexible.PetalsSpec", "modal-data": "flexible.ModalDataSpec"},
)
"""Tables of flexible links by their kind."""

EVENT_SPECS = Classes(
    _ROOM,
    {
        "angle": "events.AngleEvent",
        "rate": "events.RateEvent",
        "time": "events.TimeEvent",
        "gap": "events.GapEvent",
        "force": "events.ForceEvent",
        "change": "events.ChangeEvent",
    },
)
"""Tables of events by their kind."""

CONTROLLER_SPECS = Classes(
    _ROOM,
    {
        "pid": "controllers.PidSpec",
        "state-feedback": "controllers.StateFeedbackSpec",
        "attitude": "controllers.AttitudeSpec",
        "bang-bang": "controllers.BangBangSpec",
    },
)
"""Tables of controllers by their kind."""
