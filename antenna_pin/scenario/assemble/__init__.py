"""Assembly of a scenario into a system: URDF variant, Pinocchio model, force elements, initial state."""

from antenna_pin.base.lazy import exported

exported(__name__)
