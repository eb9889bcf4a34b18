"""Small motions about a state: linearisation, modes, frequency responses."""

from antenna_pin.base.lazy import exported

exported(__name__)
