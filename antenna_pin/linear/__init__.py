"""Small motions about a state: linearisation, modes, frequency responses."""

from antenna_pin._lazy import exported

exported(__name__)
