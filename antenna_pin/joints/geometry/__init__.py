"""Places and depths of contact between journal and bearing: surfaces, no forces."""

from antenna_pin.base.lazy import exported

exported(__name__)
