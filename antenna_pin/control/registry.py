"""The controllers by the names that a scenario has for them. One enters by a line here."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from antenna_pin.control.attitude import AttitudeFeedback
from antenna_pin.control.pid import Pid
from antenna_pin.control.relay import BangBang
from antenna_pin.control.state_feedback import StateFeedback

__all__ = ["CONTROLLERS"]

CONTROLLERS: Mapping[str, type[Any]] = MappingProxyType(
    {
        "pid": Pid,
        "state-feedback": StateFeedback,
        "attitude": AttitudeFeedback,
        "bang-bang": BangBang,
    }
)
"""Controllers by their ``kind`` in ``[controllers.NAME]``."""
