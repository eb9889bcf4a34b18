"""Materials, stiffness of a pair, normal laws and friction laws: numbers only."""

from antenna_pin.base.lazy import exported

exported(__name__)
