"""Analyses of runs, and of the contact scenarios of a joint's shape."""

from antenna_pin.base.lazy import exported

exported(__name__)
