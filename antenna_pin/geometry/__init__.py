"""Where journal and bearing meet and how deep: surfaces, no forces."""

from antenna_pin.base.lazy import exported

exported(__name__)
