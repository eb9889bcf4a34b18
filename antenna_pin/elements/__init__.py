"""Force elements: drives, a controller, springs and dampers at joints, springs between points."""

from antenna_pin.base.lazy import exported

exported(__name__)
