"""Margins of mechanisms: motorization over the travel, in the worst case."""

from antenna_pin.base.lazy import exported

exported(__name__)
