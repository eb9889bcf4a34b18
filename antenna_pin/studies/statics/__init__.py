"""Statics: equilibria, quasi-static travel and torque-angle loops of mechanisms."""

from antenna_pin.base.lazy import exported

exported(__name__)
