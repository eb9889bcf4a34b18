"""Controllers by their names in a scenario; each is registered by a line here."""

from __future__ import annotations

from antenna_pin.base.lazy import Classes

CONTROLLERS = Classes(
    "antenna_pin.elements.control",
    {
        "pid": "pid.Pid",
        "state-feedback": "state_feedback.StateFeedback",
        "attitude": "attitude.AttitudeFeedback",
        "bang-bang": "relay.BangBang",
    },
)
"""Controllers by their ``kind`` in ``[controllers.NAME]``."""
