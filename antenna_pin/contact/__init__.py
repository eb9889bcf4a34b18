"""Materials, stiffness of a pair, normal laws and friction laws: numbers only."""

from antenna_pin._lazy import exported

exported(__name__)
