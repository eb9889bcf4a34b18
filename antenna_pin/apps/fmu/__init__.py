"""Scenarios as functional mock-up units (FMI 3.0, co-simulation)."""

from antenna_pin.base.lazy import exported

exported(__name__)
