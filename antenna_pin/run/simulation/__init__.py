"""Simulation: run loop, recorder, events, monitor."""

from antenna_pin.base.lazy import exported

exported(__name__)
