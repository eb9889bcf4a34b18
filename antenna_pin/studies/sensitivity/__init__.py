"""Sensitivities: derivatives of a run's results over numbers of its scenario, through events."""

from antenna_pin.base.lazy import exported

exported(__name__)
