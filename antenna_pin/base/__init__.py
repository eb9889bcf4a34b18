"""Basics of every room, without mechanics: parameters, checks, units, text, files, state."""

from antenna_pin.base.lazy import exported

exported(__name__)
