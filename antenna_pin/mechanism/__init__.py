"""From a URDF and its variants to a Pinocchio model."""

from antenna_pin.base.lazy import exported

exported(__name__)
