"""Closed loops, couplings and motions: constraints beyond the tree, and their enforcement."""

from antenna_pin.base.lazy import exported

exported(__name__)
