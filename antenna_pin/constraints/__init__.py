"""Closed loops, couplings and motions: what joints must satisfy besides the tree, and how it is held."""

from antenna_pin.base.lazy import exported

exported(__name__)
