"""Linearisation: small motions about a state, modes, frequency responses."""

from antenna_pin.base.lazy import exported

exported(__name__)
