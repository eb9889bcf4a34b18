"""Simulation of a system: time loop, events, recorder, monitor, sessions."""

from antenna_pin.base.lazy import exported

exported(__name__)
