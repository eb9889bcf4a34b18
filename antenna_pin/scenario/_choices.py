"""Tables that a file of this room has a class for by kind; the file is loaded when one is met."""

from __future__ import annotations

from antenna_pin.scenario._kinds import in_file

__all__ = ["CONTROLLER_SPECS", "COUPLING_SPECS", "EVENT_SPECS", "FLEXIBLE_SPECS"]

COUPLING_SPECS = in_file(
    "couplings",
    {"ratio": "CouplingSpec", "differential": "DifferentialSpec", "planetary": "PlanetarySpec"},
)
"""Tables of couplings by their kind; the first is that of a table that does not say."""

FLEXIBLE_SPECS = in_file(
    "flexible", {"modes": "ModesSpec", "petals": "PetalsSpec", "modal-data": "ModalDataSpec"}
)
"""Tables of flexible links by their kind."""

EVENT_SPECS = in_file(
    "events",
    {
        "angle": "AngleEvent",
        "rate": "RateEvent",
        "time": "TimeEvent",
        "gap": "GapEvent",
        "force": "ForceEvent",
    },
)
"""Tables of events by their kind."""

CONTROLLER_SPECS = in_file(
    "controllers",
    {
        "pid": "PidSpec",
        "state-feedback": "StateFeedbackSpec",
        "attitude": "AttitudeSpec",
        "bang-bang": "BangBangSpec",
    },
)
"""Tables of controllers by their kind."""
