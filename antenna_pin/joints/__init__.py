"""The joint-contact plugin: from geometry, laws and memory to a wrench."""

from antenna_pin.base.lazy import exported

exported(__name__)
